#include "dem/energy_ledger.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "dem/kernel.h"

namespace gradwright {
namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// a + factor b
Vector plus(const Vector& a, const Vector& b, double factor = 1) {
    return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
Vector scaled(const Vector& a, double factor) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}
Vector flat(const Vector& a, const Vector& n) {
    return plus(a, n, -dot(a, n));
}
/// Turned into the plane at constant length, as the law does with xi.
Vector turned(const Vector& a, const Vector& n) {
    const Vector b = flat(a, n);
    const double length2 = dot(b, b);
    return length2 > 1e-60 ? scaled(b, std::sqrt(dot(a, a) / length2)) : Vector{};
}

/// Relative motion of a contact at one instant.
struct RelativeMotion {
    Vector v{}, wi{}, wj{};  ///< of the centres (i against j), spins
};

/// One contact over one step, all in double; a wall is j.
struct BookedContact {
    Vector n{}, n_before{};                  ///< at this force evaluation and one step earlier
    double overlap = 0, overlap_before = 0;  ///< not limited
    double limit = 1e9;                      ///< a yielding body: the law sees no more overlap than this
    double radius = 0, e_star = 0, g_star8 = 0, jkr_radius = 0;
    bool touched = false, touching = false;  ///< before and after this evaluation
    bool frictionless = false;
    Vector xi_before{}, xi{}, roll_before{}, roll{};
    RelativeMotion mean, predicted, predicted_before;  ///< over the step; as the law saw it, now and earlier
    double arm_i = 0, arm_j = 0, arm_i_before = 0, arm_j_before = 0;
    Vector force{}, torque_i{}, torque_j{};  ///< that the engine applied
    Vector body_velocity{};
};

/// The elastic part of the normal contact.
struct Elastic {
    double a = 0, force = 0, energy = 0;
};

Elastic elastic_at(const BookedContact& c, double overlap) {
    Elastic out;
    const double seen = std::min(overlap, c.limit);
    if (c.jkr_radius > 0) {
        const double scale = c.jkr_radius * c.jkr_radius / c.radius;
        const double s = jkr_root<double>(seen / scale), s3 = s * s * s;
        const double force_scale = 4.0 / 3.0 * c.e_star * c.jkr_radius * scale;
        out.a = c.jkr_radius * s * s;
        out.force = force_scale * s3 * (s3 - 1.5);
        out.energy = force_scale * scale * s3 * s * (0.4 * s3 * s3 - s3 + 0.375);
    } else {
        const double delta = std::max(seen, 0.0);
        out.a = std::sqrt(c.radius * delta);
        out.force = 4.0 / 3.0 * c.e_star * out.a * delta;
        out.energy = 0.4 * out.force * delta;
    }
    out.energy += out.force * (overlap - seen);  // a yielding body presses on with a constant force
    return out;
}

Vector slip_of(const RelativeMotion& m, const Vector& n, double arm_i, double arm_j) {
    const Vector arms = plus(scaled(m.wi, arm_i), m.wj, arm_j);
    return plus(flat(m.v, n), cross(arms, n), -1);
}

void book(EnergyLedger& ledger, const BookedContact& c, const LawConstants& law, RollingModel rolling,
          bool opening) {
    const double dt = law.time_step;
    const Elastic now = c.touching ? elastic_at(c, c.overlap) : Elastic{};
    ledger.elastic += now.energy;
    // Springs as they stand after this evaluation: the stored history runs half a step ahead.
    const double stiffness = c.frictionless ? 0 : c.g_star8 * now.a;
    const Vector slip_seen = slip_of(c.predicted, c.n, c.arm_i, c.arm_j);
    const Vector xi = c.touching ? plus(c.xi, slip_seen, -0.5 * dt) : Vector{};
    const double mu_r_arm = law.rolling_friction * c.radius;
    auto roll_stiffness = [&](double a) {
        return rolling == RollingModel::spring && !c.frictionless ? 4.5 * c.e_star * a * mu_r_arm * mu_r_arm
                                                                  : 0.0;
    };
    const double roll_k = roll_stiffness(now.a);
    auto turning = [](const RelativeMotion& m, const Vector& n) { return flat(plus(m.wi, m.wj, -1), n); };
    const Vector turn_seen = turning(c.predicted, c.n);
    const Vector roll = c.touching ? plus(c.roll, turn_seen, -0.5 * dt) : Vector{};
    ledger.springs += 0.5 * stiffness * dot(xi, xi) + 0.5 * roll_k * dot(roll, roll);
    if (opening) return;

    const Elastic before = c.touched ? elastic_at(c, c.overlap_before) : Elastic{};
    const double stiffness_before = c.frictionless ? 0 : c.g_star8 * before.a,
                 roll_k_before = roll_stiffness(before.a);
    Vector xi_before{}, roll_before{};
    if (c.touched) {
        xi_before = plus(c.xi_before, slip_of(c.predicted_before, c.n_before, c.arm_i_before, c.arm_j_before),
                         -0.5 * dt);
        roll_before = plus(c.roll_before, turning(c.predicted_before, c.n_before), -0.5 * dt);
    }
    // energies of the JKR contact at its making (s = 1) and at tear-off (s = 4^(-1/3))
    const double bond_scale =
        c.jkr_radius > 0 ? 4.0 / 3.0 * c.e_star * std::pow(c.jkr_radius, 5) / (c.radius * c.radius) : 0;
    if (!c.touched && c.touching) ledger.bonds += 0.225 * bond_scale;
    if (c.touched && !c.touching) {
        const double s4 = 0.25 * kJkrTearOffRoot;
        ledger.bonds += bond_scale * s4 * (0.4 / 16 - 0.25 + 0.375);
        ledger.respring += 0.5 * stiffness_before * dot(xi_before, xi_before) +
                           0.5 * roll_k_before * dot(roll_before, roll_before);
        return;
    }

    const double normal_force = dot(c.force, c.n);
    ledger.normal_damping -= (normal_force - now.force) * dot(c.mean.v, c.n) * dt;
    ledger.work_of_bodies += dot(c.force, c.body_velocity) * dt;
    if (c.frictionless) return;

    const Vector friction = plus(c.force, c.n, -normal_force);
    const Vector slip = slip_of(c.mean, c.n, c.arm_i, c.arm_j);
    const Vector spring_force = scaled(xi, -stiffness);
    ledger.tangential_damping -= dot(plus(friction, spring_force, -1), slip) * dt;
    const Vector reached = plus(c.touched ? turned(c.xi_before, c.n) : Vector{}, slip_seen, 0.5 * dt);
    const Vector slipped = plus(reached, xi, -1);
    const Vector mean_pull = scaled(plus(scaled(xi, stiffness), flat(xi_before, c.n), stiffness_before), 0.5);
    ledger.sliding += dot(mean_pull, slipped);
    // 1/2 xi^2 dS_t by the rule that goes with the mean force of a step: xi_before . xi, not the mean of the
    // squares. They differ where xi changes much in a step: a damped contact that slips from the start has
    // xi ~ overlap^(-1/4) there, and the account would miss 1 % at any time step.
    ledger.respring -= 0.5 * (stiffness - stiffness_before) * dot(xi, xi_before);

    if (rolling == RollingModel::none) return;
    const Vector arm_torque = cross(c.n, friction);
    const Vector moment_i = plus(c.torque_i, arm_torque, c.arm_i),
                 moment_j = plus(c.torque_j, arm_torque, c.arm_j);
    ledger.rolling -= (dot(moment_i, c.mean.wi) + dot(moment_j, c.mean.wj)) * dt;
    if (rolling != RollingModel::spring) return;
    // of that work the spring keeps its share; what the cap took from it is dissipated
    const Vector turn_mean = turning(c.mean, c.n);
    ledger.rolling -= roll_k * dot(roll, turn_mean) * dt;
    const Vector roll_reached = plus(c.touched ? flat(c.roll_before, c.n) : Vector{}, turn_seen, 0.5 * dt);
    const Vector yielded = plus(roll_reached, roll, -1);
    ledger.rolling +=
        dot(scaled(plus(scaled(roll, roll_k), flat(roll_before, c.n), roll_k_before), 0.5), yielded);
    ledger.respring -= 0.5 * (roll_k - roll_k_before) * dot(roll, roll_before);
}

}  // namespace

template <class T>
void Engine::KernelOf<T>::remember_for_energy() {
    before.tiles = tiles;
    before.rolls = rolls;
    before.walls = walls;
    before.state = e.state_;
    before.motion = motion;
    before.body_time = e.body_time_;
}

template <class T>
void Engine::KernelOf<T>::book_energy(EnergyLedger& ledger, bool opening) {
    const State &s0 = before.state, &s1 = e.state_;
    const auto n = static_cast<std::int32_t>(s1.size());
    const double dt = e.options_.time_step;
    const auto g = e.options_.gravity;
    const std::array<double, 3> period = {e.options_.period_x, e.options_.period_y, e.options_.period_z};

    before.earlier.resize(static_cast<std::size_t>(e.next_id_));
    ledger.kinetic = ledger.potential = ledger.elastic = ledger.springs = 0;
    for (std::int32_t i = 0; i < n; ++i) {
        if (s1.fixed[i]) continue;
        const double m = s1.mass[i], r = s1.radius[i];
        const Vector v = {s1.vx[i], s1.vy[i], s1.vz[i]}, w = {s1.wx[i], s1.wy[i], s1.wz[i]},
                     x = {s1.x[i], s1.y[i], s1.z[i]};
        ledger.kinetic += 0.5 * m * (dot(v, v) + 0.4 * r * r * dot(w, w));
        ledger.potential -= m * dot({g[0], g[1], g[2]}, plus(x, v, -0.5 * dt));
    }

    auto place = [&](std::int32_t i) { return Vector{s0.x[i], s0.y[i], s0.z[i]}; };
    auto speed = [](const State& s, std::int32_t i) { return Vector{s.vx[i], s.vy[i], s.vz[i]}; };
    auto spin = [](const State& s, std::int32_t i) { return Vector{s.wx[i], s.wy[i], s.wz[i]}; };
    auto mean = [&](auto&& of, std::int32_t i) { return scaled(plus(of(s0, i), of(s1, i)), 0.5); };
    auto earlier_place = [&](std::int32_t i) {
        return s0.fixed[i] ? place(i) : plus(place(i), speed(s0, i), -dt);
    };
    auto read = [](const auto& arrays, int lane) {
        return Vector{double(arrays[0][lane]), double(arrays[1][lane]), double(arrays[2][lane])};
    };
    auto add_predicted = [](RelativeMotion& m, const Motion& i, const Motion* j) {
        m.v = {i.vx, i.vy, i.vz};
        m.wi = {i.wx, i.wy, i.wz};
        if (!j) return;
        m.v = plus(m.v, {j->vx, j->vy, j->vz}, -1);
        m.wj = {j->wx, j->wy, j->wz};
    };
    const LawConstants law = e.law_;
    const auto& interaction = e.options_.interaction;
    const RollingModel rolling =
        interaction.rolling_friction > 0 ? interaction.rolling_model : RollingModel::none;
    auto common = [&](BookedContact& c, const auto& t0, const auto& t1, int lane) {
        c.radius = t1.radius[lane];
        c.e_star = t1.e_star[lane];
        c.g_star8 = t1.g_star8[lane];
        c.jkr_radius = e.adhesion_ > 0 ? double(t1.jkr_radius[lane]) : 0;
        c.touched = t0.touching[lane] > 0;
        c.touching = t1.touching[lane] > 0;
        c.xi_before = read(t0.xi, lane);
        c.xi = read(t1.xi, lane);
    };

    for (std::size_t slot = 0; slot < active_slots; ++slot) {
        const PairTile &t0 = before.tiles[slot / W], &t1 = tiles[slot / W];
        const int lane = static_cast<int>(slot % W);
        if (!(t0.touching[lane] > 0) && !(t1.touching[lane] > 0)) continue;
        const std::int32_t i = t1.i[lane], j = t1.j[lane];
        BookedContact c;
        common(c, t0, t1, lane);
        if (has_rolls) {
            c.roll_before = read(before.rolls[slot / W].angle, lane);
            c.roll = read(rolls[slot / W].angle, lane);
        }
        auto between = [&](Vector d, Vector& normal) {
            for (int k = 0; k < 3; ++k)
                if (period[k] > 0) d[k] -= period[k] * std::nearbyint(d[k] / period[k]);
            const double distance = std::sqrt(dot(d, d));
            normal = scaled(d, 1 / distance);
            return s0.radius[i] + s0.radius[j] - distance;
        };
        c.overlap = between(plus(place(i), place(j), -1), c.n);
        c.overlap_before = between(plus(earlier_place(i), earlier_place(j), -1), c.n_before);
        c.arm_i = s0.radius[i] - 0.5 * c.overlap;
        c.arm_j = s0.radius[j] - 0.5 * c.overlap;
        c.arm_i_before = s0.radius[i] - 0.5 * c.overlap_before;
        c.arm_j_before = s0.radius[j] - 0.5 * c.overlap_before;
        c.mean = {plus(mean(speed, i), mean(speed, j), -1), mean(spin, i), mean(spin, j)};
        add_predicted(c.predicted, before.motion[i], &before.motion[j]);
        add_predicted(c.predicted_before, before.earlier[s0.id[i]], &before.earlier[s0.id[j]]);
        const auto& own = kept[slot / W].to_first[lane].value;
        const auto& other = kept[slot / W].to_second[lane].value;
        c.force = {double(own[0]), double(own[1]), double(own[2])};
        c.torque_i = {double(own[4]), double(own[5]), double(own[6])};
        c.torque_j = {double(other[4]), double(other[5]), double(other[6])};
        book(ledger, c, law, rolling, opening);
    }

    for (std::size_t slot = 0; slot < wall_slots; ++slot) {
        const WallTile &t0 = before.walls[slot / W], &t1 = walls[slot / W];
        const int lane = static_cast<int>(slot % W);
        if (!(t0.touching[lane] > 0) && !(t1.touching[lane] > 0)) continue;
        const std::int32_t i = t1.i[lane];
        const Body& body = e.bodies_[t1.body[lane]];
        BookedContact c;
        common(c, t0, t1, lane);
        c.roll_before = read(t0.roll, lane);
        c.roll = read(t1.roll, lane);
        const double r = s0.radius[i];
        if (body.yield_ratio > 0) c.limit = body.yield_ratio * r;
        c.frictionless = body.frictionless;
        auto against = [&](const Vector& x, double time, Vector& normal) {
            const auto p = nearest_point(body, body.speed_x * time, body.speed_z * time, x[0], x[1], x[2]);
            normal = {p.nx, p.ny, p.nz};
            return r - p.distance;
        };
        c.overlap = against(place(i), before.body_time, c.n);
        c.overlap_before = against(earlier_place(i), before.earlier_body_time, c.n_before);
        c.arm_i = c.arm_j = r - std::min(c.overlap, c.limit);
        c.arm_i_before = c.arm_j_before = r - std::min(c.overlap_before, c.limit);
        if (e.bodies_move_) c.body_velocity = {body.speed_x, 0, body.speed_z};
        c.mean = {plus(mean(speed, i), c.body_velocity, -1), mean(spin, i), {}};
        add_predicted(c.predicted, before.motion[i], nullptr);
        add_predicted(c.predicted_before, before.earlier[s0.id[i]], nullptr);
        c.predicted.v = plus(c.predicted.v, c.body_velocity, -1);
        c.predicted_before.v = plus(c.predicted_before.v, c.body_velocity, -1);
        c.force = {double(t1.out[0][lane]), double(t1.out[1][lane]), double(t1.out[2][lane])};
        c.torque_i = {double(t1.out[3][lane]), double(t1.out[4][lane]), double(t1.out[5][lane])};
        book(ledger, c, law, rolling, opening);
    }
    for (std::int32_t i = 0; i < n; ++i) before.earlier[s0.id[i]] = before.motion[i];
    before.earlier_body_time = before.body_time;
}

long Engine::step_with_account() {
    kernel_->remember_for_energy();
    const long done = kernel_->run(1);
    const bool opening = !energy_.open;
    kernel_->book_energy(energy_, opening);
    if (opening) {
        energy_.open = true;
        energy_.start = energy_.held();
    } else {
        ++energy_.steps;
    }
    return done;
}

void Engine::book_leaving_grains() {
    const State& s = state_;
    const auto g = options_.gravity;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.fixed[i] || !(s.x[i] > options_.remove_beyond_x)) continue;
        const Vector x = {s.x[i], s.y[i], s.z[i]}, v = {s.vx[i], s.vy[i], s.vz[i]},
                     w = {s.wx[i], s.wy[i], s.wz[i]};
        const double r = s.radius[i];
        energy_.carried_off += s.mass[i] * (0.5 * (dot(v, v) + 0.4 * r * r * dot(w, w)) -
                                            dot({g[0], g[1], g[2]}, plus(x, v, -0.5 * options_.time_step)));
    }
}

template void Engine::KernelOf<double>::remember_for_energy();
template void Engine::KernelOf<WideFloat>::remember_for_energy();
template void Engine::KernelOf<double>::book_energy(EnergyLedger&, bool);
template void Engine::KernelOf<WideFloat>::book_energy(EnergyLedger&, bool);

}  // namespace gradwright
