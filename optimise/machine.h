// Machine files: geometry of a spreading machine as TOML, every number as { value = "...", source = "..." }.
// A source that says "measure this" marks a stand-in: a study that uses it shows the number as assumed and
// warns.
#pragma once
#include <string>
#include <vector>

#include "optimise/study_file.h"

namespace gradwright {

class TomlReader;

/// Keys a machine file may hold, as they stand under [machine] of a study.
const std::vector<std::string>& machine_keys();

/// Finds `use` (a shipped name, or a path ending in .toml relative to the study) and lets its numbers stand
/// in wherever the study's [machine] says nothing. Problems of the machine file, or an unknown name, go to
/// the reader. Returns the machine's title; empty when it could not be used.
std::string supply_machine(TomlReader& reader, const std::string& use, const InputProblem& at);

}  // namespace gradwright
