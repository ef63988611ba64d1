// The contact law: one text for pairs and walls, for the double reference and the eight-wide float kernel.
//
// Symbols (physics.md 3): n = unit normal from j to i; delta = overlap; R*, E*, G*, m* = effective radius,
// modulus, shear modulus, mass; a = contact radius; S_n = 2 E* a, S_t = 8 G* a; Gamma = work of adhesion;
// F_po = 3/2 pi R* Gamma.
//
// Normal, no adhesion (Hertz 1882):   a = sqrt(R* delta),  F = 4/3 E* a delta.
// Normal, JKR (Johnson, Kendall, Roberts 1971; paper eq. 3-5) in reduced units. With
//   a_s = (2 pi Gamma R*^2 / E*)^(1/3),  delta_s = a_s^2/R*,  F_s = 4/3 E* a_s^3/R* = 8/3 pi Gamma R* = 16/9
//   F_po,  a = a_s s^2: delta/delta_s = s^4 - s (larger root),  F/F_s = s^3 (s^3 - 3/2). Tear-off at s_c =
//   4^(-1/3), delta = -(3/4) 4^(-1/3) delta_s, F = -5/9 F_po; made at delta = 0 (s = 1, F = -8/9 F_po). With
//   s = s_c + u the quartic is u^2 (u^2 + 4 s_c u + 6 s_c^2) = delta/delta_s - delta_c/delta_s =: eps
//   exactly, which has no cancellation at the tear-off double root; Newton from u = (sqrt(b^2 + 4 w) - b)/2,
//   w = sqrt(eps), b = sqrt(6) s_c (at most 3.3 % off over all eps) reaches 1e-6 in two steps, 1e-13 in four.
// Damping (Tsuji et al. 1992, Antypov & Elliott 2011): F_d = -2 sqrt(5/6) beta sqrt(S_n m*) v_n, tensile
// damping allowed. Tangential (Mindlin, no slip): F_t = -S_t xi - 2 sqrt(5/6) beta sqrt(S_t m*) v_t, capped
// at mu F_cap, then xi = -F_t/S_t.
//   xi is turned into the current contact plane at constant length. The stored history is xi + v_t dt/2: the
//   trapezoidal rule for d xi/dt = v_t with velocities predicted at whole steps. (Rejected: xi += v_t dt with
//   the predicted velocity, first order, adds a damping of omega dt/4 per radian; with the half-step
//   velocity, a second record per grain to gather.)
// Rolling (w without its part along n: no twisting resistance):
//   constant_torque M = -mu_r R* F_cap w/|w|, w = relative spin, linear below a stated speed;
//   edem: tau_i = -mu_r |F_n| r_i w_i/|w_i|, each grain by its own spin and its own arm, linear below the
//   same speed (EDEM's standard rolling friction; twice the former between equal grains that roll on each
//   other); spring: elastic-plastic spring-dashpot, Ai et al. 2011 type C: k_r = 2.25 S_n (mu_r R*)^2, cap
//   mu_r R* F_cap, dashpot eta_r 2 sqrt(I_r k_r), eta_r = 0.3, only below the cap.
#pragma once
#include "dem/lanes.h"
#include "dem/material.h"

namespace gradwright {

/// Overlap over the smaller radius beyond which a contact is too deep for the law [-] (physics.md 4: warn).
inline constexpr double kOverlapRule = 0.03;
/// Share of contacts that may be [-], as of grains that may be crushed (process.cpp): a grain wedged between
/// floor and wall, two contacts of a few thousand, says nothing of the bed.
inline constexpr double kDeepContacts = 1e-3;

/// Numbers equal for all contacts of a run.
struct LawConstants {
    double time_step = 0;         ///< [s]
    double static_friction = 0;   ///< mu
    double rolling_friction = 0;  ///< mu_r
    double damping_factor = 0;    ///< 2 sqrt(5/6) beta
    double rolling_speed = 1e-4;  ///< regularisation of constant_torque and edem [m/s]
    FrictionCap friction_cap = FrictionCap::thornton;
};

/// Deliberate faults for `verify --mutate`: the ladder must turn red.
struct LawFault {
    bool no_damping = false, no_history = false, half_pull_off = false, wrong_lever_arm = false;
    bool no_tangential_damping = false;  ///< no fault of its own: the reference impacts of rung V3 have none
    bool late_velocity = false;  ///< the law sees half-step velocities: small grains stick to large ones
    bool free_dashpot = false;   ///< tangential dashpots without kDashpotShare: the step's edge falls by half
};

/// How sliding is counted. `lammps` exists to be compared with LAMMPS (pair_style granular, mindlin) and is
/// compiled only where that is asked for: the sliding speed is taken at r instead of r - delta/2, xi grows by
/// v_t dt with the velocity as it is given, and a spring that has slipped keeps the dashpot's part too, xi =
/// -(F_t + damping v_t)/S_t.
enum class SlidingConvention { own, lammps };

/// What the law needs of one contact (or eight).
template <class T>
struct Contact {
    T nx, ny, nz;                     ///< normal from j to i
    T overlap;                        ///< delta [m]
    T vx, vy, vz;                     ///< v_i - v_j, centres, predicted for this instant [m/s]
    T wix, wiy, wiz;                  ///< spin of i [rad/s]
    T wjx, wjy, wjz;                  ///< spin of j
    T arm_i, arm_j;                   ///< centre to contact point [m]
    T reach_i, reach_j;               ///< arms of the sliding speed; only read by SlidingConvention::lammps
    T radius, mass, e_star, g_star8;  ///< R*, m*, E*, 8 G*
    T jkr_radius;                     ///< a_s [m]; 0 without adhesion
    T touching;                       ///< 1 where the contact exists already, else 0
};

template <class T>
struct ContactHistory {
    T xi_x, xi_y, xi_z;        ///< xi + v_t dt/2 [m]
    T roll_x, roll_y, roll_z;  ///< rolling angle of `spring` [rad]
};

template <class T>
struct ContactResponse {
    T fx, fy, fz;     ///< force on i [N]; j gets the opposite
    T tix, tiy, tiz;  ///< torque on i [N m]
    T tjx, tjy, tjz;  ///< torque on j
    T touching;       ///< 1 where the contact lives on
};

inline constexpr double kDashpotShare = 0.25;  // of the stable rate 1/dt, for one tangential dashpot
inline constexpr double kJkrTearOffRoot = 0.62996052494743658;      // s_c = 4^(-1/3)
inline constexpr double kJkrTearOffOverlap = -0.47247039371057744;  // delta_c/delta_s = -(3/4) 4^(-1/3)

/// s = sqrt(a/a_s) of the JKR curve at delta/delta_s, larger root; clamped at tear-off.
template <class T>
inline T jkr_root(T reduced_overlap) {
    const T c1 = splat<T>(4 * kJkrTearOffRoot);
    const T c2 = splat<T>(6 * kJkrTearOffRoot * kJkrTearOffRoot);
    const T eps = larger(reduced_overlap - splat<T>(kJkrTearOffOverlap), splat<T>(1e-12));
    const T w = eps * rough_inverse_root(eps);
    const T b = splat<T>(1.5430806348152437);  // sqrt(6) s_c
    const T radicand = b * b + splat<T>(4) * w;
    // (sqrt(b^2 + 4 w) - b)/2 without its cancellation; a few parts in 1e5 off, which the steps below mend
    T u = splat<T>(2) * w * rough_inverse(radicand * rough_inverse_root(radicand) + b);
    constexpr int kNewtonSteps = Lane<T>::kWidth == 1 ? 4 : 2;
    for (int step = 0; step < kNewtonSteps; ++step) {
        const T value = u * u * (u * (u + c1) + c2) - eps;
        const T slope = u * (u * (splat<T>(4) * u + splat<T>(3) * c1) + splat<T>(2) * c2);
        u = u - value * rough_inverse(slope);
    }
    return splat<T>(kJkrTearOffRoot) + u;
}

template <class T, bool kAdhesive, RollingModel kRolling, SlidingConvention kSliding = SlidingConvention::own>
// Inlined by force: a call would send some thirty vectors through memory, a third of what the law costs.
[[gnu::always_inline]] inline ContactResponse<T> contact_law(const LawConstants& law, const LawFault& fault,
                                                             const Contact<T>& c, ContactHistory<T>& h) {
    const T zero = splat<T>(0), one = splat<T>(1);
    const T tiny = splat<T>(1e-30);
    const T dt = splat<T>(law.time_step);

    // Normal.
    T a, elastic, pull_off2, alive;  // pull_off2 = 2 F_po
    if constexpr (kAdhesive) {
        const T delta_s = c.jkr_radius * c.jkr_radius / c.radius;
        const T reduced = c.overlap / delta_s;
        // made at delta >= 0, lives down to the tear-off overlap
        const T bonded = choose(reduced > splat<T>(kJkrTearOffOverlap), c.touching, zero);
        alive = choose(c.overlap >= zero, one, bonded);
        const T s = jkr_root<T>(reduced);
        const T s3 = s * s * s;
        a = c.jkr_radius * s * s;
        const T force_scale = splat<T>(4.0 / 3.0) * c.e_star * c.jkr_radius * delta_s;
        elastic = force_scale * s3 * (s3 - splat<T>(fault.half_pull_off ? 0.75 : 1.5));
        pull_off2 = splat<T>(9.0 / 8.0) * force_scale;
    } else {
        const T delta = larger(c.overlap, zero);
        alive = choose(c.overlap > zero, one, zero);
        a = root(c.radius * delta);
        elastic = splat<T>(4.0 / 3.0) * c.e_star * a * delta;
        pull_off2 = zero;
    }
    const T damping = splat<T>(fault.no_damping ? 0.0 : law.damping_factor);
    const T vn = c.vx * c.nx + c.vy * c.ny + c.vz * c.nz;
    const T stiffness_n = splat<T>(2) * c.e_star * a;
    const T fn = elastic - damping * root(stiffness_n * c.mass) * vn;

    T cap;
    if (law.friction_cap == FrictionCap::thornton) {
        cap = kAdhesive ? elastic + pull_off2 : larger(fn, zero);
    } else if (law.friction_cap == FrictionCap::edem_repulsive) {
        cap = splat<T>(4.0 / 3.0) * c.e_star * a * a * a / c.radius;
    } else {
        cap = magnitude(fn);
    }
    cap = larger(cap, zero);

    // Tangential: velocity of i relative to j at the contact point.
    const T arm_i = fault.wrong_lever_arm ? splat<T>(0.9) * c.arm_i : c.arm_i;
    T reach_i = arm_i, reach_j = c.arm_j;
    if constexpr (kSliding == SlidingConvention::lammps) reach_i = c.reach_i, reach_j = c.reach_j;
    const T sx = reach_i * c.wix + reach_j * c.wjx, sy = reach_i * c.wiy + reach_j * c.wjy,
            sz = reach_i * c.wiz + reach_j * c.wjz;
    const T vtx = c.vx - vn * c.nx - (sy * c.nz - sz * c.ny);
    const T vty = c.vy - vn * c.ny - (sz * c.nx - sx * c.nz);
    const T vtz = c.vz - vn * c.nz - (sx * c.ny - sy * c.nx);

    const T keep = choose(c.touching > zero, splat<T>(fault.no_history ? 0.0 : 1.0), zero);
    T xx = h.xi_x * keep, xy = h.xi_y * keep, xz = h.xi_z * keep;
    const T xn = xx * c.nx + xy * c.ny + xz * c.nz;
    const T length2 = xx * xx + xy * xy + xz * xz;
    xx -= xn * c.nx;
    xy -= xn * c.ny;
    xz -= xn * c.nz;
    const T flat2 = xx * xx + xy * xy + xz * xz;
    const T turn = root(length2 / larger(flat2, tiny));
    const T half = splat<T>(0.5) * dt;
    // of one step's way, the part before this instant and the part after it
    const bool late = fault.late_velocity || kSliding == SlidingConvention::lammps;
    const T before = late ? dt : half, after = late ? zero : half;
    const T turned = choose(flat2 > tiny, turn, zero);
    xx = xx * turned + before * vtx;
    xy = xy * turned + before * vty;
    xz = xz * turned + before * vtz;

    const T stiffness_t = c.g_star8 * a;
    T damping_t = splat<T>(fault.no_tangential_damping ? 0.0 : 1.0) * damping * root(stiffness_t * c.mass);
    if constexpr (kSliding == SlidingConvention::own) {
        // A contact's dashpot slows its slip, of mass 2/7 m*, at the rate 7/2 c/m*; a grain in a packing sums
        // six to eight. With predicted velocities a rate is stable to 1/dt (two-step Adams-Bashforth), so
        // each contact may take kDashpotShare of that. No effect below an overlap of 0.8 % r at e = 0.5 and
        // 0.2 T_R, none at all as dt -> 0; without it the edge of the time step in a dense heap at 3 % is
        // 0.20 T_R with the rolling spring and 0.28 with constant torque, with it 0.44 and 0.49
        // (docs/hard-cases.md).
        const double share = fault.free_dashpot ? 1e9 : kDashpotShare;
        damping_t = smaller(damping_t, splat<T>(share / 3.5 / law.time_step) * c.mass);
    }
    T ftx = -stiffness_t * xx - damping_t * vtx;
    T fty = -stiffness_t * xy - damping_t * vty;
    T ftz = -stiffness_t * xz - damping_t * vtz;
    const T ft = root(ftx * ftx + fty * fty + ftz * ftz);
    const T limit = splat<T>(law.static_friction) * cap;
    const auto slips = ft > limit;
    const T scale = choose(slips, limit / larger(ft, tiny), one);
    ftx *= scale;
    fty *= scale;
    ftz *= scale;
    const T compliance = -one / larger(stiffness_t, tiny);
    T held_x = ftx, held_y = fty, held_z = ftz;  // what the spring of a slipping contact goes on holding
    if constexpr (kSliding == SlidingConvention::lammps) {
        held_x += damping_t * vtx;
        held_y += damping_t * vty;
        held_z += damping_t * vtz;
    }
    h.xi_x = choose(slips, held_x * compliance, xx) + after * vtx;
    h.xi_y = choose(slips, held_y * compliance, xy) + after * vty;
    h.xi_z = choose(slips, held_z * compliance, xz) + after * vtz;

    ContactResponse<T> out;
    out.fx = alive * (fn * c.nx + ftx);
    out.fy = alive * (fn * c.ny + fty);
    out.fz = alive * (fn * c.nz + ftz);
    const T qx = c.ny * ftz - c.nz * fty, qy = c.nz * ftx - c.nx * ftz,
            qz = c.nx * fty - c.ny * ftx;  // n x F_t
    out.tix = -arm_i * qx;
    out.tiy = -arm_i * qy;
    out.tiz = -arm_i * qz;
    out.tjx = -c.arm_j * qx;
    out.tjy = -c.arm_j * qy;
    out.tjz = -c.arm_j * qz;

    if constexpr (kRolling == RollingModel::edem) {
        const T pressed = splat<T>(law.rolling_friction) * magnitude(fn);
        auto resist = [&](T wx, T wy, T wz, T arm, T& tx, T& ty, T& tz) {
            const T wn = wx * c.nx + wy * c.ny + wz * c.nz;
            wx -= wn * c.nx;
            wy -= wn * c.ny;
            wz -= wn * c.nz;
            const T largest = pressed * arm;
            const T spin = root(wx * wx + wy * wy + wz * wz);
            const T slow = splat<T>(law.rolling_speed) / arm;
            // one step must not reverse the spin: 2/5 m* arm^2 is at most the grain's own inertia
            const T stable = splat<T>(2) * dt * largest / (splat<T>(0.4) * c.mass * arm * arm);
            const T factor = -largest / larger(larger(spin, slow), stable);
            tx += factor * wx;
            ty += factor * wy;
            tz += factor * wz;
        };
        resist(c.wix, c.wiy, c.wiz, c.arm_i, out.tix, out.tiy, out.tiz);
        resist(c.wjx, c.wjy, c.wjz, c.arm_j, out.tjx, out.tjy, out.tjz);
    } else if constexpr (kRolling != RollingModel::none) {
        T wx = c.wix - c.wjx, wy = c.wiy - c.wjy, wz = c.wiz - c.wjz;
        const T wn = wx * c.nx + wy * c.ny + wz * c.nz;
        wx -= wn * c.nx;
        wy -= wn * c.ny;
        wz -= wn * c.nz;
        const T largest = splat<T>(law.rolling_friction) * c.radius * cap;
        T mx, my, mz;
        if constexpr (kRolling == RollingModel::constant_torque) {
            const T spin = root(wx * wx + wy * wy + wz * wz);
            // Linear below the regularisation speed, and never so steep that one step could reverse the spin.
            const T slow = splat<T>(law.rolling_speed) / c.radius;
            // 2/5 m* R*^2 is the grain's own inertia at a wall and an eighth of it between equal grains.
            const T stable = splat<T>(2) * dt * largest / (splat<T>(0.4) * c.mass * c.radius * c.radius);
            const T factor = -largest / larger(larger(spin, slow), stable);
            mx = factor * wx;
            my = factor * wy;
            mz = factor * wz;
        } else {
            const T stiffness_r = splat<T>(2.25) * stiffness_n *
                                  splat<T>(law.rolling_friction * law.rolling_friction) * c.radius * c.radius;
            // about the contact point: 7/5 m r^2 at a wall (arm_j = arm_i there), half of it between equal
            // grains. The smaller arm: the product of both would grow without limit on a large fixed grain,
            // and the dashpot would take off.
            const T arm = smaller(c.arm_i, c.arm_j);
            const T inertia = splat<T>(1.4) * c.mass * arm * arm;
            T rx = h.roll_x * keep, ry = h.roll_y * keep, rz = h.roll_z * keep;
            const T rn = rx * c.nx + ry * c.ny + rz * c.nz;
            rx += half * wx - rn * c.nx;
            ry += half * wy - rn * c.ny;
            rz += half * wz - rn * c.nz;
            T sxr = -stiffness_r * rx, syr = -stiffness_r * ry, szr = -stiffness_r * rz;
            const T spring = root(sxr * sxr + syr * syr + szr * szr);
            const auto yields = spring > largest;
            const T part = choose(yields, largest / larger(spring, tiny), one);
            sxr *= part;
            syr *= part;
            szr *= part;
            const T dash =
                choose(yields, zero, splat<T>(0.6) * root(inertia * stiffness_r));  // 2 eta_r, eta_r = 0.3
            mx = sxr - dash * wx;
            my = syr - dash * wy;
            mz = szr - dash * wz;
            const T soft = -one / larger(stiffness_r, tiny);
            h.roll_x = choose(yields, sxr * soft, rx) + half * wx;
            h.roll_y = choose(yields, syr * soft, ry) + half * wy;
            h.roll_z = choose(yields, szr * soft, rz) + half * wz;
        }
        out.tix += mx;
        out.tiy += my;
        out.tiz += mz;
        out.tjx -= mx;
        out.tjy -= my;
        out.tjz -= mz;
    }
    out.tix *= alive;
    out.tiy *= alive;
    out.tiz *= alive;
    out.tjx *= alive;
    out.tjy *= alive;
    out.tjz *= alive;
    out.touching = alive;
    return out;
}

}  // namespace gradwright
