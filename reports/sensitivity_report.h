// What moves a design's gradation, as JSON, as text for a terminal and as a picture.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "optimise/sensitivity.h"

namespace gradwright {

nlohmann::json sensitivity_json(const Study& study, const Sensitivity& sensitivity);
/// Tables of the inputs, largest effect first, and the tolerance budget. Ends with a newline.
std::string sensitivity_text(const Study& study, const Sensitivity& sensitivity);
/// Tornado: bars of |effect on GI|, rms over the bins that count, of every input over its range, with the
/// noise floor as a line. SVG.
std::string tornado_svg(const Sensitivity& sensitivity);

}  // namespace gradwright
