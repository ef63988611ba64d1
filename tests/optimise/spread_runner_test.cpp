// Spreads of a map side by side: the same bits as one after the other, one account, one voice.
#include "optimise/spread_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "tests/dem/tiny_scene.h"

namespace gradwright {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Told {
    std::string stage;
    double fraction;
};

TEST(SlowestProgress, is_that_of_the_run_behind_in_stage_or_fraction_until_it_ends) {
    SlowestProgress two(2);
    EXPECT_EQ(two.tell(0, "pack", 0.5).stages, 0);  // the other has not begun
    EXPECT_EQ(two.tell(1, "pack", 0.2).fraction, 0.2);
    EXPECT_EQ(two.tell(1, "pack", 0.7).fraction, 0.5);
    EXPECT_EQ(two.tell(1, "spread", 0.1).stage, "pack");
    const auto behind = two.tell(0, "spread", 0.3);
    EXPECT_EQ(behind.stage, "spread");
    EXPECT_EQ(behind.fraction, 0.1);
    two.end(1);
    EXPECT_EQ(two.tell(0, "spread", 0.4).fraction, 0.4);
}

TEST(SpreadMaps, side_by_side_are_the_same_bits_as_one_after_the_other) {
    const std::vector<Scene> scenes = {tiny_scene(3), tiny_scene(5), tiny_scene(7)};
    const std::string folder = ::testing::TempDir() + "/spread_maps_side_by_side";
    std::filesystem::remove_all(folder);
    std::vector<SpreadResult> got[2];
    std::vector<Told> told;
    for (const int threads : {1, 2}) {
        RunOptions options;
        options.threads = threads;
        if (threads == 2) {
            options.spread_folder = folder;
            options.progress = [&told](const std::string& stage, double fraction) {
                told.push_back({stage, fraction});
            };
        }
        SpreadRunner runner(options);
        const auto begun = std::chrono::steady_clock::now();
        got[threads - 1] = runner.spread_maps(scenes);
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        EXPECT_EQ(runner.seconds_saved, 0);
        double seconds = 0;  // two at once on half the machine each
        for (const SpreadResult& one : got[threads - 1]) {
            seconds += one.seconds;
            EXPECT_EQ(one.seconds, one.seconds_cold);
            EXPECT_LT(one.bed.seconds, one.seconds);
        }
        EXPECT_LE(seconds, wall);
    }
    ASSERT_EQ(got[0].size(), 3u);
    ASSERT_EQ(got[1].size(), 3u);
    for (int k = 0; k < 3; ++k) {
        EXPECT_TRUE(got[0][k].health.ok()) << got[0][k].health.reason;
        EXPECT_EQ(got[0][k].state_hash, got[1][k].state_hash);
        EXPECT_EQ(got[0][k].steps, got[1][k].steps);
        EXPECT_EQ(got[0][k].layer.deposit_y, got[1][k].layer.deposit_y);
    }
    EXPECT_NE(got[0][0].state_hash, got[0][1].state_hash);

    // one voice for both; within a stage nothing goes backwards
    ASSERT_FALSE(told.empty());
    bool pair = false, third = false;
    for (std::size_t k = 0; k < told.size(); ++k) {
        pair = pair || told[k].stage.starts_with("map spreads 1 and 2: ");
        third = third || told[k].stage.starts_with("map spread 3: ");
        if (k > 0 && told[k].stage == told[k - 1].stage) {
            EXPECT_GE(told[k].fraction, told[k - 1].fraction);
        }
    }
    EXPECT_TRUE(pair);
    EXPECT_TRUE(third);

    // kept as they ended, each by itself
    RunOptions options;
    options.threads = 2;
    options.spread_folder = folder;
    options.resume = true;
    SpreadRunner again(options);
    const std::vector<SpreadResult> kept = again.spread_maps(scenes);
    ASSERT_EQ(kept.size(), 3u);
    double cost = 0;
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(kept[k].state_hash, got[1][k].state_hash);
        EXPECT_EQ(kept[k].seconds_cold, got[1][k].seconds_cold);
        cost += kept[k].seconds_cold;
    }
    EXPECT_DOUBLE_EQ(again.seconds_saved, cost);
    std::filesystem::remove_all(folder);
}

TEST(SpreadMaps, one_that_cannot_be_spread_is_the_last_however_many_run_at_once) {
    std::vector<Scene> scenes = {tiny_scene(3), tiny_scene(5), tiny_scene(7)};
    scenes[0].gap = -1e-6;
    for (const int threads : {1, 2}) {
        RunOptions options;
        options.threads = threads;
        SpreadRunner runner(options);
        const std::vector<SpreadResult> got = runner.spread_maps(scenes);
        ASSERT_EQ(got.size(), 1u);
        EXPECT_EQ(got[0].health.status, "invalid");
        EXPECT_THAT(got[0].health.reason, HasSubstr("gap"));
    }
}

TEST(SpreadMaps, nothing_begins_after_a_stop) {
    const std::atomic<bool> stop{true};
    RunOptions options;
    options.threads = 2;
    options.stop = &stop;
    SpreadRunner runner(options);
    const std::vector<SpreadResult> got = runner.spread_maps({tiny_scene(3), tiny_scene(5)});
    ASSERT_EQ(got.size(), 1u);
    EXPECT_EQ(got[0].health.status, "interrupted");
    EXPECT_THAT(got[0].health.reason, StartsWith("stopped before map spread 1"));
}

}  // namespace
}  // namespace gradwright
