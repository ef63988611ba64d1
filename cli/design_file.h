// The design of an earlier result, read back from its JSON.
#pragma once
#include <string>

#include "optimise/study.h"

namespace gradwright::cli {

/// Takes result.json, partition.json or a design object. What the file leaves out keeps the study's start
/// value. Throws Failure io without the file, InputError with everything that is no design.
Design read_design(const std::string& file, const Study& study);

}  // namespace gradwright::cli
