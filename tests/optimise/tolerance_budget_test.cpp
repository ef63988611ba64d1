// The tolerance budget against closed forms: a profile that is linear in the plate's dimensions.
#include "optimise/tolerance_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

TEST(GeneralTolerance, follows_the_table) {
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::m, 1e-3), 0.1e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::m, 6e-3), 0.1e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::m, 6.1e-3), 0.2e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::m, 100e-3), 0.3e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::f, 250e-3), 0.2e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::c, 250e-3), 1.2e-3);
    EXPECT_DOUBLE_EQ(general_tolerance(ToleranceClass::v, 25e-3), 1e-3);
}

Design bent() {
    Design design;
    design.partition.points = {{0, 1.2e-3}, {1.6e-3, 0.9e-3}, {3.2e-3, 0.4e-3}};
    return design;
}

/// GI of every bin = 500 y of the first end + 300 y of the bend, per metre.
std::vector<double> linear_profile(const Design& design) {
    const auto& p = design.partition.points;
    return std::vector<double>(8, 500 * p[0].y + 300 * p[1].y);
}

TEST(ToleranceBudget, of_a_linear_profile_is_its_sums_of_slopes) {
    const Study study = coupon();
    const ToleranceBudget budget =
        tolerance_budget(study, bent(), linear_profile, ToleranceClass::m, 0.04, 0.01);
    ASSERT_EQ(budget.dimensions.size(), 6u);  // two ends in y, a bend in x and y, the plate in x and y
    EXPECT_EQ(budget.dimensions[0].name, "P1 y");
    EXPECT_EQ(budget.dimensions[1].name, "P2 x");
    const double t = 0.1e-3, end = 500 * t, bend = 300 * t, plate = 800 * t;
    EXPECT_NEAR(budget.worst_case_rms, end + bend + plate, 1e-12);
    EXPECT_NEAR(budget.rss_rms, std::sqrt(end * end + bend * bend + plate * plate), 1e-12);
    EXPECT_NEAR(budget.dimensions[0].slope_rms, 500, 1e-9);
    EXPECT_EQ(budget.dimensions[1].slope_rms, 0);
    EXPECT_TRUE(std::isinf(budget.dimensions[1].needed));
    EXPECT_NEAR(budget.dimensions[0].needed, 0.04 / (std::sqrt(6.0) * 500), 1e-12);
    EXPECT_TRUE(budget.dimensions[0].tighter());
    double share = 0;
    for (const DimensionBudget& d : budget.dimensions) share += d.share;
    EXPECT_NEAR(share, 1, 1e-12);
    EXPECT_LT(budget.band_rms, budget.worst_case_rms);
    EXPECT_GT(budget.band_rms, budget.rss_rms);
}

TEST(ToleranceBudget, band_of_two_uniform_errors_is_the_triangle_s_point) {
    // the bend's y and the plate's alone: P(|u1 + u2| > z) = (2 - z)^2 / 4 = 0.05
    const auto profile = [](const Design& design) {
        return std::vector<double>(8, 300 * design.partition.points[1].y);
    };
    const ToleranceBudget budget = tolerance_budget(coupon(), bent(), profile, ToleranceClass::m, 0.04, 0.01);
    // three standard errors of a 95 % point from 2000 draws; density (2 - z) / 2 there
    const double error = std::sqrt(0.05 * 0.95 / 2000) / (std::sqrt(0.2) / 2);
    EXPECT_NEAR(budget.band_rms, (2 - std::sqrt(0.2)) * 300 * 0.1e-3, 3 * error * 300 * 0.1e-3);
}

TEST(ToleranceBudget, promises_nothing_finer_than_the_noise) {
    const ToleranceBudget budget =
        tolerance_budget(coupon(), bent(), linear_profile, ToleranceClass::m, 0.005, 0.03);
    EXPECT_EQ(budget.promised, 0.03);
    EXPECT_NEAR(budget.dimensions[0].needed, 0.03 / (std::sqrt(6.0) * 500), 1e-12);
}

TEST(ToleranceBudget, its_band_holds_ninety_five_of_a_hundred_plates) {
    const Study study = coupon();
    const ToleranceBudget budget =
        tolerance_budget(study, bent(), linear_profile, ToleranceClass::f, 0.04, 0.01);
    const BandCheck check = check_band(study, bent(), linear_profile, budget, 4000, 99);
    EXPECT_EQ(check.plates, 4000);
    // of this check's own plates, and of the 2000 that the band was drawn from
    EXPECT_NEAR(check.inside, 0.95, 3 * std::sqrt(0.95 * 0.05 * (1 / 4000.0 + 1 / 2000.0)));
    EXPECT_LE(check.worst_error, budget.worst_case_rms + 1e-12);
}

TEST(ToleranceBudget, two_plates_have_the_dimensions_of_both_curves) {
    Design design = bent();
    design.partition.second = {{0, 1.4e-3}, {3.2e-3, 1.0e-3}};
    EXPECT_EQ(build_dimensions(coupon(), design, ToleranceClass::m).size(), 8u);
}

}  // namespace
}  // namespace gradwright
