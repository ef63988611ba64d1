// The search over what moves grains: interpolation between maps in closed form, and heaps whose best motion
// is known.
#include "optimise/motion_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optimise/chamber_fill.h"
#include "optimise/motion.h"
#include "tests/optimise/map_run.h"

namespace gradwright {
namespace {

using namespace testing_heap;

TEST(InterpolationShares, are_barycentric_on_the_nearest_simplex) {
    const std::vector<std::vector<double>> line = {{0.5}, {0}, {1}};
    EXPECT_EQ(interpolation_shares(line, {0.5}), (std::vector<double>{1, 0, 0}));
    const std::vector<double> left = interpolation_shares(line, {0.2});
    EXPECT_NEAR(left[0], 0.4, 1e-12);  // between 0 and 0.5, not between 0 and 1
    EXPECT_NEAR(left[1], 0.6, 1e-12);
    EXPECT_EQ(left[2], 0);

    const std::vector<std::vector<double>> square = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.5}};
    const std::vector<double> in = interpolation_shares(square, {0.5, 0.2});
    EXPECT_NEAR(in[0], 0.3, 1e-12);  // the triangle of (0,0), (1,0) and the middle
    EXPECT_NEAR(in[1], 0.3, 1e-12);
    EXPECT_NEAR(in[4], 0.4, 1e-12);
    EXPECT_EQ(in[2] + in[3], 0);
}

TEST(InterpolationShares, a_linear_function_is_met_anywhere_inside) {
    const std::vector<std::vector<double>> points = {{0.3, 0.6}, {0, 0}, {1, 0.1}, {0.1, 1}, {0.9, 0.8}};
    for (const std::vector<double>& at : {std::vector{0.4, 0.5}, {0.2, 0.3}, {0.7, 0.6}, {0.5, 0.2}}) {
        const std::vector<double> shares = interpolation_shares(points, at);
        double sum = 0, x = 0, y = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            EXPECT_GE(shares[k], 0);
            sum += shares[k];
            x += shares[k] * points[k][0];
            y += shares[k] * points[k][1];
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        EXPECT_NEAR(x, at[0], 1e-9);
        EXPECT_NEAR(y, at[1], 1e-9);
    }
}

TEST(InterpolationShares, outside_the_hull_and_without_a_simplex_the_nearest_stands_alone) {
    EXPECT_EQ(interpolation_shares({{0.2}, {0.6}}, {0.9}), (std::vector<double>{0, 1}));
    EXPECT_EQ(interpolation_shares({{0.2, 0.2}, {0.8, 0.8}}, {0.3, 0.3}), (std::vector<double>{1, 0}));
    EXPECT_EQ(interpolation_shares({{0.5, 0.5}}, {0.1, 0.9}), (std::vector<double>{1}));
    // three on a line span no triangle
    EXPECT_EQ(interpolation_shares({{0, 0}, {0.5, 0.5}, {1, 1}}, {0.9, 0.8}), (std::vector<double>{0, 0, 1}));
}

struct Maps {
    Study study;
    RunOptions options;
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
    std::unique_ptr<SpreadRunner> runner;
    std::unique_ptr<MapEvaluator> map;
    Maps(Study given, const Heap& heap) : study(std::move(given)) {
        options.spread = engine(heap, calls);
        runner = std::make_unique<SpreadRunner>(options);
        map = std::make_unique<MapEvaluator>(study, *runner, nullptr);
    }
};

TEST(MapsBetween, answer_every_partition_with_the_same_mean_of_theirs) {
    Heap heap;
    heap.land_turn = 0.2 / 1e-3;
    Maps maps(coupon(), heap);
    Design near = start_design(maps.study), far = near;
    near.land = 1.6e-3;
    far.land = 4.8e-3;
    OriginMap between = maps.map->between({near, far}, {0.25, 0.75});
    Design middle = near;
    middle.land = 4e-3;
    const std::vector<double> a = maps.map->quick(near).profile.gi, b = maps.map->quick(far).profile.gi,
                              mean = maps.map->quick(middle, between).profile.gi;
    double apart = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) {
        EXPECT_NEAR(mean[k], 0.25 * a[k] + 0.75 * b[k], 1e-12);
        apart = std::max(apart, std::fabs(a[k] - b[k]));
    }
    EXPECT_GT(apart, 0.05);  // else the mean says nothing
    EXPECT_EQ(maps.calls->map_seeds.size(), 2u);
}

TEST(ChamberDoses, stand_above_the_rim_as_their_pistons_rise) {
    const Study study = coupon();
    Design design = start_design(study);
    design.dose = {1.2, 0.8};
    const Scene scene = scene_of(study, design, false, 1);
    const double rise = 3 * 40e-6;  // platform and dispenser are equally long
    EXPECT_NEAR(scene.dose_height - scene.headspace[0], 1.2 * rise, 1e-15);
    EXPECT_NEAR(scene.dose_height - scene.headspace[1], 0.8 * rise, 1e-15);
    const ChamberFill fill = chamber_fill(study, design);
    EXPECT_NEAR(fill.gi(0.5), 0.6, 1e-12);
    EXPECT_TRUE(fill.lasts());  // every pass is dosed alike
    EXPECT_NEAR(fill.levelled({fill.gi(0.3)})[0], fill.gi(0.3), 1e-12);
    design.fill_fraction[1] = 0.98;
    EXPECT_FALSE(chamber_fill(study, design).lasts());
    EXPECT_NEAR(supply_ratio(scene, 0.55, 0.28), rise * 0.55 / (scene.gap * 0.28), 1e-12);
}

TEST(ChamberDoses, that_are_equal_leave_no_step_not_even_a_rounding) {
    const Study study = coupon();
    Design design = start_design(study);
    for (int k = 0; k < 50; ++k) {
        design.dose = {0.7 + 0.014 * k, 0.7 + 0.014 * k};
        const Scene scene = scene_of(study, design, false, 1);
        EXPECT_EQ(scene.headspace[0], 0) << design.dose[0];  // below 0 the scene is refused
        EXPECT_EQ(scene.headspace[1], 0) << design.dose[0];
    }
}

TEST(ChamberDoses, are_doubted_by_what_their_step_may_carry_across) {
    const Study study = coupon();  // rises by 120 um for a dose of 1; D50 40 um
    Design design = start_design(study);
    GradationProfile profile;
    const double slope = 900;  // per metre
    for (int b = 0; b < study.bins.count; ++b) {
        profile.y_m.push_back(study.bins.centre(b));
        profile.gi.push_back(1 - slope * study.bins.centre(b));
    }
    std::vector<double> weight(profile.gi.size(), 1.0);
    for (const double tilt : {-0.3, 0.0, 0.16, 0.25, 0.4}) {
        design.dose = {1 + tilt, 1 - tilt};
        const double beyond = std::max(0.0, 2 * std::fabs(tilt) * 120e-6 - 40e-6);
        EXPECT_NEAR(step_doubt(study, design, profile, weight), slope * beyond, 1e-9) << tilt;
    }
    for (std::size_t b = 0; b < weight.size(); ++b)  // where nothing is judged there is nothing to doubt
        if (b >= weight.size() / 2) weight[b] = 0, profile.gi[b] = std::nan("");
    EXPECT_NEAR(step_doubt(study, design, profile, weight), slope * 56e-6, 1e-9);
    profile.gi.assign(profile.gi.size(), 0.5);
    EXPECT_EQ(step_doubt(study, design, profile, std::vector(profile.gi.size(), 1.0)), 0);
}

TEST(ChamberDoses, that_only_trade_powder_cost_no_new_map) {
    Maps maps(coupon(), {});
    Design design = start_design(maps.study);
    maps.map->map_of(design);
    for (const double tilt : {0.1, 0.2, 0.3}) {
        design.dose = {1 + tilt, 1 - tilt};
        maps.map->map_of(design);
    }
    EXPECT_EQ(maps.calls->map_seeds.size(), 1u);
    design.dose = {1.2, 1.2};  // more of both is another motion
    maps.map->map_of(design);
    EXPECT_EQ(maps.calls->map_seeds.size(), 2u);
}

/// A partition that cannot move lays s; the doses of 1.3 and 0.7 that make the target of it are known.
Outcome with_free_doses(std::array<Variable, 2> dose) {
    Study study = coupon();
    study.design_space.partition_free = false;
    study.design_space.given_points = {{0, 1.3e-3}, {3.2e-3, 0.3e-3}};
    study.max_spreads = 3;  // one map and two confirmations
    const Design fixed = start_design(study);
    ChamberFill wanted;
    wanted.dose = {1.3, 0.7};
    const Heap heap;
    const Truth equal = truth(heap, study, fixed, false);
    study.target.shape = TargetShape::table;
    for (int b = 0; b < study.bins.count; ++b) {
        study.target.table_y.push_back(study.bins.centre(b));
        study.target.table_gi.push_back(wanted.gi(equal.gi[std::size_t(b)]));
    }
    study.design_space.dose = dose;
    return run(study, heap);
}

TEST(MotionSearch, doses_bend_the_profile_of_a_partition_that_stands_fixed) {
    const Outcome got =
        with_free_doses({Variable{"dose.A", 1, true, 0.5, 1.5}, Variable{"dose.B", 1, true, 0.5, 1.5}});
    const auto& dose = got.result.design.dose;
    EXPECT_NEAR(dose[0] / dose[1], 1.3 / 0.7, 0.15);
    EXPECT_NEAR(dose[0] + dose[1], 2, 1e-9);  // another mean would be another motion
    EXPECT_EQ(got.result.spreads_map, 1) << "the ratio needs no map of its own";
}

TEST(MotionSearch, doses_are_searched_between_bounds_that_differ) {
    const Outcome got =
        with_free_doses({Variable{"dose.A", 1.2, true, 1.0, 1.4}, Variable{"dose.B", 0.8, true, 0.6, 1.0}});
    const auto& dose = got.result.design.dose;
    EXPECT_NEAR(dose[0] / dose[1], 1.3 / 0.7, 0.15);
    EXPECT_NEAR(dose[0] + dose[1], 2, 1e-9);
    const Outcome short_of =
        with_free_doses({Variable{"dose.A", 1.05, true, 1.0, 1.1}, Variable{"dose.B", 0.95, true, 0.9, 1.0}});
    EXPECT_NEAR(short_of.result.design.dose[0], 1.1, 1e-3);  // as far as both allow
    EXPECT_NEAR(short_of.result.design.dose[1], 0.9, 1e-3);
}

TEST(MotionSearch, finds_the_land_and_the_dosage_that_leave_no_drift) {
    Study study = coupon();
    study.max_spreads = 12;
    study.footprint.x_low = 0;
    study.design_space.land = {"land", 3.2e-3, true, 1.6e-3, 6.4e-3};
    study.design_space.dosage_factor = {"dosage_factor", 3, true, 2, 4};
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    options.spread = [calls](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        Heap heap;
        heap.grains_per_m2 /= 6;
        // order turns with the land and shifts with the dose; none is left on one line through
        // the box
        heap.turn = 0.6 * (scene.land - 4.8e-3) / 3.2e-3 + 0.4 * (scene.dose_height - 140e-6) / 80e-6;
        return spread(heap, *calls, scene, partition);
    };
    const StudyResult result = run_map_strategy(study, options);
    const double turn =
        0.6 * (result.design.land - 4.8e-3) / 3.2e-3 + 0.4 * (result.design.dosage_factor - 3.5) / 2;
    EXPECT_NEAR(turn, 0, 0.06);  // the start has -0.40
    EXPECT_LE(result.spreads_map + result.spreads_full, 12);
    int checks = 0;
    for (const HistoryEntry& entry : result.history)
        checks += entry.note.find("between the maps") != std::string::npos;
    EXPECT_GE(checks, 1);
}

TEST(MotionSearch, looks_second_where_the_heap_has_turned_over_as_often_as_suits_a_straight_partition) {
    Study study = coupon();
    study.max_spreads = 4;
    study.design_space.land = {"land", 1.6e-3, true, 0.8e-3, 6.4e-3};
    const Outcome got = run(study, {});
    ASSERT_GE(got.calls->map_seeds.size(), 2u);
    std::vector<double> turnovers;
    for (const HistoryEntry& entry : got.result.history)
        if (entry.stage == "motion") turnovers.push_back(turnovers_to_part(study, entry.design));
    ASSERT_GE(turnovers.size(), 2u);
    EXPECT_NEAR(turnovers[0], (1.6e-3 + 2.4e-3) / std::sqrt(120e-6 * 3.2e-3), 1e-9);
    EXPECT_NEAR(turnovers[1], kBestTurnovers, 0.3);
}

TEST(MotionSearch, says_that_nothing_is_left_to_search_with) {
    Study study = coupon();
    study.max_spreads = 2;
    study.design_space.land = {"land", 3.2e-3, true, 1.6e-3, 6.4e-3};
    const Outcome got = run(study, {});
    EXPECT_EQ(got.result.design.land, 3.2e-3);
    EXPECT_EQ(got.result.spreads_map, 1);
    bool told = false;
    for (const std::string& warning : got.result.warnings)
        told = told || warning.find("leaves no spread to search") != std::string::npos;
    EXPECT_TRUE(told);
}

TEST(MotionVariables, are_set_and_read_by_name) {
    Study study = coupon();
    Design design = start_design(study);
    for (const MotionVariable& motion : kMotionVariables) {
        EXPECT_EQ(motion.in(study.design_space).name, motion.name);
        motion.of(design) = 0.7;
    }
    EXPECT_EQ(design.dose, (std::array<double, 2>{0.7, 0.7}));
    EXPECT_EQ(design.fill_fraction, (std::array<double, 2>{0.7, 0.7}));
    design = start_design(study);
    design.blade_speed = 0.05;
    design.layer_thickness = 50e-6;
    const Scene scene = scene_of(study, design, false, 1);
    EXPECT_EQ(scene.blade_speed, 0.05);
    EXPECT_DOUBLE_EQ(scene.gap, 50e-6 / study.steady_packing);
    EXPECT_DOUBLE_EQ(scene.dose_height, 3 * 50e-6);
}

}  // namespace
}  // namespace gradwright
