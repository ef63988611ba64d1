// V9, V13: forces as slopes of energies, what the step does to the energy, and the order of the step.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "dem/random.h"
#include "dem/spread.h"
#include "dem/verification/curves.h"

namespace gradwright {
using namespace verification;
namespace {

constexpr double kRadius = 20e-6;
Material metal() {
    return grain_material(8000, 2e7, 0.3);
}

/// Two like grains: overlap, closing speed and energies at an instant.
struct Probe {
    double overlap = 0, energy = 0;
};

double hertz_energy(double e_star, double r_star, double overlap) {
    return overlap > 0 ? 8.0 / 15.0 * e_star * std::sqrt(r_star) * std::pow(overlap, 2.5) : 0;
}

/// Two like grains from `overlap` at closing `speed`, after `time`, which must be a whole number of steps.
Probe pair_after(const VerificationOptions& options, double restitution, double overlap, double speed,
                 double dt, long steps) {
    Interaction interaction = bare_interaction();
    interaction.coefficient_of_restitution = restitution;
    Engine engine(laboratory_options(options, metal(), interaction, dt));
    engine.add_grain({.x = -2 * kRadius + overlap, .vx = 0.5 * speed, .radius = kRadius});
    engine.add_grain({.vx = -0.5 * speed, .radius = kRadius});
    engine.advance(steps);
    Probe p;
    p.overlap = 2 * kRadius - std::fabs(engine.state().x[1] - engine.state().x[0]);
    // whole-step velocity by the mean of the half steps on either side, so that the energy is of one instant
    std::array<double, 2> half;
    for (int k = 0; k < 2; ++k) half[k] = engine.state().vx[k];
    engine.advance(1);
    double kinetic = 0;
    for (int k = 0; k < 2; ++k) {
        const double v = 0.5 * (half[k] + engine.state().vx[k]);
        kinetic += 0.5 * engine.state().mass[k] * v * v;
    }
    p.energy = kinetic + hertz_energy(effective_modulus(metal(), false), 0.5 * kRadius, p.overlap);
    return p;
}

/// Force of the engine between a fixed and a mobile grain at an overlap (contact made first when it is
/// adhesive).
class ForceProbe {
  public:
    ForceProbe(const VerificationOptions& options, double work_of_adhesion) : options_(options) {
        interaction_ = bare_interaction();
        interaction_.work_of_adhesion = work_of_adhesion;
    }
    double force(double overlap) const {
        Engine engine(laboratory_options(options_, grain_material(1e20, 2e7, 0.3), interaction_, 1e-12));
        engine.add_grain({.radius = kRadius, .fixed = true});
        const double touch = 1e-9;
        engine.add_grain({.x = 2 * kRadius - touch, .radius = kRadius});
        engine.advance(1);
        engine.state().x[index_of(engine, 1)] = 2 * kRadius - overlap;
        engine.refresh();
        engine.advance(1);
        return -engine.force_on_fixed().x;
    }

  private:
    VerificationOptions options_;
    Interaction interaction_;
};

double order_of(double coarse, double middle, double fine) {
    return std::log2(std::fabs(coarse - middle) / std::fabs(middle - fine));
}

/// A case that asks for at least a bound.
VerificationCase at_least(std::string id, std::string name, std::string quantity, double bound,
                          double obtained, std::string source) {
    VerificationCase c =
        judged(std::move(id), std::move(name), std::move(quantity), bound, obtained, 1, 0, std::move(source));
    c.error = std::max(0.0, bound - obtained);
    c.pass = obtained >= bound;
    return c;
}

/// Eight grains in a box without gravity: largest rise of the energy between instants with no contact open,
/// over the first energy.
double largest_energy_rise(const VerificationOptions& options, double restitution, double friction) {
    Interaction interaction = bare_interaction();
    interaction.coefficient_of_restitution = restitution;
    interaction.static_friction = friction;
    EngineOptions eo = laboratory_options(options, metal(), interaction, 5e-9);
    Engine engine(eo);
    Random random(7);
    const double side = 6 * kRadius;
    for (int k = 0; k < 8; ++k) {
        GrainSpec g{.x = side * (k & 1 ? 0.75 : 0.25),
                    .y = side * (k & 2 ? 0.75 : 0.25),
                    .z = side * (k & 4 ? 0.75 : 0.25),
                    .radius = kRadius};
        for (double* v : {&g.vx, &g.vy, &g.vz}) *v = 0.2 * (random.uniform() - 0.5);
        for (double* w : {&g.wx, &g.wy, &g.wz}) *w = 0.2 * (random.uniform() - 0.5) / kRadius;
        engine.add_grain(g);
    }
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            Body wall;
            wall.axis = axis;
            wall.sign = sign;
            wall.offset = sign > 0 ? 0 : side;
            wall.material = 1;
            engine.add_body(wall);
        }
    const double start = engine.kinetic_energy();
    double before = start, rise = -1;
    for (int block = 0; block < 40000; ++block) {
        engine.advance(10);
        if (engine.mean_coordination() > 0) continue;
        const double now = engine.kinetic_energy();
        rise = std::max(rise, (now - before) / start);
        before = now;
    }
    return rise;
}

}  // namespace

VerificationCases verify_energy(const VerificationOptions& options) {
    VerificationCases out;
    const bool exact = options.precision == Precision::double_law;
    const double e_star = effective_modulus(metal(), false), r_star = 0.5 * kRadius;
    // F = dE/d overlap: Hertz E = 8/15 E* sqrt(R*) delta^2.5; JKR with s = sqrt(a/a_s):
    // E = F_s delta_s (2/5 s^10 - s^7 + 3/8 s^4), delta = delta_s (s^4 - s) (elastic plus surface energy).
    const double tolerance = exact ? 1e-6 : 1e-4;
    {
        const ForceProbe probe(options, 0);
        for (const double ratio : {1e-4, 1e-3, 1e-2}) {
            const double d = ratio * kRadius, h = 1e-4 * d;
            const double slope =
                (hertz_energy(e_star, r_star, d + h) - hertz_energy(e_star, r_star, d - h)) / (2 * h);
            out.push_back(judged("V9", fmt::format("Hertz, overlap {:g} of the radius", ratio),
                                 "force as slope of the energy [N]", slope, probe.force(d), slope, tolerance,
                                 "F = dE/d delta"));
        }
    }
    {
        const double gamma = 5.02377286302e-4, pull_off = 1.5 * kPi * r_star * gamma;
        const double a_s = std::cbrt(2 * kPi * gamma * r_star * r_star / e_star), d_s = a_s * a_s / r_star,
                     f_s = 16.0 / 9.0 * pull_off;
        auto energy = [&](double s) {
            return f_s * d_s * (0.4 * std::pow(s, 10) - std::pow(s, 7) + 0.375 * std::pow(s, 4));
        };
        auto overlap = [&](double s) { return d_s * (std::pow(s, 4) - s); };
        const ForceProbe probe(options, gamma);
        for (const double s : {0.7, 0.9, 1.0, 1.3, 2.0}) {
            const double h = 1e-4 * s;
            const double slope = (energy(s + h) - energy(s - h)) / (overlap(s + h) - overlap(s - h));
            out.push_back(judged("V9", fmt::format("JKR, contact radius {:g} of its scale", s * s),
                                 "force as slope of the energy [N], error of max(|F|, F_po)", slope,
                                 probe.force(overlap(s)), std::max(std::fabs(slope), pull_off), tolerance,
                                 "F = dE/d delta"));
        }
    }
    const double speed = 0.1,
                 contact = hertz_impact(e_star, r_star, 0.5 * sphere_mass(8000, kRadius), speed).contact_time;
    const double start = 0.5 * 0.5 * sphere_mass(8000, kRadius) * speed * speed;
    if (exact) {
        // Energy error in mid-contact: float leaves nothing to see of it.
        double error[3];
        for (int k = 0; k < 3; ++k) {
            const long steps = 40L << k;
            error[k] =
                pair_after(options, 1, 0, speed, 0.5 * contact / static_cast<double>(steps), steps).energy -
                start;
        }
        for (int k = 0; k < 2; ++k)
            out.push_back(judged("V9", fmt::format("impact at e = 1 with {} and {} steps", 40 << k, 80 << k),
                                 "energy error over that of half the step", 4, error[k] / error[k + 1], 4,
                                 0.1, "second order"));
    }
    for (const auto& [e, mu] : {std::pair{0.5, 0.0}, {0.9, 0.0}, {0.8, 0.64}, {0.5, 0.64}}) {
        const double rise = largest_energy_rise(options, e, mu);
        VerificationCase c = judged("V9", fmt::format("eight grains in a box, e = {:g}, mu = {:g}", e, mu),
                                    "largest rise of the energy / first energy", 0, rise, 1,
                                    exact ? 1e-9 : 1e-6, "dissipation only");
        c.error = std::max(0.0, rise);
        c.pass = rise > -1 && c.error <= c.tolerance;  // -1: never free of contacts, nothing was seen
        out.push_back(c);
    }
    return out;
}

namespace verification {

StepErrors step_errors(const VerificationOptions& options) {
    VerificationOptions exact = options;
    exact.precision = Precision::double_law;
    const double speed = 0.1;
    const auto elastic = hertz_impact(effective_modulus(metal(), false), 0.5 * kRadius,
                                      0.5 * sphere_mass(8000, kRadius), speed);
    auto overlap_at = [&](double restitution, double start, long steps) {
        return pair_after(exact, restitution, start, speed,
                          0.7 * elastic.contact_time / static_cast<double>(steps), steps)
            .overlap;
    };
    StepErrors out;
    const double inside = 0.3 * elastic.overlap_max;
    const double best[3] = {overlap_at(1, 0, 100000), overlap_at(0.5, inside, 100000),
                            overlap_at(0.5, 0, 100000)};
    for (long steps = 10; steps <= 2560; steps *= 2) {
        out.steps.push_back(static_cast<double>(steps) / 0.7);
        auto error = [&](double value, int k) { return std::fabs(value - best[k]) / elastic.overlap_max; };
        out.elastic.push_back(error(overlap_at(1, 0, steps), 0));
        out.damped_inside.push_back(error(overlap_at(0.5, inside, steps), 1));
        out.damped_from_touch.push_back(error(overlap_at(0.5, 0, steps), 2));
    }
    return out;
}

double production_rebound(const VerificationOptions& options, double restitution, double speed,
                          double phase) {
    ImpactSetup s;
    s.material = metal();
    s.radius_1 = s.radius_2 = kRadius;
    s.normal_speed = speed;
    s.interaction.coefficient_of_restitution = restitution;
    s.phase = phase;
    const double shear = s.material.youngs_modulus / (2 * (1 + s.material.poissons_ratio));
    const double dt = 0.2 * rayleigh_time_step(kRadius, s.material.density, shear, s.material.poissons_ratio);
    s.steps_per_contact = hertz_impact(effective_modulus(metal(), false), 0.5 * kRadius,
                                       0.5 * sphere_mass(8000, kRadius), speed)
                              .contact_time /
                          dt;
    return run_impact(options, s).normal_speed;
}

}  // namespace verification

VerificationCases verify_time_step_order(const VerificationOptions& options) {
    VerificationCases out;
    VerificationOptions exact = options;
    exact.precision = Precision::double_law;  // the integrator is one; float would hide its order
    const double e_star = effective_modulus(metal(), false), r_star = 0.5 * kRadius,
                 m_star = 0.5 * sphere_mass(8000, kRadius);
    const double speed = 0.1;
    const auto elastic = hertz_impact(e_star, r_star, m_star, speed);
    auto order = [&](double restitution, double overlap) {
        double end[3];
        for (int k = 0; k < 3; ++k) {
            const long steps = 400L << k;
            end[k] = pair_after(exact, restitution, overlap, speed,
                                0.7 * elastic.contact_time / static_cast<double>(steps), steps)
                         .overlap;
        }
        return order_of(end[0], end[1], end[2]);
    };
    out.push_back(at_least("V13", "e = 1, from first touch", "order of the overlap at 0.7 contact times", 1.9,
                           order(1, 0), "velocity Verlet"));
    out.push_back(
        at_least("V13", "e = 0.5, started inside contact", "order of the overlap at 0.7 contact times", 1.9,
                 order(0.5, 0.3 * elastic.overlap_max), "velocity Verlet with predicted velocities"));
    out.push_back(at_least("V13", "e = 0.5, from first touch", "order of the overlap at 0.7 contact times",
                           1.2, order(0.5, 0), "damping force starts as overlap^(1/4)"));
    return out;
}

}  // namespace gradwright
