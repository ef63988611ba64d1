// One impact of two spheres, or of a sphere and a rigid plane, by the ordinary differential equations of the
// law without the engine: Hertz, Tsuji damping, F_t = -S_t xi - c_t v_t under Coulomb's cap. A second text of
// the law for reference values where no closed form exists; private to the ladder.
#pragma once
#include "dem/verification/laboratory.h"

namespace gradwright::verification {

/// Same set-up and same results as run_impact (force_max is left 0), by a midpoint rule with 40 000 steps an
/// elastic contact. Without adhesion and without rolling resistance.
ImpactResult integrate_impact(const ImpactSetup& setup);

}  // namespace gradwright::verification
