// Machine files: geometry of a spreading machine as TOML, every number as { value = "...", source = "..." }.
// A source that says "measure this" marks a stand-in, and so does a number without a source: a study that
// uses it shows the number as assumed and warns. `feed` says how powder comes before the blade: "piston", the
// default and the only one that has a dispenser for a partition to stand in.
#pragma once
#include <string>
#include <vector>

#include "optimise/study_file.h"

namespace gradwright {

class TomlReader;

/// What stands in the source of a number that nobody has measured.
inline constexpr const char* kMeasureThis = "measure this";

/// Keys a machine file may hold, as they stand under [machine] of a study.
const std::vector<std::string>& machine_keys();

/// Every number of a machine with its source, in the order of machine_keys(). `use`: a shipped name, or a
/// path ending in .toml relative to `folder`. Values stand as they are written, unread. Throws InputError
/// when the file cannot be read or is no TOML.
std::vector<MachineNumber> machine_numbers(const std::string& use, const std::string& folder);

/// Finds `use` (a shipped name, or a path ending in .toml relative to the study) and lets its numbers stand
/// in wherever the study's [machine] says nothing. Problems of the machine file, or an unknown name, go to
/// the reader. Returns the machine's title; empty when it could not be used.
std::string supply_machine(TomlReader& reader, const std::string& use, const InputProblem& at);

}  // namespace gradwright
