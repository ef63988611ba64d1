#include "dem/verification/verification.h"

namespace gradwright {

const std::vector<VerificationRung>& verification_ladder() {
    static const std::vector<VerificationRung> rungs = {
        {"V1", "Hertz impacts have the published overlap, force and contact time", verify_hertz_impacts},
        {"V2", "grains rebound with the coefficient of restitution asked for", verify_restitution},
        {"V3", "oblique impacts follow the published curves", verify_oblique_impacts},
        {"V4", "spinning impacts follow the closed forms", verify_spin_impacts},
        {"V5", "the adhesive contact follows the JKR curve", verify_jkr_curve},
        {"V6", "adhesive grains stay together below the sticking speed", verify_sticking_speed},
        {"V7", "a sliding grain comes to roll", verify_slide_to_roll},
        {"V8", "rolling resistance slows, holds and creeps as stated", verify_rolling},
        {"V9", "forces are slopes of energies, and energy only falls", verify_energy},
        {"V10", "an isolated cluster keeps its momenta", verify_conservation},
        {"V11", "lists find every contact; threads change no bit", verify_neighbours},
        {"V12", "a gas of smooth grains cools by Haff's law", verify_cooling},
        {"V13", "the time step has its order", verify_time_step_order},
        {"V15", "walls obey the pair law, also at edges and in corners", verify_walls},
        {"V16", "the work of the blade is dissipated or held", verify_balance},
    };
    return rungs;
}

const std::vector<Mutation>& mutations() {
    static const std::vector<Mutation> all = {
        {"damping", "no damping, normal or tangential", {.no_damping = true}, {"V2", "V4", "V6"}},
        {"history",
         "the tangential spring is forgotten in every step",
         {.no_history = true},
         {"V3", "V7", "V8", "V15"}},
        {"pull_off", "half the pull-off force", {.half_pull_off = true}, {"V5", "V6", "V9"}},
        {"lever_arm",
         "one grain's lever arm is a tenth short",
         {.wrong_lever_arm = true},
         {"V3", "V7", "V10"}},
    };
    return all;
}

}  // namespace gradwright
