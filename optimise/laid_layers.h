// Each layer of a run of several, in numbers: what is common to a spread with both powders and a map's
// strips.
#pragma once
#include <span>
#include <vector>

#include "optimise/evaluation.h"

namespace gradwright {

/// Volumes and fractions of layer `number` (from 1), means over `spreads`; profile, drift and misfits are
/// left to the evaluator. `footprint` in the layers' own y.
LaidLayer laid_layer(std::span<const SpreadResult> spreads, int number, const Footprint& footprint);

/// Misfits of the layer's profile and drift, by the rule of judge().
void judge_layer(const Study& study, const Design& design, LaidLayer& layer);

/// h phi_bed A_dispenser / (g phi_layer A_platform) of a judged layer, or of all pooled [-].
double supply_ratio_of(const Study& study, const Scene& scene, const Layer& layer);

}  // namespace gradwright
