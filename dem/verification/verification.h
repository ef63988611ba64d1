// The verification ladder: published impacts, closed forms and conservation laws, each run
// through the engine's own stepping path. Part of the product: `gradwright verify` prints what the tests
// assert. No test framework here.
#pragma once
#include <string>
#include <vector>

#include "dem/contact_law.h"
#include "dem/scene.h"

namespace gradwright {

/// One claim of the ladder with its outcome.
struct VerificationCase {
    std::string id;        ///< rung: "V1" ... "V16"
    std::string name;      ///< the case, with the numbers that set it apart
    std::string quantity;  ///< what is compared, with its unit
    double expected = 0, obtained = 0;
    double error = 0;  ///< relative to `expected`, or to the scale that the quantity's name gives; for bounds
                       ///< and orders the excess
    double tolerance = 0;  ///< largest error that passes
    std::string source;    ///< formula or publication
    bool pass = false;
};

struct VerificationOptions {
    Precision precision = Precision::double_law;
    LawFault fault;  ///< a deliberate fault: the ladder must turn red
};

using VerificationCases = std::vector<VerificationCase>;

/// V1: elastic Hertz impacts, tests 1-3 of Chung & Ooi 2011: overlap, force, contact time.
VerificationCases verify_hertz_impacts(const VerificationOptions& options);
/// V2: rebound speed over impact speed is the coefficient of restitution that was asked for.
VerificationCases verify_restitution(const VerificationOptions& options);
/// V3: oblique impacts, test 4 of Chung & Ooi 2011, without tangential damping.
VerificationCases verify_oblique_impacts(const VerificationOptions& options);
/// V4: impacts with spin in gross sliding, and of two grains that turn like gears.
VerificationCases verify_spin_impacts(const VerificationOptions& options);
/// V5: the JKR curve, its landmarks, and the work lost in one make-and-break.
VerificationCases verify_jkr_curve(const VerificationOptions& options);
/// V6: the impact speed below which two adhesive grains stay together.
VerificationCases verify_sticking_speed(const VerificationOptions& options);
/// V7: a sliding grain comes to roll at 5/7 of its speed.
VerificationCases verify_slide_to_roll(const VerificationOptions& options);
/// V8: rolling resistance: spin-down, rolling down an incline, rest on it.
VerificationCases verify_rolling(const VerificationOptions& options);
/// V9: force = slope of the elastic energy; energy error falls fourfold with half the step; dissipative laws
/// only lose energy.
VerificationCases verify_energy(const VerificationOptions& options);
/// V10: an isolated cluster keeps its momentum and angular momentum.
VerificationCases verify_conservation(const VerificationOptions& options);
/// V11: the neighbour list finds what a search over all pairs finds; the same bits on 1, 2, 3 and 8 threads.
VerificationCases verify_neighbours(const VerificationOptions& options);
/// V12: a gas of smooth inelastic grains, periodic in x, y and z, cools by Haff's law.
VerificationCases verify_cooling(const VerificationOptions& options);
/// V13: order of the time step.
VerificationCases verify_time_step_order(const VerificationOptions& options);
/// V15: a wall is the limit of a huge grain; edges and corners.
VerificationCases verify_walls(const VerificationOptions& options);
/// V16: energy of a pushed pile and of a whole spread: work of the blade = losses + change of what is held.
/// The spread is run as users run it, so a fault in `options` reaches the piles only.
VerificationCases verify_balance(const VerificationOptions& options);

/// A rung by its name, for `verify --only V5`.
struct VerificationRung {
    std::string id, claim;
    VerificationCases (*run)(const VerificationOptions&);
};
const std::vector<VerificationRung>& verification_ladder();

/// A deliberate fault that the ladder must see, for `verify --mutate`.
struct Mutation {
    std::string name;  ///< "damping", "history", "pull_off", "lever_arm"
    std::string fault_text;
    LawFault fault;
    std::vector<std::string> red;  ///< rungs that must turn red
};
const std::vector<Mutation>& mutations();

}  // namespace gradwright
