// The contact pass: gather two grains per lane, run the law, leave force and torques in records. No grain is
// written here. Rejected, on a bed of 29 000 grains and one core unless said otherwise:
// - prefetching the second grains of the tile four ahead: 11.2 against 11.4 million grain-steps/s;
// - prefetching what a block and the next one touch first: 10.6 against 11.6 (medians of six);
// - estimated reciprocal roots with one Newton step and one Halley step for JKR instead of square roots and
//   divisions: the law alone 8.0 against 9.3 ns a contact, but the pass hardly (in the cache 38.4
//   against 39.1 ns a grain-step): gathers and transposes fill the time that dividers spend.
#include <algorithm>
#include <cmath>

#include "dem/kernel.h"

namespace gradwright {
namespace {

/// Rows in, columns out.
inline void transpose4(D4& a, D4& b, D4& c, D4& d) {
    const D4 ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const D4 cd0 = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    c = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

inline void transpose8(F8 r[8]) {
    F8 t[8];
    for (int k = 0; k < 4; ++k) {
        t[2 * k] = __builtin_shufflevector(r[2 * k], r[2 * k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        t[2 * k + 1] = __builtin_shufflevector(r[2 * k], r[2 * k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    F8 u[8];
    for (int k = 0; k < 2; ++k) {
        u[4 * k] = __builtin_shufflevector(t[4 * k], t[4 * k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        u[4 * k + 1] = __builtin_shufflevector(t[4 * k], t[4 * k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        u[4 * k + 2] = __builtin_shufflevector(t[4 * k + 1], t[4 * k + 3], 0, 1, 8, 9, 4, 5, 12, 13);
        u[4 * k + 3] = __builtin_shufflevector(t[4 * k + 1], t[4 * k + 3], 2, 3, 10, 11, 6, 7, 14, 15);
    }
    for (int k = 0; k < 4; ++k) {
        r[k] = __builtin_shufflevector(u[k], u[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        r[k + 4] = __builtin_shufflevector(u[k], u[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

inline F8 join(D4 lo, D4 hi) {
    const F4 a = __builtin_convertvector(lo, F4), b = __builtin_convertvector(hi, F4);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}

inline D4 round4(D4 v) {
#ifdef __AVX__
    return __builtin_ia32_roundpd256(v, 0);
#endif
    for (int k = 0; k < 4; ++k) v[k] = std::nearbyint(v[k]);
    return v;
}

}  // namespace

template <class T>
template <bool kAdhesive, RollingModel kRolling>
void Engine::KernelOf<T>::pair_pass(std::size_t first, std::size_t last, Record* own) {
    const double period = e.options_.period_y, inv_period = period > 0 ? 1 / period : 0;
    const double period_x = e.options_.period_x, inv_period_x = period_x > 0 ? 1 / period_x : 0;
    const double period_z = e.options_.period_z, inv_period_z = period_z > 0 ? 1 / period_z : 0;
    const LawConstants law = e.law_;
    const LawFault fault = e.options_.fault;
    for (std::size_t k = first; k < last; ++k) {
        PairTile& t = tiles[k];
        Contact<T> c;
        T dx, dy, dz, distance;
        if constexpr (W == 1) {
            const Position &pi = position[t.i[0]], &pj = position[t.j[0]];
            const Motion &mi = motion[t.i[0]], &mj = motion[t.j[0]];
            dx = pi.x - pj.x;
            dy = pi.y - pj.y;
            dz = pi.z - pj.z;
            dx -= period_x * std::nearbyint(dx * inv_period_x);
            dy -= period * std::nearbyint(dy * inv_period);
            dz -= period_z * std::nearbyint(dz * inv_period_z);
            const double sum = pi.r + pj.r;
            const double d2 = dx * dx + dy * dy + dz * dz;
            distance = std::sqrt(d2);
            c.overlap = (sum * sum - d2) / (sum + distance);
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
            const D4 turn = {-1, -1, -1, 1};
            D4 d[8];
            F8 mi[8], mj[8];
            for (int lane = 0; lane < 8; ++lane) {
                const std::int32_t i = t.i[lane], j = t.j[lane];
                d[lane] = *reinterpret_cast<const D4*>(&position[i]) +
                          turn * *reinterpret_cast<const D4*>(&position[j]);
                mi[lane] = *reinterpret_cast<const F8*>(&motion[i]);
                mj[lane] = *reinterpret_cast<const F8*>(&motion[j]);
            }
            transpose4(d[0], d[1], d[2], d[3]);
            transpose4(d[4], d[5], d[6], d[7]);
            if (inv_period != 0) {
                d[1] -= period * round4(d[1] * inv_period);
                d[5] -= period * round4(d[5] * inv_period);
                if (inv_period_x != 0 || inv_period_z != 0) {
                    d[0] -= period_x * round4(d[0] * inv_period_x);
                    d[4] -= period_x * round4(d[4] * inv_period_x);
                    d[2] -= period_z * round4(d[2] * inv_period_z);
                    d[6] -= period_z * round4(d[6] * inv_period_z);
                }
            }
            const D4 d2lo = d[0] * d[0] + d[1] * d[1] + d[2] * d[2],
                     d2hi = d[4] * d[4] + d[5] * d[5] + d[6] * d[6];
            const F8 numerator = join(d[3] * d[3] - d2lo, d[7] * d[7] - d2hi);
            const F8 sum = join(d[3], d[7]);
            dx = join(d[0], d[4]);
            dy = join(d[1], d[5]);
            dz = join(d[2], d[6]);
            distance = root(join(d2lo, d2hi));
            c.overlap = numerator / (sum + distance);
            transpose8(mi);
            transpose8(mj);
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
        if constexpr (W == 1) {
            own[k] = {{out.fx, out.fy, out.fz, 0, out.tix, out.tiy, out.tiz, 0}};
            ring[t.in_place[0]] = {{-out.fx, -out.fy, -out.fz, 0, out.tjx, out.tjy, out.tjz, 0}};
        } else {
            F8 mine[8] = {out.fx, out.fy, out.fz, F8{}, out.tix, out.tiy, out.tiz, F8{}};
            F8 other[8] = {-out.fx, -out.fy, -out.fz, F8{}, out.tjx, out.tjy, out.tjz, F8{}};
            transpose8(mine);
            transpose8(other);
            for (int lane = 0; lane < 8; ++lane) {
                *reinterpret_cast<F8*>(&own[k * 8 + lane]) = mine[lane];
                *reinterpret_cast<F8*>(&ring[t.in_place[lane]]) = other[lane];
            }
        }
    }
}

template <class T>
template <bool kAdhesive, RollingModel kRolling>
void Engine::KernelOf<T>::wall_pass(std::size_t first, std::size_t last, double body_time) {
    const LawConstants law = e.law_;
    const LawFault fault = e.options_.fault;
    for (std::size_t k = first; k < last; ++k) {
        WallTile& t = walls[k];
        alignas(32) S n[3][W], overlap[W], v[3][W], w[3][W], arm[W], friction[W];
        for (int lane = 0; lane < W; ++lane) {
            n[0][lane] = n[1][lane] = 0;
            n[2][lane] = 1;
            overlap[lane] = S(-1);
            for (int x = 0; x < 3; ++x) v[x][lane] = w[x][lane] = 0;
            arm[lane] = 1;
            friction[lane] = 1;
            if (t.i[lane] < 0) continue;
            const Body& body = e.bodies_[t.body[lane]];
            const Position& p = position[t.i[lane]];
            const Motion& m = motion[t.i[lane]];
            const auto near =
                nearest_point(body, body.speed_x * body_time, body.speed_z * body_time, p.x, p.y, p.z);
            n[0][lane] = S(near.nx);
            n[1][lane] = S(near.ny);
            n[2][lane] = S(near.nz);
            overlap[lane] = S(p.r - near.distance);
            if (body.yield_ratio > 0) overlap[lane] = std::min(overlap[lane], S(body.yield_ratio * p.r));
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
    }
}

#define GRADWRIGHT_PASSES(T, ADHESIVE, ROLLING)                                                         \
    template void Engine::KernelOf<T>::pair_pass<ADHESIVE, ROLLING>(std::size_t, std::size_t, Record*); \
    template void Engine::KernelOf<T>::wall_pass<ADHESIVE, ROLLING>(std::size_t, std::size_t, double);
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
GRADWRIGHT_ALL_PASSES(F8)

}  // namespace gradwright
