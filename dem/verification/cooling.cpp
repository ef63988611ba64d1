// V12: smooth inelastic grains without gravity cool as T = T0/(1 + t/tau)^2 (Haff 1983, J. Fluid Mech. 134)
// with
//   tau = 6/((1 - e^2) w0),  w0 = 4 n d^2 chi sqrt(pi T0/m),  chi = (1 - phi/2)/(1 - phi)^3
// (Enskog's collision frequency with Carnahan & Starling's chi) until they cluster. A box with walls would
// not do: the walls share the law's e and cool the gas from outside, and the gas is thinner one diameter from
// them. So the engine wraps x and z too, which is a few lines in its search for pairs.
#include "dem/verification/cooling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "dem/random.h"

namespace gradwright {
namespace verification {
namespace {

// At 0.1 m/s per axis these overlap by 0.8 % of the radius: contacts last 1 % of the time between two.
constexpr double kRadius = 20e-6, kDensity = 8000, kYoungsModulus = 3e8, kSpeed = 0.1;

/// Speed of the hot gas: T/m = mean square of one velocity component about the mean.
double thermal_speed2(const Engine& engine) {
    const std::size_t n = engine.state().size();
    std::array<double, 3> sum{};
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const auto v = engine.velocity(i);
        for (int k = 0; k < 3; ++k) {
            sum[k] += v[k];
            square += v[k] * v[k];
        }
    }
    const double count = static_cast<double>(n);
    for (const double s : sum) square -= s * s / count;
    return square / (3 * (count - 1));
}

}  // namespace

std::vector<CoolingPoint> cool(const VerificationOptions& options, const CoolingOptions& c) {
    const double d = 2 * kRadius, spacing = d * std::cbrt(kPi / (6 * c.packing_fraction));
    const double side = c.cells * spacing;
    const Material material = grain_material(kDensity, kYoungsModulus, 0.3);
    const auto contact = hertz_impact(effective_modulus(material, false), 0.5 * kRadius,
                                      0.5 * sphere_mass(kDensity, kRadius), 2 * kSpeed);
    auto gas = [&](double restitution) {
        Interaction interaction = bare_interaction();
        interaction.coefficient_of_restitution = restitution;
        EngineOptions eo = laboratory_options(options, material, interaction, contact.contact_time / 30);
        eo.period_x = eo.period_y = eo.period_z = side;
        return eo;
    };
    // From a lattice to a gas: about eight elastic collisions a grain.
    Engine hot(gas(1));
    Random random(12);
    for (int i = 0; i < c.cells; ++i)
        for (int j = 0; j < c.cells; ++j)
            for (int k = 0; k < c.cells; ++k) {
                GrainSpec g{.x = spacing * i, .y = spacing * j, .z = spacing * k, .radius = kRadius};
                // sum of twelve uniform numbers: near enough to a normal one to start from
                for (double* v : {&g.vx, &g.vy, &g.vz}) {
                    double sum = -6;
                    for (int draw = 0; draw < 12; ++draw) sum += random.uniform();
                    *v = kSpeed * sum;
                }
                hot.add_grain(g);
            }
    const double number_density = 1 / (spacing * spacing * spacing), phi = c.packing_fraction;
    const double chi = (1 - 0.5 * phi) / std::pow(1 - phi, 3);
    auto frequency = [&](double t_over_m) {
        return 4 * number_density * d * d * chi * std::sqrt(kPi * t_over_m);
    };
    const double dt = hot.time_step();
    hot.advance(std::lround(8 / frequency(kSpeed * kSpeed) / dt));

    Engine cooling(gas(c.restitution));
    for (std::size_t i = 0; i < hot.state().size(); ++i) {
        const State& s = hot.state();
        const auto v = hot.velocity(i);
        cooling.add_grain(
            {.x = s.x[i], .y = s.y[i], .z = s.z[i], .vx = v[0], .vy = v[1], .vz = v[2], .radius = kRadius});
    }
    const double start = thermal_speed2(cooling);
    const double tau = 6 / ((1 - c.restitution * c.restitution) * frequency(start));
    std::vector<CoolingPoint> out = {{0, 1, 1}};
    for (int k = 1; k <= c.points; ++k) {
        const double time = c.end * k / c.points;
        cooling.advance(std::lround(time * tau / dt) - cooling.steps());
        out.push_back({time, thermal_speed2(cooling) / start, 1 / ((1 + time) * (1 + time))});
    }
    return out;
}

}  // namespace verification

using namespace verification;

VerificationCases verify_cooling(const VerificationOptions& options) {
    VerificationCases out;
    // At e = 0.8 vortices slow the cooling from half a tau on; at e = 0.9 this box is too small for them.
    for (const auto& [e, end] : {std::pair{0.8, 0.5}, {0.9, 1.0}}) {
        const auto curve = cool(options, {.restitution = e, .end = end, .points = 4});
        for (std::size_t k = 1; k < curve.size(); ++k)
            out.push_back(judged(
                "V12",
                fmt::format("2744 smooth grains, 10 % solid, e = {:g}, t = {:g} tau", e, curve[k].time),
                "temperature over the first", curve[k].expected, curve[k].temperature, curve[k].expected,
                0.05, "1/(1 + t/tau)^2, Haff 1983"));
    }
    return out;
}

}  // namespace gradwright
