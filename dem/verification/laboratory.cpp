#include "dem/verification/laboratory.h"

#include <algorithm>

namespace gradwright::verification {

ImpactResult run_impact(const VerificationOptions& options, const ImpactSetup& s) {
    const bool wall = s.radius_2 == 0;
    const double m1 = sphere_mass(s.material.density, s.radius_1);
    const double m2 = wall ? 0 : sphere_mass(s.material.density, s.radius_2);
    const double r_star = wall ? s.radius_1 : s.radius_1 * s.radius_2 / (s.radius_1 + s.radius_2);
    const double m_star = wall ? m1 : m1 * m2 / (m1 + m2);
    const double v = s.normal_speed;
    const auto elastic = hertz_impact(effective_modulus(s.material, wall), r_star, m_star, v);
    const double dt = elastic.contact_time / s.steps_per_contact;
    // a first touch within a step: contacts of a run start anywhere in a step
    const double gap = (3 + s.phase) * dt * v;

    Engine engine(laboratory_options(options, s.material, s.interaction, dt));
    const double share_1 = wall ? 1 : m2 / (m1 + m2), share_2 = 1 - share_1;
    engine.add_grain({.x = -s.radius_1 - gap,
                      .vx = v * share_1,
                      .vy = s.tangential_speed * share_1,
                      .wz = s.spin_1,
                      .radius = s.radius_1});
    if (wall) {
        Body plane;
        plane.axis = 0;
        plane.sign = -1;
        plane.offset = 0;
        plane.material = 1;
        engine.add_body(plane);
    } else {
        engine.add_grain({.x = s.radius_2,
                          .vx = -v * share_2,
                          .vy = -s.tangential_speed * share_2,
                          .wz = s.spin_2,
                          .radius = s.radius_2});
    }
    auto overlap = [&] {
        const State& g = engine.state();
        const std::size_t a = index_of(engine, 0);
        if (wall) return s.radius_1 + g.x[a];
        const std::size_t b = index_of(engine, 1);
        return s.radius_1 + s.radius_2 - std::hypot(g.x[a] - g.x[b], g.y[a] - g.y[b], g.z[a] - g.z[b]);
    };

    ImpactResult out;
    double before = overlap(), speed_before = engine.state().vx[index_of(engine, 0)], end = 0;
    bool touched = false;
    const long most = static_cast<long>(60 * s.steps_per_contact);
    for (long step = 1; step <= most; ++step) {
        engine.advance(1);
        const double now = overlap(), speed = engine.state().vx[index_of(engine, 0)];
        out.force_max = std::max(out.force_max, m1 * std::fabs(speed - speed_before) / dt);
        out.overlap_max = std::max(out.overlap_max, now);
        speed_before = speed;
        if (now > 0) {
            touched = true;
            ++out.steps_in_contact;
        } else if (touched) {
            end = dt * (static_cast<double>(step) - now / (now - before));  // linear between the two instants
            break;
        }
        before = now;
    }
    if (end == 0) return out;  // never parted: no rebound
    engine.advance(2);         // clear of the contact: half-step and whole-step velocities agree
    out.contact_time = end - gap / v;
    const std::size_t a = index_of(engine, 0);
    auto va = engine.velocity(a);
    out.spin_1 = engine.spin(a)[2];
    if (!wall) {
        const std::size_t b = index_of(engine, 1);
        const auto vb = engine.velocity(b);
        for (int k = 0; k < 3; ++k) va[k] -= vb[k];
        out.spin_2 = engine.spin(b)[2];
    }
    out.normal_speed = -va[0];
    out.tangential_speed = va[1];
    return out;
}

}  // namespace gradwright::verification
