// The plates as closed triangle meshes in one ASCII STL file, lengths in mm.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

using MeshPoint = std::array<double, 3>;    ///< [mm]
using Triangle = std::array<MeshPoint, 3>;  ///< counter-clockwise seen from outside

/// Closed surface of a plate: every edge in exactly two triangles, once each way. Arcs as chords within
/// `sagitta` [m].
std::vector<Triangle> plate_mesh(const Plate& plate, double sagitta);

/// `name` stands in the first line; line breaks in it become spaces.
std::string stl_text(const std::vector<Plate>& plates, const std::string& name);

}  // namespace gradwright
