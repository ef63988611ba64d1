// What the reductions that a study uses are known to cost: from the study's own `tradeoff`, else from the
// table of docs/speed-against-error.md, which was measured on the first example and travels inside the
// program.
#pragma once
#include <nlohmann/json.hpp>

#include "optimise/study.h"

namespace gradwright {

/// {own, source, command, study, seeds, noise_allowed, used, levels[{name, meaning, reductions, speed_up,
/// gi_rmse, noise_floor, packing_error, max_overlap_ratio, within_noise, overlap_rule_kept, ...}]}: the table
/// in which one level, `used`, has the study's reductions, softening, time step, coarse factor and sleep.
/// Null when none has.
nlohmann::json reduction_cost(const Study& study);
/// The same from the object of tradeoff_json() for this very study; `command` reproduces it. Null when its
/// level "study" has not been spread.
nlohmann::json reduction_cost(const nlohmann::json& tradeoff, const std::string& command);

}  // namespace gradwright
