// Strategies side by side, as JSON and as text for a terminal.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "optimise/strategy_comparison.h"

namespace gradwright {

nlohmann::json comparison_json(const Study& study, const StrategyComparison& comparison);
/// One row a strategy. Ends with a newline.
std::string comparison_text(const Study& study, const StrategyComparison& comparison);

}  // namespace gradwright
