// A gradation over x and y as JSON and as text: one value per cell, row by row [y][x].
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "optimise/study_result.h"

namespace gradwright {

/// {x_m, y_m, target, predicted, confirmed, predicted_standard_error, standard_error, band_low, band_high,
/// weight, left_out, band, order}; null for a target of y alone. Cells without weight are null in target and
/// confirmed and stand in left_out, as in `profile`. Bands: simultaneous 95 % over the cells that count.
nlohmann::json field_json(const StudyResult& result);
/// The same of one evaluation: {x_m, y_m, target, gi, standard_error, band_low, band_high, weight, ...}.
nlohmann::json field_json(const Evaluation& evaluation);

/// Target and what was found, side by side over x, one line per y.
std::string field_table(const GradationField& found, const std::vector<double>& target, const char* name);

}  // namespace gradwright
