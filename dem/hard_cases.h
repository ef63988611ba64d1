// Hard cases: scenes at the edge of what a spread can be, each with the end it must come to. The sound ones
// must complete; the others must end with a named status that says which knob to turn. Never NaN, a hang, or
// a layer that means nothing. `gradwright limits` prints them, the tests assert them, docs/hard-cases.md
// keeps the last outcome.
#pragma once
#include <string>
#include <vector>

#include "dem/scene.h"
#include "dem/spread.h"

namespace gradwright {

struct HardCase {
    std::string id;        ///< short, for --only
    std::string tried;     ///< the scene in one line, with its numbers
    std::string expected;  ///< the end it must come to
    std::string happened;  ///< status, reason or the numbers that show it
    bool pass = false;
    double seconds = 0;
};

struct HardCaseSpec {
    std::string id, tried, expected;
    bool quick = false;                                        ///< under two seconds
    void (*run)(const SpreadOptions& options, HardCase& out);  ///< sets happened and pass
};

/// All hard cases in the order of the page.
const std::vector<HardCaseSpec>& hard_cases();

HardCase run_hard_case(const HardCaseSpec& spec, const SpreadOptions& options);

}  // namespace gradwright
