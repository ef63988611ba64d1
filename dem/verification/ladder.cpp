#include "dem/verification/verification.h"

namespace gradwright {

const std::vector<VerificationRung>& verification_ladder() {
    static const std::vector<VerificationRung> rungs = {
        {"V1", "Hertz impacts have the published overlap, force and contact time", verify_hertz_impacts},
        {"V2", "grains rebound with the coefficient of restitution asked for", verify_restitution},
        {"V3", "oblique impacts follow the published curves", verify_oblique_impacts},
        {"V4", "spinning impacts follow the closed forms of gross sliding", verify_spin_impacts},
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
