#include "dem/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "dem/engine.h"
#include "dem/random.h"
#include "dem/spread.h"

namespace gradwright {
namespace {

// Softened steel; only ratios count.
const Material kMetal = {"metal", 8000, 2.1e7, 0.3, ""};
constexpr double kRadius = 20e-6;  // of the smallest grain [m]
constexpr double kWatch = 200;     // Rayleigh times watched: at the edge of f = 0.5, 400 steps
constexpr double kCalm = 0.05;     // the reference step, far inside [T_R]
constexpr double kGrowth = 100;    // a top speed this many times the reference's is growth
constexpr double kKick =
    1e-5;  // of the speed that would open a contact: no contact changes, no grain moves on

double rayleigh() {
    return rayleigh_time_step(kRadius, kMetal.density,
                              kMetal.youngs_modulus / (2 * (1 + kMetal.poissons_ratio)),
                              kMetal.poissons_ratio);
}

double mass(double r) {
    return kMetal.density * sphere_volume(r);
}

/// Speed of a smallest grain whose kinetic energy is the Hertz energy 8/15 E* sqrt(R*) delta^(5/2) of a
/// contact between two of them.
double opening_speed(double overlap) {
    const double e_star = kMetal.youngs_modulus / (2 * (1 - kMetal.poissons_ratio * kMetal.poissons_ratio));
    const double energy = 8.0 / 15.0 * e_star * std::sqrt(0.5 * kRadius) * std::pow(overlap * kRadius, 2.5);
    return std::sqrt(2 * energy / mass(kRadius));
}

struct Box {
    std::vector<GrainSpec> grains;
    std::vector<Body> bodies;
    double gravity = 0;
    double overlap = 0;
};

Body plane(int axis, double sign, double offset) {
    Body b;
    b.axis = axis;
    b.sign = sign;
    b.offset = offset;
    return b;
}

EngineOptions options_for(const StabilitySetup& setup, const Interaction& interaction, double gravity,
                          double fraction) {
    EngineOptions o;
    o.materials = {kMetal};
    o.interaction = interaction;
    o.adhesion_scaling = AdhesionScaling::none;
    o.time_step = fraction * rayleigh();
    o.gravity = {0, 0, -gravity};
    o.precision = setup.precision;
    o.threads = 1;
    o.speed_limit = 1e4;
    o.fault.free_dashpot = setup.free_dashpot;
    return o;
}

void fill(Engine& engine, const Box& box) {
    for (const Body& b : box.bodies) engine.add_body(b);
    for (const GrainSpec& g : box.grains) engine.add_grain(g);
}

Box wedge(const StabilitySetup& setup) {
    Box box;
    const double half = (1 - setup.overlap) * kRadius;
    box.bodies = {plane(0, 1, -half), plane(0, -1, half)};
    box.grains = {{.radius = kRadius}};
    box.overlap = setup.overlap;
    return box;
}

/// Settled without friction, so that the law under test starts in equilibrium with unloaded springs; the
/// gravity is set in three rounds so that the largest overlap is the one asked for.
Box heap(const StabilitySetup& setup) {
    const double ratio = setup.size_ratio, r = kRadius, big = ratio * r;
    Random random(setup.seed);
    const bool mixed = ratio > 1;
    const double side = mixed ? 4.4 * big : 8 * r;
    Box box;
    for (const int axis : {0, 1})
        for (const double sign : {1.0, -1.0}) box.bodies.push_back(plane(axis, sign, sign > 0 ? 0 : side));
    box.bodies.push_back(plane(2, 1, 0));
    // small grains on a loose lattice, one and a half layers of them below the large ones
    const int across = std::max(1, static_cast<int>(side / (2.15 * r)));
    const int small = mixed ? std::min(400, across * across * 3 / 2) : 96;
    for (int k = 0; k < small; ++k) {
        const int layer = k / (across * across), cell = k % (across * across);
        auto jitter = [&] { return 0.05 * r * random.uniform(); };
        box.grains.push_back({.x = (cell % across + 0.5) * side / across + jitter(),
                              .y = (cell / across + 0.5) * side / across + jitter(),
                              .z = (1.1 + 2.2 * layer) * r + jitter(),
                              .radius = r});
    }
    const double top = (2.2 * ((small - 1) / (across * across)) + 2.3) * r;
    for (int k = 0; mixed && k < 8; ++k)
        box.grains.push_back({.x = (k % 2 + 0.5) * side / 2 + 0.02 * big * random.uniform(),
                              .y = (k / 2 % 2 + 0.5) * side / 2 + 0.02 * big * random.uniform(),
                              .z = top + (1.05 + 2.2 * (k / 4)) * big,
                              .radius = big});

    Interaction smooth;
    smooth.static_friction = smooth.rolling_friction = 0;
    smooth.coefficient_of_restitution = 0.1;
    smooth.work_of_adhesion = setup.interaction.work_of_adhesion;
    // first guess: one column of six grains, or a large one on four small ones, at the overlap asked for
    const double e_star = kMetal.youngs_modulus / (2 * (1 - kMetal.poissons_ratio * kMetal.poissons_ratio));
    const double force = 4.0 / 3.0 * e_star * std::sqrt(0.5 * r) * std::pow(setup.overlap * r, 1.5);
    box.gravity = force / (6 * mass(r)) * (mixed ? 24 / (ratio * ratio * ratio) : 1);
    for (int round = 0; round < 3; ++round) {
        Engine engine(options_for(setup, smooth, box.gravity, 0.15));
        fill(engine, box);
        for (int k = 0; k < 600; ++k) {
            engine.advance(round == 0 ? 40 : 20);
            if (round > 0 || k > 300) engine.scale_velocities(k > 500 ? 0.3 : 0.7);
        }
        const State& s = engine.state();
        for (std::size_t i = 0; i < s.size(); ++i) {
            GrainSpec& g = box.grains[static_cast<std::size_t>(s.id[i])];
            g.x = s.x[i], g.y = s.y[i], g.z = s.z[i];
        }
        box.overlap = engine.max_overlap_ratio();
        // F ~ delta^(3/2)
        if (round < 2) box.gravity *= std::pow(setup.overlap / std::max(box.overlap, 1e-6), 1.5);
    }
    return box;
}

/// Top speed (of centres, and of surfaces by spin) while kWatch Rayleigh times pass with this step; infinity
/// when the run failed. Before that the packing relaxes with all motion taken out every second step, so that
/// springs and bonds are in equilibrium under the law itself.
double top_speed(const StabilitySetup& setup, const Box& box, double fraction) {
    Engine engine(options_for(setup, setup.interaction, box.gravity, fraction));
    fill(engine, box);
    const long rounds = std::lround(30 / fraction);
    for (long k = 0; k < rounds; ++k) {
        engine.advance(2);
        engine.scale_velocities(0);
    }
    Random random(setup.seed + 77);
    const double speed = kKick * opening_speed(setup.overlap);
    State& s = engine.state();
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double part = speed * std::pow(kRadius / s.radius[i], 1.5);
        for (double* v : {&s.vx[i], &s.vy[i], &s.vz[i]}) *v = part * random.normal();
        for (double* w : {&s.wx[i], &s.wy[i], &s.wz[i]}) *w = part / s.radius[i] * random.normal();
    }
    engine.refresh();
    const long steps = std::lround(kWatch / fraction), burst = std::max(1L, std::lround(5 / fraction));
    double top = 0;
    for (long done = 0; done < steps; done += burst) {
        engine.advance(burst);
        if (!engine.failed().empty()) return std::numeric_limits<double>::infinity();
        double spin = 0;
        for (std::size_t i = 0; i < s.size(); ++i) {
            const auto w = engine.spin(i);
            spin = std::max(spin, std::hypot(w[0], w[1], w[2]) * s.radius[i]);
        }
        top = std::max({top, engine.max_speed(), spin});
    }
    return top;
}

}  // namespace

StabilityEdge stability_edge(const StabilitySetup& setup) {
    const Box box = setup.packing == StabilityPacking::wedge ? wedge(setup) : heap(setup);
    StabilityEdge out;
    out.overlap = box.overlap;
    out.grains = static_cast<long>(box.grains.size());
    const double calm = top_speed(setup, box, kCalm);
    auto grows = [&](double fraction) { return !(top_speed(setup, box, fraction) < kGrowth * calm); };
    // upwards in steps of two first: a step far beyond the edge leaves the heap altogether
    out.stable = kCalm;
    out.unstable = 2 * kCalm;
    while (out.unstable < 6 && !grows(out.unstable)) {
        out.stable = out.unstable;
        out.unstable *= 1.5;
    }
    while (out.unstable > 1.03 * out.stable) {
        const double middle = std::sqrt(out.stable * out.unstable);
        (grows(middle) ? out.unstable : out.stable) = middle;
    }
    return out;
}

double stability_edge_of(const Interaction& interaction) {
    const double e = interaction.coefficient_of_restitution;
    if (e >= 1 && interaction.static_friction > 0) return kUndampedEdge;
    if (e >= 0.5) return kStabilityEdge;
    return kDampedEdge + (kStabilityEdge - kDampedEdge) * std::max(0.0, e - 0.05) / 0.45;
}

std::string step_advice(double rayleigh_fraction, const Interaction& interaction) {
    const double times = rayleigh_fraction / stability_edge_of(interaction);
    return fmt::format("the time step is {:.3g} Rayleigh times, {:.2g} times the stability edge; {}",
                       rayleigh_fraction, times,
                       times > 1 ? "lower numerics.time_step.rayleigh_fraction (0.2 is the default)"
                                 : "raise numerics.softening or lower the speeds");
}

std::vector<StabilityRow> stability_table() {
    Interaction base;  // the paper's, without adhesion
    base.work_of_adhesion = 0;
    Interaction smooth = base;
    smooth.static_friction = smooth.rolling_friction = 0;
    auto with = [](Interaction i, auto&& change) {
        change(i);
        return i;
    };
    struct Law {
        std::string name;
        Interaction interaction;
        bool in_wedge = false, free_dashpot = false;
    };
    const std::vector<Law> laws = {
        {"Hertz, e 1, no friction", with(smooth, [](auto& i) { i.coefficient_of_restitution = 1; }), true},
        {"Hertz, e 0.5, no friction", smooth, false},
        {"Hertz, e 1, friction 0.64, no rolling resistance",
         with(base,
              [](auto& i) {
                  i.coefficient_of_restitution = 1;
                  i.rolling_friction = 0;
              }),
         true},
        {"Hertz, e 0.5, friction 0.64, no rolling resistance",
         with(base, [](auto& i) { i.rolling_friction = 0; }), false},
        {"Hertz, e 0.5, friction 0.64, constant torque", base, true},
        {"Hertz, e 0.5, friction 0.64, rolling spring",
         with(base, [](auto& i) { i.rolling_model = RollingModel::spring; }), true},
        {"Hertz, e 0.5, friction 0.64, EDEM's rolling",
         with(base, [](auto& i) { i.rolling_model = RollingModel::edem; }), false},
        {"Hertz, e 0.05, friction 0.64, constant torque",
         with(base, [](auto& i) { i.coefficient_of_restitution = 0.05; }), true},
        {"JKR 5.0e-4 J/m2, e 0.5, friction 0.64, constant torque",
         with(base, [](auto& i) { i.work_of_adhesion = 5.024e-4; }), true},
        {"JKR 0.02 J/m2, e 0.5, friction 0.64, constant torque",
         with(base, [](auto& i) { i.work_of_adhesion = 0.02; }), true},
        {"Hertz, e 0.5, friction 0.64, constant torque; dashpots unlimited", base, false, true},
        {"Hertz, e 0.5, friction 0.64, rolling spring; dashpots unlimited",
         with(base, [](auto& i) { i.rolling_model = RollingModel::spring; }), false, true},
    };
    std::vector<StabilityRow> rows;
    for (const Law& law : laws)
        for (const double overlap : {0.001, 0.03})
            for (const double ratio : {1.0, 3.0, 10.0}) {
                StabilityRow row{law.name, {}};
                row.setup.interaction = law.interaction;
                row.setup.size_ratio = ratio;
                row.setup.overlap = overlap;
                row.setup.free_dashpot = law.free_dashpot;
                rows.push_back(row);
            }
    for (const Law& law : laws)
        for (const double overlap : {0.03, 0.10, 0.20}) {
            if (!law.in_wedge) continue;
            StabilityRow row{law.name, {}};
            row.setup.packing = StabilityPacking::wedge;
            row.setup.interaction = law.interaction;
            row.setup.overlap = overlap;
            rows.push_back(row);
        }
    return rows;
}

SaddleResult roll_off_saddle(const SaddleSetup& setup) {
    // material and large radius as published; glass-like, softened
    const Material glass = {"glass", 2500, 5e8, 0.3, ""};
    const double big = 5e-3, small = big / setup.size_ratio, degree = std::numbers::pi / 180, from = degree,
                 to = 30 * degree, gravity = 9.81;
    const double sum = big + small, rho = std::sqrt(sum * sum - big * big);
    SaddleResult out;
    {
        const double rate = gravity / (rho * (1 + 0.4 * (sum / rho) * (sum / rho)));
        const double dt = 1e-4 / std::sqrt(rate);
        double phi = from, speed = 0;
        while (phi < to) {  // leapfrog; at 1e-4 of the time scale its error is 1e-8
            speed += dt * rate * std::sin(phi);
            phi += dt * speed;
            out.expected_time += dt;
        }
    }
    EngineOptions o;
    o.materials = {glass};
    o.interaction.work_of_adhesion = 0;
    o.interaction.rolling_friction = 0;
    o.interaction.static_friction = 0.5;
    o.time_step =
        setup.rayleigh_fraction * rayleigh_time_step(small, glass.density,
                                                     glass.youngs_modulus / (2 * (1 + glass.poissons_ratio)),
                                                     glass.poissons_ratio);
    o.gravity = {0, 0, -gravity};
    o.precision = setup.precision;
    o.threads = 1;
    o.fault.late_velocity = setup.late_velocity;
    Engine engine(o);
    for (const double side : {-1.0, 1.0}) engine.add_grain({.x = side * big, .radius = big, .fixed = true});
    const int id = engine.add_grain({.y = rho * std::sin(from), .z = rho * std::cos(from), .radius = small});
    const long burst = std::max(1L, std::lround(out.expected_time / 2000 / o.time_step));
    out.time = std::numeric_limits<double>::infinity();
    while (engine.time() < 4 * out.expected_time && engine.failed().empty() && !out.fell) {
        engine.advance(burst);
        const State& s = engine.state();
        const auto i = static_cast<std::size_t>(std::find(s.id.begin(), s.id.end(), id) - s.id.begin());
        const double phi = std::fabs(std::atan2(s.y[i], s.z[i])), reach = std::hypot(s.x[i], s.y[i], s.z[i]);
        if (phi >= to && std::isinf(out.time)) out.time = engine.time();
        if (reach < 1.01 * rho) out.farthest_angle_deg = std::max(out.farthest_angle_deg, phi / degree);
        out.fell = reach > 1.5 * rho;
    }
    return out;
}

}  // namespace gradwright
