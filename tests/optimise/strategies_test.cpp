// Every strategy on the same heap, whose transport kernel is known.
#include "optimise/strategies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "optimise/search_space.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

struct Outcome {
    StudyResult result;
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
};
Outcome run(const std::string& name, const Study& study, const Heap& heap, Fidelity fidelity, int budget,
            RunOptions options = {}) {
    Outcome outcome;
    if (!options.spread) options.spread = engine(heap, outcome.calls);
    outcome.result = run_strategy(study, {name, fidelity, budget}, options);
    return outcome;
}

int count_stage(const StudyResult& result, const std::string& stage) {
    return int(std::count_if(result.history.begin(), result.history.end(),
                             [&](const HistoryEntry& entry) { return entry.stage == stage; }));
}

std::string used(const StudyResult& result, const std::string& option) {
    for (const auto& [name, value] : result.given_used)
        if (name == option) return value;
    return "";
}

/// A target that the closed form misses on this heap: skewed origins, so that there is something to be found.
struct Skewed {
    Study study = coupon();
    Heap heap;
    Skewed() {
        heap.centre = 0.8;
        heap.mixing = 0.35;
        heap.turn = 0;
        study.design_space.knots = 3;
    }
};

class EveryStrategy : public testing::TestWithParam<std::string> {
  protected:
    bool plain() const { return searches_one_fidelity(GetParam()); }
    /// Keeps to `spreads` in all, by the budget that the strategy listens to.
    Outcome over_full(Study study, const Heap& heap, int spreads, RunOptions options = {}) const {
        study.max_spreads = spreads;
        return run(GetParam(), study, heap, Fidelity::full, spreads - 1, std::move(options));
    }
};

TEST_P(EveryStrategy, over_full_spreads_keeps_its_budget_and_confirms_on_beds_that_it_never_saw) {
    const Skewed skewed;
    const Outcome got = over_full(skewed.study, skewed.heap, 14);
    const StudyResult& result = got.result;
    EXPECT_LE(result.spreads_map + result.spreads_full, 14);
    EXPECT_EQ(result.spreads_full, int(got.calls->full_seeds.size()));
    EXPECT_EQ(result.spreads_map, int(got.calls->map_seeds.size()));
    ASSERT_FALSE(result.confirmations.empty());
    for (const HistoryEntry& entry : result.history)
        EXPECT_TRUE(entry.stage == GetParam() || entry.stage == "start" || entry.stage == "map" ||
                    entry.stage == "correct" || entry.stage == "confirm")
            << entry.stage;
    for (const Evaluation& confirmation : result.confirmations)
        EXPECT_EQ(std::count(got.calls->full_seeds.begin(), got.calls->full_seeds.end(), confirmation.seed),
                  1);
    if (GetParam() == "map") return;
    EXPECT_GE(count_stage(result, GetParam()), 1);
    EXPECT_LE(count_stage(result, GetParam()), 13);
    // two levels: our word, then the method's own
    EXPECT_NE(used(result, "search").find(", "), std::string::npos) << used(result, "search");
    EXPECT_FALSE(used(result, "budget").empty());
}

TEST_P(EveryStrategy, the_same_study_gives_the_same_numbers) {
    Skewed skewed;
    skewed.heap.grains_per_m2 /= 4;
    const StudyResult a = over_full(skewed.study, skewed.heap, 10).result,
                      b = over_full(skewed.study, skewed.heap, 10).result;
    EXPECT_EQ(a.misfit.value, b.misfit.value);
    EXPECT_EQ(a.confirmed.gi, b.confirmed.gi);
    EXPECT_EQ(used(a, "search"), used(b, "search"));
}

TEST_P(EveryStrategy, a_stop_keeps_what_there_is) {
    Skewed skewed;
    skewed.heap.grains_per_m2 /= 4;
    std::atomic<bool> stop = false;
    RunOptions options;
    options.stop = &stop;
    auto calls = std::make_shared<Calls>();
    const SpreadFunction heap = engine(skewed.heap, calls);
    options.spread = [&](const Scene& scene, const PartitionCurve* partition,
                         const SpreadOptions& spread_options) {
        SpreadResult result = heap(scene, partition, spread_options);
        if (calls->full_seeds.size() >= 2) {
            stop = true;
            result.health.status = "interrupted";
        }
        return result;
    };
    skewed.study.objective.tolerance = 0.001;  // out of reach: no strategy ends before
    const StudyResult result = over_full(skewed.study, skewed.heap, 14, options).result;
    EXPECT_EQ(result.termination, "interrupted");
    EXPECT_FALSE(result.predicted.profile.gi.empty());
    EXPECT_EQ(calls->full_seeds.size(), 2u);
}

TEST_P(EveryStrategy, nothing_but_failures_ends_failed_with_the_reason) {
    Skewed skewed;
    skewed.heap.grains_per_m2 /= 4;
    skewed.heap.fail_full = 99;
    const StudyResult result = over_full(skewed.study, skewed.heap, 8).result;
    EXPECT_EQ(result.termination, "failed");
    EXPECT_NE(result.message.find("nip"), std::string::npos) << result.message;
    EXPECT_EQ(result.verdict, Verdict::undecided);
    EXPECT_TRUE(std::isfinite(result.misfit.value));
}

TEST_P(EveryStrategy, a_fixed_partition_is_judged_and_not_moved) {
    Study study = coupon();
    study.design_space.partition_free = false;
    study.design_space.given_points = {{0, 1.3e-3}, {3.2e-3, 0.3e-3}};
    const StudyResult result = over_full(study, {}, 4).result;
    ASSERT_EQ(result.design.partition.points.size(), 2u);
    EXPECT_EQ(result.design.partition.points[0].y, 1.3e-3);
    EXPECT_GE(result.spreads_full, 1);
}

INSTANTIATE_TEST_SUITE_P(Strategies, EveryStrategy, testing::ValuesIn(strategy_names()),
                         [](const auto& name) { return name.param; });

class EveryPlainStrategy : public testing::TestWithParam<std::string> {};

std::vector<std::string> plain_names() {
    std::vector<std::string> names;
    for (const std::string& name : strategy_names())
        if (searches_one_fidelity(name)) names.push_back(name);
    return names;
}

TEST_P(EveryPlainStrategy, over_the_map_finds_the_ramp_with_one_map_spread) {
    const Skewed skewed;
    const Outcome got = run(GetParam(), skewed.study, skewed.heap, Fidelity::map, 150);
    EXPECT_EQ(got.result.spreads_map, 1);
    EXPECT_LE(count_stage(got.result, GetParam()), 150);
    // never worse than the closed form, which it began with; the record is by objective on the map
    const double start = got.result.history.front().objective;
    EXPECT_LE(got.result.predicted.objective, start + 1e-12);
    EXPECT_LT(true_rmse(skewed.study, truth(skewed.heap, skewed.study, got.result.design, true)), 0.05);
    EXPECT_FALSE(got.result.map_layers.empty());
}

TEST_P(EveryPlainStrategy, over_the_kinematic_picture_needs_no_spread_but_the_confirmation) {
    Heap heap;
    heap.centre = 0.5;
    heap.mixing = 3;  // uniform origins: the kinematic picture is the truth
    heap.turn = 0;
    const Outcome got = run(GetParam(), coupon(), heap, Fidelity::kinematic, 60);
    EXPECT_EQ(got.result.spreads_map, 0);
    EXPECT_EQ(got.result.verdict, Verdict::met) << got.result.message;
    EXPECT_TRUE(got.calls->map_seeds.empty());
}

INSTANTIATE_TEST_SUITE_P(Strategies, EveryPlainStrategy, testing::ValuesIn(plain_names()),
                         [](const auto& name) { return name.param; });

TEST(CeresStrategy, over_full_spreads_lowers_the_misfit_below_the_closed_form) {
    Skewed skewed;
    const Outcome got = run("ceres", skewed.study, skewed.heap, Fidelity::full, 40);
    ASSERT_FALSE(got.result.history.empty());
    EXPECT_LT(got.result.predicted.objective, 0.8 * got.result.history.front().objective)
        << used(got.result, "search");
    EXPECT_LT(true_rmse(skewed.study, truth(skewed.heap, skewed.study, got.result.design, true)), 0.04);
    for (int i = 0; i < count_stage(got.result, "ceres"); ++i)  // common random numbers
        EXPECT_EQ(got.calls->full_seeds[i], got.calls->full_seeds[0]);
}

TEST(MfStrategy, powders_that_the_map_does_not_know_are_mended_by_few_full_spreads) {
    Study study = coupon();
    study.max_spreads = 14;
    study.scene.powder[1].material.density *= 0.54;
    Heap heap;
    heap.full_shift = -0.12;  // about 0.12 in GI between map and spread
    const Outcome got = run("mf", study, heap, Fidelity::map, 0);
    const StudyResult& result = got.result;
    ASSERT_GE(count_stage(result, "mf"), 2);
    double first = -1;
    for (const HistoryEntry& entry : result.history)
        if (entry.stage == "mf" && first < 0) first = entry.misfit;
    EXPECT_GT(first, 0.08);  // the map's own optimum, spread
    EXPECT_EQ(result.verdict, Verdict::met) << result.message << used(result, "search");
    EXPECT_LT(true_rmse(study, truth(heap, study, result.design, true)), study.objective.tolerance);
    EXPECT_EQ(result.spreads_map, 1);
    EXPECT_LE(count_stage(result, "mf"), 9);  // 13 left, 4 of them kept for the confirmation
    EXPECT_LE(result.spreads_full, 13);
}

TEST(MfStrategy, one_spread_in_all_is_a_prediction_and_says_so) {
    Study study = coupon();
    study.max_spreads = 1;
    const StudyResult result = run("mf", study, {}, Fidelity::map, 0).result;
    EXPECT_EQ(result.verdict, Verdict::undecided);
    EXPECT_EQ(result.termination, "budget");
    EXPECT_EQ(result.spreads_full, 0);
    EXPECT_FALSE(result.predicted.profile.gi.empty());
}

TEST(MfStrategy, free_land_stays_and_that_is_said) {
    Study study = coupon();
    study.design_space.land = {"land", 3.2e-3, true, 1.6e-3, 8e-3};
    const StudyResult result = run("mf", study, {}, Fidelity::map, 0).result;
    EXPECT_EQ(result.design.land, 3.2e-3);
    EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(), [](const std::string& warning) {
        return warning.find("land stay at their start") != std::string::npos;
    }));
}

TEST(Strategies, a_name_or_a_fidelity_that_is_not_there_is_refused) {
    EXPECT_THROW(run_strategy(coupon(), {"bobyca", Fidelity::map, 5}, {}), std::invalid_argument);
    EXPECT_THROW(run_strategy(coupon(), {"ceres", Fidelity::lammps, 5}, {}), std::invalid_argument);
    EXPECT_EQ(strategy_names().size(), 9u);
}

TEST(SearchSpace, the_footprint_stays_whole_and_numbers_outside_are_clipped) {
    Study study = coupon();
    study.design_space.footprint_offset = {"footprint_offset", 0, true, -5e-3, 5e-3};
    study.design_space.dosage_factor = {"dosage_factor", 3, true, 2, 5};
    const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, {true, false});
    const std::vector<double> p(family.size(), 0.3);
    const SearchSpace space(study, family, start_design(study), p);
    std::vector<double> x = space.start();
    for (const double end : {-1.0, 2.0}) {
        x.back() = end;
        const Footprint footprint = footprint_of(study, space.design(x));
        EXPECT_NEAR(footprint.x_high - footprint.x_low, 1.6e-3, 1e-12);
    }
    EXPECT_NEAR(space.design(space.start()).footprint_offset, 0, 1e-12);
    EXPECT_NEAR(space.design(space.start()).dosage_factor, 3, 1e-12);
    const SearchSpace labels(study, family, start_design(study), p, Moves::labels);
    EXPECT_EQ(labels.free_count(), space.free_count() - 1);
    x.assign(space.size(), 9);
    EXPECT_EQ(space.design(x).dosage_factor, 5);
    EXPECT_EQ(labels.design(x).dosage_factor, 3);
}

}  // namespace
}  // namespace gradwright
