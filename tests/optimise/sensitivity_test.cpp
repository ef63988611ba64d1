// What moves a design, on a heap whose answers are known.
#include "optimise/sensitivity.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>

#include "tests/optimise/map_run.h"

namespace gradwright {
namespace {

using namespace testing_heap;

TEST(LatinHypercube, has_one_point_in_every_slice_of_every_direction) {
    const auto points = latin_hypercube(16, 5, 3);
    for (std::size_t i = 0; i < 5; ++i) {
        std::set<int> slices;
        for (const auto& p : points) slices.insert(int(std::floor((p[i] + 1) / 2 * 16)));
        EXPECT_EQ(slices.size(), 16u);
    }
}

TEST(LineFit, meets_a_line_and_knows_its_error_from_the_scatter) {
    const auto z = latin_hypercube(12, 3, 1);
    std::vector<double> y, noisy;
    for (std::size_t k = 0; k < z.size(); ++k) {
        y.push_back(0.5 + 2 * z[k][0] - z[k][2]);
        noisy.push_back(y.back() + (k % 2 ? 0.1 : -0.1));
    }
    const LineFit exact = fit_line(z, y);
    EXPECT_NEAR(exact.coefficient[0], 0.5, 1e-12);
    EXPECT_NEAR(exact.coefficient[1], 2, 1e-12);
    EXPECT_NEAR(exact.coefficient[2], 0, 1e-12);
    EXPECT_NEAR(exact.coefficient[3], -1, 1e-12);
    EXPECT_LT(exact.leave_one_out, 1e-10);
    const LineFit rough = fit_line(z, noisy);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(rough.coefficient[i], exact.coefficient[i], 3 * rough.standard_error[i]);
    EXPECT_GT(rough.leave_one_out, 0.1);  // a left-out strip is missed by more than the scatter
    EXPECT_LT(rough.leave_one_out, 0.25);
    EXPECT_THROW(fit_line(latin_hypercube(5, 3, 1), {1, 2, 3, 4, 5}), std::invalid_argument);
}

TEST(LineFit, leaves_one_out_as_a_fit_without_it_would) {
    const auto z = latin_hypercube(9, 2, 5);
    std::vector<double> y;
    for (const auto& p : z) y.push_back(p[0] * p[0] + p[1]);
    double sum = 0;
    for (std::size_t k = 0; k < z.size(); ++k) {
        auto others = z;
        auto values = y;
        others.erase(others.begin() + std::ptrdiff_t(k));
        values.erase(values.begin() + std::ptrdiff_t(k));
        const LineFit fit = fit_line(others, values);
        sum += std::pow(
            y[k] - fit.coefficient[0] - fit.coefficient[1] * z[k][0] - fit.coefficient[2] * z[k][1], 2);
    }
    EXPECT_NEAR(fit_line(z, y).leave_one_out, std::sqrt(sum / double(z.size())), 1e-12);
}

struct Case {
    Study study = coupon();
    Design design;
    SensitivityOptions options;
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
    Case() {
        study.strip_width = 0.4e-3;
        design = start_design(study);
        design.partition.points = {{0, 1.3e-3}, {3.2e-3, 0.3e-3}};
        options.samples = 16;
        options.trajectories = 4;
        options.band_plates = 200;
    }
    Sensitivity run(const Heap& heap) {
        options.run.spread = engine(heap, calls);
        return run_sensitivity(study, design, options);
    }
};

TEST(Sensitivity, labels_cost_one_map_and_shift_the_profile_as_the_plate_is_shifted) {
    Case c;
    const Sensitivity got = c.run({});
    EXPECT_EQ(got.status, "ok");
    EXPECT_EQ(c.calls->map_seeds.size(), 1u);
    EXPECT_EQ(got.outputs.size(), 8u);  // six bins, misfit, drift
    ASSERT_EQ(got.labels.size(), 6u);   // two ends, the plate's place twice, doses, the part's place
    // GI(y) moves with the plate: the slope of plate y is minus that of the profile along y
    const auto find = [&](const std::string& name) {
        for (const DimensionBudget& d : got.budget.dimensions)
            if (d.name == name) return d;
        return DimensionBudget{};
    };
    const DimensionBudget plate = find("plate y"), end = find("P1 y"), other = find("P2 y");
    EXPECT_LT(plate.slope[3], -300);
    for (std::size_t b = 1; b < 7; ++b)  // both ends together are the plate
        EXPECT_NEAR(end.slope[b] + other.slope[b], plate.slope[b], 0.06 * 1000) << b;
    EXPECT_GT(got.band.inside, 0.9);
    EXPECT_EQ(got.morris.failed + got.sobol.failed, 0);
    EXPECT_TRUE(got.effects.empty());
    EXPECT_FALSE(got.motion.empty());
}

TEST(Sensitivity, strips_find_the_input_that_turns_the_heap_and_name_those_that_failed) {
    Case c;
    c.options.strips = 24;
    Heap heap;
    heap.centre = 0.5;
    int strip = 0;
    c.options.run.spread = [&](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        Heap moved = heap;  // the dose alone decides where in the dispenser the layer comes from
        moved.centre += 2e3 * (scene.dose_height / scene.layer_thickness * 40e-6 - 120e-6);
        moved.fail_map = ++strip == 9;
        return spread(moved, *c.calls, scene, partition);
    };
    const Sensitivity got = run_sensitivity(c.study, c.design, c.options);
    EXPECT_EQ(got.strips, 23);
    ASSERT_EQ(got.failed.size(), 1u);
    EXPECT_EQ(got.failed[0].status, "jammed");
    EXPECT_EQ(got.failed[0].inputs.size(), got.motion.size());
    ASSERT_EQ(got.effects.size(), got.motion.size());
    std::size_t best = 0;
    for (std::size_t i = 0; i < got.effects.size(); ++i)
        if (got.effects[i].gi_rms > got.effects[best].gi_rms) best = i;
    EXPECT_EQ(got.motion[best].name, "design_space.dosage_factor");
    EXPECT_GT(got.effects[best].share, 0.5);
    EXPECT_LT(got.surrogate_gi_error, 0.05);
}

TEST(Sensitivity, an_interruption_keeps_the_strips_that_are_there) {
    Case c;
    c.options.strips = 24;
    std::atomic<bool> stop = false;
    c.options.run.stop = &stop;
    int strip = 0;
    c.options.run.spread = [&](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        stop = ++strip == 20;
        return spread({}, *c.calls, scene, partition);
    };
    const Sensitivity got = run_sensitivity(c.study, c.design, c.options);
    EXPECT_EQ(got.status, "interrupted");
    EXPECT_EQ(got.strips, 19);  // the first spread is the design's own map
    EXPECT_EQ(got.effects.size(), got.motion.size());
}

TEST(Sensitivity, plates_are_spread_with_both_powders_on_beds_of_their_own) {
    Case c;
    c.options.spread_plates = 20;
    const Sensitivity got = c.run({});
    ASSERT_EQ(got.plates.size(), 20u);
    EXPECT_EQ(std::set(c.calls->full_seeds.begin(), c.calls->full_seeds.end()).size(), 20u);
    int inside = 0, bins = 0;
    for (const PlateSpread& plate : got.plates) {
        inside += plate.inside;
        bins += plate.bins;
    }
    EXPECT_EQ(bins, 120);
    EXPECT_GE(inside, 0.85 * bins);
}

TEST(Sensitivity, a_map_that_fails_is_told_and_not_reckoned_with) {
    Case c;
    Heap heap;
    heap.fail_map = true;
    const Sensitivity got = c.run(heap);
    EXPECT_EQ(got.status, "jammed");
    EXPECT_FALSE(got.reason.empty());
    EXPECT_TRUE(got.budget.dimensions.empty());
    c.design.partition.points.clear();
    EXPECT_THROW(c.run({}), std::invalid_argument);
}

}  // namespace
}  // namespace gradwright
