// V15: walls obey the pair law: a plane is a grain of a million radii; edges and corners.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "dem/verification/laboratory.h"

namespace gradwright {
using namespace verification;
namespace {

constexpr double kRadius = 20e-6;
Material metal() {
    return grain_material(8000, 2e7, 0.3);
}

Body plane_towards_z() {
    Body b;
    b.material = 0;
    return b;
}

Body box_below_and_left() {
    Body box;
    box.kind = Body::Kind::box;
    box.x0 = box.z0 = -1e-3;
    box.x1 = box.z1 = 0;
    box.material = 1;
    return box;
}

/// Oblique, spinning impact from above at 1 mm/s, 45 degrees: v_x, v_z and the rim's speed afterwards, over
/// the impact speed. The partner is a plane or a grain of a million radii, free and as heavy as that.
std::array<double, 3> impact(const VerificationOptions& options, const Interaction& interaction, bool plane) {
    const double speed = 1e-3, huge = 1e6 * kRadius;
    const auto contact =
        hertz_impact(effective_modulus(metal(), false), kRadius, sphere_mass(8000, kRadius), speed);
    EngineOptions eo = laboratory_options(options, metal(), interaction, contact.contact_time / 1000);
    eo.skin = 0.5 * kRadius;  // the default follows the largest grain
    eo.near_skin = 0.1 * kRadius;
    Engine engine(eo);
    const double gap = 5.3 * speed * eo.time_step;
    const int id = engine.add_grain(
        {.z = kRadius + gap, .vx = speed, .vz = -speed, .wy = -0.7 * speed / kRadius, .radius = kRadius});
    if (plane)
        engine.add_body(plane_towards_z());
    else
        engine.add_grain({.z = -huge, .radius = huge});
    engine.advance(6000);
    const std::size_t i = index_of(engine, id);
    const auto v = engine.velocity(i);
    return {v[0] / speed, v[2] / speed, engine.spin(i)[1] * kRadius / speed};
}

void add_limit_cases(VerificationCases& out, const VerificationOptions& options) {
    struct Row {
        const char* name;
        double adhesion, restitution;
        RollingModel rolling;
    };
    // The work of adhesion is small enough for the grain to part again.
    for (const Row& row : {Row{"Hertz, e = 1, no rolling resistance", 0, 1, RollingModel::none},
                           Row{"Hertz, e = 0.5, constant torque", 0, 0.5, RollingModel::constant_torque},
                           Row{"Hertz, e = 0.5, edem", 0, 0.5, RollingModel::edem},
                           Row{"Hertz, e = 0.5, spring", 0, 0.5, RollingModel::spring},
                           Row{"JKR, e = 1, spring", 1e-4, 1, RollingModel::spring}}) {
        Interaction interaction;
        interaction.work_of_adhesion = row.adhesion;
        interaction.coefficient_of_restitution = row.restitution;
        interaction.rolling_model = row.rolling;
        interaction.rolling_friction = row.rolling == RollingModel::none ? 0 : 0.1;
        const auto pair = impact(options, interaction, false), wall = impact(options, interaction, true);
        const char* quantities[] = {"tangential speed after / before, plane against huge grain",
                                    "normal speed after / before, plane against huge grain",
                                    "rim speed after / impact speed, plane against huge grain"};
        // The arms r - delta/2 and r - delta differ by 0.02 % of r at this speed.
        for (int k = 0; k < 3; ++k)
            out.push_back(judged("V15", row.name, quantities[k], pair[k], wall[k], 1, 5e-4,
                                 "pair law with a grain of 1e6 radii and its mass"));
        out.push_back(judged("V15", row.name, "the grain rebounds (1 = yes)", 1, pair[1] > 0.05, 1, 0,
                             "else nothing was shown"));
    }
}

/// A grain dragged along the top of a box and over its edge by inertia alone: it slides all the way, so
/// friction is mu times the normal force at every instant. A contact that were made anew at the edge would
/// start without a spring.
void add_rim_case(VerificationCases& out, const VerificationOptions& options) {
    Interaction interaction = bare_interaction();
    interaction.static_friction = 0.64;
    EngineOptions eo = laboratory_options(options, metal(), interaction, 2e-7);
    eo.materials.push_back(grain_material(1e20, 2e7, 0.3));
    Engine engine(eo);
    const int box = engine.add_body(box_below_and_left());
    const double overlap = 0.01 * kRadius, speed = 1e-3;
    engine.add_grain(
        {.x = -0.08 * kRadius, .z = kRadius - overlap, .vx = speed, .radius = kRadius, .material = 2});
    double worst = 0, at_worst = 0.64, tilt = 0;
    for (int block = 0; block < 900; ++block) {
        engine.advance(20);
        // The force belongs to the position before the last step: 2e-10 m, 1e-5 of the radius.
        const double x = engine.state().x[0], nx = std::max(x, 0.0), nz = engine.state().z[0],
                     d = std::hypot(nx, nz);
        const auto f = engine.force_on_body(box);
        if (block < 300) continue;  // until the spring has reached Coulomb's limit
        if (kRadius - d < 0.003 * kRadius) break;
        const double normal = -(f.x * nx + f.z * nz) / d, tangential = (f.x * nz - f.z * nx) / d;
        const double error = std::fabs(tangential / normal - 0.64);
        if (error > worst) worst = error, at_worst = tangential / normal;
        tilt = std::max(tilt, nx / d);
    }
    VerificationCase c = judged("V15", "grain dragged from the face over the edge of a box",
                                "friction / normal force where it is farthest from mu", 0.64, at_worst, 0.64,
                                1e-3, "sliding: F_t = mu F_n; a lost spring starts from 0");
    out.push_back(c);
    out.push_back(judged("V15", "grain dragged from the face over the edge of a box",
                         "the contact turned round the edge (1 = yes)", 1, tilt > 0.05, 1, 0,
                         "else nothing was shown"));
}

/// Frictionless elastic impact on the edge of a box: the normal runs from the edge to the centre, the
/// velocity is mirrored in it.
void add_edge_impact(VerificationCases& out, const VerificationOptions& options) {
    for (const double offset : {0.3, 0.6, 0.9}) {
        const double speed = 1e-4;
        const auto contact =
            hertz_impact(effective_modulus(metal(), true), kRadius, sphere_mass(8000, kRadius), speed);
        Engine engine(laboratory_options(options, metal(), bare_interaction(), contact.contact_time / 1000));
        engine.add_body(box_below_and_left());
        const double nz = std::sqrt(1 - offset * offset);
        engine.add_grain({.x = offset * kRadius,
                          .z = nz * kRadius + 5 * contact.overlap_max,
                          .vz = -speed,
                          .radius = kRadius});
        engine.advance(30000);
        const auto v = engine.velocity(0);
        const auto name = fmt::format("smooth impact on an edge, {:g} radii beside it", offset);
        out.push_back(judged("V15", name, "v_x after / speed before", 2 * nz * offset, v[0] / speed, 1, 1e-3,
                             "v - 2 (v.n) n, n from the edge to the centre"));
        out.push_back(judged("V15", name, "v_z after / speed before", 2 * nz * nz - 1, v[2] / speed, 1, 1e-3,
                             "v - 2 (v.n) n, n from the edge to the centre"));
    }
}

/// A grain at rest in the corner of two planes under tilted gravity: each plane carries its own component.
void add_corner_case(VerificationCases& out, const VerificationOptions& options) {
    Interaction interaction = bare_interaction();
    interaction.coefficient_of_restitution = 0.3;
    interaction.static_friction = 0;
    EngineOptions eo = laboratory_options(options, metal(), interaction, 1e-7);
    const double g = 9.81, tilt = 30 * kPi / 180;
    eo.gravity = {-g * std::sin(tilt), 0, -g * std::cos(tilt)};
    Engine engine(eo);
    const int floor = engine.add_body(plane_towards_z());
    Body side = plane_towards_z();
    side.axis = 0;
    const int wall = engine.add_body(side);
    engine.add_grain({.x = kRadius, .z = kRadius, .radius = kRadius});
    engine.advance(60000);
    const double weight = sphere_mass(8000, kRadius) * g;
    out.push_back(judged("V15", "grain in a corner, gravity tilted by 30 degrees",
                         "force on the floor / weight", std::cos(tilt),
                         -engine.force_on_body(floor).z / weight, 1, 1e-3, "cos: one contact a plane"));
    out.push_back(judged("V15", "grain in a corner, gravity tilted by 30 degrees",
                         "force on the wall / weight", std::sin(tilt), -engine.force_on_body(wall).x / weight,
                         1, 1e-3, "sin: one contact a plane"));
}

}  // namespace

VerificationCases verify_walls(const VerificationOptions& options) {
    VerificationCases out;
    add_limit_cases(out, options);
    add_rim_case(out, options);
    add_edge_impact(out, options);
    add_corner_case(out, options);
    return out;
}

}  // namespace gradwright
