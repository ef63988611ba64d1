// The plates as closed triangle meshes in one ASCII STL file, lengths in mm.
#pragma once
#include <string>
#include <vector>

#include "reports/plate_mesh.h"

namespace gradwright {

/// `name` stands in the first line; line breaks in it become spaces.
std::string stl_text(const std::vector<Plate>& plates, const std::string& name);

}  // namespace gradwright
