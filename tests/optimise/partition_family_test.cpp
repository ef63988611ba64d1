#include "optimise/partition_family.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "optimise/kinematic_evaluator.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using testing_heap::coupon;

constexpr double kLength = 3.2e-3, kWidth = 1.6e-3;

std::vector<double> random_point(const PartitionFamily& family, Random& random) {
    std::vector<double> p(family.size());
    for (std::size_t i = 0; i < p.size(); ++i)
        p[i] = family.low()[i] + random.uniform() * (family.high()[i] - family.low()[i]);
    return p;
}

TEST(PartitionFamily, knots_stay_ordered_and_a_segment_apart_anywhere_in_the_box) {
    DesignSpace space;
    space.monotone = false;
    for (const int knots : {2, 3, 5, 12}) {
        space.knots = knots;
        const PartitionFamily family(space, kLength, kWidth, {});
        Random random(7);
        for (int trial = 0; trial < 200; ++trial) {
            const auto points = family.curve(random_point(family, random)).points;
            ASSERT_EQ(points.size(), std::size_t(knots));
            EXPECT_DOUBLE_EQ(points.front().x, 0);
            EXPECT_DOUBLE_EQ(points.back().x, kLength);
            for (std::size_t k = 0; k < points.size(); ++k) {
                EXPECT_GE(points[k].y, -0.5 * kWidth - 1e-12);
                EXPECT_LE(points[k].y, 1.5 * kWidth + 1e-12);
                if (k > 0) {
                    EXPECT_GE(points[k].x - points[k - 1].x, space.minimum_segment * (1 - 1e-9));
                }
            }
        }
    }
}

TEST(PartitionFamily, monotone_polyline_never_turns_back_and_keeps_its_bounds_anywhere_in_the_box) {
    const DesignSpace space;
    for (const bool rising : {false, true}) {
        const PartitionFamily family(space, kLength, kWidth, {true, rising});
        Random random(11);
        for (int trial = 0; trial < 200; ++trial) {
            const auto points = family.curve(random_point(family, random)).points;
            for (std::size_t k = 1; k < points.size(); ++k) {
                EXPECT_GE((rising ? 1 : -1) * (points[k].y - points[k - 1].y), 0);
                EXPECT_GE(points[k].y, -0.5 * kWidth - 1e-12);
                EXPECT_LE(points[k].y, 1.5 * kWidth + 1e-12);
            }
        }
    }
}

TEST(PartitionFamily, more_knots_than_segments_fit_are_refused_with_the_number_that_fits) {
    DesignSpace space;
    space.knots = 40;  // 39 segments of 82 um, minimum 100 um: 33 knots fit
    try {
        PartitionFamily family(space, kLength, kWidth, {});
        FAIL() << "accepted";
    } catch (const std::invalid_argument& problem) {
        EXPECT_NE(std::string(problem.what()).find("at most 33 knots"), std::string::npos) << problem.what();
    }
}

TEST(PartitionFamily, straight_parameters_are_angle_and_offset_of_the_line_through_the_centre) {
    DesignSpace space;
    space.family = Family::straight;
    const PartitionFamily family(space, kLength, kWidth, {});
    const double angle = -20 * std::numbers::pi / 180, offset = 0.1e-3;
    const PartitionCurve curve = family.curve(std::vector<double>{angle, offset / kWidth});
    const PartitionCurve expected = straight_partition(kLength, kWidth, angle, offset);
    for (const double x : {0.1e-3, 1.6e-3, 3.0e-3})
        for (const double y : {0.05e-3, 0.8e-3, 1.5e-3})
            EXPECT_NEAR(curve.signed_distance(x, y), expected.signed_distance(x, y), 1e-12);
    EXPECT_NEAR(family.named(std::vector<double>{angle, 0.0}).front().second, -20, 1e-12);
}

TEST(PartitionFamily, mirrored_curve_has_a_below) {
    const DesignSpace space;
    const std::vector<double> p = {0.5, 0.1, 0.1, 0.1, 0.1, 0, 0, 0};
    const PartitionFamily above(space, kLength, kWidth, {true, false}),
        below(space, kLength, kWidth, {false, false});
    EXPECT_TRUE(above.curve(p).on_side_a(1.6e-3, 5e-3));
    EXPECT_FALSE(below.curve(p).on_side_a(1.6e-3, 5e-3));
    EXPECT_TRUE(below.curve(p).on_side_a(1.6e-3, -5e-3));
}

TEST(PartitionFamily, fit_of_a_curve_of_the_family_gives_the_curve_back) {
    const DesignSpace space;
    const PartitionFamily family(space, kLength, kWidth, {});
    const std::vector<double> p = {0.8, 0.05, 0.2, 0.1, 0.3, 0, 0, 0};
    std::vector<double> x, y;
    family.knots_of(p.data(), x, y);
    std::vector<PlanPoint> samples;
    for (int i = 0; i <= 800; ++i) {
        const double at = kLength * i / 800;
        const int k = std::min(3, int(at / (kLength / 4)));
        samples.push_back({at, y[k] + (y[k + 1] - y[k]) * (at - x[k]) / (x[k + 1] - x[k])});
    }
    const std::vector<double> back = family.fit_samples(samples);
    for (std::size_t i = 0; i < p.size(); ++i)
        EXPECT_NEAR(back[i], p[i], 0.02);  // the weak pull to straightness
}

TEST(PartitionFamily, closed_form_of_a_linear_ramp_over_uniform_origins_is_the_diagonal) {
    // g = (y - 0.4) / 0.8, x_p = L_d (1 - g): y_p(x) = 1.2 - 0.8 x / L_d [mm]
    const Study study = coupon();
    const auto curve = closed_form_curve(study, {true, false}, [](double share) { return share * kLength; });
    for (const PlanPoint& point : curve) EXPECT_NEAR(point.y, 1.2e-3 - 0.8e-3 * point.x / kLength, 5e-6);
}

TEST(PartitionFamily, closed_form_reproduces_each_target_in_the_fully_mixed_limit) {
    // Without lateral blur the kinematic picture turns the closed form into the target itself, for every
    // orientation.
    for (const bool falls : {false, true})
        for (const bool rising : {false, true}) {
            Study study = coupon();
            study.scene.powder[0].size.d50 = study.scene.powder[1].size.d50 = 1e-9;  // sigma_y -> 0
            study.target = falls ? linear_target(0.4e-3, 1, 1.2e-3, 0) : sigmoid_target(0.9e-3, 0.4e-3);
            study.design_space.knots = 9;
            ASSERT_EQ(target_rises(study), !falls);
            const PartitionFamily family(study.design_space, kLength, kWidth, {!falls, rising});
            const auto p = family.fit_samples(
                closed_form_curve(study, family.orientation(), [](double share) { return share * kLength; }));
            Design design = start_design(study);
            design.partition = family.curve(p);
            const Evaluation evaluation = KinematicEvaluator(study).evaluate(design, 1);
            for (int bin = 1; bin < 7; ++bin)
                EXPECT_NEAR(evaluation.profile.gi[bin],
                            study.target.bin_mean(bin * 0.2e-3, (bin + 1) * 0.2e-3), 0.03)
                    << "falls " << falls << " rising " << rising << " bin " << bin;
        }
}

TEST(Seeds, map_and_confirmation_seeds_never_meet_and_are_exact_in_json) {
    std::set<std::uint64_t> map, confirmation;
    for (std::uint64_t study = 0; study < 50; ++study)
        for (int i = 0; i < 50; ++i) {
            map.insert(map_seed(study, i));
            confirmation.insert(confirmation_seed(study, i));
            EXPECT_LT(confirmation_seed(study, i), 1ULL << 53);
        }
    EXPECT_EQ(map.size(), 2500u);
    EXPECT_EQ(confirmation.size(), 2500u);
    for (const std::uint64_t seed : map) EXPECT_EQ(confirmation.count(seed), 0u);
}

TEST(Scene, dose_height_land_and_headspace_follow_the_design) {
    const Study study = coupon();
    Design design = start_design(study);
    design.dosage_factor = 2;
    design.land = 1e-3;
    design.fill_fraction = {0.95, 1};
    const Scene full = scene_of(study, design, false, 42), strip = scene_of(study, design, true, 42);
    EXPECT_DOUBLE_EQ(full.dose_height, 2 * 40e-6);  // A_platform = A_dispenser
    EXPECT_DOUBLE_EQ(full.land, 1e-3);
    EXPECT_NEAR(full.headspace[0], 0.05 * study.scene.dispenser_depth, 1e-15);
    EXPECT_EQ(full.headspace[1], 0);
    EXPECT_EQ(full.seed, 42u);
    EXPECT_EQ(full.width, study.dispenser_width);
    EXPECT_EQ(full.sides, Sides::frictional);
    EXPECT_EQ(strip.width, study.strip_width);
    EXPECT_EQ(strip.sides, Sides::periodic);
    // h phi_bed L_d / (g phi_layer L_b) = 55 um 0.56 / (143 um 0.28): A stands 50 um lower, half the powder
    EXPECT_NEAR(supply_ratio(full, 0.56, 0.28), 55e-6 * 0.56 / (143e-6 * 0.28), 1e-12);
    design.fill_fraction = {1, 1};
    EXPECT_NEAR(supply_ratio(scene_of(study, design, false, 42), 0.56, 0.28), 80e-6 * 0.56 / (143e-6 * 0.28),
                1e-12);
}

TEST(Judge, bins_at_the_sides_and_outside_the_footprint_do_not_count) {
    Study study = coupon();
    EXPECT_EQ(bin_weights(study), (std::vector<double>{0, 1, 1, 1, 1, 1, 1, 0}));
    study.footprint.y_low = 0.4e-3;
    study.target.zones = {{0.8e-3, 0.9e-3, 3}};
    const std::vector<double> weight = bin_weights(study);
    EXPECT_EQ(weight[1], 0);
    EXPECT_NEAR(weight[4], 2, 1e-12);  // half the bin counts 3, half 1
    EXPECT_EQ(weight[7], 0);
}

TEST(Judge, residuals_squared_are_the_objective_without_waste) {
    Study study = coupon();
    study.objective.waste_weight = 0;
    Evaluation evaluation;
    evaluation.health.status = "ok";
    evaluation.coverage = 1;
    for (int bin = 0; bin < 8; ++bin) {
        evaluation.profile.gi.push_back(0.1 * bin);
        evaluation.profile.standard_error.push_back(0.01);
        evaluation.drift.difference.push_back(0.02 * bin);
        evaluation.drift.standard_error.push_back(0.01);
    }
    judge(study, evaluation);
    double squares = 0;
    for (const double r : evaluation.residuals) squares += r * r;
    EXPECT_NEAR(evaluation.objective, std::sqrt(squares), 1e-12);
    EXPECT_NEAR(evaluation.drift.value, 0.02 * std::sqrt((1 + 4 + 9 + 16 + 25 + 36) / 6.0), 1e-12);
    EXPECT_EQ(evaluation.residuals.size(), 12u);
}

TEST(Judge, a_footprint_without_bins_is_a_status_and_not_a_number) {
    Study study = coupon();
    study.footprint.y_high = 0.1e-3;
    Evaluation evaluation;
    evaluation.health.status = "ok";
    evaluation.profile.gi.assign(8, 0.5);
    judge(study, evaluation);
    EXPECT_EQ(evaluation.health.status, "no_bins");
    EXPECT_EQ(evaluation.objective, kNotEvaluable);
}

}  // namespace
}  // namespace gradwright
