#include "optimise/nlopt_strategy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optimise/strategies.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

/// sum_k (y_k - target_k)^2 over the knots: its minimum is known, and so is where it lies.
class Quadratic : public Evaluator {
  public:
    std::vector<double> target;
    int calls = 0, fail_every = 0;
    bool out_of_bounds = false;
    Evaluation evaluate(const Design& design, std::uint64_t seed) override {
        Evaluation e;
        e.design = design;
        e.seed = seed;
        ++calls;
        for (std::size_t k = 0; k < target.size(); ++k) {
            const double y = design.partition.points[k].y;
            out_of_bounds = out_of_bounds || y < -0.8e-3 - 1e-12 || y > 2.4e-3 + 1e-12;
            e.objective += 1e6 * (y - target[k]) * (y - target[k]);
        }
        e.health.status = fail_every && calls % fail_every == 0 ? "jammed" : "ok";
        return e;
    }
    Fidelity fidelity() const override { return Fidelity::map; }
};

EvaluatorSearch search(Quadratic& quadratic, int budget, SearchMethod method = SearchMethod::bobyqa) {
    Study study = coupon();
    study.design_space.knots = 3;
    study.design_space.monotone = false;
    const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, {});
    const SearchSpace space(study, family, start_design(study), {0.5, 0.5, 0.5, 0});
    return search_with(method, {quadratic, space, 7, budget, {}, {}});
}

TEST(Bobyqa, finds_the_known_minimum_of_a_quadratic_evaluator) {
    Quadratic quadratic;
    quadratic.target = {1.2e-3, 0.9e-3, 0.3e-3};
    const EvaluatorSearch found = search(quadratic, 200);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(found.best.design.partition.points[k].y, quadratic.target[k], 1e-6);
    EXPECT_EQ(found.termination, "converged") << found.native;
    EXPECT_EQ(found.best.seed, 7u);  // common random numbers
}

TEST(Bobyqa, a_minimum_outside_is_found_on_the_bound_and_never_beyond) {
    Quadratic quadratic;
    quadratic.target = {9e-3, 0.9e-3, -9e-3};
    const EvaluatorSearch found = search(quadratic, 300);
    EXPECT_NEAR(found.best.design.partition.points[0].y, 1.5 * 1.6e-3, 1e-6);
    EXPECT_NEAR(found.best.design.partition.points[2].y, -0.5 * 1.6e-3, 1e-6);
    EXPECT_FALSE(quadratic.out_of_bounds);
}

class EveryMethodOverAnEvaluator : public testing::TestWithParam<SearchMethod> {};

TEST_P(EveryMethodOverAnEvaluator, keeps_its_budget_its_own_best_and_one_seed) {
    Quadratic quadratic;
    quadratic.target = {1.2e-3, 0.9e-3, 0.3e-3};
    const EvaluatorSearch found = search(quadratic, 12, GetParam());
    EXPECT_EQ(quadratic.calls, 12);
    EXPECT_EQ(found.evaluations, 12);
    EXPECT_EQ(found.termination, "budget") << found.native;
    EXPECT_LE(found.best.objective, 0.42 + 1e-12);  // start: 0.16 + 0.01 + 0.25
    EXPECT_EQ(found.best.seed, 7u);
}

TEST_P(EveryMethodOverAnEvaluator, evaluations_without_numbers_are_passed_over) {
    Quadratic quadratic;
    quadratic.target = {1.2e-3, 0.9e-3, 0.3e-3};
    quadratic.fail_every = 9;
    const EvaluatorSearch found = search(quadratic, 400, GetParam());
    EXPECT_TRUE(found.best.health.ok());
    EXPECT_LT(found.best.objective, 0.3);  // 0.42 at the start
}

INSTANTIATE_TEST_SUITE_P(Nlopt, EveryMethodOverAnEvaluator, testing::ValuesIn(kSearchMethods),
                         [](const auto& method) { return std::string(to_string(method.param)); });

TEST(BobyqaStrategy, over_the_map_meets_the_ramp_with_one_map_spread) {
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    const Heap heap;
    options.spread = engine(heap, calls);
    const Study study = coupon();
    const StudyResult result = run_strategy(study, {"bobyqa", Fidelity::map, 150}, options);
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    EXPECT_EQ(result.spreads_map, 1);
    EXPECT_LT(true_rmse(study, truth(heap, study, result.design, true)), 0.04);
    EXPECT_FALSE(result.map_layers.empty());
}

TEST(BobyqaStrategy, over_full_spreads_confirms_on_a_seed_that_the_search_never_saw) {
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    options.spread = engine({}, calls);
    Study study = coupon();
    study.max_spreads = 16;
    const StudyResult result = run_strategy(study, {"bobyqa", Fidelity::full, 14}, options);
    EXPECT_LE(result.spreads_full, 16);
    EXPECT_EQ(result.spreads_map, 0);
    ASSERT_FALSE(result.confirmations.empty());
    for (const Evaluation& confirmation : result.confirmations)
        EXPECT_NE(confirmation.seed, calls->full_seeds.front());
    EXPECT_EQ(calls->full_seeds[0], calls->full_seeds[1]);
}

TEST(BobyqaStrategy, over_the_kinematic_picture_needs_no_spread_but_the_confirmation) {
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    Heap heap;
    heap.centre = 0.5;
    heap.mixing = 3;  // uniform origins: the kinematic picture is the truth
    heap.turn = 0;
    options.spread = engine(heap, calls);
    Study study = coupon();
    const StudyResult result = run_strategy(study, {"bobyqa", Fidelity::kinematic, 60}, options);
    EXPECT_EQ(result.spreads_map, 0);
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    EXPECT_TRUE(calls->map_seeds.empty());
}

TEST(BobyqaStrategy, all_failures_end_failed_with_the_reason) {
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    Heap heap;
    heap.fail_map = true;
    options.spread = engine(heap, calls);
    const StudyResult result = run_strategy(coupon(), {"bobyqa", Fidelity::map, 5}, options);
    EXPECT_EQ(result.termination, "failed");
    EXPECT_NE(result.message.find("nip"), std::string::npos) << result.message;
}

}  // namespace
}  // namespace gradwright
