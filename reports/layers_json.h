// Each layer of several as JSON: profile, drift, fractions and volumes, with the one that is judged.
#pragma once
#include <nlohmann/json.hpp>

#include "optimise/study_result.h"

namespace gradwright {

/// Number of the judged layer, or "all".
nlohmann::json judged_layer_json(const Study& study);

/// One entry a layer. An evaluation of a single layer has one, with the evaluation's own numbers; one that
/// laid nothing (kinematic, failed) has none.
nlohmann::json layers_json(const Study& study, const Evaluation& evaluation);

/// Of a design: each layer's mean over the confirmations, over the prediction where there are none. Empty
/// where the study lays one.
nlohmann::json layers_json(const Study& study, const StudyResult& result);

/// The layers behind layers_json(study, result).
std::vector<LaidLayer> mean_layers(const Study& study, const StudyResult& result);

/// A line a layer for people; empty for a single layer on fused metal or a plate.
std::string layers_text(const Study& study, std::span<const LaidLayer> layers);

}  // namespace gradwright
