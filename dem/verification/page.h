// docs/verification.md and its plots, written by the program itself: `gradwright verify --docs DIR`.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "dem/verification/verification.h"

namespace gradwright {

/// Cases of one run of the ladder.
struct VerificationRun {
    Precision precision = Precision::double_law;
    VerificationCases cases;
};

struct VerificationPage {
    std::string markdown;                                     ///< refers to its pictures as images/NAME
    std::vector<std::pair<std::string, std::string>> images;  ///< file name, SVG text
};

/// Measures the curves, runs the mutations on the rungs that must see them, and writes the page. Some
/// minutes. `runs`: whole ladders, as just run. `progress`: what is being done, share of it.
VerificationPage verification_page(const std::vector<VerificationRun>& runs,
                                   const std::function<void(const std::string&, double)>& progress);

}  // namespace gradwright
