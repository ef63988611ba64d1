// Between two passes (physics.md 1, `layers`): the blade has stopped, the grains are at rest, the layer has
// been measured.
//
//   overflow   what lies behind the platform's end is gone: the next dose's heap begins with none of it
//   substrate  fused: the layer is melted, all of it: the part covers the platform. Its grains are gone and a
//              fresh fused surface stands one gap below the blade's edge. Powder and plate: the layer stays
//              as it lies and the platform sinks by one layer thickness, which is the gap of the next layer
//   dose       the dispenser's floor and all the powder on it rise by the dose h. Chamber levels are history:
//              the blade has levelled them
//   blade      back behind the dispenser, lifted clear of the powder on its way
//
// The few grains that the blade rolled over and left on the land before the platform go on with the next
// dose. They rise with the bed (else it would rise into them at the rim) and fall back while the blade
// crosses the dispenser. The bed rises as one, floor and springs included, which is what a slow piston does;
// rejected: a floor that moves at a speed, some 1e5 steps for a motion in which no grain moves against
// another.
#pragma once
#include "dem/stage.h"

namespace gradwright {

/// Sets up the pass after `before` and lets the grains come to rest. `first_mobile`: id of the bed's first
/// grain in the engine.
Pass next_pass(const Scene& scene, const Stage& stage, const Pass& before, Engine& engine, int first_mobile);

/// Runs until the grains are at rest (physics.md 1.5) or 20000 steps are done.
void come_to_rest(const Scene& scene, Engine& engine, std::size_t grains);

}  // namespace gradwright
