// V16: energy balance: what the blade works is dissipated or held.
#include "dem/verification/balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "dem/random.h"
#include "dem/verification/curves.h"

namespace gradwright {
namespace verification {

Scene balance_scene(const VerificationOptions& options) {
    Scene s;
    s.dispenser_length = 0.5e-3;
    s.width = 0.26e-3;
    s.bed_depth = 40e-6;
    s.dose_height = 120e-6;
    s.land = 0.3e-3;
    s.platform_length = 0.7e-3;
    s.second_land = 0.5e-3;
    s.gap = 150e-6;
    s.blade_speed = 0.15;
    s.blade_thickness = 0.2e-3;
    s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    for (auto& p : s.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    s.wall = s.powder[0].material;
    s.precision = options.precision;
    s.seed = 3;
    return s;
}

}  // namespace verification

using namespace verification;
namespace {

constexpr double kPileStep = 2e-7;  // 0.17 Rayleigh times of the smallest grain [s]

/// The cases every account gets: it closes, and no loss runs backwards.
void judge_account(VerificationCases& out, const std::string& name, const EnergyLedger& e) {
    const double work = e.work_of_bodies;
    VerificationCase c =
        judged("V16", name, "work of the bodies [J] against what was dissipated and held more", work,
               e.dissipated() + e.held() + e.carried_off - e.start, work, 0.01,
               "first law: forces x ways of the bodies = losses + change of what is held");
    out.push_back(c);
    double least = 1e300;
    const char* which = "";
    const std::pair<const char*, double> losses[] = {{"normal damping", e.normal_damping},
                                                     {"tangential damping", e.tangential_damping},
                                                     {"sliding", e.sliding},
                                                     {"rolling", e.rolling},
                                                     {"bonds", e.bonds}};
    for (const auto& [loss, value] : losses)
        if (value != 0 && value < least) least = value, which = loss;  // not those the law does not have
    VerificationCase d = judged("V16", name, fmt::format("least loss ({}) / work", which), 0, least / work, 1,
                                1e-3, "second law: dissipation is not negative");
    d.error = std::max(0.0, -least / work);
    d.pass = d.error <= d.tolerance;
    out.push_back(d);
}

/// A pile on a plane, pushed by a blade, periodic across: way of the blade and account, `points` times.
std::vector<std::pair<double, EnergyLedger>> push_pile(const VerificationOptions& options, double adhesion,
                                                       RollingModel rolling, int points) {
    const double radius = 20e-6, d = 2 * radius;
    Interaction interaction;
    interaction.work_of_adhesion = adhesion;
    interaction.rolling_model = rolling;
    EngineOptions eo = laboratory_options(options, grain_material(8000, 2e7, 0.3), interaction, kPileStep);
    eo.gravity = {0, 0, -9.81};
    eo.period_y = 5 * d;
    eo.energy_account = true;
    Engine engine(eo);
    engine.add_body({});  // the plane z = 0
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x0 = -1e-3;
    blade.x1 = 0;
    blade.z0 = 0.1 * radius;
    blade.z1 = 1e-2;
    blade.speed_x = 0.1;
    engine.add_body(blade);
    Random random(21);
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k) {
                GrainSpec g;
                g.radius = radius * (1 - 0.2 * static_cast<double>(random.below(3)));
                g.x = d * (1.05 * i + 0.8 + 0.04 * random.uniform());
                g.y = d * (1.25 * j + 0.5 + 0.2 * random.uniform());
                g.z = d * (1.05 * k + 0.5 + 0.04 * random.uniform());
                engine.add_grain(g);
            }
    engine.start_bodies();
    std::vector<std::pair<double, EnergyLedger>> account;
    const long steps = 30000;  // 0.6 mm of the blade's way
    for (int k = 1; k <= points; ++k) {
        engine.advance(steps * k / points - engine.steps());
        account.emplace_back(blade.speed_x * engine.time(), engine.energy());
    }
    return account;
}

void add_pushed_pile(VerificationCases& out, const VerificationOptions& options, const char* name,
                     double adhesion, RollingModel rolling) {
    judge_account(out, name, push_pile(options, adhesion, rolling, 1).back().second);
}

}  // namespace

namespace verification {

std::vector<std::pair<double, EnergyLedger>> pushed_pile_account(const VerificationOptions& options) {
    return push_pile(options, 5e-4, RollingModel::spring, 120);
}

}  // namespace verification

VerificationCases verify_balance(const VerificationOptions& options) {
    VerificationCases out;
    add_pushed_pile(out, options, "96 grains pushed over a plane, Hertz, constant torque", 0,
                    RollingModel::constant_torque);
    add_pushed_pile(out, options, "96 grains pushed over a plane, Hertz, edem", 0, RollingModel::edem);
    add_pushed_pile(out, options, "96 grains pushed over a plane, Hertz, spring", 0, RollingModel::spring);
    add_pushed_pile(out, options, "96 grains pushed over a plane, JKR, spring", 5e-4, RollingModel::spring);
    SpreadOptions so;
    so.threads = 1;
    so.energy_account = true;
    const SpreadResult spread = run_spread(balance_scene(options), nullptr, so);
    const auto name =
        fmt::format("a whole spread of {} grains: {} layer grains", spread.grains, spread.layer.size());
    out.push_back(judged("V16", name, "the spread ended well (1 = yes)", 1, spread.health.ok(), 1, 0,
                         "else nothing was shown"));
    if (spread.health.ok()) judge_account(out, name, spread.energy);
    return out;
}

}  // namespace gradwright
