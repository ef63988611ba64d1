// V7, V8: one grain on a rigid plane: sliding into rolling, rolling resistance.
#include <fmt/format.h>

#include <algorithm>

#include "dem/verification/laboratory.h"

namespace gradwright {
using namespace verification;
namespace {

constexpr double kGravity = 9.81, kRadius = 1e-3, kTimeStep = 2e-6;

const char* name_of(RollingModel model) {
    return model == RollingModel::spring ? "spring" : "constant torque";
}

/// A grain at rest on the plane z = 0, which is tilted so that x points down the slope. Stiff: overlap 2e-4
/// of the radius.
struct GrainOnPlane {
    Engine engine;
    GrainOnPlane(const VerificationOptions& options, const Interaction& interaction, double slope_deg,
                 double speed, double spin)
        : engine(engine_options_for(options, interaction, slope_deg)) {
        const Material m = material();
        const double slope = slope_deg * kPi / 180,
                     weight = sphere_mass(m.density, kRadius) * kGravity * std::cos(slope);
        const double overlap =
            std::pow(0.75 * weight / (effective_modulus(m, true) * std::sqrt(kRadius)), 2.0 / 3.0);
        engine.add_grain({.z = kRadius - overlap, .vx = speed, .wy = spin, .radius = kRadius});
        Body plane;
        plane.material = 1;
        engine.add_body(plane);
    }
    static Material material() { return grain_material(8000, 1e8, 0.3); }
    static EngineOptions engine_options_for(const VerificationOptions& options,
                                            const Interaction& interaction, double slope_deg) {
        EngineOptions o = laboratory_options(options, material(), interaction, kTimeStep);
        const double slope = slope_deg * kPi / 180;
        o.gravity = {kGravity * std::sin(slope), 0, -kGravity * std::cos(slope)};
        return o;
    }
    double speed() const { return engine.velocity(0)[0]; }
    double spin() const { return engine.spin(0)[1]; }
};

Interaction rough(double friction, double rolling, RollingModel model) {
    Interaction i = bare_interaction();
    i.static_friction = friction;
    i.rolling_friction = rolling;
    i.rolling_model = model;
    i.coefficient_of_restitution = 0.5;
    i.rolling_regularisation_speed = 1e-6;
    return i;
}

}  // namespace

VerificationCases verify_slide_to_roll(const VerificationOptions& options) {
    VerificationCases out;
    for (const double mu : {0.2, 0.64}) {
        const double u0 = 0.2, end = 2 * u0 / (7 * mu * kGravity);
        GrainOnPlane lab(options, rough(mu, 0, RollingModel::none), 0, u0, 0);
        double slip_before = u0, rolls_at = 0;
        const long steps = static_cast<long>(3 * end / kTimeStep);
        for (long step = 1; step <= steps; ++step) {
            lab.engine.advance(1);
            const double slip = lab.speed() - kRadius * lab.spin();
            if (rolls_at == 0 && slip <= 0)
                rolls_at = kTimeStep * (static_cast<double>(step) - slip / (slip - slip_before));
            slip_before = slip;
        }
        const auto name = fmt::format("grain thrown flat onto a plane, mu = {:g}", mu);
        out.push_back(judged("V7", name, "rolling speed [m/s]", 5.0 / 7.0 * u0, lab.speed(), 5.0 / 7.0 * u0,
                             5e-3, "5/7 u0"));
        out.push_back(
            judged("V7", name, "instant of rolling [s]", end, rolls_at, end, 5e-3, "2 u0/(7 mu g)"));
    }
    return out;
}

VerificationCases verify_rolling(const VerificationOptions& options) {
    VerificationCases out;
    const double mu_r = 0.1;
    for (const RollingModel model : {RollingModel::constant_torque, RollingModel::spring}) {
        {
            // From 2 ms on: before the spring yields, in its first steps, type C's dashpot acts above the cap
            // and takes 1 % of this spin.
            const double time = 0.018, expected = 2.5 * mu_r * kGravity * time / kRadius;
            GrainOnPlane lab(options, rough(0, mu_r, model), 0, 0, 100);
            lab.engine.advance(std::lround(0.002 / kTimeStep));
            const double before = lab.spin();
            lab.engine.advance(std::lround(time / kTimeStep));
            out.push_back(judged("V8", fmt::format("spin-down without friction, {}", name_of(model)),
                                 "spin lost in 18 ms [rad/s]", expected, before - lab.spin(), expected, 5e-3,
                                 "5 mu_r g t/(2 r)"));
        }
        {
            const double slope = 16, time = 0.03, s = std::sin(slope * kPi / 180),
                         c = std::cos(slope * kPi / 180);
            const double expected = 5.0 / 7.0 * kGravity * (s - mu_r * c) * time;
            GrainOnPlane lab(options, rough(0.64, mu_r, model), slope, 0, 0);
            lab.engine.advance(std::lround(time / kTimeStep));
            out.push_back(judged("V8", fmt::format("rolling down 16 degrees, {}", name_of(model)),
                                 "speed after 30 ms [m/s]", expected, lab.speed(), expected, 5e-3,
                                 "5/7 g (sin - mu_r cos) t"));
        }
    }
    const double slope = 4.5;  // tan = 0.0787 < mu_r
    {
        GrainOnPlane lab(options, rough(0.64, mu_r, RollingModel::spring), slope, 0, 0);
        lab.engine.advance(20000);
        const double x = lab.engine.state().x[0],
                     free_fall = kGravity * std::sin(slope * kPi / 180) * 20000 * kTimeStep;
        out.push_back(judged("V8", "rest on 4.5 degrees, spring",
                             "speed after 40 ms / speed of a frictionless slide", 0, lab.speed(), free_fall,
                             1e-6, "rest if mu_r >= tan"));
        lab.engine.advance(20000);
        out.push_back(judged("V8", "rest on 4.5 degrees, spring", "way in the next 40 ms / radius", 0,
                             lab.engine.state().x[0] - x, kRadius, 1e-6, "rest if mu_r >= tan"));
    }
    {
        Interaction interaction = rough(0.64, mu_r, RollingModel::constant_torque);
        interaction.rolling_regularisation_speed = 1e-4;
        const double expected = 1e-4 * std::tan(slope * kPi / 180) / mu_r;
        GrainOnPlane lab(options, interaction, slope, 0, 0);
        lab.engine.advance(20000);
        out.push_back(judged("V8", "creep on 4.5 degrees, constant torque", "speed [m/s]", expected,
                             lab.speed(), expected, 5e-3, "regularisation speed x tan/mu_r"));
    }
    return out;
}

}  // namespace gradwright
