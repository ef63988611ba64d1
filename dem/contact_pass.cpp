// The contact pass: gather two grains per lane, run the law, add force and torques to the sums of both
// grains, one slot after the other. Rejected, on a bed of 25 000 grains and one core unless said otherwise:
// - prefetching the second grains of the tile four ahead: 11.2 against 11.4 million grain-steps/s;
// - prefetching what a block and the next one touch first: 10.6 against 11.6 (medians of six);
// - estimated reciprocal roots with one Newton step instead of every square root and division: the law alone
//   8.0 against 9.3 ns a contact, but the pass hardly. In the root of JKR alone, whose own steps mend the
//   error, they pay (jkr_root in contact_law.h): 48 against 45 million grain-steps/s;
// - place and motion in one record of 64 bytes, arrays' addresses read once before the loop: nothing.
#include <algorithm>
#include <cmath>

#include "dem/kernel.h"
#include "dem/lane_rows.h"

namespace gradwright {

// Inlined by order: GCC takes a function that only fetches for one without effect, and drops the call.
template <class T>
[[gnu::always_inline]] inline void Engine::KernelOf<T>::fetch_tile(std::int32_t tile,
                                                                   bool second_half) const {
    constexpr std::int32_t kTilesAhead = 8;  // 4 and 16: the same
    constexpr std::size_t kLine = 64, kHalf = sizeof(PairTile) / 2 / kLine * kLine;
    const char* const pairs = reinterpret_cast<const char*>(tiles.data() + tile + kTilesAhead);
    for (std::size_t byte = second_half ? kHalf : 0; byte < (second_half ? sizeof(PairTile) : kHalf);
         byte += kLine)
        __builtin_prefetch(pairs + byte, 1);
    if (!second_half || !has_rolls) return;
    const char* const springs = reinterpret_cast<const char*>(rolls.data() + tile + kTilesAhead);
    for (std::size_t byte = 0; byte < sizeof(RollTile); byte += kLine) __builtin_prefetch(springs + byte, 1);
}

template <class T>
[[gnu::always_inline]] inline void Engine::KernelOf<T>::fetch_grains(Ahead& ahead) const {
    for (const std::int32_t end = std::min(ahead.met_end, ahead.met + ahead.met_each); ahead.met < end;
         ahead.met += 2) {  // two grains a cache line
        __builtin_prefetch(&e.state_.place[ahead.met], 1);
        __builtin_prefetch(&motion[ahead.met], 1);
    }
    for (const std::int32_t end = std::min(ahead.own_end, ahead.own + ahead.own_each); ahead.own < end;
         ++ahead.own)
        __builtin_prefetch(&e.state_.moving[ahead.own], 1);
}

template <class T>
template <bool kAdhesive, RollingModel kRolling>
void Engine::KernelOf<T>::pair_pass(const Block& block, const Sums& to, Handed* kept, Ahead* ahead) {
    const double period = e.options_.period_y, inv_period = period > 0 ? 1 / period : 0;
    const double period_x = e.options_.period_x, inv_period_x = period_x > 0 ? 1 / period_x : 0;
    const double period_z = e.options_.period_z, inv_period_z = period_z > 0 ? 1 / period_z : 0;
    const LawConstants law = e.law_;
    const LawFault fault = e.options_.fault;
    const Place* const place = e.state_.place.data();
    [[maybe_unused]] constexpr std::uint32_t kAllLanes = (std::uint32_t{1} << W) - 1;
    for (std::int32_t k = block.first_tile; k < block.end_tile; ++k) {
        PairTile& t = tiles[k];
        Contact<T> c;
        T dx, dy, dz, distance;
        if constexpr (W == 1) {
            const Place &pi = place[t.i[0]], &pj = place[t.j[0]];
            const Motion &mi = motion[t.i[0]], &mj = motion[t.j[0]];
            dx = pi.x - pj.x;
            dy = pi.y - pj.y;
            dz = pi.z - pj.z;
            dx -= period_x * std::nearbyint(dx * inv_period_x);
            dy -= period * std::nearbyint(dy * inv_period);
            dz -= period_z * std::nearbyint(dz * inv_period_z);
            const double sum = pi.radius + pj.radius;
            const double d2 = dx * dx + dy * dy + dz * dz;
            distance = std::sqrt(d2);
            c.overlap = (sum * sum - d2) / (sum + distance);
            if (c.overlap < 0 && !(t.touching[0] > 0)) {
                if (kept) kept[k - block.first_tile].idle = true;
                continue;
            }
            c.vx = mi.vx - mj.vx;
            c.vy = mi.vy - mj.vy;
            c.vz = mi.vz - mj.vz;
            c.wix = mi.wx, c.wiy = mi.wy, c.wiz = mi.wz;
            c.wjx = mj.wx, c.wjy = mj.wy, c.wjz = mj.wz;
            c.arm_i = mi.r - 0.5 * c.overlap;
            c.arm_j = mj.r - 0.5 * c.overlap;
        } else {
            // positions in double: difference of coordinates and sum of radii in one fused operation per
            // lane; the overlap from (s^2 - d^2)/(s + d) with the numerator in double, so that float enters
            // only where its 6e-8 is relative to the overlap
            using Half = typename Lane<T>::Half;
            Half d[2][4], square[2];
            if (ahead) fetch_tile(k, false);
            for (int half = 0; half < 2; ++half) {
                for (int four = 0; four < W / 2; four += static_cast<int>(sizeof(Half) / sizeof(double)))
                    gather4(d[half], half * W / 2 + four, [&](int lane) {
                        const D4 turn = {-1, -1, -1, 1};
                        return *reinterpret_cast<const D4*>(&place[t.i[lane]]) +
                               turn * *reinterpret_cast<const D4*>(&place[t.j[lane]]);
                    });
                if (inv_period != 0) {
                    d[half][1] -= period * nearest_whole(d[half][1] * inv_period);
                    if (inv_period_x != 0 || inv_period_z != 0) {
                        d[half][0] -= period_x * nearest_whole(d[half][0] * inv_period_x);
                        d[half][2] -= period_z * nearest_whole(d[half][2] * inv_period_z);
                    }
                }
                square[half] = d[half][0] * d[half][0] + d[half][1] * d[half][1] + d[half][2] * d[half][2];
            }
            if (ahead) fetch_tile(k, true);
            if (ahead) fetch_grains(*ahead);
            const T numerator = join(d[0][3] * d[0][3] - square[0], d[1][3] * d[1][3] - square[1]);
            const T sum = join(d[0][3], d[1][3]);
            dx = join(d[0][0], d[1][0]);
            dy = join(d[0][1], d[1][1]);
            dz = join(d[0][2], d[1][2]);
            distance = root(join(square[0], square[1]));
            c.overlap = numerator / (sum + distance);
            // Nothing touches and nothing did: the law would find no force and leave nothing. The history of
            // what does not touch is never read.
            const T zero{};
            if (bits_where_less(c.overlap, zero) == kAllLanes &&
                bits_where_less(zero, load<T>(t.touching)) == 0) {
                if (kept) kept[k - block.first_tile].idle = true;
                continue;
            }
            T mi[8], mj[8];
            gather8(mi, [&](int lane) { return *reinterpret_cast<const F8*>(&motion[t.i[lane]]); });
            gather8(mj, [&](int lane) { return *reinterpret_cast<const F8*>(&motion[t.j[lane]]); });
            c.vx = mi[0] - mj[0];
            c.vy = mi[1] - mj[1];
            c.vz = mi[2] - mj[2];
            c.wix = mi[4], c.wiy = mi[5], c.wiz = mi[6];
            c.wjx = mj[4], c.wjy = mj[5], c.wjz = mj[6];
            c.arm_i = mi[3] - 0.5f * c.overlap;
            c.arm_j = mj[3] - 0.5f * c.overlap;
        }
        const T inverse = splat<T>(1) / distance;
        c.nx = dx * inverse;
        c.ny = dy * inverse;
        c.nz = dz * inverse;
        c.radius = load<T>(t.radius);
        c.mass = load<T>(t.mass);
        c.e_star = load<T>(t.e_star);
        c.g_star8 = load<T>(t.g_star8);
        c.jkr_radius = load<T>(t.jkr_radius);
        c.touching = load<T>(t.touching);
        ContactHistory<T> h{load<T>(t.xi[0]), load<T>(t.xi[1]), load<T>(t.xi[2]), T{}, T{}, T{}};
        if constexpr (kRolling == RollingModel::spring) {
            h.roll_x = load<T>(rolls[k].angle[0]);
            h.roll_y = load<T>(rolls[k].angle[1]);
            h.roll_z = load<T>(rolls[k].angle[2]);
        }
        const ContactResponse<T> out = contact_law<T, kAdhesive, kRolling>(law, fault, c, h);
        store<T>(t.xi[0], h.xi_x);
        store<T>(t.xi[1], h.xi_y);
        store<T>(t.xi[2], h.xi_z);
        if constexpr (kRolling == RollingModel::spring) {
            store<T>(rolls[k].angle[0], h.roll_x);
            store<T>(rolls[k].angle[1], h.roll_y);
            store<T>(rolls[k].angle[2], h.roll_z);
        }
        store<T>(t.touching, out.touching);
        Handed now;
        Handed& handed = kept ? kept[k - block.first_tile] : now;
        handed.idle = false;
        T first[8] = {out.fx, out.fy, out.fz, T{}, out.tix, out.tiy, out.tiz, T{}};
        T second[8] = {-out.fx, -out.fy, -out.fz, T{}, out.tjx, out.tjy, out.tjz, T{}};
        if constexpr (W == 1) {
            for (int q = 0; q < 8; ++q) {
                handed.to_first[0].value[q] = first[q];
                handed.to_second[0].value[q] = second[q];
            }
        } else {
            write_rows(first, reinterpret_cast<F8*>(handed.to_first));
            write_rows(second, reinterpret_cast<F8*>(handed.to_second));
        }
        if (!kept) hand_over(t, handed, std::min<std::int32_t>(W, block.own_end - k * W), to);
    }
}

template <class T>
template <bool kAdhesive, RollingModel kRolling>
void Engine::KernelOf<T>::wall_pass(const Block& block, const Sums& to, double body_time) {
    const LawConstants law = e.law_;
    const LawFault fault = e.options_.fault;
    for (std::int32_t k = block.first_wall; k < block.end_wall; ++k) {
        WallTile& t = walls[k];
        alignas(64) S n[3][W], overlap[W], v[3][W], w[3][W], arm[W], friction[W];
        for (int lane = 0; lane < W; ++lane) {
            n[0][lane] = n[1][lane] = 0;
            n[2][lane] = 1;
            overlap[lane] = S(-1);
            for (int x = 0; x < 3; ++x) v[x][lane] = w[x][lane] = 0;
            arm[lane] = 1;
            friction[lane] = 1;
            if (t.i[lane] < 0) continue;
            const Body& body = e.bodies_[t.body[lane]];
            const Place& p = e.state_.place[t.i[lane]];
            const Motion& m = motion[t.i[lane]];
            const auto near =
                nearest_point(body, body.speed_x * body_time, body.speed_z * body_time, p.x, p.y, p.z);
            n[0][lane] = S(near.nx);
            n[1][lane] = S(near.ny);
            n[2][lane] = S(near.nz);
            overlap[lane] = S(p.radius - near.distance);
            if (body.yield_ratio > 0) overlap[lane] = std::min(overlap[lane], S(body.yield_ratio * p.radius));
            const bool moving = e.bodies_move_;
            v[0][lane] = m.vx - S(moving ? body.speed_x : 0);
            v[1][lane] = m.vy;
            v[2][lane] = m.vz - S(moving ? body.speed_z : 0);
            w[0][lane] = m.wx;
            w[1][lane] = m.wy;
            w[2][lane] = m.wz;
            arm[lane] = m.r - overlap[lane];
            if (body.frictionless) friction[lane] = 0;
        }
        Contact<T> c;
        c.nx = load<T>(n[0]);
        c.ny = load<T>(n[1]);
        c.nz = load<T>(n[2]);
        c.overlap = load<T>(overlap);
        c.vx = load<T>(v[0]);
        c.vy = load<T>(v[1]);
        c.vz = load<T>(v[2]);
        c.wix = load<T>(w[0]);
        c.wiy = load<T>(w[1]);
        c.wiz = load<T>(w[2]);
        c.wjx = c.wjy = c.wjz = splat<T>(0);
        c.arm_i = c.arm_j = load<T>(arm);
        c.radius = load<T>(t.radius);
        c.mass = load<T>(t.mass);
        c.e_star = load<T>(t.e_star);
        c.g_star8 = load<T>(t.g_star8);
        c.jkr_radius = load<T>(t.jkr_radius);
        c.touching = load<T>(t.touching);
        ContactHistory<T> h{load<T>(t.xi[0]),   load<T>(t.xi[1]),   load<T>(t.xi[2]),
                            load<T>(t.roll[0]), load<T>(t.roll[1]), load<T>(t.roll[2])};
        ContactResponse<T> out = contact_law<T, kAdhesive, kRolling>(law, fault, c, h);
        // a frictionless body keeps only the normal part
        const T rough = load<T>(friction);
        const T fn = out.fx * c.nx + out.fy * c.ny + out.fz * c.nz;
        out.fx = rough * out.fx + (splat<T>(1) - rough) * fn * c.nx;
        out.fy = rough * out.fy + (splat<T>(1) - rough) * fn * c.ny;
        out.fz = rough * out.fz + (splat<T>(1) - rough) * fn * c.nz;
        store<T>(t.xi[0], h.xi_x);
        store<T>(t.xi[1], h.xi_y);
        store<T>(t.xi[2], h.xi_z);
        store<T>(t.roll[0], h.roll_x);
        store<T>(t.roll[1], h.roll_y);
        store<T>(t.roll[2], h.roll_z);
        store<T>(t.touching, out.touching);
        store<T>(t.out[0], out.fx);
        store<T>(t.out[1], out.fy);
        store<T>(t.out[2], out.fz);
        store<T>(t.out[3], rough * out.tix);
        store<T>(t.out[4], rough * out.tiy);
        store<T>(t.out[5], rough * out.tiz);
        const int lanes = std::min<std::int32_t>(W, block.wall_end - k * W);
        for (int lane = 0; lane < lanes; ++lane) {
            S* const sum = to[t.i[lane]].value;
            for (int c = 0; c < 3; ++c) sum[c] += t.out[c][lane], sum[4 + c] += t.out[3 + c][lane];
        }
    }
}

#define GRADWRIGHT_PASSES(T, ADHESIVE, ROLLING)                                                         \
    template void Engine::KernelOf<T>::pair_pass<ADHESIVE, ROLLING>(const Block&, const Sums&, Handed*, \
                                                                    Ahead*);                            \
    template void Engine::KernelOf<T>::wall_pass<ADHESIVE, ROLLING>(const Block&, const Sums&, double);
#define GRADWRIGHT_ALL_PASSES(T)                               \
    GRADWRIGHT_PASSES(T, true, RollingModel::none)             \
    GRADWRIGHT_PASSES(T, false, RollingModel::none)            \
    GRADWRIGHT_PASSES(T, true, RollingModel::constant_torque)  \
    GRADWRIGHT_PASSES(T, false, RollingModel::constant_torque) \
    GRADWRIGHT_PASSES(T, true, RollingModel::spring)           \
    GRADWRIGHT_PASSES(T, false, RollingModel::spring)          \
    GRADWRIGHT_PASSES(T, true, RollingModel::edem)             \
    GRADWRIGHT_PASSES(T, false, RollingModel::edem)
GRADWRIGHT_ALL_PASSES(double)
GRADWRIGHT_ALL_PASSES(WideFloat)

}  // namespace gradwright
