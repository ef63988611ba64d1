// What the plots of the page show, each measured by the rung that owns it. Private to the ladder.
#pragma once
#include <utility>
#include <vector>

#include "dem/energy_ledger.h"
#include "dem/verification/laboratory.h"

namespace gradwright::verification {

/// Test 4 of Chung & Ooi 2011 at one angle. Rebound angle: of the contact point's velocity [deg].
struct ObliquePoint {
    double angle_deg = 0, tangential_restitution = 0, spin = 0, rebound_deg = 0;
};
/// Undamped along the tangent, as the reference. `speed_factor` scales the impact speed.
ObliquePoint oblique_impact(const VerificationOptions& options, double angle_deg, double speed_factor = 1);
/// Read off the published curve.
std::vector<ObliquePoint> digitised_oblique_impacts();
/// Closed form where it slides all the way.
std::vector<ObliquePoint> sliding_oblique_impacts();

/// Slow push and pull of two grains of 40 um, modulus and adhesion softened: overlap [m] and force [N], as
/// the engine has them, in units of the tear-off overlap and the pull-off force.
struct JkrLoop {
    std::vector<double> in_overlap, in_force, out_overlap, out_force;
    std::vector<double> curve_overlap, curve_force;  ///< JKR 1971, both branches
};
JkrLoop jkr_loop(const VerificationOptions& options);

/// Rebound speed of two grains of 40 um, adhesive with the scaled work of adhesion; 0: they stay together.
/// `dt` [s].
double adhesive_rebound(const VerificationOptions& options, double restitution, double speed, double dt);
double elastic_sticking_speed();  ///< of the same two grains at e = 1, closed form [m/s]
/// The same without adhesion at the production step, 0.2 Rayleigh times of this grain; the touch falls at
/// `phase` of a step.
double production_rebound(const VerificationOptions& options, double restitution, double speed, double phase);

/// Error of the overlap at 0.7 contact times against the finest run, over the largest overlap, by steps a
/// contact.
struct StepErrors {
    std::vector<double> steps, elastic, damped_inside, damped_from_touch;
};
StepErrors step_errors(const VerificationOptions& options);

/// Way of the blade [m] and account of the pile of rung V16 (JKR, spring rolling).
std::vector<std::pair<double, EnergyLedger>> pushed_pile_account(const VerificationOptions& options);

}  // namespace gradwright::verification
