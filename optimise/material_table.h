// The shipped material table (examples/materials.toml): density, Young's modulus, Poisson's ratio, nominal
// composition, each with its source. A study may also write a material in place as { density = "...",
// youngs_modulus = "...", ... }.
#pragma once
#include <vector>

#include "dem/material.h"

namespace gradwright {

class Section;

/// Reads a material table. Throws InputError with every problem of the file.
std::vector<Material> read_materials(const std::string& file);

/// composition = { wt = { Ni = 52.5, Fe = "balance" }, source = "..." } of a material's table: wt% by
/// chemical symbol, at most one "balance" (100 less the rest), together at most 100. Optional; problems go to
/// the reader of `material`. `source`: what stands in for a missing one; empty = it is required.
void read_composition(Section& material, Material& into, const std::string& source = "");
/// "Ni 52.5, Cr 19, Fe 18.925": falling shares [wt%]; "not known" for an empty one.
std::string composition_text(const Material& material);

}  // namespace gradwright
