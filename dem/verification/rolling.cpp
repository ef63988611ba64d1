// V7, V8: one grain on a rigid plane: sliding into rolling, rolling resistance; V8 also on another grain and
// in a heap of four.
#include <fmt/format.h>

#include <algorithm>

#include "dem/verification/laboratory.h"

namespace gradwright {
using namespace verification;
namespace {

constexpr double kGravity = 9.81, kRadius = 1e-3, kTimeStep = 2e-6;

const char* name_of(RollingModel model) {
    switch (model) {
        case RollingModel::none:
            return "no resistance";
        case RollingModel::spring:
            return "spring";
        case RollingModel::edem:
            return "edem";
        default:
            return "constant torque";
    }
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

/// A grain turning on top of a like fixed one, without friction. Where two equal grains meet, R* = r/2: the
/// edem model, with each grain's own arm, brakes twice as hard as the others.
void add_grain_on_grain(VerificationCases& out, const VerificationOptions& options) {
    const double mu_r = 0.1, time = 0.018;
    for (const RollingModel model :
         {RollingModel::constant_torque, RollingModel::edem, RollingModel::spring}) {
        EngineOptions eo =
            laboratory_options(options, GrainOnPlane::material(), rough(0, mu_r, model), kTimeStep);
        eo.gravity = {0, 0, -kGravity};
        Engine engine(eo);
        engine.add_grain({.radius = kRadius, .fixed = true});
        const double weight = sphere_mass(8000, kRadius) * kGravity;
        const double overlap = std::pow(
            0.75 * weight / (effective_modulus(GrainOnPlane::material(), false) * std::sqrt(0.5 * kRadius)),
            2.0 / 3.0);
        const int top = engine.add_grain({.z = 2 * kRadius - overlap, .wy = 100, .radius = kRadius});
        engine.advance(std::lround(0.002 / kTimeStep));
        const double before = engine.spin(index_of(engine, top))[1];
        engine.advance(std::lround(time / kTimeStep));
        const double arm = model == RollingModel::edem ? 1 : 0.5;
        const double expected = 2.5 * arm * mu_r * kGravity * time / kRadius;
        out.push_back(judged(
            "V8", fmt::format("spin-down on a like grain, {}", name_of(model)), "spin lost in 18 ms [rad/s]",
            expected, before - engine.spin(index_of(engine, top))[1], expected, 5e-3,
            model == RollingModel::edem ? "5 mu_r g t/(2 r), arm r" : "5 mu_r g t/(4 r), R* = r/2"));
    }
}

/// The smallest heap: three grains on a plane, touching, and one on top; theta = angle of the upper contacts
/// from the vertical, sin theta = 1/sqrt(3). It gives way by sliding at the upper contacts while the lower
/// grains roll outwards. Torques on a lower grain about its centre, forces on it and on the top grain:
///   mu N + m_1 + m_2 = F,  F = N (sin - mu cos),  N_2 = 4/3 W,  3 N (cos + mu sin) = W,
/// with m_1 = mu_r N/2 (R* = r/2; edem: mu_r N) at the upper contact and m_2 = mu_r N_2 at the plane, over r.
/// So
///   mu (1 + cos + 4 mu_r sin) = sin - mu_r (1/2 or 1) - 4 mu_r cos;  without resistance mu = tan(theta/2).
double critical_friction(double mu_r, RollingModel model) {
    const double s = 1 / std::sqrt(3.0), c = std::sqrt(2.0 / 3.0);
    if (model == RollingModel::none) mu_r = 0;
    const double upper = model == RollingModel::edem ? 1 : 0.5;
    return (s - upper * mu_r - 4 * mu_r * c) / (1 + c + 4 * mu_r * s);
}

bool heap_stands(const VerificationOptions& options, double friction, double mu_r, RollingModel model) {
    Interaction interaction = rough(friction, mu_r, model);
    interaction.coefficient_of_restitution = 0.1;
    EngineOptions eo = laboratory_options(options, GrainOnPlane::material(), interaction, kTimeStep);
    eo.gravity = {0, 0, -kGravity};
    Engine engine(eo);
    const double weight = sphere_mass(8000, kRadius) * kGravity;
    const double plane = std::pow(
        0.75 * 4.0 / 3.0 * weight / (effective_modulus(GrainOnPlane::material(), true) * std::sqrt(kRadius)),
        2.0 / 3.0);
    for (int k = 0; k < 3; ++k) {
        // a hair apart: nothing but the top grain joins them
        const double angle = 2 * kPi * k / 3, distance = 2.0004 * kRadius / std::sqrt(3.0);
        engine.add_grain({.x = distance * std::cos(angle),
                          .y = distance * std::sin(angle),
                          .z = kRadius - plane,
                          .radius = kRadius});
    }
    const int top =
        engine.add_grain({.z = kRadius - plane + 2 * kRadius * std::sqrt(2.0 / 3.0), .radius = kRadius});
    Body floor;
    floor.material = 1;
    engine.add_body(floor);
    const double start = engine.state().z[index_of(engine, top)];
    // Settling takes 0.0004 radii, the rolling spring some 0.005 before it yields. Half a per cent short of
    // the least friction, 0.02 radii take 50 ms.
    for (int block = 0; block < 30; ++block) {
        engine.advance(1000);
        if (engine.state().z[index_of(engine, top)] < start - 0.02 * kRadius) return false;
    }
    return true;
}

void add_heap_of_four(VerificationCases& out, const VerificationOptions& options) {
    const double mu_r = 0.02;
    for (const RollingModel model :
         {RollingModel::none, RollingModel::constant_torque, RollingModel::edem, RollingModel::spring}) {
        const double expected = critical_friction(mu_r, model);
        double falls = 0.8 * expected, stands = 1.25 * expected;
        for (int k = 0; k < 7; ++k) {
            const double middle = 0.5 * (falls + stands);
            (heap_stands(options, middle, mu_r, model) ? stands : falls) = middle;
        }
        out.push_back(
            judged("V8", fmt::format("heap of four, mu_r = 0.02, {}", name_of(model)),
                   "least friction that holds it", expected, 0.5 * (falls + stands), expected, 0.02,
                   "(sin - mu_r/2 - 4 mu_r cos)/(1 + cos + 4 mu_r sin), sin = 1/sqrt 3; edem: mu_r for "
                   "mu_r/2; none: tan(theta/2)"));
    }
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
    for (const RollingModel model :
         {RollingModel::constant_torque, RollingModel::edem, RollingModel::spring}) {
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
    for (const RollingModel model : {RollingModel::constant_torque, RollingModel::edem}) {
        Interaction interaction = rough(0.64, mu_r, model);
        interaction.rolling_regularisation_speed = 1e-4;
        const double expected = 1e-4 * std::tan(slope * kPi / 180) / mu_r;
        GrainOnPlane lab(options, interaction, slope, 0, 0);
        lab.engine.advance(20000);
        out.push_back(judged("V8", fmt::format("creep on 4.5 degrees, {}", name_of(model)), "speed [m/s]",
                             expected, lab.speed(), expected, 5e-3, "regularisation speed x tan/mu_r"));
    }
    add_grain_on_grain(out, options);
    add_heap_of_four(out, options);
    return out;
}

}  // namespace gradwright
