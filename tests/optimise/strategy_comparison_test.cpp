// Strategies side by side on the heap whose truth is known.
#include "optimise/strategy_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

struct Arena {
    Study study = coupon();
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
    ComparisonOptions options;
    explicit Arena(std::vector<std::string> strategies, Heap heap = {}) {
        study.design_space.knots = 3;
        heap.grains_per_m2 /= 2;
        options.strategies = std::move(strategies);
        options.budget = 9;
        options.run.spread = engine(heap, calls);
    }
};

TEST(Comparison, every_strategy_keeps_the_budget_and_is_judged_on_the_same_unseen_beds) {
    Arena arena(strategy_names());
    std::vector<std::size_t> before;  // full spreads when each strategy had ended
    arena.options.after_strategy = [&](const std::string&, const StudyResult&) {
        before.push_back(arena.calls->full_seeds.size());
    };
    const StrategyComparison comparison = compare_strategies(arena.study, arena.options);
    EXPECT_EQ(comparison.status, "ok");
    EXPECT_EQ(comparison.evaluations, 8);
    ASSERT_EQ(comparison.strategies.size(), strategy_names().size());
    ASSERT_EQ(comparison.seeds.size(), 2u);
    const std::vector<std::uint64_t>& full = arena.calls->full_seeds;
    for (std::size_t k = 0; k < before.size(); ++k) {
        const ComparedStrategy& row = comparison.strategies[k];
        EXPECT_EQ(row.name, strategy_names()[k]);
        EXPECT_LE(row.spreads_map + row.spreads_full, 9) << row.name;
        EXPECT_GE(row.spreads_full, 1) << row.name;
        EXPECT_EQ(row.confirmations, 2) << row.reason;
        EXPECT_GT(row.misfit.noise_floor, 0);
        EXPECT_EQ(row.native.empty(), row.name == "map");
        // the two spreads after each strategy are the judgement's
        EXPECT_EQ(full[before[k]], comparison.seeds[0]);
        EXPECT_EQ(full[before[k] + 1], comparison.seeds[1]);
        // what is confirmed is the truth of the design, within the noise
        const double true_misfit = true_rmse(arena.study, truth(Heap{}, arena.study, row.design, true));
        EXPECT_NEAR(row.misfit.debiased, true_misfit, 3 * row.misfit.noise_floor) << row.name;
    }
    for (const std::uint64_t seed : comparison.seeds)
        EXPECT_EQ(std::count(full.begin(), full.end(), seed), long(before.size()));
}

TEST(Comparison, on_the_map_evaluations_are_the_bound_and_spreads_stay_few) {
    Arena arena({"bobyqa", "ceres"});
    arena.options.fidelity = Fidelity::map;
    arena.options.evaluations = 40;
    arena.options.confirmations = 3;
    const StrategyComparison comparison = compare_strategies(arena.study, arena.options);
    EXPECT_EQ(comparison.evaluations, 40);
    for (const ComparedStrategy& row : comparison.strategies) {
        EXPECT_EQ(row.spreads_map, 1);
        EXPECT_EQ(row.confirmations, 3);
        EXPECT_LT(true_rmse(arena.study, truth(Heap{}, arena.study, row.design, true)), 0.05) << row.name;
    }
}

TEST(Comparison, the_same_study_gives_the_same_table) {
    Arena a({"crs", "mf"}), b({"crs", "mf"});
    const StrategyComparison one = compare_strategies(a.study, a.options),
                             other = compare_strategies(b.study, b.options);
    for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(one.strategies[k].misfit.value, other.strategies[k].misfit.value);
        EXPECT_EQ(one.strategies[k].native, other.strategies[k].native);
    }
}

TEST(Comparison, a_failure_fills_its_row_and_the_others_go_on) {
    Heap heap;
    heap.fail_map = true;
    Arena arena({"map", "bobyqa"}, heap);
    const StrategyComparison comparison = compare_strategies(arena.study, arena.options);
    EXPECT_EQ(comparison.strategies[0].termination, "failed");
    EXPECT_NE(comparison.strategies[0].reason.find("nip"), std::string::npos)
        << comparison.strategies[0].reason;
    EXPECT_EQ(comparison.strategies[0].confirmations, 0);
    EXPECT_EQ(comparison.strategies[1].confirmations, 2);
    EXPECT_EQ(comparison.status, "ok");
}

TEST(Comparison, a_stop_keeps_the_finished_rows) {
    Arena arena({"bobyqa", "cobyla", "mf"});
    std::atomic<bool> stop = false;
    arena.options.run.stop = &stop;
    arena.options.after_strategy = [&](const std::string& name, const StudyResult&) {
        stop = name == "cobyla";
    };
    const StrategyComparison comparison = compare_strategies(arena.study, arena.options);
    EXPECT_EQ(comparison.status, "interrupted");
    EXPECT_EQ(comparison.strategies[0].confirmations, 2);
    EXPECT_EQ(comparison.strategies[1].reason, "interrupted");
    EXPECT_EQ(comparison.strategies[2].termination, "not_run");
}

TEST(Comparison, options_that_cannot_be_compared_are_refused) {
    const auto refused = [](std::vector<std::string> names, int budget) {
        Arena arena(std::move(names));
        arena.options.budget = budget;
        EXPECT_THROW(compare_strategies(arena.study, arena.options), std::invalid_argument);
        EXPECT_TRUE(arena.calls->full_seeds.empty());
    };
    refused({}, 9);
    refused({"bobyca"}, 9);
    refused({"map", "map"}, 9);
    refused({"map"}, 1);
    refused({"map"}, kMostCompared + 1);
}

}  // namespace
}  // namespace gradwright
