// [partition_build] of a study: what the workshop makes the partition of and what the operator fills in.
#pragma once
#include "optimise/toml_reader.h"

namespace gradwright {

/// Reads [partition_build] into study.build. Machine, powders, process and partition must be read before: the
/// defaults and the refusals rest on them. Nothing here changes a spread.
void read_partition_build(TomlReader& reader, Section& root, Study& study);

/// K-factor of a bend with this inside radius and sheet thickness [m]: DIN 6935's k = 0.65 + lg(r/t)/2, at
/// most 1, which counts in half thicknesses.
double din_k_factor(double bend_radius, double thickness);

/// Finest D10 of the two powders [m]: no gap around the plate may be wider.
double finest_d10(const Study& study);

}  // namespace gradwright
