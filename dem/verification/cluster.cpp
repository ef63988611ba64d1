// V10, V11: many grains: conservation, and what the lists find.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dem/random.h"
#include "dem/verification/laboratory.h"

namespace gradwright {
using namespace verification;
namespace {

constexpr double kRadius = 20e-6, kTimeStep = 2e-7;

Interaction powder(double adhesion, RollingModel rolling) {
    Interaction i;
    i.work_of_adhesion = adhesion;
    i.rolling_model = rolling;
    return i;
}

/// Grains of three sizes on a loose jittered lattice of n^3, moving towards the middle and turning. `period`
/// closes y exactly.
void add_cloud(Engine& engine, int n, double speed, double spacing, std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                GrainSpec g;
                g.radius = kRadius * (1 - 0.2 * static_cast<double>(random.below(3)));
                auto place = [&](int cell) {
                    return spacing * (cell + 0.5 + 0.06 * (random.uniform() - 0.5));
                };
                g.x = place(i), g.y = place(j), g.z = place(k);
                const double middle = 0.5 * n * spacing;
                g.vx = speed * ((middle - g.x) / middle + 0.5 * random.uniform());
                g.vy = speed * ((middle - g.y) / middle + 0.5 * random.uniform());
                g.vz = speed * ((middle - g.z) / middle + 0.5 * random.uniform());
                for (double* w : {&g.wx, &g.wy, &g.wz}) *w = speed / kRadius * random.uniform();
                engine.add_grain(g);
            }
}

/// Momentum and angular momentum about the origin, and the sums of their parts' magnitudes. Half-step
/// velocities with whole-step positions: what leapfrog keeps exactly.
struct Momenta {
    std::array<double, 6> sum{};
    double linear_scale = 0, angular_scale = 0;
};
Momenta momenta(const State& s) {
    Momenta p;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double m = s.mass[i], inertia = 0.4 * m * s.radius[i] * s.radius[i];
        const double l[3] = {m * (s.y[i] * s.vz[i] - s.z[i] * s.vy[i]) + inertia * s.wx[i],
                             m * (s.z[i] * s.vx[i] - s.x[i] * s.vz[i]) + inertia * s.wy[i],
                             m * (s.x[i] * s.vy[i] - s.y[i] * s.vx[i]) + inertia * s.wz[i]};
        const double q[3] = {m * s.vx[i], m * s.vy[i], m * s.vz[i]};
        for (int k = 0; k < 3; ++k) {
            p.sum[k] += q[k];
            p.sum[k + 3] += l[k];
        }
        p.linear_scale += std::hypot(q[0], q[1], q[2]);
        p.angular_scale += std::hypot(l[0], l[1], l[2]);
    }
    return p;
}

/// Touching pairs by trying all of them.
std::size_t touching_pairs(const State& s, double period) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
        for (std::size_t j = i + 1; j < s.size(); ++j) {
            const double dx = s.x[i] - s.x[j], dz = s.z[i] - s.z[j];
            double dy = s.y[i] - s.y[j];
            if (period > 0) dy -= period * std::round(dy / period);
            const double sum = s.radius[i] + s.radius[j];
            count += dx * dx + dy * dy + dz * dz < sum * sum;
        }
    return count;
}

}  // namespace

VerificationCases verify_conservation(const VerificationOptions& options) {
    VerificationCases out;
    const double tolerance = options.precision == Precision::double_law ? 1e-12 : 1e-6;
    struct Row {
        const char* name;
        double adhesion;
        RollingModel rolling;
    };
    for (const Row& row : {Row{"64 grains, Hertz, constant torque", 0, RollingModel::constant_torque},
                           Row{"64 grains, JKR, spring rolling", 5e-4, RollingModel::spring}}) {
        Engine engine(laboratory_options(options, grain_material(8000, 2e7, 0.3),
                                         powder(row.adhesion, row.rolling), kTimeStep));
        add_cloud(engine, 4, 0.1, 2.1 * kRadius, 3);
        const Momenta before = momenta(engine.state());
        std::size_t seen = 0;
        for (int block = 0; block < 150; ++block) {
            engine.advance(20);
            seen += engine.contacts();
        }
        const Momenta after = momenta(engine.state());
        double linear = 0, angular = 0;
        for (int k = 0; k < 3; ++k) {
            linear = std::hypot(linear, after.sum[k] - before.sum[k]);
            angular = std::hypot(angular, after.sum[k + 3] - before.sum[k + 3]);
        }
        const auto name = fmt::format("{}, {} contacts at 150 instants", row.name, seen);
        out.push_back(judged("V10", name, "change of momentum / sum of magnitudes", 0,
                             linear / before.linear_scale, 1, tolerance, "action and reaction"));
        out.push_back(judged("V10", name, "change of angular momentum / sum of magnitudes", 0,
                             angular / before.angular_scale, 1, tolerance, "arms meet in the contact point"));
        out.push_back(
            judged("V10", name, "contacts were made", 1, seen > 200, 1, 0, "else nothing was shown"));
    }
    return out;
}

VerificationCases verify_neighbours(const VerificationOptions& options) {
    VerificationCases out;
    for (const bool periodic : {false, true}) {
        const char* sides = periodic ? "periodic in y" : "free";
        const int n = 7;
        const double spacing = 2.1 * kRadius;
        EngineOptions eo = laboratory_options(options, grain_material(8000, 2e7, 0.3),
                                              powder(0, RollingModel::constant_torque), kTimeStep);
        if (periodic) eo.period_y = n * spacing;
        Engine engine(eo);
        add_cloud(engine, n, 0.3, spacing, 5);
        std::size_t compared = 0, wrong = 0;
        for (int block = 0; block < 150; ++block) {
            engine.advance(19);
            const std::size_t expected = touching_pairs(engine.state(), eo.period_y);
            engine.advance(1);  // counts the contacts of the positions just looked at
            wrong += engine.contacts() != expected;
            compared += expected;
        }
        out.push_back(judged("V11",
                             fmt::format("343 grains, {}, {} contacts at 150 instants", sides, compared),
                             "instants with other contacts than all pairs give", 0,
                             static_cast<double>(wrong), 1, 0, "search over all pairs"));
        out.push_back(judged("V11", fmt::format("343 grains, {}", sides), "contacts were made", 1,
                             compared > 1000, 1, 0, "else nothing was shown"));

        std::string first;
        for (const int threads : {1, 2, 3, 8}) {
            EngineOptions many = eo;
            many.threads = threads;
            many.interaction = powder(5e-4, RollingModel::constant_torque);
            if (periodic) many.period_y = 12 * spacing;
            Engine cloud(many);
            add_cloud(cloud, 12, 0.3, spacing, 11);
            cloud.advance(150);
            const std::string hash = cloud.state_hash();
            if (first.empty())
                first = hash;
            else
                out.push_back(judged("V11", fmt::format("1728 grains, {}, {} threads", sides, threads),
                                     "state hash as on one thread (1 = equal)", 1, hash == first, 1, 0,
                                     "sums in fixed order"));
        }
    }
    return out;
}

}  // namespace gradwright
