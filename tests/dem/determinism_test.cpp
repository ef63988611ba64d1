// The same bits on any number of threads, and after a run was saved at any step and restored.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dem/engine.h"
#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kRadius = 20e-6;

EngineOptions powder(Precision precision, int threads) {
    EngineOptions o;
    o.materials = {{"metal", 8000, 2e7, 0.3, ""}, {"light", 4000, 2e7, 0.3, ""}};
    o.interaction.work_of_adhesion = 2e-4;
    o.time_step = 3e-7;
    o.gravity = {0, 0, -4000};  // falls into contact within a few hundred steps
    o.period_y = 12 * kRadius;
    o.precision = precision;
    o.sleep = true;
    o.threads = threads;
    return o;
}

/// A floor, and a slow blade that ploughs through the pile: grains at rest, in flight and asleep at once.
void add_machine(Engine& engine) {
    Body floor;
    engine.add_body(floor);
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x0 = -1;
    blade.x1 = -2 * kRadius;
    blade.z0 = 2 * kRadius;
    blade.z1 = 1;
    blade.speed_x = 0.1;
    engine.add_body(blade);
}

/// Loosely stacked grains of two materials and sizes within a factor of two; more than 8 x 200, below which
/// fewer threads than asked for are used.
void add_grains(Engine& engine, int count, int length = 40) {
    Random random(5);
    for (int k = 0; k < count; ++k)
        engine.add_grain({.x = kRadius * (2.1 * (k / 5 % length) + 0.1 * random.uniform()),
                          .y = kRadius * (2.3 * (k % 5) + 0.1 * random.uniform()),
                          .z = kRadius * (1.1 + 2.1 * (k / (5 * length))),
                          .vx = 0.05 * random.normal(),
                          .radius = kRadius * (0.6 + 0.4 * random.uniform()),
                          .material = k % 2});
}

constexpr int kGrains = 1800;
constexpr long kSteps = 900;

std::string whole_run(Precision precision, int threads, bool beyond_cache = false) {
    EngineOptions o = powder(precision, threads);
    if (beyond_cache) o.cached_grains = 0;
    Engine engine(o);
    add_machine(engine);
    add_grains(engine, kGrains);
    engine.start_bodies();
    EXPECT_EQ(engine.advance(kSteps), kSteps) << engine.failed();
    EXPECT_GT(engine.contacts(), 500u);
    return fmt::format("{}, {} late", engine.state_hash(), engine.late_steps());
}

class Determinism : public testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(Law, Determinism, testing::Values(Precision::double_law, Precision::single_law),
                         [](const auto& info) {
                             return info.param == Precision::double_law ? "double" : "single";
                         });

TEST_P(Determinism, one_two_three_and_eight_threads_leave_the_same_bits) {
    const std::string one = whole_run(GetParam(), 1);
    for (const int threads : {2, 3, 8})
        EXPECT_EQ(whole_run(GetParam(), threads), one) << threads << " threads";
}

TEST_P(Determinism, a_bed_beyond_the_cache_has_the_same_bits_on_any_number_of_threads) {
    // several steps at once on one thread; too short a bed for several threads to follow each other, so that
    // they have a share each and ask the memory ahead
    const std::string one = whole_run(GetParam(), 1, true);
    for (const int threads : {2, 3, 8})
        EXPECT_EQ(whole_run(GetParam(), threads, true), one) << threads << " threads";
}

TEST_P(Determinism, steps_taken_at_once_leave_the_same_bits) {
    // a long bed, so that several threads can follow each other through it
    constexpr int kLength = 800, kMany = 8000;
    const auto run = [](int threads, int cached_grains, int steps_at_once) {
        EngineOptions o = powder(GetParam(), threads);
        o.cached_grains = cached_grains;
        o.gravity = {0, 0, -400};  // no list of pairs may run out within a few steps (late_steps)
        o.skin = 4 * kRadius;      // and it must last for long, or several threads take a share each
        o.near_skin = 2 * kRadius;
        Engine engine(o);
        add_machine(engine);
        add_grains(engine, kMany, kLength);
        engine.start_bodies();
        std::string hashes;
        for (const long portion : {1L, 2L, 1497L}) {
            EXPECT_EQ(engine.advance(portion), portion) << engine.failed();
            hashes += engine.state_hash();
        }
        EXPECT_EQ(engine.steps_at_once(), steps_at_once) << threads << " threads";
        EXPECT_GT(engine.contacts(), 500u);
        EXPECT_EQ(engine.late_steps(), 0);
        const BodyForce floor = engine.force_on_body(0);
        return fmt::format("{} {} {}", hashes, floor.x, floor.z);
    };
    const std::string by_step = run(1, kMany, 1);
    EXPECT_EQ(run(1, 0, 4), by_step);
    EXPECT_EQ(run(2, 0, 4), by_step);
    EXPECT_EQ(run(3, 0, 3), by_step);
    EXPECT_EQ(run(8, 0, 1), by_step);  // by shares: so many would mostly wait
}

TEST_P(Determinism, steps_for_which_the_end_of_a_list_was_seen_too_late_are_counted) {
    // A fast grain, which has the longest reach, strikes a light one at rest, which has a short one and
    // leaves twice as fast: its reach is used up eight times as fast as any before.
    const auto late_steps = [](int cached_grains, double gap, int threads) {
        EngineOptions o = powder(GetParam(), threads);
        o.cached_grains = cached_grains;
        o.materials[0].density = 4e5;
        o.interaction.work_of_adhesion = 0;
        o.interaction.coefficient_of_restitution = 1;
        o.gravity = {0, 0, 0};
        o.sleep = false;
        o.time_step = 1.2e-6;  // a collision of a few steps
        o.skin = 4 * kRadius;
        o.near_skin = 0.5 * kRadius;
        Engine engine(o);
        const double speed = 0.016 * kRadius / o.time_step;
        for (int k = 0; k < 500; ++k)
            engine.add_grain({.x = 10 * kRadius * k, .y = 0, .z = 0, .radius = kRadius, .material = 1});
        engine.add_grain(
            {.x = -2 * kRadius - gap, .y = 0, .z = 0, .vx = speed, .radius = kRadius, .material = 0});
        engine.advance(200);
        EXPECT_EQ(engine.failed(), "");
        return engine.late_steps();
    };
    long late = 0;
    for (double gap = 0.05 * kRadius; gap < kRadius; gap += 0.05 * kRadius) {
        const long one = late_steps(0, gap, 1);
        EXPECT_EQ(late_steps(0, gap, 2), one);
        EXPECT_EQ(late_steps(1000, gap, 1), 0);
        late += one;
    }
    EXPECT_GT(late, 0);
}

TEST_P(Determinism, threads_whose_grains_never_meet_end_every_run_of_steps_together) {
    // without pairs one barrier stands between two steps: a thread that judged by its neighbour's next step
    // would leave the others waiting
    std::string hash[2];
    for (const int threads : {1, 8}) {
        EngineOptions o = powder(GetParam(), threads);
        o.period_y = 0;
        o.gravity = {0, 0, 0};
        Engine engine(o);
        Random random(3);
        for (int k = 0; k < kGrains; ++k)
            engine.add_grain({.x = kRadius * 10 * (k % 100),
                              .y = kRadius * 10 * (k / 100),
                              .z = 0,
                              .vx = 0.2 * random.normal(),
                              .vy = 0.2 * random.normal(),
                              .radius = kRadius});
        engine.advance(4000);
        EXPECT_EQ(engine.failed(), "");
        hash[threads > 1] = engine.state_hash();
    }
    EXPECT_EQ(hash[0], hash[1]);
}

/// A bed far wider than it is long, its period `period` [m] or open at both sides: ordered along y, folded
/// where it is periodic.
std::string wide_run(Precision precision, double period, int threads) {
    EngineOptions o = powder(precision, threads);
    o.period_y = period;
    Engine engine(o);
    engine.add_body({});  // a floor
    Random random(11);
    for (int k = 0; k < kGrains; ++k)
        engine.add_grain({.x = kRadius * (2.1 * (k % 5) + 0.1 * random.uniform()),
                          .y = kRadius * (2.1 * (k / 5 % 90) + 0.1 * random.uniform()),
                          .z = kRadius * (1.1 + 2.1 * (k / 450)),
                          .vy = 0.05 * random.normal(),
                          .radius = kRadius * (0.6 + 0.4 * random.uniform()),
                          .material = k % 2});
    for (int portion = 0; portion < 4; ++portion) {
        engine.advance(150);
        const State& s = engine.state();
        std::size_t sure = 0;
        for (std::size_t i = 0; i < s.size(); ++i)
            for (std::size_t j = i + 1; j < s.size(); ++j) {
                double dy = s.y[i] - s.y[j];
                if (period > 0) dy -= period * std::nearbyint(dy / period);
                const double dx = s.x[i] - s.x[j], dz = s.z[i] - s.z[j], sum = s.radius[i] + s.radius[j];
                sure += dx * dx + dy * dy + dz * dz < sum * sum * (1 - 1e-9);
            }
        engine.advance(1);
        EXPECT_EQ(engine.failed(), "");
        EXPECT_GE(engine.contacts(), sure);  // and some that adhesion holds
        if (portion == 3) {
            EXPECT_GT(sure, 500u);
            EXPECT_LT(engine.contacts(), sure + sure / 3);
        }
    }
    return engine.state_hash();
}

TEST_P(Determinism, a_bed_ordered_along_its_width_has_every_contact_and_the_same_bits) {
    for (const double period : {0.0, 2.1 * 90 * kRadius, 2.1 * 91.3 * kRadius}) {
        const std::string one = wide_run(GetParam(), period, 1);
        for (const int threads : {2, 3, 8})
            EXPECT_EQ(wide_run(GetParam(), period, threads), one)
                << period << " m, " << threads << " threads";
    }
}

TEST_P(Determinism, a_run_saved_at_any_step_and_restored_goes_on_with_the_same_bits) {
    Engine straight(powder(GetParam(), 1));
    add_machine(straight);
    add_grains(straight, kGrains);
    straight.start_bodies();
    std::vector<std::string> saved;
    const std::vector<long> at = {0, 1, 7, 133, 601, 899, kSteps};
    for (const long step : at) {
        straight.advance(step - straight.steps());
        saved.push_back(straight.save());
    }
    ASSERT_EQ(straight.failed(), "");
    for (std::size_t k = 0; k < at.size(); ++k) {
        Engine later(powder(GetParam(), 2));
        add_machine(later);
        later.restore(saved[k]);
        EXPECT_EQ(later.steps(), at[k]);
        for (const long step : at)  // in the same portions: the bodies' clock is summed portion by portion
            if (step > at[k]) later.advance(step - later.steps());
        EXPECT_EQ(later.state_hash(), straight.state_hash()) << "saved at step " << at[k];
        EXPECT_EQ(later.contacts(), straight.contacts());
        EXPECT_EQ(later.grain_steps(), straight.grain_steps());
        EXPECT_EQ(later.force_on_body(0).z, straight.force_on_body(0).z);
    }
}

TEST_P(Determinism, a_run_in_which_bodies_and_grains_were_moved_is_restored_and_goes_on_with_the_same_bits) {
    const auto moved = [](const Engine& engine) {
        Body floor = engine.bodies()[0];
        floor.offset -= 0.5 * kRadius;
        return floor;
    };
    std::string hash[3];
    for (const int threads : {1, 2, 3}) {
        Engine straight(powder(GetParam(), threads));
        add_machine(straight);
        add_grains(straight, kGrains);
        straight.start_bodies();
        straight.advance(400);
        // between two passes: all sinks with the floor, the blade goes back
        straight.stop_bodies();
        straight.start_bodies();
        const std::size_t contacts = straight.contacts();
        EXPECT_EQ(straight.body_shift_x(1), 0);
        straight.move_body(1, straight.bodies()[1], false);
        straight.move_body(0, moved(straight), true);
        for (std::size_t i = 0; i < straight.state().size(); ++i) straight.state().z[i] -= 0.5 * kRadius;
        straight.wake_all();
        straight.advance(1);
        EXPECT_NEAR(double(straight.contacts()), double(contacts), 0.05 * double(contacts));
        straight.advance(100);
        const std::string saved = straight.save();
        straight.advance(200);
        ASSERT_EQ(straight.failed(), "");

        Engine later(powder(GetParam(), 2));
        add_machine(later);
        EXPECT_THROW(later.restore(saved), std::invalid_argument) << "the floor does not stand there";
        later.move_body(0, moved(later), true);
        later.restore(saved);
        later.advance(200);
        EXPECT_EQ(later.state_hash(), straight.state_hash());
        hash[threads - 1] = straight.state_hash();
    }
    EXPECT_EQ(hash[0], hash[1]);
    EXPECT_EQ(hash[0], hash[2]);
}

TEST(Checkpoint, of_another_run_cut_short_or_damaged_is_refused) {
    Engine engine(powder(Precision::single_law, 1));
    add_machine(engine);
    add_grains(engine, 20);
    engine.advance(5);
    const std::string good = engine.save(), before = engine.state_hash();
    const auto reason = [](Engine& onto, const std::string& bytes) {
        try {
            onto.restore(bytes);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_EQ(reason(engine, good), "accepted");
    EXPECT_THAT(reason(engine, ""), testing::HasSubstr("no saved run"));
    EXPECT_THAT(reason(engine, good.substr(0, good.size() - 9)), testing::HasSubstr("damaged"));
    std::string flipped = good;
    flipped[good.size() / 2] ^= 1;
    EXPECT_THAT(reason(engine, flipped), testing::HasSubstr("damaged"));
    EngineOptions other = powder(Precision::single_law, 1);
    other.interaction.static_friction = 0.1;
    Engine stranger(other);
    add_machine(stranger);
    EXPECT_THAT(reason(stranger, good), testing::HasSubstr("other options"));
    EXPECT_EQ(engine.state_hash(), before);  // a refusal changes nothing
}

}  // namespace
}  // namespace gradwright
