// The sections of a study file that describe the spread itself: [machine], [powder], [process],
// [interaction], [numerics] -> Study.scene and what stands beside it. Called by study_file in this order.
#pragma once
#include "optimise/study.h"
#include "optimise/toml_reader.h"

namespace gradwright {

void read_machine(TomlReader& reader, Section& root, Study& study);
void read_powders(TomlReader& reader, Section& root, Study& study);
/// Needs the powders: roughness, gap warning.
void read_process(TomlReader& reader, Section& root, Study& study);
void read_interaction(TomlReader& reader, Section& root, Study& study);
/// Needs machine and powders; applies the named reductions.
void read_numerics(TomlReader& reader, Section& root, Study& study);

/// Largest grain that either powder holds [m].
double largest_grain(const Scene& scene);

}  // namespace gradwright
