// The hand-over of a finished design: read back from its folder, written to OUT/spec. `spec` and the end of
// `design` are one way.
#pragma once
#include <string>
#include <vector>

#include "reports/spec_folder.h"

namespace gradwright::cli {

struct SpecOutcome {
    Study study;
    FinishedDesign finished;
    HandOver over;
    SpecFiles files;
    std::string folder;  ///< OUT/spec
};

/// `set`: replaced values of [partition_build], nothing else. Throws Failure and InputError.
SpecOutcome make_spec(const std::string& out, const std::vector<std::string>& set, StepSchema schema);

}  // namespace gradwright::cli
