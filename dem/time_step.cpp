// The step: contact law over near pairs and walls -> sums per grain in fixed order -> integrate.
// Velocity Verlet in leapfrog form: v(t+dt/2) = v(t-dt/2) + a(t) dt, x(t+dt) = x(t) + v(t+dt/2) dt; the
// velocity that damping and friction see at t+dt is predicted as v(t+dt/2) + a(t) dt/2.
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/kernel.h"

namespace gradwright {

template <class T>
double Engine::KernelOf<T>::grain_pass(std::size_t first, std::size_t last, double kick, double frame) {
    State& s = e.state_;
    const double dt = e.options_.time_step;
    const auto g = e.options_.gravity;
    const bool late = e.options_.fault.late_velocity;
    double top = 0, sum = 0;  // std::max drops what is not a number, a sum keeps it
    for (std::size_t k = first; k < last; ++k) {
        const std::int32_t i = e.awake_[k];
        using Sum = typename Lane<T>::Sum;
        Sum f = {};
        for (std::int32_t slot = own_first[i]; slot < own_first[i + 1]; ++slot)
            f += *reinterpret_cast<const Sum*>(&own_record[slot]);
        for (std::int32_t slot = in_first[i]; slot < in_first[i + 1]; ++slot)
            f += *reinterpret_cast<const Sum*>(&in_record[slot]);
        for (std::int32_t slot = wall_first[i]; slot < wall_first[i + 1]; ++slot) {
            const WallTile& t = walls[slot / W];
            const int lane = slot % W;
            for (int c = 0; c < 6; ++c) f[c] += t.out[c][lane];
        }
        const double m = inverse_mass[i], n = inverse_inertia[i];
        const double ax = f[0] * m + g[0], ay = f[1] * m + g[1], az = f[2] * m + g[2];
        const double bx = f[3] * n, by = f[4] * n, bz = f[5] * n;
        s.vx[i] += kick * ax;
        s.vy[i] += kick * ay;
        s.vz[i] += kick * az;
        s.wx[i] += kick * bx;
        s.wy[i] += kick * by;
        s.wz[i] += kick * bz;
        s.x[i] += dt * s.vx[i];
        s.y[i] += dt * s.vy[i];
        s.z[i] += dt * s.vz[i];
        const double forward = s.vx[i] - frame;
        const double speed2 = forward * forward + s.vy[i] * s.vy[i] + s.vz[i] * s.vz[i];
        top = std::max(top, speed2);
        sum += speed2;
        const double half = late ? 0 : 0.5 * dt;
        position[i].x = s.x[i];
        position[i].y = s.y[i];
        position[i].z = s.z[i];
        Motion& p = motion[i];
        p.vx = S(s.vx[i] + half * ax);
        p.vy = S(s.vy[i] + half * ay);
        p.vz = S(s.vz[i] + half * az);
        p.wx = S(s.wx[i] + half * bx);
        p.wy = S(s.wy[i] + half * by);
        p.wz = S(s.wz[i] + half * bz);
    }
    return std::isfinite(sum) ? top : std::numeric_limits<double>::infinity();
}

template <class T>
template <bool kAdhesive, RollingModel kRolling>
long Engine::KernelOf<T>::run_with(long steps) {
    const double dt = e.options_.time_step;
    const std::size_t pair_tiles = (active_slots + W - 1) / W, wall_tiles = walls.size();
    const std::size_t awake = e.awake_.size();
    // fewer grains than this per thread cost more in waiting than they win
    const int threads = static_cast<int>(std::clamp<std::size_t>(awake / 200, 1, e.threads_));
    const double frame = e.frame_speed(), body_top = e.body_speed(frame);

    std::vector<double> tops(threads * 8, 0.0);
    long done = 0;
    double travel = e.travel_, law_seconds = 0,
           grain_seconds = 0;  // written by thread 0 alone; every thread keeps the same numbers
    const double body_time = e.body_time_;
    const bool first_kick = e.first_kick_;
#pragma omp parallel num_threads(threads)
    {
        double my_travel = e.travel_;
        long my_done = 0;
        const int me = omp_get_thread_num(), all = omp_get_num_threads();
        auto share = [&](std::size_t count, int who) { return count * who / all; };
        double clock = omp_get_wtime();
        for (long step = 0; step < steps; ++step) {
            const double bt = body_time + (e.bodies_move_ ? dt * step : 0);
            pair_pass<kAdhesive, kRolling>(share(pair_tiles, me), share(pair_tiles, me + 1));
            wall_pass<kAdhesive, kRolling>(share(wall_tiles, me), share(wall_tiles, me + 1), bt);
#pragma omp barrier
            if (me == 0) {
                const double now = omp_get_wtime();
                law_seconds += now - clock;
                clock = now;
            }
            const double kick = first_kick && step == 0 ? 0.5 * dt : dt;
            tops[me * 8] = grain_pass(share(awake, me), share(awake, me + 1), kick, frame);
#pragma omp barrier
            if (me == 0) {
                const double now = omp_get_wtime();
                grain_seconds += now - clock;
                clock = now;
            }
            double top = 0;
            for (int k = 0; k < all; ++k) top = std::max(top, tops[k * 8]);
            top = std::sqrt(top);
            my_travel +=
                dt *
                (top + std::max(top, body_top));  // two grains, or a grain and a body, close in by no more
            my_done = step + 1;
            // `not (a <= b)`: a speed that is not a number ends the block too
            if (!(my_travel <= e.near_skin_)) break;
        }
        if (me == 0) {
            travel = my_travel;
            done = my_done;
        }
    }
    e.first_kick_ = false;
    e.travel_ = std::isfinite(travel) ? travel : 1e9;
    e.steps_ += done;
    e.steps_since_near_ += done;
    e.frame_shift_ += frame * dt * done;
    e.body_way_ += body_top * dt * done;
    e.time_ += dt * done;
    if (e.bodies_move_) e.body_time_ += dt * done;
    e.grain_steps_ += static_cast<double>(done) * static_cast<double>(awake);
    e.times_.law += law_seconds;
    e.times_.grains += grain_seconds;
    return done;
}

template <class T>
long Engine::KernelOf<T>::run(long steps) {
    const auto& interaction = e.options_.interaction;
    const bool adhesive = e.adhesion_ > 0;
    const RollingModel rolling =
        interaction.rolling_friction > 0 ? interaction.rolling_model : RollingModel::none;
    // chosen once per block of steps: what the scene does not need is not computed
    if (rolling == RollingModel::none)
        return adhesive ? run_with<true, RollingModel::none>(steps)
                        : run_with<false, RollingModel::none>(steps);
    if (rolling == RollingModel::constant_torque)
        return adhesive ? run_with<true, RollingModel::constant_torque>(steps)
                        : run_with<false, RollingModel::constant_torque>(steps);
    if (rolling == RollingModel::edem)
        return adhesive ? run_with<true, RollingModel::edem>(steps)
                        : run_with<false, RollingModel::edem>(steps);
    return adhesive ? run_with<true, RollingModel::spring>(steps)
                    : run_with<false, RollingModel::spring>(steps);
}

template long Engine::KernelOf<double>::run(long);
template long Engine::KernelOf<F8>::run(long);
template double Engine::KernelOf<double>::grain_pass(std::size_t, std::size_t, double, double);
template double Engine::KernelOf<F8>::grain_pass(std::size_t, std::size_t, double, double);

}  // namespace gradwright
