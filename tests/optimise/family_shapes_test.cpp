// Sigmoid, spline and pair of curves: shape, buildability, derivatives, fit, journal and study file.
#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "optimise/ceres_fit.h"
#include "optimise/journal.h"
#include "optimise/kinematic_evaluator.h"
#include "optimise/study_file.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;
using testing::HasSubstr;

constexpr double kLength = 3.2e-3, kWidth = 1.6e-3;

DesignSpace space_of(Family family, int knots = 5) {
    DesignSpace space;
    space.family = family;
    space.knots = knots;
    return space;
}

std::vector<double> random_point(const PartitionFamily& family, Random& random) {
    std::vector<double> p(family.size());
    for (std::size_t i = 0; i < p.size(); ++i)
        p[i] = family.low()[i] + random.uniform() * (family.high()[i] - family.low()[i]);
    return p;
}

Layer map_layer(const Study& study, std::uint64_t seed, const Heap& heap = {}) {
    Calls calls;
    return spread(heap, calls, scene_of(study, start_design(study), true, seed), nullptr).layer;
}

/// B, a plateau of A from 0.7 to 0.9 mm, B; ramps 0.4 mm wide.
Target peak() {
    Target target;
    target.shape = TargetShape::table;
    target.table_y = {0.3e-3, 0.7e-3, 0.9e-3, 1.3e-3};
    target.table_gi = {0, 1, 1, 0};
    return target;
}

double height_of(const PartitionFamily& family, const std::vector<double>& p, double x) {
    double yc = 0, widening = 1;
    family.visit_curves(p.data(), [&](const auto& curve, double sign) {
        if (sign > 0) curve.evaluate(x, yc, widening);
    });
    return yc;
}

TEST(Sigmoid, runs_from_10_to_90_percent_of_its_height_over_its_width) {
    const PartitionFamily family(space_of(Family::sigmoid), kLength, kWidth, {true, true});
    // centre 0.8 mm, height 0.5 mm, place 1.2 mm, width 0.9 mm
    const std::vector<double> p = {0.5, 0.5e-3 / kWidth, 1.2e-3 / kLength, std::log(0.9e-3 / kLength)};
    EXPECT_NEAR(height_of(family, p, 1.2e-3), 0.8e-3, 1e-12);
    EXPECT_NEAR(height_of(family, p, 1.2e-3 - 0.45e-3), 0.8e-3 - 0.4 * 0.5e-3, 1e-12);
    EXPECT_NEAR(height_of(family, p, 1.2e-3 + 0.45e-3), 0.8e-3 + 0.4 * 0.5e-3, 1e-12);
    const auto named = family.named(p);
    EXPECT_EQ(named[1].first, "height_m");
    EXPECT_NEAR(named[1].second, 0.5e-3, 1e-15);
    EXPECT_NEAR(named[3].second, 0.9e-3, 1e-15);
}

TEST(Sigmoid, fit_of_a_sigmoid_gives_the_sigmoid_back) {
    const PartitionFamily family(space_of(Family::sigmoid), kLength, kWidth, {true, false});
    const std::vector<double> p = {0.45, -0.5, 0.4, std::log(0.3)};
    std::vector<PlanPoint> samples;
    for (int i = 0; i < 200; ++i) {
        const double x = kLength * (i + 0.5) / 200;
        samples.push_back({x, height_of(family, p, x)});
    }
    const std::vector<double> back = family.fit_samples(samples);
    double furthest = 0;
    for (const PlanPoint& sample : samples)
        furthest = std::max(furthest, std::abs(height_of(family, back, sample.x) - sample.y));
    EXPECT_LT(furthest, 2e-6);  // the grid's step over the second pass, squared
}

TEST(Spline, meets_its_knots_with_the_slopes_of_fritsch_and_butland) {
    // d = 1, 1/2; h = 1, 2: inner slope (w1 + w2)/(w1/d0 + w2/d1), w1 = 2 h1 + h0, w2 = h1 + 2 h0
    const CubicOverX<double> curve({0, 1, 3}, {0, 1, 2});
    EXPECT_NEAR(curve.slope[1], 9.0 / (5.0 / 1 + 4.0 / 0.5), 1e-15);
    EXPECT_NEAR(curve.slope[0], ((2.0 + 2) * 1 - 1 * 0.5) / 3, 1e-15);
    double yc = 0, widening = 0;
    for (int k = 0; k < 3; ++k) {
        curve.evaluate(curve.x[k], yc, widening);
        EXPECT_NEAR(yc, curve.y[k], 1e-15);
        EXPECT_NEAR(widening, std::sqrt(1 + curve.slope[k] * curve.slope[k]), 1e-12);
    }
    // cubic Hermite at the middle of a piece: mean of the ends plus h (m0 - m1)/8
    curve.evaluate(2, yc, widening);
    EXPECT_NEAR(yc, 1.5 + 2 * (curve.slope[1] - curve.slope[2]) / 8, 1e-15);
}

TEST(Spline, never_turns_back_anywhere_in_the_box) {
    for (const bool rising : {false, true}) {
        const PartitionFamily family(space_of(Family::spline), kLength, kWidth, {true, rising});
        Random random(11);
        for (int trial = 0; trial < 100; ++trial) {
            const auto p = random_point(family, random);
            double before = height_of(family, p, 0);
            for (int i = 1; i <= 400; ++i) {
                const double y = height_of(family, p, kLength * i / 400);
                EXPECT_GE((rising ? 1 : -1) * (y - before), -1e-15);
                before = y;
            }
        }
    }
}

TEST(SmoothFamily, polyline_stands_within_two_micrometres_of_the_curve_and_is_short) {
    for (const Family kind : {Family::sigmoid, Family::spline}) {
        const PartitionFamily family(space_of(kind), kLength, kWidth, {true, false});
        Random random(5);
        double furthest = 0;
        for (int trial = 0; trial < 60; ++trial) {
            const auto p = random_point(family, random);
            const PartitionCurve line = family.curve(p);
            EXPECT_EQ(line.points.front().x, 0);
            EXPECT_EQ(line.points.back().x, kLength);
            EXPECT_LT(line.points.size(), 120u);
            for (int i = 0; i <= 3000; ++i) {
                const double x = kLength * i / 3000;
                furthest = std::max(furthest, std::abs(line.signed_distance(x, height_of(family, p, x))));
            }
        }
        EXPECT_LE(furthest, kChordError) << to_string(kind);
        EXPECT_GT(furthest, 0.2 * kChordError);  // no finer than stated either
    }
}

TEST(SmoothFamily, least_bend_radius_is_that_of_the_circle_through_three_near_points) {
    for (const Family kind : {Family::sigmoid, Family::spline}) {
        const PartitionFamily family(space_of(kind), kLength, kWidth, {true, false});
        const std::vector<double> p = kind == Family::sigmoid
                                          ? std::vector<double>{0.5, -0.4, 0.5, std::log(0.4)}
                                          : std::vector<double>{0.8, 0.05, 0.2, 0.1, 0.3, 0, 0, 0};
        double least = 1;
        const double step = 1e-6;
        for (int i = 1; i < 3199; ++i) {
            const double x = i * step;
            const double a = height_of(family, p, x - step), b = height_of(family, p, x),
                         c = height_of(family, p, x + step);
            const double slope = (c - a) / (2 * step), second = (a - 2 * b + c) / (step * step);
            if (std::abs(second) > 1)
                least = std::min(least, std::pow(1 + slope * slope, 1.5) / std::abs(second));
        }
        EXPECT_NEAR(family.least_bend_radius(p), least, 0.03 * least) << to_string(kind);
    }
}

TEST(SmoothFamily, what_is_too_tight_costs_the_more_the_tighter_and_a_sound_one_nothing) {
    const PartitionFamily family(space_of(Family::sigmoid), kLength, kWidth, {true, true});
    const auto at = [](double width) {
        return std::vector<double>{0.5, 0.5, 0.5, std::log(width / kLength)};
    };
    EXPECT_GT(family.least_bend_radius(at(2e-3)), 0.3e-3);
    EXPECT_EQ(family.unsound(at(2e-3)), 0);
    EXPECT_LT(family.least_bend_radius(at(0.4e-3)), 0.3e-3);
    EXPECT_GT(family.unsound(at(0.4e-3)), 1);
    EXPECT_GT(family.unsound(at(0.2e-3)), family.unsound(at(0.4e-3)));
    std::vector<double> excess;
    const std::vector<double> wide = at(2e-3);
    family.bend_excess(wide.data(), excess);
    EXPECT_EQ(int(excess.size()), family.bend_count());
}

TEST(TwoCurves, keep_their_clearance_and_their_order_anywhere_in_the_box) {
    const DesignSpace space = space_of(Family::two_curves, 4);
    for (const bool a_between : {true, false}) {
        const PartitionFamily family(space, kLength, kWidth, {a_between, false});
        EXPECT_EQ(family.size(), 10u);
        Random random(3);
        for (int trial = 0; trial < 200; ++trial) {
            PartitionCurve pair = family.curve(random_point(family, random));
            EXPECT_FALSE(pair.pair_disagrees());
            EXPECT_EQ(pair.a_between(), a_between);
            auto &lower = pair.points, &upper = pair.second;
            if (!a_between)
                std::reverse(lower.begin(), lower.end());
            else
                std::reverse(upper.begin(), upper.end());
            for (std::size_t k = 0; k < lower.size(); ++k) {
                EXPECT_EQ(lower[k].x, upper[k].x);
                EXPECT_GE(upper[k].y - lower[k].y, space.clearance * (1 - 1e-12));
            }
        }
    }
}

TEST(TwoCurves, closed_form_reproduces_a_peak_and_a_valley_in_the_fully_mixed_limit) {
    for (const bool valley : {false, true}) {
        Study study = coupon();
        study.scene.powder[0].size.d50 = study.scene.powder[1].size.d50 = 1e-9;  // sigma_y -> 0
        study.target = peak();
        if (valley)
            for (double& gi : study.target.table_gi) gi = 1 - gi;
        study.design_space = space_of(Family::two_curves, 2);
        study.design_space.clearance = 0.05e-3;
        ASSERT_EQ(target_peaks(study), !valley);
        const Design design = start_design(study);
        EXPECT_EQ(design.partition.a_between(), !valley);
        const Evaluation evaluation = KinematicEvaluator(study).evaluate(design, 1);
        for (int bin = 1; bin < 7; ++bin)
            EXPECT_NEAR(evaluation.profile.gi[bin], study.target.bin_mean(bin * 0.2e-3, (bin + 1) * 0.2e-3),
                        0.03)
                << "valley " << valley << " bin " << bin;
    }
}

TEST(FamilyFit, derivatives_agree_with_central_differences_bends_included) {
    Study study = coupon();
    study.target = peak();
    const std::vector<Layer> layers = {map_layer(study, 3)};
    const FitProblem problem(study, start_design(study), layers);
    using Jet = ceres::Jet<double, 8>;
    const std::vector<std::pair<Family, std::vector<double>>> cases = {
        {Family::sigmoid, {0.45, -0.5, 0.45, std::log(0.15)}},
        {Family::spline, {0.8, 0.05, 0.1, 0.25, 0.1, 0.1, -0.2, 0.05}},
        {Family::two_curves, {0.3, 0.35, 0.32, 0.3, 0.25, 0.35, 0.1}}};
    for (const auto& [kind, p] : cases)
        for (const bool above : {true, false}) {
            DesignSpace space = space_of(kind, kind == Family::two_curves ? 3 : 5);
            space.minimum_bend_radius = 1e-3;  // so that bends cost something here
            const PartitionFamily family(space, kLength, kWidth, {above, false});
            ASSERT_EQ(family.size(), p.size());
            std::vector<Jet> at, residual;
            for (std::size_t i = 0; i < p.size(); ++i) at.emplace_back(p[i], int(i));
            problem.residuals(family, at.data(), 50e-6, residual);
            ASSERT_EQ(int(residual.size()), problem.residual_count() + family.bend_count());
            double of_profile = 0, of_bends = 0;
            for (std::size_t i = 0; i < p.size(); ++i) {
                const double step = 1e-5;  // 16 nm: as in ceres_fit_test
                std::vector<double> up = p, down = p, high, low;
                up[i] += step;
                down[i] -= step;
                problem.residuals(family, up.data(), 50e-6, high);
                problem.residuals(family, down.data(), 50e-6, low);
                for (std::size_t r = 0; r < residual.size(); ++r) {
                    const double numeric = (high[r] - low[r]) / (2 * step);
                    EXPECT_NEAR(residual[r].v[int(i)], numeric, 2e-3 * std::max(1.0, std::abs(numeric)))
                        << to_string(kind) << " residual " << r << " parameter " << i;
                    double& largest = int(r) < problem.residual_count() ? of_profile : of_bends;
                    largest = std::max(largest, std::abs(numeric));
                }
            }
            EXPECT_GT(of_profile, 0.3) << to_string(kind);
            if (family.bend_count() > 0) {
                EXPECT_GT(of_bends, 0.3) << to_string(kind);
            }
        }
}

TEST(FamilyFit, smooth_curve_and_its_polyline_give_the_same_profile) {
    const Study study = coupon();
    const std::vector<Layer> layers = {map_layer(study, 4)};
    const FitProblem problem(study, start_design(study), layers);
    HomogeneousOptions options;
    options.resamples = 0;
    Random random(2);
    for (const Family kind : {Family::sigmoid, Family::spline, Family::two_curves})
        for (const bool above : {true, false}) {
            const PartitionFamily family(space_of(kind, 3), kLength, kWidth, {above, false});
            for (int trial = 0; trial < 10; ++trial) {
                const auto p = random_point(family, random);
                std::vector<double> gi, difference;
                problem.gradation<double>(family, p.data(), 0, gi, difference);
                const PartitionCurve curve = family.curve(p);
                const GradationProfile profile =
                    homogeneous_profile(problem.grains, curve, study.bins, options);
                const XDrift drift = homogeneous_drift(problem.grains, curve, study.bins, options);
                for (std::size_t b = 0; b < gi.size(); ++b) {
                    // 2 um across a curve of slope s are 2 um sqrt(1 + s^2) along y; bins are 200 um wide
                    EXPECT_NEAR(profile.gi[b], gi[b], 0.02) << to_string(kind);
                    EXPECT_NEAR(drift.difference[b], difference[b], 0.02);
                }
            }
        }
}

TEST(FamilyFit, a_sigmoid_and_a_spline_meet_a_sigmoidal_target_on_a_known_heap) {
    Study study = coupon();
    study.target = sigmoid_target(0.8e-3, 0.7e-3);
    const Heap heap;
    const std::vector<Layer> layers = {map_layer(study, 5, heap)};
    for (const Family kind : {Family::sigmoid, Family::spline}) {
        study.design_space.family = kind;
        const FitProblem problem(study, start_design(study), layers);
        FitOptions options;
        options.perturbed_starts = 2;
        const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, options);
        ASSERT_TRUE(fit.ok) << fit.message;
        EXPECT_EQ(fit.design.family, kind);
        EXPECT_LT(true_rmse(study, truth(heap, study, fit.design, true)), 0.025) << to_string(kind);
        const PartitionFamily family(study.design_space, kLength, kWidth, fit.orientation);
        EXPECT_GE(family.least_bend_radius(fit.p), study.design_space.minimum_bend_radius);
    }
}

TEST(FamilyFit, the_bend_radius_asked_for_is_kept_where_the_target_pulls_against_it) {
    Study study = coupon();
    study.target = step_target(0.8e-3);  // the steeper the better
    study.objective.x_drift_weight = 0;
    const std::vector<Layer> layers = {map_layer(study, 5)};
    constexpr double kLeast = 3e-3;
    double radius[2];
    for (const int limited : {0, 1}) {
        study.design_space = space_of(Family::spline, 5);
        study.design_space.given_points = {
            {0, 1.4e-3}, {1.4e-3, 1.35e-3}, {1.8e-3, 0.3e-3}, {kLength, 0.2e-3}};
        study.target = sigmoid_target(0.8e-3, 1.2e-3);
        study.design_space.minimum_bend_radius = limited ? kLeast : 0;
        const FitProblem problem(study, start_design(study), layers);
        FitOptions options;
        options.perturbed_starts = 3;
        const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, options);
        ASSERT_TRUE(fit.ok) << fit.message;
        const PartitionFamily family(study.design_space, kLength, kWidth, fit.orientation);
        radius[limited] = family.least_bend_radius(fit.p);
        for (const Design& finalist : fit.finalists)
            if (limited) {
                EXPECT_GE(finalist.parameters.back().second, kLeast);
            }
    }
    EXPECT_LT(radius[0], kLeast);  // unlimited, it would bend tighter
    EXPECT_GE(radius[1], kLeast);
}

TEST(FamilyFit, two_curves_meet_a_peak_that_one_curve_cannot) {
    Study study = coupon();
    study.target = peak();
    study.objective.x_drift_weight = 0;
    const Heap heap;
    const std::vector<Layer> layers = {map_layer(study, 5, heap)}, other = {map_layer(study, 6, heap)};
    FitOptions options;
    options.perturbed_starts = 2;
    double rmse[2];
    for (const Family kind : {Family::polyline, Family::two_curves}) {
        study.design_space = space_of(kind, kind == Family::polyline ? 5 : 2);
        const FitProblem problem(study, start_design(study), layers),
            unseen(study, start_design(study), other);
        const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, options);
        ASSERT_TRUE(fit.ok) << fit.message;
        const PartitionFamily family(study.design_space, kLength, kWidth, fit.orientation);
        rmse[kind == Family::two_curves] = unseen.hard_misfit_and_drift(family, fit.p).first;
    }
    EXPECT_LT(rmse[1], 0.03);
    EXPECT_GT(rmse[0], 0.15);
}

TEST(FamilyJournal, every_family_and_a_second_curve_come_back) {
    char name[] = "/tmp/gradwright_shapes_XXXXXX";
    const std::string folder = mkdtemp(name);
    {
        Journal journal(folder);
        for (std::size_t i = 0; i < kFamilies.size(); ++i) {
            Evaluation e;
            e.design.family = static_cast<Family>(i);
            e.design.partition.points = {{0, 0.5e-3}, {kLength, 1.0 / 3.0 * 1e-3}};
            if (e.design.family == Family::two_curves)
                e.design.partition.second = {{kLength, 1.25e-3}, {0, 1.0 / 7.0 * 1e-2}};
            journal.append(e);
        }
    }
    const auto entries = Journal::read(folder);
    ASSERT_EQ(entries.size(), kFamilies.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Design& design = entries[i].evaluation.design;
        EXPECT_EQ(design.family, static_cast<Family>(i));
        ASSERT_EQ(design.partition.second.size(), design.family == Family::two_curves ? 2u : 0u);
    }
    EXPECT_EQ(entries.back().evaluation.design.partition.second[1].y, 1.0 / 7.0 * 1e-2);
    std::filesystem::remove_all(folder);
}

// --- study file

std::string study_with(const std::string& partition) {
    return R"([machine]
use = "coupon-rig"
[powder.A]
material = "SS17-4PH"
[powder.B]
material = "IN718"
[target]
shape = "linear"
from = { y = "0.4 mm", gi = 0.0 }
to = { y = "1.2 mm", gi = 1.0 }
[design_space]
partition = )" +
           partition + "\n";
}

Study parsed(const std::string& partition) {
    try {
        return parse_study(study_with(partition), "shapes.toml", {});
    } catch (const InputError& error) {
        ADD_FAILURE() << report_of(error);
        return {};
    }
}

std::string told(const std::string& partition) {
    try {
        parse_study(study_with(partition), "shapes.toml", {});
    } catch (const InputError& error) {
        return report_of(error);
    }
    return "accepted";
}

TEST(FamilyStudy, a_sigmoid_takes_any_subset_of_its_numbers_fixed) {
    const Study free = parsed(R"({ family = "sigmoid" })");
    EXPECT_TRUE(free.design_space.partition_free);
    const PartitionFamily falling(free.design_space, kLength, kWidth, {true, false}),
        rising(free.design_space, kLength, kWidth, {true, true});
    EXPECT_EQ(falling.high()[1], 0);  // the direction follows the orientation
    EXPECT_EQ(rising.low()[1], 0);
    const Study some = parsed(R"({ family = "sigmoid", centre = "0.7 mm", height = ["-1 mm", "-0.5 mm"] })");
    const PartitionFamily family(some.design_space, kLength, kWidth, {true, true});
    EXPECT_NEAR(family.low()[0], 0.7e-3 / kWidth, 1e-12);
    EXPECT_EQ(family.low()[0], family.high()[0]);
    EXPECT_NEAR(family.low()[1], -1e-3 / kWidth, 1e-12);
    EXPECT_NEAR(family.high()[1], -0.5e-3 / kWidth, 1e-12);
    const Study fixed = parsed(
        R"({ family = "sigmoid", centre = "0.8 mm", height = "-0.6 mm", place = "1.6 mm", width_10_90 = "2 mm" })");
    EXPECT_FALSE(fixed.design_space.partition_free);
    const Design design = start_design(fixed);
    EXPECT_EQ(design.family, Family::sigmoid);
    EXPECT_NEAR(design.partition.signed_distance(0.6e-3, 0.8e-3 + 0.24e-3), 0, kChordError);
    EXPECT_NEAR(design.partition.signed_distance(2.6e-3, 0.8e-3 - 0.24e-3), 0, kChordError);
    EXPECT_TRUE(design.partition.on_side_a(1.6e-3, 1e-3));
}

TEST(FamilyStudy, a_fixed_spline_stands_through_its_points_and_names_its_radius) {
    const Study study = parsed(
        R"({ family = "spline", points = [["0 mm", "1.2 mm"], ["1.6 mm", "0.9 mm"], ["3.2 mm", "0.2 mm"]] })");
    EXPECT_FALSE(study.design_space.partition_free);
    const Design design = start_design(study);
    EXPECT_GT(design.partition.points.size(), 5u);
    EXPECT_NEAR(design.partition.signed_distance(1.6e-3, 0.9e-3), 0, 1e-12);
    EXPECT_EQ(design.parameters.back().first, "least_bend_radius_m");
    EXPECT_NEAR(study.design_space.minimum_bend_radius, 0.3e-3, 1e-12);  // 1.5 times a foil of 0.2 mm
}

TEST(FamilyStudy, two_fixed_curves_hold_the_powder_that_their_directions_say) {
    const Study study = parsed(
        R"({ family = "two_curves", points = [["0 mm", "0.4 mm"], ["3.2 mm", "0.6 mm"]], points2 = [["3.2 mm", "1.2 mm"], ["0 mm", "1.1 mm"]] })");
    const PartitionCurve& pair = start_design(study).partition;
    EXPECT_TRUE(pair.a_between());
    EXPECT_TRUE(pair.on_side_a(1.6e-3, 0.8e-3));
    EXPECT_FALSE(pair.on_side_a(1.6e-3, 0.2e-3));
    EXPECT_FALSE(pair.on_side_a(1.6e-3, 1.4e-3));
    EXPECT_NEAR(study.design_space.clearance, 0.24e-3, 1e-12);  // three grains of 80 um
}

TEST(FamilyStudy, what_cannot_be_built_is_refused_with_its_reason) {
    EXPECT_THAT(told(R"({ family = "sigmoid", knots = 4 })"),
                HasSubstr("has no place in family = \"sigmoid\""));
    EXPECT_THAT(told(R"({ family = "polyline", points2 = [["0 mm", "1 mm"], ["3 mm", "1 mm"]] })"),
                HasSubstr("choose family = \"two_curves\""));
    EXPECT_THAT(
        told(
            R"({ family = "sigmoid", centre = "0.8 mm", height = "1 mm", place = "1.6 mm", width_10_90 = "0.2 mm" })"),
        HasSubstr("tighter than minimum_bend_radius = 0.3 mm"));
    EXPECT_THAT(
        told(
            R"({ family = "spline", points = [["0 mm", "1 mm"], ["1.6 mm", "1 mm"], ["1.7 mm", "0.2 mm"], ["3.2 mm", "0.2 mm"]] })"),
        HasSubstr("tighter than minimum_bend_radius"));
    EXPECT_THAT(
        told(
            R"({ family = "spline", start = [["0 mm", "1 mm"], ["1.6 mm", "0.5 mm"], ["3.2 mm", "0.9 mm"]] })"),
        HasSubstr("y must not turn back"));
    EXPECT_THAT(told(R"({ family = "two_curves", points = [["0 mm", "1 mm"], ["3.2 mm", "1 mm"]] })"),
                HasSubstr("fixes one of two curves"));
    EXPECT_THAT(
        told(
            R"({ family = "two_curves", points = [["0 mm", "0.4 mm"], ["3.2 mm", "0.6 mm"]], points2 = [["0 mm", "1.2 mm"], ["3.2 mm", "1.2 mm"]] })"),
        HasSubstr("calls A what the first calls B"));
    EXPECT_THAT(
        told(
            R"({ family = "two_curves", points = [["0 mm", "0.4 mm"], ["3.2 mm", "1.2 mm"]], points2 = [["3.2 mm", "0.6 mm"], ["0 mm", "1 mm"]] })"),
        HasSubstr("meets the first curve"));
    EXPECT_THAT(told(R"({ family = "two_curves", clearance = "2 mm" })"), HasSubstr("leaves no room"));
}

}  // namespace
}  // namespace gradwright
