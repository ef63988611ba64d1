// design_space.partition of a study: family, its numbers fixed or free, and what can be built.
#pragma once
#include "optimise/toml_reader.h"

namespace gradwright {

/// Reads design_space.partition into study.design_space. The machine and the plate thickness must be read
/// before: the defaults and the refusals rest on them.
void read_partition(TomlReader& reader, Section& space, Study& study);

}  // namespace gradwright
