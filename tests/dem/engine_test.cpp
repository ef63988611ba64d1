// What the engine does around the law: lists, history, bodies, sleep, removal, failure.
#include "dem/engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "dem/cube_root.h"
#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kRadius = 20e-6, kStep = 2e-7;

Material metal(double density = 8000) {
    return {"metal", density, 2e7, 0.3, ""};
}

/// Material 0 metal, 1 rigid, 2 metal of half the density, 3 metal too heavy for any force here to move.
EngineOptions bare(Precision precision = Precision::double_law) {
    EngineOptions o;
    o.materials = {
        metal(), {"rigid", 1000, std::numeric_limits<double>::infinity(), 0.3, ""}, metal(4000), metal(1e18)};
    o.interaction.work_of_adhesion = 0;
    o.gravity = {0, 0, 0};
    o.time_step = kStep;
    o.precision = precision;
    o.threads = 1;
    return o;
}

std::size_t index_of(const Engine& e, int id) {
    const auto& ids = e.state().id;
    return static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
}

Body plane_z(double z = 0) {
    Body b;
    b.offset = z;
    b.material = 1;
    return b;
}

/// Positions and spins by grain number.
std::map<int, std::array<double, 6>> by_id(const Engine& e) {
    std::map<int, std::array<double, 6>> out;
    const State& s = e.state();
    for (std::size_t i = 0; i < s.size(); ++i)
        out[s.id[i]] = {s.x[i], s.y[i], s.z[i], s.wx[i], s.wy[i], s.wz[i]};
    return out;
}

class EngineOf : public testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(Law, EngineOf, testing::Values(Precision::double_law, Precision::single_law),
                         [](const auto& info) {
                             return info.param == Precision::double_law ? "double" : "single";
                         });

TEST_P(EngineOf, nothing_one_and_two_grains_run) {
    for (int grains = 0; grains <= 2; ++grains) {
        EngineOptions o = bare(GetParam());
        o.gravity = {0, 0, -9.81};
        Engine e(o);
        for (int k = 0; k < grains; ++k)
            e.add_grain({.x = 3 * kRadius * k, .z = 5 * kRadius, .radius = kRadius});
        EXPECT_EQ(e.advance(1000), 1000);
        EXPECT_EQ(e.failed(), "");
        EXPECT_EQ(e.contacts(), 0u);
        EXPECT_EQ(e.mobile(), static_cast<std::size_t>(grains));
        const double t = 1000 * kStep;
        for (int k = 0; k < grains; ++k) EXPECT_NEAR(e.state().z[k], 5 * kRadius - 0.5 * 9.81 * t * t, 1e-12);
    }
}

TEST_P(EngineOf, a_grain_held_by_static_friction_does_not_creep_over_a_thousand_list_rebuilds) {
    EngineOptions o = bare(GetParam());
    const double slope = 20 * std::numbers::pi / 180;
    o.gravity = {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
    o.interaction.rolling_model = RollingModel::spring;
    o.interaction.rolling_friction = 0.5;  // > tan 20 degrees: it may not roll away either
    // three fixed grains carry it on one engine, a plane on the other
    for (const bool on_grains : {false, true}) {
        Engine e(o);
        if (on_grains) {
            for (int k = 0; k < 3; ++k) {
                const double a = 2 * std::numbers::pi * k / 3;
                e.add_grain({.x = 1.1 * kRadius * std::cos(a),
                             .y = 1.1 * kRadius * std::sin(a),
                             .radius = kRadius,
                             .fixed = true});
            }
        } else {
            e.add_body(plane_z(std::sqrt(4 - 1.21) * kRadius - kRadius));
        }
        const int id = e.add_grain({.z = std::sqrt(4 - 1.21) * kRadius, .radius = kRadius});
        e.advance(60000);
        const double x = e.state().x[index_of(e, id)], z = e.state().z[index_of(e, id)];
        for (int k = 0; k < 1000; ++k) {
            e.refresh();
            e.advance(10);
        }
        EXPECT_NEAR(e.state().x[index_of(e, id)], x, 1e-6 * kRadius)
            << (on_grains ? "on grains" : "on a plane");
        EXPECT_NEAR(e.state().z[index_of(e, id)], z, 1e-6 * kRadius);
    }
}

/// Two bonded grains that circle each other with loaded springs past a far fixed grain; the order of storage
/// follows the cells.
std::map<int, std::array<double, 6>> circling_pair(Precision precision, RollingModel rolling, bool rebuild,
                                                   int& swaps) {
    EngineOptions o = bare(precision);
    o.interaction.work_of_adhesion = 5e-4;
    o.interaction.coefficient_of_restitution = 1;
    o.interaction.rolling_model = rolling;
    if (!rebuild) o.skin = 20 * kRadius, o.near_skin = 19 * kRadius;
    Engine e(o);
    const double cell = 2 * kRadius + 1.5 * 0.6 * kRadius, turn = 1000,
                 reach = kRadius - 2e-9;  // 1.5 (0.45 r + 0.15 r): the default skin and its widest reach
    e.add_grain({.x = -4 * cell, .z = 0, .radius = kRadius, .fixed = true});
    // around x = 0, the boundary of two cells
    const int a = e.add_grain({.x = -reach, .vy = -turn * reach, .wz = turn + 30, .radius = kRadius});
    const int b = e.add_grain({.x = reach, .vy = turn * reach, .wx = 20, .wz = turn, .radius = kRadius});
    bool first = true;
    for (int k = 0; k < 8000; ++k) {
        if (rebuild) e.refresh();
        e.advance(10);
        const bool now = index_of(e, a) < index_of(e, b);
        swaps += now != first;
        first = now;
    }
    EXPECT_EQ(e.contacts(), 1u);
    return by_id(e);
}

TEST_P(EngineOf, springs_turn_round_with_the_storage_order_of_their_pair) {
    for (const RollingModel rolling : {RollingModel::none, RollingModel::spring}) {
        int swaps = 0, none = 0;
        const auto kept = circling_pair(GetParam(), rolling, false, none),
                   rebuilt = circling_pair(GetParam(), rolling, true, swaps);
        EXPECT_GE(swaps, 4);
        EXPECT_EQ(none, 0);
        const double exact = GetParam() == Precision::double_law ? 1e-9 : 1e-4;
        for (const auto& [id, values] : kept)
            for (int k = 0; k < 6; ++k)
                EXPECT_NEAR(rebuilt.at(id)[k], values[k], exact * (k < 3 ? kRadius : 1000)) << id << " " << k;
    }
}

/// A heap of grains dropped into a walled box.
void add_pile(Engine& e, int n, std::uint64_t seed) {
    Random random(seed);
    const double side = 8 * kRadius;
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {1.0, -1.0}) {
            Body wall;
            wall.axis = axis;
            wall.sign = sign;
            wall.offset = sign > 0 ? 0 : side;
            wall.material = 1;
            e.add_body(wall);
        }
    e.add_body(plane_z());
    for (int k = 0; k < n; ++k)
        e.add_grain({.x = side * (0.2 + 0.3 * (k % 3)) + kRadius * 0.1 * random.uniform(),
                     .y = side * (0.2 + 0.3 * (k / 3 % 3)) + kRadius * 0.1 * random.uniform(),
                     .z = kRadius * (1.1 + 2.2 * (k / 9)),
                     .radius = kRadius * (0.8 + 0.2 * random.uniform())});
}

TEST(CubeRoots, of_a_vectors_width_are_those_of_the_library) {
    for (double x = 1e-60; x < 1e3; x *= 1.0007) {
        double v[4] = {x, 1.3 * x, 0, 7.1 * x};
        cube_roots(v);
        EXPECT_NEAR(v[0] / std::cbrt(x), 1, 1e-15) << x;
        EXPECT_NEAR(v[1] / std::cbrt(1.3 * x), 1, 1e-15) << x;
        EXPECT_NEAR(v[3] / std::cbrt(7.1 * x), 1, 1e-15) << x;
        EXPECT_EQ(v[2], 0);
    }
}

TEST(Sleep, a_settled_pile_lies_where_it_lies_without_sleep) {
    EngineOptions o = bare(Precision::single_law);
    o.gravity = {0, 0, -9.81};
    o.interaction.rolling_model = RollingModel::spring;
    o.interaction.work_of_adhesion = 5e-4;
    Engine settled(o);
    add_pile(settled, 54, 4);
    settled.advance(100000);
    ASSERT_LT(settled.max_speed(), 1e-3);
    // From these positions and without springs: a short relaxation, then rest, asleep or not. (The fall
    // itself is chaotic: the last rollers of two runs that part by one bit end up radii apart.)
    std::map<int, std::array<double, 6>> ends[2];
    for (const bool sleep : {false, true}) {
        o.sleep = sleep;
        Engine e(o);
        add_pile(e, 54, 4);
        for (std::size_t i = 0; i < 54; ++i) {
            const std::size_t from = index_of(settled, static_cast<int>(i));
            e.state().x[i] = settled.state().x[from], e.state().y[i] = settled.state().y[from],
            e.state().z[i] = settled.state().z[from];
        }
        e.advance(50000);
        EXPECT_EQ(e.failed(), "");
        if (sleep) {
            EXPECT_LT(e.awake(), 6u);
            EXPECT_LT(e.grain_steps(), 0.5 * 54 * 50000);
        } else {
            EXPECT_EQ(e.awake(), 54u);
        }
        ends[sleep] = by_id(e);
    }
    // A grain that falls asleep early keeps up to sleep_speed x sleep_time to itself, and a neighbour may
    // then hold where it would have rolled on: single grains differ by tenths of a radius, the pile does not.
    double sum = 0, height = 0;
    for (const auto& [id, values] : ends[0])
        for (int k = 0; k < 3; ++k) {
            const double difference = ends[1].at(id)[k] - values[k];
            EXPECT_LT(std::fabs(difference), 0.4 * kRadius) << id;
            sum += std::fabs(difference) / (3 * 54);
            if (k == 2) height += difference / 54;
        }
    EXPECT_LT(sum, 0.04 * kRadius);
    EXPECT_LT(std::fabs(height), 0.02 * kRadius);
}

TEST(Sleep, a_sleeping_grain_wakes_when_it_is_hit) {
    EngineOptions o = bare();
    o.gravity = {0, 0, -9.81};
    o.sleep = true;
    Engine e(o);
    e.add_body(plane_z());
    const int sleeper = e.add_grain({.z = 0.9999 * kRadius, .radius = kRadius});
    const int hammer = e.add_grain({.x = -40 * kRadius, .z = 0.9999 * kRadius, .radius = kRadius});
    e.advance(20000);
    ASSERT_EQ(e.awake(), 0u);
    e.state().vx[index_of(e, hammer)] = 0.2;
    e.wake_all();
    const double before = e.state().x[index_of(e, sleeper)];
    e.advance(30000);
    EXPECT_GT(e.state().x[index_of(e, sleeper)], before + 0.5 * kRadius);
}

TEST(Sleep, a_sleeping_grain_wakes_when_a_moving_body_comes_near_and_not_before) {
    EngineOptions o = bare();
    o.gravity = {0, 0, -9.81};
    o.sleep = true;
    Engine e(o);
    e.add_body(plane_z());
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x0 = -400 * kRadius, blade.x1 = -12 * kRadius;
    blade.z0 = 0.5 * kRadius, blade.z1 = 10 * kRadius;
    blade.speed_x = 0.03;
    const int number = e.add_body(blade);
    for (int k = 0; k < 8; ++k) e.add_grain({.x = 8 * kRadius * k, .z = 0.9999 * kRadius, .radius = kRadius});
    e.advance(20000);
    ASSERT_EQ(e.awake(), 0u);
    e.start_bodies();
    const double look = blade.speed_x * e.sleep_time();  // who sleeps is asked no less often
    ASSERT_LT(look, 0.8 * kRadius);
    int woken = 0;
    for (int portion = 0; portion < 300; ++portion) {
        e.advance(200);
        const double face = blade.x1 + e.body_shift_x(number);
        for (std::size_t i = 0; i < e.state().size(); ++i) {
            const double ahead = e.state().x[i] - face;
            if (ahead > 3.1 * kRadius && e.state().id[i] != 0) {
                EXPECT_EQ(e.state().asleep[i], 1) << ahead / kRadius;
            } else if (ahead > kRadius && ahead < 2.9 * kRadius - look) {
                EXPECT_EQ(e.state().asleep[i], 0) << ahead / kRadius;
                ++woken;
            }
        }
        if (face > 3 * kRadius) break;  // soon the first grain, pushed along, meets the second
    }
    EXPECT_GT(woken, 5);
}

TEST(Removal, removed_grains_are_gone_and_the_others_stay_at_rest_at_once) {
    EngineOptions o = bare();
    o.gravity = {0, 0, -9.81};
    o.interaction.rolling_model = RollingModel::spring;
    Engine e(o);
    e.add_body(plane_z());
    for (int k = 0; k < 10; ++k)
        e.add_grain({.x = 5 * kRadius * k, .z = 0.9999 * kRadius, .radius = kRadius});
    e.advance(20000);
    e.remove_grains([&](std::size_t i) { return e.state().id[i] % 2 == 0; });
    EXPECT_EQ(e.mobile(), 5u);
    EXPECT_EQ(e.awake(), 5u);
    EXPECT_EQ(e.advance(1), 1);
    EXPECT_LT(e.max_speed(), 1e-4);
    EXPECT_EQ(e.mean_coordination(), 1);
    e.advance(2000);
    for (const auto& [id, values] : by_id(e)) {
        EXPECT_EQ(id % 2, 1);
        EXPECT_NEAR(values[0], 5 * kRadius * id, 1e-4 * kRadius);
    }
    EXPECT_EQ(e.failed(), "");
}

TEST(Removal, grains_past_the_end_leave_the_run) {
    EngineOptions o = bare();
    o.remove_beyond_x = 10 * kRadius;
    Engine e(o);
    e.add_grain({.vx = 0.1, .radius = kRadius});
    e.add_grain({.y = 5 * kRadius, .radius = kRadius});
    e.advance(20000);  // 20 radii
    EXPECT_EQ(e.mobile(), 1u);
    EXPECT_EQ(e.state().id[0], 1);
}

TEST(Bodies, a_grain_keeps_its_spring_from_the_face_over_the_edge) {
    // Dragged along the top of a box and over its edge by inertia alone, the contact slides all the way:
    // friction is mu times the normal force at every instant. A lost spring would start again from zero.
    EngineOptions o = bare();
    o.interaction.coefficient_of_restitution = 1;
    o.interaction.rolling_friction = 0;
    Engine e(o);
    Body box;
    box.kind = Body::Kind::box;
    box.x0 = -1e-3;
    box.x1 = 0;
    box.z0 = -1e-3;
    box.z1 = 0;
    box.material = 1;
    const int body = e.add_body(box);
    const double overlap = 0.01 * kRadius, speed = 1e-3;
    e.add_grain(
        {.x = -0.08 * kRadius, .z = kRadius - overlap, .vx = speed, .radius = kRadius, .material = 3});
    double worst = 0, tilt = 0;
    for (int k = 0; k < 900; ++k) {
        e.advance(20);
        const double x = e.state().x[0];
        const auto f = e.force_on_body(body);
        const double nx = x > 0 ? x : 0, nz = e.state().z[0], d = std::hypot(nx, nz);
        if (k < 300) continue;  // until the spring has reached Coulomb's limit
        if (kRadius - d < 0.003 * kRadius) break;
        const double normal = -(f.x * nx + f.z * nz) / d, tangential = (f.x * nz - f.z * nx) / d;
        worst = std::max(worst, std::fabs(tangential / normal - o.interaction.static_friction));
        tilt = std::max(tilt, nx / d);
    }
    EXPECT_GT(tilt, 0.05);
    EXPECT_LT(worst, 0.01);
}

TEST(Bodies, a_plane_is_the_limit_of_a_huge_fixed_grain) {
    const double huge = 2e4 * kRadius;
    std::array<double, 4> ends[2];
    for (const bool wall : {false, true}) {
        EngineOptions o = bare();
        o.interaction.work_of_adhesion = 5e-4;
        o.interaction.rolling_model = RollingModel::spring;
        o.skin = 0.5 * kRadius;
        Engine e(o);
        const int id =
            e.add_grain({.x = 0, .z = 1.01 * kRadius, .vx = 0.1, .vz = -0.1, .wy = -500, .radius = kRadius});
        if (wall) {
            Body b = plane_z();
            b.material = 0;
            e.add_body(b);
        } else {
            e.add_grain({.z = -huge, .radius = huge, .fixed = true});
        }
        e.advance(400);
        const std::size_t i = index_of(e, id);
        ends[wall] = {e.state().z[i] / kRadius - 1, e.velocity(i)[0], e.velocity(i)[2],
                      e.spin(i)[1] * kRadius};
    }
    // lever arms r - overlap/2 and r - overlap: up to 1.5 % of the radius apart in this impact
    EXPECT_GT(ends[0][2], 0.01);
    EXPECT_NEAR(ends[1][0], ends[0][0], 1e-3);
    EXPECT_NEAR(ends[1][1], ends[0][1], 1e-3);
    EXPECT_NEAR(ends[1][2], ends[0][2], 1e-4);
    EXPECT_NEAR(ends[1][3], ends[0][3], 2e-3);
}

TEST(Bodies, a_removed_body_lets_its_grains_fall) {
    EngineOptions o = bare();
    o.gravity = {0, 0, -9.81};
    Engine e(o);
    const int floor = e.add_body(plane_z());
    e.add_grain({.z = 0.9999 * kRadius, .radius = kRadius});
    e.advance(5000);
    EXPECT_NEAR(e.force_on_body(floor).z / (-9.81 * e.state().mass[0]), 1, 0.01);
    e.remove_body(floor);
    const double z = e.state().z[0];
    e.advance(5000);
    EXPECT_NEAR(e.state().z[0], z - 0.5 * 9.81 * 1e-6, 0.05e-6);
    EXPECT_EQ(e.force_on_body(floor).z, 0);
}

TEST(Bodies, a_moving_body_pushes_and_a_stopped_one_does_not) {
    EngineOptions o = bare();
    o.interaction.coefficient_of_restitution = 1;
    o.interaction.static_friction = 0;
    Engine e(o);
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x0 = -1e-3;
    blade.x1 = 0;
    blade.z0 = -1e-3;
    blade.z1 = 1e-3;
    blade.speed_x = 0.1;
    blade.material = 1;
    e.add_body(blade);
    e.add_grain({.x = 1.5 * kRadius, .radius = kRadius});
    e.advance(2000);
    EXPECT_EQ(e.state().vx[0], 0);
    e.start_bodies();
    e.advance(2000);
    EXPECT_NEAR(e.velocity(0)[0], 0.2, 1e-3);  // elastic: twice the blade's speed
}

TEST(Lists, no_touching_pair_or_wall_contact_is_missed_however_fast_single_grains_are) {
    // A gas that drifts as a whole, a few grains thirty times as fast as the rest, over a plane that does not
    // move with it: what touches by brute force is what the law sees, step by step.
    EngineOptions o = bare();
    const double box = 14 * kRadius, step = 0.5 * kStep;
    o.time_step = step;
    o.period_x = o.period_y = box;
    o.period_z = 0;
    Engine e(o);
    const int floor = e.add_body(plane_z(0)),
              fixed = e.add_grain({.z = -3 * kRadius, .radius = kRadius, .fixed = true});
    Body lid = plane_z(box);
    lid.sign = -1;
    const int roof = e.add_body(lid);
    Random random(7);
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
            for (int k = 0; k < 5; ++k) {
                const double fast = random.uniform() < 0.03 ? 30 : 1;
                const auto kick = [&] { return 0.03 * fast * random.normal(); };
                e.add_grain({.x = (i + 0.5) * box / 6,
                             .y = (j + 0.5) * box / 6,
                             .z = (k + 0.5) * box / 5,
                             .vx = 0.1 + kick(),
                             .vy = kick(),
                             .vz = kick(),
                             .radius = kRadius * (0.5 + 0.6 * random.uniform())});
            }
    EXPECT_EQ(fixed, 0);
    long touching = 0, walls = 0;
    for (int n = 0; n < 6000; ++n) {
        const State& s = e.state();
        long sure = 0, doubtful = 0;
        for (std::size_t i = 0; i < s.size(); ++i)
            for (std::size_t j = i + 1; j < s.size(); ++j) {
                double dx = s.x[i] - s.x[j], dy = s.y[i] - s.y[j];
                dx -= box * std::nearbyint(dx / box);
                dy -= box * std::nearbyint(dy / box);
                const double dz = s.z[i] - s.z[j];
                const double overlap = s.radius[i] + s.radius[j] - std::sqrt(dx * dx + dy * dy + dz * dz);
                sure += overlap > 1e-9 * kRadius;
                doubtful += std::abs(overlap) <= 1e-9 * kRadius;
            }
        const bool hits[2] = {!e.overlapping_body(floor, 1e-9).empty(),
                              !e.overlapping_body(roof, 1e-9).empty()};
        e.advance(1);
        ASSERT_TRUE(e.failed().empty()) << e.failed();
        const long seen = static_cast<long>(e.contacts());
        ASSERT_GE(seen, sure) << "step " << n;
        ASSERT_LE(seen, sure + doubtful) << "step " << n;
        touching += sure;
        for (const int b : {0, 1}) {
            if (!hits[b]) continue;
            ++walls;
            ASSERT_NE(e.force_on_body(b == 0 ? floor : roof).z, 0) << "step " << n;
        }
    }
    EXPECT_GT(touching, 1000);
    EXPECT_GT(walls, 100);
}

TEST_P(EngineOf, deep_contacts_are_a_share_of_those_seen) {
    // Pairs at 1, 5 and 12 % of the smaller radius, one grain at 4 % in the floor: too heavy to move.
    Engine e(bare(GetParam()));
    e.add_body(plane_z());
    double x = 0;
    for (const double overlap : {0.01, 0.05, 0.12}) {
        const double small = 0.5 * kRadius;
        e.add_grain({.x = x, .z = 5 * kRadius, .radius = kRadius, .material = 3});
        e.add_grain({.x = x, .z = 6 * kRadius + small - overlap * small, .radius = small, .material = 3});
        x += 10 * kRadius;
    }
    e.add_grain({.x = x, .z = 0.96 * kRadius, .radius = kRadius, .material = 3});
    e.advance(1);
    EXPECT_NEAR(e.max_overlap_ratio_seen(), 0.12, 1e-6);
    EXPECT_DOUBLE_EQ(e.deep_contact_share(), 3.0 / 4);
    // a new grain, and so a second look at the same contacts
    e.add_grain({.x = -10 * kRadius, .z = 5 * kRadius, .radius = kRadius});
    e.advance(1);
    EXPECT_DOUBLE_EQ(e.deep_contact_share(), 6.0 / 8);
    Engine again(bare(GetParam()));
    again.add_body(plane_z());
    again.restore(e.save());
    EXPECT_DOUBLE_EQ(again.deep_contact_share(), 6.0 / 8);
}

TEST_P(EngineOf, a_face_that_yields_makes_no_deep_contacts) {
    Engine e(bare(GetParam()));
    Body floor = plane_z();
    floor.yield_ratio = 0.006;
    e.add_body(floor);
    e.add_grain({.z = 0.9 * kRadius, .radius = kRadius, .material = 3});
    e.advance(1);
    EXPECT_EQ(e.deep_contact_share(), 0);
    EXPECT_EQ(e.max_overlap_ratio_seen(), 0);
}

TEST(Failure, grains_at_one_place_are_a_failed_run_and_not_a_silent_one) {
    for (const Precision precision : {Precision::double_law, Precision::single_law}) {
        Engine e(bare(precision));
        e.add_grain({.radius = kRadius});
        e.add_grain({.radius = kRadius});
        e.advance(1000);
        EXPECT_EQ(e.failed(), "not finite");
    }
}

TEST(Failure, a_step_beyond_the_stability_edge_is_reported) {
    EngineOptions o = bare();
    o.time_step = 2e-5;  // 9 Rayleigh times
    o.gravity = {0, 0, -9.81};
    Engine e(o);
    add_pile(e, 54, 4);
    e.advance(2000);
    EXPECT_FALSE(e.failed().empty());
}

TEST(Failure, nonsense_options_are_refused) {
    EngineOptions o = bare();
    o.time_step = 0;
    EXPECT_THROW(Engine{o}, std::invalid_argument);
    o = bare();
    o.materials.clear();
    EXPECT_THROW(Engine{o}, std::invalid_argument);
}

TEST(Materials, a_relabelled_grain_has_its_new_mass_at_once) {
    Engine e(bare());
    const int a = e.add_grain({.vx = 0.1, .radius = kRadius});
    const int b = e.add_grain({.x = 2.5 * kRadius, .radius = kRadius});
    e.set_material(index_of(e, b), 2);
    const double m = 8000 * 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);
    EXPECT_NEAR(e.state().mass[index_of(e, b)], 0.5 * m, 1e-12 * m);
    e.advance(3000);
    // centre of mass goes on at m v/(m + m/2), parting speed e v: v_b = 0.1 (1 + e)/1.5
    EXPECT_NEAR(e.velocity(index_of(e, b))[0], 0.1 * 1.5 / 1.5, 1e-3);
    EXPECT_NEAR(e.velocity(index_of(e, a))[0], 0.1 - 0.5 * 0.1, 1e-3);
}

TEST_P(EngineOf, contacts_across_the_periodic_boundary_are_contacts) {
    // The same impact inside the period and across its seam.
    std::array<double, 2> ends;
    for (const bool seam : {false, true}) {
        EngineOptions o = bare(GetParam());
        o.period_y = 12 * kRadius;
        Engine e(o);
        const double shift = seam ? 6 * kRadius : 0;
        const int a = e.add_grain({.y = 5 * kRadius + shift, .vy = 0.1, .radius = kRadius});
        // the other one is written one period back when the pair straddles the seam
        const int b = e.add_grain({.y = 7.5 * kRadius + shift - (seam ? o.period_y : 0), .radius = kRadius});
        e.advance(2000);
        ends[seam] = e.velocity(index_of(e, b))[1];
        EXPECT_NEAR(e.velocity(index_of(e, a))[1] + ends[seam], 0.1, 1e-7);
    }
    EXPECT_NEAR(ends[0], 0.075, 1e-3);  // (1 + e)/2
    EXPECT_NEAR(ends[1], ends[0], 1e-5);
}

}  // namespace
}  // namespace gradwright
