// The shipped material table (examples/materials.toml): density, Young's modulus, Poisson's ratio, each
// number with its source. A study may also write a material in place as { density = "...", youngs_modulus =
// "...", ... }.
#pragma once
#include <vector>

#include "dem/material.h"

namespace gradwright {

/// Reads a material table. Throws InputError with every problem of the file.
std::vector<Material> read_materials(const std::string& file);

}  // namespace gradwright
