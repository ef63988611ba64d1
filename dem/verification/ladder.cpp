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
        {"V13", "the time step has its order", verify_time_step_order},
    };
    return rungs;
}

VerificationCases verify_all(const VerificationOptions& options) {
    VerificationCases out;
    for (const auto& rung : verification_ladder())
        for (auto& c : rung.run(options)) out.push_back(std::move(c));
    return out;
}

}  // namespace gradwright
