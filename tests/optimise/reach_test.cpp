// What can be reached, on heaps whose transport is known in closed form.
#include "optimise/reach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "optimise/evaluation.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;
using testing::Contains;
using testing::HasSubstr;

struct Outcome {
    Reach reach;
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
};
ReachOptions coarse() {
    ReachOptions options;
    options.grid = 4;
    options.resolution = 0.1e-3;
    return options;
}
Outcome run(const Study& study, const Heap& heap, ReachOptions options = coarse()) {
    Outcome outcome;
    options.run.spread = engine(heap, outcome.calls);
    outcome.reach = run_reach(study, options);
    return outcome;
}

/// A heap that lays every x alike needs no more than a straight curve; short fits keep the tests short.
Study sharp() {
    Study study = coupon();
    study.design_space.knots = 2;
    return study;
}
Heap quiet() {
    Heap heap;
    heap.turn = 0;
    return heap;
}

const ReachPoint* point_beyond(const ReachScan& scan, double value) {
    const ReachPoint* found = nullptr;
    for (const ReachPoint& p : scan.points)
        if (p.value < value - 1e-12) found = &p;
    return found;
}

/// rms distance, over the bins that count, of a ramp from the steepest profile that lateral scatter allows:
/// a step blurred by a normal distribution.
double blurred_step_misfit(const Study& study, double sigma, double width) {
    const double centre = 0.5 * study.dispenser_width;
    const Target ramp = linear_target(centre - 0.5 * width, 0, centre + 0.5 * width, 1);
    const std::vector<double> weight = bin_weights(study);
    std::vector<double> residual(weight.size());
    for (int b = 0; b < study.bins.count; ++b) {
        double mean = 0;
        constexpr int kParts = 400;
        for (int i = 0; i < kParts; ++i) {
            const double y = study.bins.low(b) + (i + 0.5) / kParts * study.bins.width;
            mean += 0.5 * std::erfc(-(y - centre) / sigma * std::sqrt(0.5)) / kParts;
        }
        residual[b] = mean - ramp.bin_mean(study.bins.low(b), study.bins.low(b) + study.bins.width);
    }
    return norm_of(Norm::rmse, residual, weight);
}

TEST(Reach, the_narrowest_ramp_is_where_lateral_scatter_blurs_a_step_by_the_tolerance) {
    const Study study = sharp();
    Heap heap = quiet();
    heap.sigma_y = 220e-6;
    const Outcome got = run(study, heap, {});  // the resolution of a user
    const Reach& reach = got.reach;
    ASSERT_EQ(reach.status, "ok") << reach.reason;
    // truth: the width at which the steepest profile is off by the tolerance
    double narrow = 0.2e-3, wide = 1.2e-3;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (narrow + wide);
        (blurred_step_misfit(study, heap.sigma_y, middle) > study.objective.tolerance ? narrow : wide) =
            middle;
    }
    ASSERT_GT(narrow, 0.3e-3);
    // the bounds of a noisy map lie a little inside
    EXPECT_GT(reach.ramp.low, narrow - reach.ramp.resolution);
    EXPECT_LT(reach.ramp.low, narrow + 2 * reach.ramp.resolution + 0.05e-3);
    EXPECT_EQ(reach.ramp.low_limit, ReachLimit::profile);
    const ReachPoint* beyond = point_beyond(reach.ramp, reach.ramp.low);
    ASSERT_NE(beyond, nullptr);
    EXPECT_FALSE(beyond->reachable);
    EXPECT_LE(reach.ramp.low - beyond->value, reach.ramp.resolution * 1.001);
    // a full 1.2 mm ramp takes the whole window of six bins
    EXPECT_EQ(reach.bins, 6);
    EXPECT_DOUBLE_EQ(reach.window_low, 0.2e-3);
    EXPECT_DOUBLE_EQ(reach.window_high, 1.4e-3);
    EXPECT_DOUBLE_EQ(reach.ramp.high, 1.2e-3);
    EXPECT_EQ(reach.ramp.high_limit, ReachLimit::margins);
    // the study's own ramp of 0.8 mm is moved until it touches the last bins that count
    EXPECT_TRUE(reach.own.reachable);
    EXPECT_EQ(reach.own.limit, ReachLimit::none);
    EXPECT_DOUBLE_EQ(reach.shift.ramp_width, 0.8e-3);
    EXPECT_NEAR(reach.shift.low, 0.6e-3, 1e-9);
    EXPECT_NEAR(reach.shift.high, 1.0e-3, 1e-9);
    EXPECT_EQ(reach.shift.low_limit, ReachLimit::margins);
    // one map, as the design would make it
    ASSERT_EQ(got.calls->map_seeds.size(), 1u);
    EXPECT_EQ(got.calls->map_seeds[0], map_seed(study.seed, 0));
    EXPECT_TRUE(got.calls->full_seeds.empty());
}

TEST(Reach, with_little_scatter_only_the_bins_bound_the_narrowest_and_the_steepest) {
    const Reach reach = run(sharp(), quiet()).reach;
    EXPECT_DOUBLE_EQ(reach.ramp.low, 0.2e-3);
    EXPECT_EQ(reach.ramp.low_limit, ReachLimit::bin_width);
    EXPECT_DOUBLE_EQ(reach.sigmoid.low, 0.2e-3);
    EXPECT_EQ(reach.sigmoid.low_limit, ReachLimit::bin_width);
    EXPECT_FALSE(reach.ramp.gaps);
}

TEST(Reach, a_heap_that_lays_last_in_first_out_reaches_steep_ramps_only_and_drift_binds) {
    Study study = sharp();
    study.footprint.x_low = 0;
    Heap heap = quiet();
    heap.turn = -0.8;
    heap.mixing = 0.1;
    const Reach reach = run(study, heap).reach;
    // a step holds at every origin: it cannot drift
    EXPECT_DOUBLE_EQ(reach.ramp.low, 0.2e-3);
    EXPECT_LT(reach.ramp.high, 0.8e-3);
    EXPECT_EQ(reach.ramp.high_limit, ReachLimit::x_drift);
    EXPECT_FALSE(reach.own.reachable);
    EXPECT_EQ(reach.own.limit, ReachLimit::x_drift);
    EXPECT_GT(reach.own.drift.debiased, study.objective.x_drift_tolerance);
    // its own ramp of 0.8 mm is out of reach, so one from the middle of what is reachable is moved
    EXPECT_NEAR(reach.shift.ramp_width, 0.5 * (reach.ramp.low + reach.ramp.high), 1e-12);
}

TEST(Reach, an_unreachable_target_keeps_its_best_design_and_zones_bind_it_alone) {
    Study study = sharp();
    study.target = aba_target(1, 0, 0.45e-3, 0.55e-3, 1.05e-3, 1.15e-3);
    const Reach reach = run(study, quiet()).reach;
    EXPECT_FALSE(reach.own.reachable);
    EXPECT_EQ(reach.own.limit, ReachLimit::profile);
    EXPECT_GE(reach.own.design.partition.points.size(), 2u);
    EXPECT_GT(reach.own.misfit.interval_low, study.objective.tolerance);
    // one side of the band alone is a ramp, which the heap can lay
    study.target.zones = {{0.8e-3, 1.6e-3, 0}};
    const Reach half = run(study, quiet()).reach;
    EXPECT_TRUE(half.own.reachable) << half.own.misfit.interval_high;
    EXPECT_DOUBLE_EQ(half.ramp.high, 1.2e-3);
    EXPECT_FALSE(half.rises);  // the band's first side falls, and so do the ramps that are tried
    EXPECT_GT(half.ramp.points.front().target.gi0, half.ramp.points.front().target.gi1);
}

TEST(Reach, too_few_grains_bind_by_noise) {
    Heap heap = quiet();
    heap.grains_per_m2 /= 20;
    const Reach reach = run(sharp(), heap).reach;
    EXPECT_FALSE(reach.own.reachable);
    EXPECT_EQ(reach.own.limit, ReachLimit::noise);
    EXPECT_TRUE(std::isnan(reach.ramp.low) || reach.ramp.low_limit == ReachLimit::noise ||
                reach.ramp.low_limit == ReachLimit::bin_width);
}

TEST(Reach, grid_and_resolution_are_obeyed_and_every_point_is_kept_in_order) {
    Heap heap = quiet();
    heap.sigma_y = 220e-6;
    ReachOptions options;
    options.grid = 3;
    options.resolution = 0.3e-3;
    std::vector<double> fractions;
    options.run.progress = [&](const std::string& stage, double fraction) {
        if (stage == "reach") fractions.push_back(fraction);
    };
    const Reach reach = run(sharp(), heap, options).reach;
    int grid = 0;
    for (std::size_t i = 0; i < reach.ramp.points.size(); ++i) {
        grid += reach.ramp.points[i].on_grid;
        if (i > 0) {
            EXPECT_GT(reach.ramp.points[i].value, reach.ramp.points[i - 1].value);
        }
    }
    EXPECT_EQ(grid, 3);
    EXPECT_EQ(reach.ramp.points.size(), 4u);  // 0.5 mm between grid points: halved once
    ASSERT_FALSE(fractions.empty());
    EXPECT_EQ(fractions.front(), 0);
    for (std::size_t i = 1; i < fractions.size(); ++i) EXPECT_GT(fractions[i], fractions[i - 1]);
    EXPECT_LT(fractions.back(), 1);
}

TEST(Reach, a_map_that_fails_and_a_stop_are_told) {
    Heap heap;
    heap.fail_map = true;
    const Reach failed = run(sharp(), heap).reach;
    EXPECT_EQ(failed.status, "jammed");
    EXPECT_EQ(failed.reason, "a grain sits in the nip");
    EXPECT_TRUE(failed.ramp.points.empty());
    std::atomic<bool> stop = false;
    ReachOptions options;
    options.run.stop = &stop;
    options.run.progress = [&](const std::string& stage, double) { stop = stop || stage == "reach"; };
    const Reach stopped = run(sharp(), {}, options).reach;
    EXPECT_EQ(stopped.status, "interrupted");
    EXPECT_FALSE(stopped.own.reachable);
    EXPECT_TRUE(stopped.ramp.points.empty());
}

TEST(Reach, free_motion_and_unlike_powders_are_remarked) {
    Study study = sharp();
    study.design_space.land.free = true;
    study.scene.powder[1].material.density *= 0.5;
    study.objective.min_coverage = 1;
    ReachOptions options;
    options.grid = 3;
    Heap thin = quiet();
    thin.grains_per_m2 /= 20;
    const Reach reach = run(study, thin, options).reach;
    EXPECT_THAT(reach.remarks, Contains(HasSubstr("stay at their start")));
    EXPECT_THAT(reach.remarks, Contains(HasSubstr("density")));
    EXPECT_THAT(reach.remarks, Contains(HasSubstr("coverage")));
}

}  // namespace
}  // namespace gradwright
