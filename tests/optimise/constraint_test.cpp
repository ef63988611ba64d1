// Linear constraints: the nearest point that keeps them, and every search on problems whose optimum on the
// border is known in closed form.
#include "optimise/constraint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "optimise/ceres_fit.h"
#include "optimise/least_squares_strategy.h"
#include "optimise/nlopt_strategy.h"
#include "optimise/strategies.h"
#include "tests/optimise/map_run.h"

namespace gradwright {
namespace {

using namespace testing_heap;

constexpr double kOpen = std::numeric_limits<double>::infinity();

// ---- the nearest point

TEST(NearestKept, is_the_projection_on_a_plane_on_two_and_on_the_box) {
    const std::vector<double> low(3, -5), high(3, 5);
    const auto sums = [](const std::vector<double>& x) {
        return std::vector<double>{x[0] + x[1], x[1] - x[2]};
    };
    // x0 + x1 <= 1 from (1, 1, 0): half of the excess from each
    std::vector<double> x = nearest_kept(sums, {{-kOpen, 1}, {-kOpen, kOpen}}, low, high, {1, 1, 0});
    EXPECT_NEAR(x[0], 0.5, 1e-9);
    EXPECT_NEAR(x[1], 0.5, 1e-9);
    EXPECT_EQ(x[2], 0);
    // and x1 - x2 >= 1 with it, both active: x = (1, 1, 0) - a (1, 1, 0) + b (0, 1, -1) with 2 a - b = 1 and
    // 2 b - a = 0
    const double a = 2.0 / 3, b = 1.0 / 3;
    x = nearest_kept(sums, {{-kOpen, 1}, {1, kOpen}}, low, high, {1, 1, 0});
    EXPECT_NEAR(x[0], 1 - a, 1e-8);
    EXPECT_NEAR(x[1], 1 - a + b, 1e-8);
    EXPECT_NEAR(x[2], -b, 1e-8);
    // the box stops the first number: the other one has to go all the way
    x = nearest_kept(sums, {{-kOpen, 1}, {-kOpen, kOpen}}, std::vector<double>{0.9, -5, -5}, high, {1, 1, 0});
    EXPECT_NEAR(x[0], 0.9, 1e-8);
    EXPECT_NEAR(x[1], 0.1, 1e-8);
    // what keeps them stays as it is, bit for bit
    EXPECT_EQ(nearest_kept(sums, {{-kOpen, 1}, {-1, 1}}, low, high, {0.1, 0.2, 0.3}),
              (std::vector<double>{0.1, 0.2, 0.3}));
}

TEST(NearestKept, equality_is_kept_to_rounding_and_curved_values_too) {
    const auto product = [](const std::vector<double>& x) { return std::vector<double>{x[0] * x[1]}; };
    const std::vector<double> low(2, 0.0), high(2, 3.0);
    // x y = 1 nearest to (2, 2): (1, 1) by symmetry
    const std::vector<double> x = nearest_kept(product, {{1, 1}}, low, high, {2, 2});
    EXPECT_NEAR(x[0] * x[1], 1, 1e-9);
    EXPECT_NEAR(x[0], 1, 1e-4);
}

TEST(NearestKept, without_any_such_point_says_so_by_what_it_breaks) {
    const auto sum = [](const std::vector<double>& x) { return std::vector<double>{x[0] + x[1]}; };
    const std::vector<double> x =
        nearest_kept(sum, {{3, kOpen}}, std::vector<double>(2, 0.0), std::vector<double>(2, 1.0), {0.2, 0.4});
    EXPECT_NEAR(x[0] + x[1], 2, 1e-6);  // as near as the box lets it
}

// ---- searches over a function with a known optimum

/// Sum of squares of the knots' distances from heights of its own, in widths.
class Heights : public Evaluator {
  public:
    explicit Heights(std::vector<double> heights) : heights_(std::move(heights)) {}
    Evaluation evaluate(const Design& design, std::uint64_t) override {
        Evaluation evaluation;
        evaluation.design = design;
        evaluation.fidelity = Fidelity::kinematic;
        evaluation.health.status = "ok";
        evaluation.objective = 0;
        for (std::size_t k = 0; k < heights_.size(); ++k) {
            const double off = (design.parameters.at(2 * k + 1).second - heights_[k]) / 1.6e-3;
            evaluation.residuals.push_back(off);
            evaluation.objective += off * off;
        }
        return evaluation;
    }
    Fidelity fidelity() const override { return Fidelity::kinematic; }

  private:
    std::vector<double> heights_;
};

/// Two knots at 1.0 and 0.8 mm would be best; asked for is a fall of at least 0.6 mm: by projection each of
/// them goes 0.2 mm, to 1.2 and 0.6 mm.
struct Fall {
    Study study = coupon();
    Heights heights{{1.0e-3, 0.8e-3}};
    Fall() {
        study.design_space.knots = 2;
        study.design_space.monotone = false;
        study.constraints = {{"fall", {{"partition.y0", 1}, {"partition.y1", -1}}, 0.6e-3, kOpen, "length"}};
    }
    EvaluatorSearch search(const std::function<EvaluatorSearch(const SearchTask&)>& method, int budget) {
        const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, {true, false});
        const SearchSpace space(study, family, start_design(study), {0.5, 0.5});
        return method({heights, space, 1, budget});
    }
    void expect_border(const EvaluatorSearch& found, double near) const {
        const auto& y = found.best.design.parameters;
        ASSERT_GE(y.size(), 4u);
        EXPECT_NEAR(y[1].second, 1.2e-3, near);
        EXPECT_NEAR(y[3].second, 0.6e-3, near);
        const std::vector<ConstraintState> states = constraint_states(study, found.best.design);
        ASSERT_EQ(states.size(), 1u);
        EXPECT_TRUE(states[0].kept()) << describe(states[0]);
        EXPECT_NEAR(states[0].slack, 0, near);
    }
};

class EverySearch : public testing::TestWithParam<SearchMethod> {};

TEST_P(EverySearch, finds_the_optimum_on_the_border) {
    Fall fall;
    const bool local = GetParam() == SearchMethod::bobyqa || GetParam() == SearchMethod::cobyla ||
                       GetParam() == SearchMethod::sbplx;
    fall.expect_border(
        fall.search([](const SearchTask& task) { return search_with(GetParam(), task); }, local ? 200 : 3000),
        local ? 5e-6 : 40e-6);
}

INSTANTIATE_TEST_SUITE_P(all, EverySearch, testing::ValuesIn(kSearchMethods),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(ConstrainedSearch, least_squares_find_the_optimum_on_the_border) {
    Fall fall;
    fall.expect_border(fall.search([](const SearchTask& task) { return least_squares_with({}, task); }, 200),
                       5e-6);
}

TEST(ConstrainedSearch, no_design_is_ever_evaluated_that_breaks_one) {
    Fall fall;
    const PartitionFamily family(fall.study.design_space, 3.2e-3, 1.6e-3, {true, false});
    const SearchSpace space(fall.study, family, start_design(fall.study), {0.5, 0.5});
    int seen = 0;
    const SearchTask task{fall.heights, space, 1, 60, {}, [&](const Evaluation& evaluation) {
                              ++seen;
                              EXPECT_EQ(broken(constraint_states(fall.study, evaluation.design)), 0);
                          }};
    search_with(SearchMethod::bobyqa, task);
    EXPECT_GT(seen, 10);
}

// ---- the fit on a map

TEST(ConstrainedFit, of_a_straight_partition_ends_on_the_border_and_is_the_best_there) {
    Study study = coupon();
    study.design_space.family = Family::straight;
    const Heap heap;
    Calls calls;
    const Design start = start_design(study);
    const std::vector<Layer> layers = {spread(heap, calls, scene_of(study, start, true, 3), nullptr).layer};
    const FitProblem problem(study, start, layers);
    const FitResult free = fit_partition(study, study.design_space, start, problem, {});
    ASSERT_TRUE(free.ok);
    const double degree = std::numbers::pi / 180, best = free.design.parameters[0].second * degree;
    // 5 degrees off the best at least
    const double bound = best + 5 * degree;
    study.constraints = {{"flat", {{"partition.angle", 1}}, bound, kOpen, "angle"}};
    const FitResult kept = fit_partition(study, study.design_space, start, problem, {});
    ASSERT_TRUE(kept.ok);
    EXPECT_NEAR(kept.design.parameters[0].second * degree, bound, 1e-4);
    EXPECT_EQ(broken(constraint_states(study, kept.design)), 0);
    EXPECT_GT(kept.objective, free.objective);
    // with the angle fixed there, the offset alone finds nothing better
    Study fixed = study;
    fixed.constraints.clear();
    fixed.design_space.angle_deg.free = false;
    fixed.design_space.angle_deg.value = bound / degree;
    const FitResult there = fit_partition(fixed, fixed.design_space, start, problem, {});
    EXPECT_NEAR(kept.objective, there.objective, 1e-3);
    for (const Design& finalist : kept.finalists) EXPECT_EQ(broken(constraint_states(study, finalist)), 0);
}

// ---- whole strategies

TEST(ConstrainedStrategy, a_bound_that_costs_nothing_is_met_with_its_slack_stated) {
    Study study = coupon();
    study.constraints = {{"fall", {{"partition.y0", 1}, {"partition.y4", -1}}, 0.1e-3, kOpen, "length"}};
    const StudyResult result = run(study, {}).result;
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    ASSERT_EQ(result.constraints.size(), 1u);
    EXPECT_GT(result.constraints[0].slack, 0);
    double fall = 0;
    for (const auto& [name, value] : result.design.parameters)
        fall += name == "y0_m" ? value : name == "y4_m" ? -value : 0;
    EXPECT_DOUBLE_EQ(result.constraints[0].value, fall);
    EXPECT_DOUBLE_EQ(result.constraints[0].slack, fall - 0.1e-3);
}

class EveryStrategyConstrained : public testing::TestWithParam<std::string> {};

TEST_P(EveryStrategyConstrained, keeps_a_bound_that_spoils_the_gradation_and_names_it) {
    Study study = coupon();
    study.design_space.knots = 3;
    study.max_spreads = 5;
    // a plate along x lays no ramp; equal bounds bind wherever a search ends
    study.constraints = {{"flat", {{"partition.y0", 1}, {"partition.y2", -1}}, 0, 0, "length"},
                         {"straight", {{"partition.y0", 1}, {"partition.y1", -1}}, 0, 0, "length"}};
    RunOptions options;
    options.spread = engine(Heap{}, std::make_shared<Calls>());
    const StudyResult result = run_strategy(study, {GetParam(), Fidelity::map, 60}, options);
    EXPECT_EQ(result.verdict, Verdict::not_met) << result.message;
    ASSERT_EQ(result.constraints.size(), 2u);
    for (const ConstraintState& state : result.constraints) EXPECT_TRUE(state.kept()) << describe(state);
    EXPECT_NE(result.message.find("binds"), std::string::npos) << result.message;
}

INSTANTIATE_TEST_SUITE_P(all, EveryStrategyConstrained,
                         testing::Values("map", "mf", "bobyqa", "cobyla", "sbplx", "crs", "isres", "direct",
                                         "ceres"),
                         [](const auto& info) { return info.param; });

TEST(ConstrainedStrategy, an_impossible_set_is_not_met_and_names_what_is_broken) {
    Study study = coupon();
    study.constraints = {{"steep", {{"partition.y0", 1}, {"partition.y4", -1}}, 2e-3, kOpen, "length"},
                         {"level", {{"partition.y0", 1}, {"partition.y4", -1}}, -kOpen, 0.5e-3, "length"}};
    const StudyResult result = run(study, {}).result;
    EXPECT_EQ(result.verdict, Verdict::not_met);
    EXPECT_EQ(result.message.find("No design was found that keeps every constraint: '"), 0u)
        << result.message;
    EXPECT_TRUE(std::any_of(result.constraints.begin(), result.constraints.end(),
                            [](const ConstraintState& state) { return !state.kept(); }));
}

TEST(ConstrainedStrategy, motion_is_searched_within_its_constraints) {
    Study study = coupon();
    study.design_space.land = {"land", 3.2e-3, true, 1e-3, 6e-3};
    study.design_space.footprint_offset = {"footprint_offset", 0, true, -1.6e-3, 0};
    study.max_spreads = 8;
    study.constraints = {{"way", {{"land", 1}, {"footprint_offset", 1}}, -kOpen, 2e-3, "length"}};
    const Outcome got = run(study, {});
    const Design& design = got.result.design;
    EXPECT_LE(design.land + design.footprint_offset, 2e-3 + 1e-9);
    for (const HistoryEntry& entry : got.result.history)
        EXPECT_LE(entry.design.land + entry.design.footprint_offset, 2e-3 + 1e-9) << entry.stage;
    ASSERT_EQ(got.result.constraints.size(), 1u);
}

TEST(ConstrainedStrategy, a_limit_on_waste_that_the_machine_breaks_is_not_met) {
    Study study = coupon();
    const Heap heap;  // 1 - capture = 0.4 of every dose overflows
    study.objective.max_waste = 0.41;
    const StudyResult kept = run(study, heap).result;
    EXPECT_EQ(kept.verdict, Verdict::met) << kept.message;
    ASSERT_EQ(kept.constraints.size(), 1u);
    EXPECT_NEAR(kept.constraints[0].slack, 0.01, 1e-9);
    study.objective.max_waste = 0.35;
    const StudyResult broken_one = run(study, heap).result;
    EXPECT_EQ(broken_one.verdict, Verdict::not_met);
    EXPECT_NE(broken_one.message.find("'objective.max_waste' is broken by 0.05"), std::string::npos)
        << broken_one.message;
}

}  // namespace
}  // namespace gradwright
