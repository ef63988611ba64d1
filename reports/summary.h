// The outcome on a terminal: verdict first, then the numbers with band and floor, what to build, what to
// fill, what it cost.
#pragma once
#include <string>
#include <vector>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

enum class TerminalColour { plain, ansi };

/// Text of several lines. `ansi` colours the verdict only (the caller looks at NO_COLOR and isatty).
std::string summary(const Study& study, const StudyResult& result, const std::string& folder = "",
                    const std::vector<std::string>& files = {},
                    TerminalColour colour = TerminalColour::plain);

/// The same for `evaluate`.
std::string evaluation_summary_text(const Study& study, const Evaluation& evaluation);

}  // namespace gradwright
