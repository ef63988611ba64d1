// [[constraint]] of a study file -> Study.constraints (docs/constraints.md).
#pragma once
#include "optimise/study.h"
#include "optimise/toml_reader.h"

namespace gradwright {

/// Needs machine and design space: the family says which variables there are, and given values are held
/// against the constraints.
void read_constraints(TomlReader& reader, Section& root, Study& study);

}  // namespace gradwright
