#include "dem/verification/reference_impact.h"

#include <algorithm>

namespace gradwright::verification {
namespace {

/// x is the line of centres, y the tangent; `slip` = v_t + w1 a1 + w2 a2 is the speed of grain 1's surface
/// against the other's.
struct Motion {
    double overlap = 0, closing = 0;  ///< [m], [m/s]
    double tangential = 0, spin_1 = 0, spin_2 = 0;
    double stretch = 0;  ///< xi [m]
};

Motion advanced(const Motion& from, const Motion& rate, double dt) {
    Motion to = from;
    to.overlap += dt * rate.overlap;
    to.closing += dt * rate.closing;
    to.tangential += dt * rate.tangential;
    to.spin_1 += dt * rate.spin_1;
    to.spin_2 += dt * rate.spin_2;
    to.stretch += dt * rate.stretch;
    return to;
}

}  // namespace

ImpactResult integrate_impact(const ImpactSetup& s) {
    const bool wall = s.radius_2 == 0;
    const double m1 = sphere_mass(s.material.density, s.radius_1),
                 m2 = wall ? 0 : sphere_mass(s.material.density, s.radius_2);
    const double r_star = wall ? s.radius_1 : s.radius_1 * s.radius_2 / (s.radius_1 + s.radius_2);
    const double m_star = wall ? m1 : m1 * m2 / (m1 + m2);
    const double inertia_1 = 0.4 * m1 * s.radius_1 * s.radius_1,
                 inertia_2 = 0.4 * m2 * s.radius_2 * s.radius_2;
    const double e_star = effective_modulus(s.material, wall);
    // 1/G* = (2 - nu)/G for each deformable side, G = E/(2(1 + nu))
    const double shear = s.material.youngs_modulus / (2 * (1 + s.material.poissons_ratio));
    const double g_star = shear / (2 - s.material.poissons_ratio) / (wall ? 1 : 2);
    const double log_e = std::log(s.interaction.coefficient_of_restitution);
    const double beta = -log_e / std::hypot(log_e, kPi), dashpot = 2 * std::sqrt(5.0 / 6.0) * beta;
    const double mu = s.interaction.static_friction;
    const double dt = hertz_impact(e_star, r_star, m_star, s.normal_speed).contact_time / 40000;

    ImpactResult out;
    auto forces = [&](const Motion& m, double& friction, double& stretch) {
        const double a = std::sqrt(r_star * std::max(m.overlap, 0.0));
        const double normal =
            4.0 / 3.0 * e_star * a * m.overlap + dashpot * std::sqrt(2 * e_star * a * m_star) * m.closing;
        const double share = wall ? 1 : 0.5;
        const double arm_1 = s.radius_1 - share * m.overlap,
                     arm_2 = wall ? 0 : s.radius_2 - share * m.overlap;
        const double slip = m.tangential + m.spin_1 * arm_1 + m.spin_2 * arm_2;
        const double stiffness = 8 * g_star * a;
        const double trial = -stiffness * m.stretch - dashpot * std::sqrt(stiffness * m_star) * slip;
        const double limit = mu * std::max(normal, 0.0);
        friction = std::clamp(trial, -limit, limit);
        // beyond the cap the spring is left at what it holds
        stretch = friction != trial && stiffness > 0 ? -friction / stiffness : m.stretch;
        Motion rate;
        rate.overlap = m.closing;
        rate.closing = -normal / m_star;
        rate.tangential = friction / m_star;
        rate.spin_1 = friction * arm_1 / inertia_1;
        rate.spin_2 = wall ? 0 : friction * arm_2 / inertia_2;
        rate.stretch = slip;
        return rate;
    };
    Motion m{0, s.normal_speed, s.tangential_speed, s.spin_1, s.spin_2, 0};
    for (long step = 0; step < 400000; ++step) {
        double friction = 0, stretch = 0;
        const Motion first = forces(m, friction, stretch);
        const Motion middle = advanced(m, first, 0.5 * dt);
        const Motion second = forces(middle, friction, stretch);
        m = advanced(m, second, dt);
        forces(m, friction, stretch);
        m.stretch = stretch;
        ++out.steps_in_contact;
        out.overlap_max = std::max(out.overlap_max, m.overlap);
        if (m.overlap <= 0) break;
    }
    out.contact_time = dt * static_cast<double>(out.steps_in_contact);
    out.normal_speed = -m.closing;
    out.tangential_speed = m.tangential;
    out.spin_1 = m.spin_1;
    out.spin_2 = m.spin_2;
    return out;
}

}  // namespace gradwright::verification
