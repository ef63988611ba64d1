// Premixed chambers and unequal levels: closed forms, and a study that needs them.
#include "optimise/chamber_fill.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optimise/dem_evaluator.h"
#include "optimise/map_evaluator.h"
#include "optimise/study_file.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

TEST(ChamberFill, pure_powders_at_equal_levels_change_nothing) {
    const ChamberFill fill;
    for (const double s : {0.0, 0.3, 1.0}) {
        EXPECT_EQ(fill.gi(s), s);
        EXPECT_EQ(fill.slope(s), 1);
        EXPECT_EQ(fill.side_share(s), s);
    }
}

TEST(ChamberFill, a_premix_is_a_straight_line_and_doses_weigh_the_chambers) {
    ChamberFill mixed;
    mixed.share_a = {0.9, 0.2};
    EXPECT_DOUBLE_EQ(mixed.gi(0.0), 0.2);
    EXPECT_DOUBLE_EQ(mixed.gi(1.0), 0.9);
    EXPECT_DOUBLE_EQ(mixed.gi(0.5), 0.55);
    ChamberFill dosed;
    dosed.dose = {120e-6, 60e-6};  // chamber A stands twice as high
    EXPECT_DOUBLE_EQ(dosed.gi(0.5), 2.0 / 3);
    EXPECT_DOUBLE_EQ(dosed.gi(0.0), 0.0);
    EXPECT_DOUBLE_EQ(dosed.gi(1.0), 1.0);
    ChamberFill both = mixed;
    both.dose = {1, 3};
    EXPECT_DOUBLE_EQ(both.gi(0.25), (0.25 * 0.9 + 0.75 * 3 * 0.2) / (0.25 + 2.25));
    for (const ChamberFill& fill : {mixed, dosed, both})
        for (const double s : {0.1, 0.5, 0.85}) {
            EXPECT_NEAR(fill.side_share(fill.gi(s)), s, 1e-12);
            EXPECT_NEAR(fill.slope(s), (fill.gi(s + 1e-6) - fill.gi(s - 1e-6)) / 2e-6, 1e-8);
        }
    // once level, the same share of chamber A's side is laid with equal doses
    const std::vector<double> after = both.levelled({both.gi(0.25), std::nan(""), both.gi(1.0)});
    EXPECT_NEAR(after[0], mixed.gi(0.25), 1e-12);
    EXPECT_TRUE(std::isnan(after[1]));
    EXPECT_NEAR(after[2], 0.9, 1e-12);
    EXPECT_EQ(mixed.side_share(0.1), 0);  // beyond what the chambers hold
    EXPECT_EQ(mixed.side_share(0.95), 1);
}

TEST(ChamberFill, errors_and_drift_shrink_with_the_slope) {
    ChamberFill fill;
    fill.share_a = {0.75, 0.25};
    GradationProfile profile;
    profile.gi = {0.4, std::nan("")};
    profile.standard_error = {0.02, std::nan("")};
    XDrift drift;
    drift.difference = {0.1, std::nan("")};
    drift.standard_error = {0.04, std::nan("")};
    fill.apply(profile, drift);
    EXPECT_DOUBLE_EQ(profile.gi[0], 0.45);
    EXPECT_DOUBLE_EQ(profile.standard_error[0], 0.01);
    EXPECT_DOUBLE_EQ(drift.value, 0.05);
    EXPECT_DOUBLE_EQ(drift.noise_floor, 0.02);
    EXPECT_TRUE(std::isnan(profile.gi[1]));
}

Study premixed() {
    Study study = coupon();
    study.scene.sides = Sides::periodic;
    study.scene.share_a = {0.85, 0.15};
    study.target = linear_target(0.4e-3, 0.15, 1.2e-3, 0.85);
    return study;
}

TEST(ChamberFill, a_map_and_a_spread_of_a_premix_agree_with_the_truth) {
    const Study study = premixed();
    const Heap heap;
    const Design design = start_design(study);
    Truth expected = truth(heap, study, design, true);
    RunOptions options;
    options.spread = engine(heap, std::make_shared<Calls>());
    SpreadRunner runner(options);
    const Evaluation map = MapEvaluator(study, runner, nullptr).evaluate(design, 0);
    const Evaluation full = DemEvaluator(study, runner, nullptr).evaluate(design, 7);
    EXPECT_TRUE(full.every_grain);
    for (std::size_t b = 0; b < expected.gi.size(); ++b) {
        const double gi = 0.15 + 0.7 * expected.gi[b];
        EXPECT_NEAR(map.profile.gi[b], gi, 0.06) << b;
        EXPECT_NEAR(full.profile.gi[b], gi, 0.04) << b;
        EXPECT_NEAR(full.plain_check.gi[b], gi, 0.12) << b;  // the lots of single grains show in their bins
        EXPECT_NEAR(full.drift.difference[b], 0.7 * expected.drift[b], 0.1) << b;
    }
    // a grain of A where chamber B holds none sends it back to the bins
    Study pure_b = study;
    pure_b.scene.share_a[1] = 0;
    Heap stray = heap;
    stray.stray = 0.1;
    RunOptions other;
    other.spread = engine(stray, std::make_shared<Calls>());
    SpreadRunner strays(other);
    EXPECT_FALSE(DemEvaluator(pure_b, strays, nullptr).evaluate(design, 7).every_grain);
}

TEST(ChamberFill, a_ramp_between_two_mixes_is_designed_and_met) {
    const Study study = premixed();
    const Heap heap;
    RunOptions options;
    options.spread = engine(heap, std::make_shared<Calls>());
    const StudyResult result = run_map_strategy(study, options);
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    Truth laid = truth(heap, study, result.design, true);
    for (double& gi : laid.gi) gi = 0.15 + 0.7 * gi;
    EXPECT_LT(true_rmse(study, laid), study.objective.tolerance);
    ASSERT_TRUE(result.kinematic);
    EXPECT_GT(result.kinematic->profile.gi.front(), 0.14);
}

TEST(ChamberFill, a_study_says_its_premix_and_is_warned_of_targets_beyond_it) {
    const auto study_of = [](const char* premix, const char* gi) {
        return parse_study(
            std::string("[machine]\nuse = \"coupon-rig\"\n[powder.A]\nmaterial = \"SS17-4PH\"\n"
                        "[powder.B]\nmaterial = \"IN718\"\n[target]\nshape = \"linear\"\n"
                        "from = { y = \"0.4 mm\", gi = 0.2 }\nto = { y = \"1.2 mm\", gi = ") +
                gi + " }\n[design_space]\npremix = " + premix + "\n",
            "premix.toml");
    };
    const auto warned = [](const Study& study) {
        return std::any_of(study.warnings.begin(), study.warnings.end(),
                           [](const std::string& w) { return w.find("premix") != std::string::npos; });
    };
    const Study inside = study_of("{ A = 0.9, B = 0.1 }", "0.8");
    EXPECT_EQ(inside.scene.share_a[0], 0.9);
    EXPECT_EQ(inside.scene.share_a[1], 0.1);
    EXPECT_FALSE(warned(inside));
    EXPECT_TRUE(warned(study_of("{ A = 0.7 }", "0.8")));
    // strips carry no powder: pure whatever the chambers hold, so that their cache serves every premix
    EXPECT_EQ(scene_of(inside, start_design(inside), true, 1).share_a[0], 1);
    EXPECT_EQ(scene_of(inside, start_design(inside), false, 1).share_a[0], 0.9);
}

}  // namespace
}  // namespace gradwright
