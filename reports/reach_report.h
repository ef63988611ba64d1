// What can be reached, as JSON and as text for a terminal.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "optimise/reach.h"

namespace gradwright {

/// reach.json and --json; docs/schema/reach.schema.json. `design` is the best one for the study's own target:
/// `evaluate --design` takes the file.
nlohmann::json reach_json(const Study& study, const Reach& reach);
/// Limits first, then the scans behind them. Ends with a newline.
std::string reach_text(const Study& study, const Reach& reach);

}  // namespace gradwright
