// [target] of a study file -> Study.target, footprint, bins: the wish, and where it is judged
// (docs/targets.md).
#pragma once
#include "optimise/study.h"
#include "optimise/toml_reader.h"

namespace gradwright {

/// Needs machine, powders and process: footprint and margins follow from them.
void read_target(TomlReader& reader, Section& root, Study& study);

}  // namespace gradwright
