// Speed against error as JSON, as text for a terminal and as a page.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "optimise/tradeoff.h"

namespace gradwright {

nlohmann::json tradeoff_json(const Study& study, const Tradeoff& tradeoff);
/// Table of the levels and what is recommended. Ends with a newline.
std::string tradeoff_text(const Study& study, const Tradeoff& tradeoff);
/// One self-contained page for the object of tradeoff_json().
std::string tradeoff_html(const nlohmann::json& tradeoff);

}  // namespace gradwright
