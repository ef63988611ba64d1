// The step: contact law over near pairs and walls -> sums per grain in fixed order -> integrate.
// Velocity Verlet in leapfrog form: v(t+dt/2) = v(t-dt/2) + a(t) dt, x(t+dt) = x(t) + v(t+dt/2) dt; the
// velocity that damping and friction see at t+dt is predicted as v(t+dt/2) + a(t) dt/2.
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "dem/kernel.h"

namespace gradwright {

namespace {

/// Force and torque of a sum, in double.
inline void split(F8 sum, D4& force, D4& torque) {
    force = __builtin_convertvector(__builtin_shufflevector(sum, sum, 0, 1, 2, 3), D4);
    torque = __builtin_convertvector(__builtin_shufflevector(sum, sum, 4, 5, 6, 7), D4);
}
inline void split(D8 sum, D4& force, D4& torque) {
    force = __builtin_shufflevector(sum, sum, 0, 1, 2, 3);
    torque = __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
}
/// Four numbers in the law's type.
inline void put(D4 from, float* to) {
    *reinterpret_cast<F4*>(to) = __builtin_convertvector(from, F4);
}
inline void put(D4 from, double* to) {
    *reinterpret_cast<D4*>(to) = from;
}

}  // namespace

// Where the grains do not fit in the processor's cache, it is told what comes: second grains are met in no
// order, and there are more rows than it can follow. A little at a time, in three places of every tile: a
// million grains 39 million grain-steps/s, all of it before the tile 37, a block's worth at once 18 (the core
// then waits for its own requests), not told 16. What does fit gains nothing, hence `cached_grains`, about 15
// MB.
template <class T>
void Engine::KernelOf<T>::aim(Ahead& ahead, std::int32_t b, std::int32_t tail) const {
    const Block& block = blocks[b];
    const std::int32_t pair_tiles = std::max(1, block.end_tile - block.first_tile);
    const auto part = [pair_tiles](std::int32_t count) { return (count + pair_tiles - 1) / pair_tiles; };
    if (b + 2 < tail) ahead.met_end = std::max(ahead.met_end, blocks[b + 2].reach);
    ahead.met_each = 2 * part((ahead.met_end - ahead.met + 1) / 2);
    ahead.own = first_grain(b + 1);
    ahead.own_end = first_grain(b + 2);
    ahead.own_each = part(ahead.own_end - ahead.own);
    // two rows of four bytes a grain, read in order: a line holds sixteen
    if (b + 2 < static_cast<std::int32_t>(blocks.size()))
        for (std::int32_t k = 0; k < static_cast<std::int32_t>(kBlock); k += 16) {
            __builtin_prefetch(e.inverse_reach2_.data() + ahead.own + k, 0);
            __builtin_prefetch(e.awake_.data() + block.end_awake + k, 0);
        }
}

// What the pairs of one share's tail do to the next share's grains goes from core to core and back in every
// step: places, motions and sums, all asked for at once, as these are few and the computing would only wait
// for one after the other. Without the sums a twelfth of the tail's thread stood in one addition.
template <class T>
[[gnu::always_inline]] inline void Engine::KernelOf<T>::fetch_met(std::int32_t first, std::int32_t last,
                                                                  const Sums& of, bool reading) const {
    for (std::int32_t grain = first; grain <= last; grain += 2) {  // two a cache line, of the wide law
        __builtin_prefetch(&of[grain], 1);
        if (reading) {
            __builtin_prefetch(&e.state_.place[grain], 0);
            __builtin_prefetch(&motion[grain], 0);
        } else {
            __builtin_prefetch(&e.state_.place[grain], 1);
            __builtin_prefetch(&motion[grain], 1);
        }
    }
}

template <class T>
void Engine::KernelOf<T>::hand_over_kept(const Block& block, const Handed* from, const Sums& to,
                                         std::int32_t end, bool beyond) {
    using Sum = typename Lane<T>::Sum;
    if (block.reach < end) {
        for (std::int32_t k = block.first_tile; k < block.end_tile && !beyond; ++k)
            if (!from[k - block.first_tile].idle)
                hand_over(tiles[k], from[k - block.first_tile],
                          std::min<std::int32_t>(W, block.own_end - k * W), to);
        return;
    }
    for (std::int32_t slot = block.first_tile * W; slot < block.own_end; ++slot) {
        const PairTile& t = tiles[slot / W];
        const Handed& handed = from[slot / W - block.first_tile];
        if (handed.idle) continue;
        const int lane = slot % W;
        if (!beyond)
            *reinterpret_cast<Sum*>(&to[t.i[lane]]) += *reinterpret_cast<const Sum*>(&handed.to_first[lane]);
        if ((t.j[lane] >= end) == beyond)
            *reinterpret_cast<Sum*>(&to[t.j[lane]]) += *reinterpret_cast<const Sum*>(&handed.to_second[lane]);
    }
}

template <class T>
double Engine::KernelOf<T>::grain_pass(const Block& block, const Sums& from, double kick, D4 frame) {
    const double dt = e.options_.time_step;
    const D4 gravity = {e.options_.gravity[0], e.options_.gravity[1], e.options_.gravity[2], 0};
    const double half = e.options_.fault.late_velocity ? 0 : 0.5 * dt;
    using Sum = typename Lane<T>::Sum;
    Place* const place = e.state_.place.data();
    Moving* const moving = e.state_.moving.data();
    double top = 0, sum = 0;  // std::max drops what is not a number, a sum keeps it
    for (std::int32_t k = block.first_awake; k < block.end_awake; ++k) {
        const std::int32_t i = e.awake_[k];
        const Sum f = *reinterpret_cast<const Sum*>(&from[i]);
        *reinterpret_cast<Sum*>(&from[i]) = Sum{};
        D4 force, torque;
        split(f, force, torque);
        D4 v = *reinterpret_cast<const D4*>(&moving[i].vx), w = *reinterpret_cast<const D4*>(&moving[i].wx);
        const D4 a = force * v[3] + gravity, b = torque * w[3];  // fourth lanes are zero
        v += kick * a;
        w += kick * b;
        *reinterpret_cast<D4*>(&moving[i].vx) = v;
        *reinterpret_cast<D4*>(&moving[i].wx) = w;
        D4 way = v;
        way[3] = 0;
        D4 x = *reinterpret_cast<const D4*>(&place[i]);
        x += dt * way;
        *reinterpret_cast<D4*>(&place[i]) = x;
        const D4 against = v - frame;
        const double share2 = (against[0] * against[0] + against[1] * against[1] + against[2] * against[2]) *
                              e.inverse_reach2_[static_cast<std::size_t>(i)];
        top = std::max(top, share2);
        sum += share2;
        D4 next_v = v + half * a, next_w = w + half * b;
        next_v[3] = x[3];  // the radius stands there
        next_w[3] = 0;
        put(next_v, &motion[i].vx);
        put(next_w, &motion[i].wx);
    }
    return std::isfinite(sum) ? top : std::numeric_limits<double>::infinity();
}

template <class T>
template <bool kAdhesive, RollingModel kRolling, class Lap>
double Engine::KernelOf<T>::finish_block(std::int32_t b, const Sums& sums, const Step& step, D4 frame,
                                         Lap&& lap) {
    const Block& block = blocks[b];
    wall_pass<kAdhesive, kRolling>(block, sums, step.body_time);
    lap();
    // `force_on_fixed` is asked for after the last step only
    if (step.last) force_on_fixed_by_block[b] = force_on_fixed_of(block, sums);
    const double top = grain_pass(block, sums, step.kick, frame);
    if (block.presses_still)
        for (std::int32_t i = first_grain(b); i < first_grain(b + 1); ++i) sums[i] = Record{};
    return top;
}

// Several steps at once, for a bed that does not fit in the cache: one step sweeps the blocks, the next one
// follows as soon as the grains that its block meets have moved, and so on, so that what one has fetched the
// others find. Each thread sweeps some steps that follow each other; the first of them waits for the last one
// of the thread ahead, block by block. Same sums in the same order as one step after the other.
template <class T>
template <bool kAdhesive, RollingModel kRolling>
long Engine::KernelOf<T>::run_in_levels(long steps) {
    Run run{e, steps};
    const auto count = static_cast<std::int32_t>(blocks.size());
    struct alignas(64) Level {
        std::atomic<std::int32_t> done{0};  ///< blocks
        double top = 0;
    };
    double travel = e.travel_;
    long done = 0, at_once = 1;
    while (done < steps) {
        at_once = std::min(at_once, steps - done);
        std::vector<Level> level(static_cast<std::size_t>(at_once));
        const auto sweep = [&](Level& of, std::int32_t b, const Step& step, const Sums& sums, Ahead* ahead,
                               bool clocked) {
            const double begun = clocked ? omp_get_wtime() : 0;
            double middle = 0;
            if (ahead) aim(*ahead, b, count);
            pair_pass<kAdhesive, kRolling>(blocks[b], sums, nullptr, ahead);
            const double top = finish_block<kAdhesive, kRolling>(b, sums, step, run.frame, [&] {
                if (clocked) middle = omp_get_wtime();
            });
            of.top = std::max(of.top, top);
            if (clocked) {
                run.law_seconds += middle - begun;
                run.grain_seconds += omp_get_wtime() - middle;
            }
            of.done.store(b + 1, std::memory_order_release);
        };
        const int threads = static_cast<int>(std::min<long>(e.threads_, (at_once + levels - 1) / levels));
#pragma omp parallel num_threads(threads)
        {
            const int me = omp_get_thread_num(), all = omp_get_num_threads();
            for (long first = long{me} * levels; first < at_once; first += long{all} * levels) {
                const long last = std::min<long>(first + levels, at_once) - 1;
                Ahead ahead;
                // one block of each in turn, whichever may go on
                while (level[last].done.load(std::memory_order_relaxed) < count) {
                    bool idle = true;
                    for (long l = first; l <= last; ++l) {
                        const std::int32_t b = level[l].done.load(std::memory_order_relaxed);
                        if (b == count ||
                            (l > 0 && level[l - 1].done.load(std::memory_order_acquire) <= last_met(b)))
                            continue;
                        idle = false;
                        sweep(level[l], b, run.step(done + l),
                              sums_of(static_cast<std::size_t>(me) * levels + (l - first)),
                              l == first ? &ahead : nullptr, me == 0 && b % 8 == 4);
                    }
                    if (idle) std::this_thread::yield();
                }
            }
        }
        double step_share = 0;
        for (const Level& one : level) {
            run.late += !(travel <= 1);
            step_share = run.share(one.top);
            travel += step_share;
        }
        done += at_once;
        // `not (a <= b)`: a speed that is not a number ends the block too
        if (!(travel <= 1)) break;
        at_once = steps_between_looks(travel, step_share);
    }
    book_run(run, done, travel);
    return done;
}

template <class T>
template <bool kAdhesive, RollingModel kRolling>
long Engine::KernelOf<T>::run_with(long steps) {
    if (levels > 0) return run_in_levels<kAdhesive, kRolling>(steps);
    Run run{e, steps};
    const auto count = static_cast<int>(shares.size());
    // Two sets, by turns: between two steps without tails stands one barrier, and a thread that is past it
    // may write its next one while another still reads.
    struct alignas(64) Top {
        double of[2] = {0, 0};
    };
    std::vector<Top> tops(static_cast<std::size_t>(count));
    std::vector<Busy> busy(static_cast<std::size_t>(count));
    long done = 0;
    double travel = e.travel_;  // written by thread 0 alone; every thread keeps the same numbers
    const bool tails = !kept.empty();
    const bool ask_ahead = static_cast<int>(e.state_.size()) > e.options_.cached_grains;
#pragma omp parallel num_threads(count)
    {
        double my_travel = e.travel_;
        long my_late = 0;
        Busy my_busy;
        long my_done = 0, look = 1;
        const int me = omp_get_thread_num(), all = omp_get_num_threads();
        const auto kept_of = [&](const Share& share, const Block& block) {
            return kept.data() + share.kept + (block.first_tile - blocks[share.tail].first_tile);
        };
        for (long step = 0; step < steps; ++step) {
            const Step parts = run.step(step);
            // what a stage costs is looked at in every eighth step, by the first thread; how long a share
            // takes by its own. Not in the first: there the new lists come from another core's cache.
            const bool watched = step % 8 == 4, clocked = me == 0 && watched;
            double clock = clocked ? omp_get_wtime() : 0;
            double since = 0;
            const auto watch = [&](double* seconds) {
                const double now = watched && count == all ? omp_get_wtime() : 0;
                if (seconds) *seconds += now - since;
                since = now;
            };
            watch(nullptr);
            const auto lap = [&](double& seconds) {
                if (!clocked) return;
                const double now = omp_get_wtime();
                seconds += now - clock;
                clock = now;
            };
            if (tails) {
                for (int s = me; s < count; s += all) {
                    const Share& share = shares[s];
                    if (s + 1 < count) fetch_met(first_grain(share.end), share.reach, sums_of(s + 1), true);
                    for (std::int32_t b = share.tail; b < share.end; ++b) {
                        Handed* const to = kept_of(share, blocks[b]);
                        pair_pass<kAdhesive, kRolling>(blocks[b], {}, to, nullptr);
                        if (s + 1 < count)
                            hand_over_kept(blocks[b], to, sums_of(s + 1), first_grain(share.end), true);
                    }
                }
                watch(&my_busy.tail);
#pragma omp barrier
                lap(run.law_seconds);
                watch(nullptr);
            }
            for (int s = me; s < count; s += all) {
                const Share& share = shares[s];
                const Sums mine = sums_of(s);
                double top = 0;
                if (s > 0) fetch_met(first_grain(share.first), shares[s - 1].reach, mine, false);
                Ahead ahead;
                ahead.met = ahead.met_end = first_grain(share.first);
                for (std::int32_t b = share.first; b < share.end; ++b) {
                    const Block& block = blocks[b];
                    if (b < share.tail) {
                        if (ask_ahead) aim(ahead, b, share.tail);
                        pair_pass<kAdhesive, kRolling>(block, mine, nullptr, ask_ahead ? &ahead : nullptr);
                    } else {
                        hand_over_kept(block, kept_of(share, block), mine, first_grain(share.end), false);
                    }
                    top = std::max(top, finish_block<kAdhesive, kRolling>(b, mine, parts, run.frame,
                                                                          [&] { lap(run.law_seconds); }));
                    lap(run.grain_seconds);
                }
                tops[s].of[step % 2] = top;
            }
            if (count > 1) {
                watch(&my_busy.sweep);
#pragma omp barrier
            }
            double top = 0;
            for (const Top& one : tops) top = std::max(top, one.of[step % 2]);
            const double step_share = run.share(top);
            my_late += !(my_travel <= 1);
            my_travel += step_share;
            my_done = step + 1;
            if (my_done < look) continue;
            // `not (a <= b)`: a speed that is not a number ends the block too
            if (!(my_travel <= 1)) break;
            look = my_done + steps_between_looks(my_travel, step_share);
        }
        if (count == all) busy[me] = my_busy;
        if (me == 0) {
            travel = my_travel;
            run.late = my_late;
            done = my_done;
        }
    }
    learn_pace(busy);
    book_run(run, done, travel);
    return done;
}

template <class T>
long Engine::KernelOf<T>::steps_between_looks(double travel, double step_share) const {
    constexpr double kAtMost = 16;  // four times four: the fewer, the more often threads wait for the last
    constexpr double kJump = kLongestReach;  // what is struck may use up its reach so much faster
    const double lasts = (1 - travel) / (kJump * step_share);  // no number when both are zero: look at once
    return !beyond_cache() || !(lasts >= 1) ? 1 : static_cast<long>(std::min(lasts, kAtMost));
}

template <class T>
void Engine::KernelOf<T>::book_run(const Run& run, long done, double travel) {
    const double dt = run.dt, seconds = omp_get_wtime() - run.start;
    e.first_kick_ = false;
    e.travel_ = std::isfinite(travel) ? travel : 1e9;
    e.steps_ += done;
    e.late_steps_ += run.late;
    e.steps_since_near_ += done;
    for (int k = 0; k < 3; ++k) e.frame_shift_[k] += run.frame[k] * dt * done;
    e.body_way_ += run.body_top * dt * done;
    e.time_ += dt * done;
    if (e.bodies_move_) e.body_time_ += dt * done;
    e.grain_steps_ += static_cast<double>(done) * static_cast<double>(e.awake_.size());
    const double looked = run.law_seconds + run.grain_seconds;
    e.times_.law += looked > 0 ? seconds * run.law_seconds / looked : seconds;  // too few steps to look
    e.times_.grains += looked > 0 ? seconds * run.grain_seconds / looked : 0;
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
template long Engine::KernelOf<WideFloat>::run(long);

}  // namespace gradwright
