#include "optimise/least_squares_strategy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

constexpr double kWidth = 1.6e-3;

/// Residuals of the three knots' y / W, as given; the objective is their norm. Its optimum is known.
class Knots : public Evaluator {
  public:
    std::function<std::vector<double>(const std::vector<double>&)> residuals;
    std::vector<std::vector<double>> points;
    std::vector<std::uint64_t> seeds;
    std::vector<int> jammed;  ///< calls without numbers, from 1
    int empty_bin = 0;        ///< this call has lost a residual
    Evaluation evaluate(const Design& design, std::uint64_t seed) override {
        Evaluation e;
        e.design = design;
        e.seed = seed;
        seeds.push_back(seed);
        std::vector<double> y;
        for (const PlanPoint& point : design.partition.points) y.push_back(point.y / kWidth);
        points.push_back(y);
        const int call = int(points.size());
        e.health.status = std::count(jammed.begin(), jammed.end(), call) ? "jammed" : "ok";
        e.residuals = residuals(y);
        double sum = 0;
        for (const double r : e.residuals) sum += r * r;
        e.objective = std::sqrt(sum);
        if (call == empty_bin) e.residuals.pop_back();
        return e;
    }
    Fidelity fidelity() const override { return Fidelity::full; }
};

SearchSpace three_knots(const std::vector<double>& start = {0.5, 0.5, 0.5, 0}) {
    Study study = coupon();
    study.design_space.knots = 3;
    study.design_space.monotone = false;
    return {study, PartitionFamily(study.design_space, 3.2e-3, kWidth, {}), start_design(study), start};
}

/// y - optimum, coupled: Gauss-Newton is there in a step.
std::vector<double> linear(const std::vector<double>& y) {
    const double a = y[0] - 0.75, b = y[1] - 0.55, c = y[2] - 0.2;
    return {a + 0.3 * b, b - 0.2 * c, c + 0.1 * a, 0.5 * (a + b + c)};
}

double distance(const EvaluatorSearch& found, const std::vector<double>& optimum) {
    double most = 0;
    for (int k = 0; k < 3; ++k)
        most = std::max(most, std::fabs(found.best.design.partition.points[k].y / kWidth - optimum[k]));
    return most;
}

TEST(LeastSquares, finds_the_known_optimum_of_linear_residuals) {
    Knots knots;
    knots.residuals = linear;
    const SearchSpace space = three_knots();
    const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, 100});
    EXPECT_LT(distance(found, {0.75, 0.55, 0.2}), 1e-3);
    EXPECT_EQ(found.termination, "converged") << found.native;
    EXPECT_EQ(found.native, "Ceres LEVENBERG_MARQUARDT: CONVERGENCE");
    EXPECT_EQ(found.evaluations, int(knots.points.size()));
    for (const std::uint64_t seed : knots.seeds) EXPECT_EQ(seed, 7u);  // common random numbers
}

TEST(LeastSquares, finds_the_known_optimum_of_a_curved_valley) {
    Knots knots;
    knots.residuals = [](const std::vector<double>& y) {
        const double u = 2 * y[0], v = 2 * y[1];  // Rosenbrock, 3 (v - u^2) instead of 10, at (0.5, 0.5)
        return std::vector<double>{3 * (v - u * u), 1 - u, y[2] - 0.4};
    };
    const SearchSpace space = three_knots({-0.4, 1.2, 0.9, 0});
    const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, 300});
    EXPECT_LT(distance(found, {0.5, 0.5, 0.4}), 0.02) << found.native;
}

TEST(LeastSquares, roughness_of_single_grains_does_not_lead_it_astray) {
    // A step of 0.01 every 0.004: to a derivative over 1e-6 all is flat, or a cliff.
    Knots knots;
    knots.residuals = [](const std::vector<double>& y) {
        std::vector<double> r = linear(y);
        for (double& number : r) number = 0.01 * std::round(number / 0.01);
        return r;
    };
    const SearchSpace space = three_knots();
    const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, 100});
    EXPECT_LT(distance(found, {0.75, 0.55, 0.2}), 0.03) << found.native;
    EXPECT_GT(found.evaluations, 1);
}

TEST(LeastSquares, differences_step_by_their_share_of_the_range_to_both_sides) {
    for (const double share : {0.03, 0.05, 0.1}) {
        Knots knots;
        knots.residuals = linear;
        const SearchSpace space = three_knots();
        LeastSquaresOptions options;
        options.difference_step = share;
        least_squares_with(options, {knots, space, 7, 10});
        // start; then each knot up and down by the share of [-0.5, 1.5]
        ASSERT_GE(knots.points.size(), 7u);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(knots.points[1 + 2 * k][k] - 0.5, 2 * share, 1e-12);
            EXPECT_NEAR(knots.points[2 + 2 * k][k] - 0.5, -2 * share, 1e-12);
        }
    }
}

TEST(LeastSquares, at_the_bounds_it_differences_to_one_side_and_never_leaves_the_box) {
    Knots knots;
    knots.residuals = [](const std::vector<double>& y) {
        return std::vector<double>{y[0] - 3, y[1] - 0.55, y[2] + 2};  // two optima outside [-0.5, 1.5]
    };
    const SearchSpace space = three_knots({1.5, 0.5, -0.5, 0});
    const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, 100});
    // 1e-4 of the squares that the bounds leave, 3, is what the middle knot may still lack
    EXPECT_LT(distance(found, {1.5, 0.55, -0.5}), 0.017) << found.native;
    for (const std::vector<double>& y : knots.points)
        for (const double number : y) {
            EXPECT_GE(number, -0.5 - 1e-12);
            EXPECT_LE(number, 1.5 + 1e-12);
        }
}

TEST(LeastSquares, keeps_any_budget_and_buys_no_derivative_without_a_step) {
    const SearchSpace space = three_knots();
    for (const int budget : {1, 3, 5, 6, 8, 9, 10, 17}) {
        Knots knots;
        knots.residuals = [](const std::vector<double>& y) {
            const double u = 2 * y[0], v = 2 * y[1];
            return std::vector<double>{10 * (v - u * u), 1 - u, y[2] - 0.4};
        };
        const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, budget});
        EXPECT_LE(int(knots.points.size()), budget);
        EXPECT_EQ(found.evaluations, int(knots.points.size()));
        EXPECT_EQ(found.termination, "budget") << budget << found.native;
        // 1 + 4 one-sided, 1 + 8 central, and a step; less is not begun
        if (budget < 6) {
            EXPECT_EQ(found.evaluations, 1) << budget;
        } else {
            EXPECT_GE(found.evaluations, 6) << budget;
        }
    }
}

TEST(LeastSquares, best_is_of_all_that_was_seen) {
    Knots knots;
    knots.residuals = linear;
    const SearchSpace space = three_knots({1.4, -0.4, 1.4, 0});
    double least = 1e9;
    const EvaluatorSearch found = least_squares_with(
        {}, {knots, space, 7, 9, {}, [&](const Evaluation& e) { least = std::min(least, e.objective); }});
    EXPECT_EQ(found.best.objective, least);
}

TEST(LeastSquares, points_without_numbers_or_with_an_empty_bin_are_passed_over) {
    Knots knots;
    knots.residuals = linear;
    knots.jammed = {2, 5, 6};  // with the empty bin: one side of the first and third knot, both of the second
    knots.empty_bin = 4;
    const SearchSpace space = three_knots();
    const EvaluatorSearch found = least_squares_with({}, {knots, space, 7, 100});
    EXPECT_LT(distance(found, {0.75, 0.55, 0.2}), 0.01) << found.native;
    Knots never;
    never.residuals = linear;
    never.jammed = {1};
    const EvaluatorSearch nothing = least_squares_with({}, {never, space, 7, 100});
    EXPECT_EQ(nothing.termination, "failed");
    EXPECT_FALSE(nothing.best.health.ok());
}

TEST(LeastSquares, a_stop_ends_it_and_an_exception_arrives_with_its_text) {
    const SearchSpace space = three_knots();
    Knots knots;
    knots.residuals = linear;
    const EvaluatorSearch found =
        least_squares_with({}, {knots, space, 7, 100, [&] { return knots.points.size() >= 5; }});
    EXPECT_EQ(found.termination, "interrupted");
    EXPECT_EQ(found.evaluations, 5);
    EXPECT_TRUE(found.best.health.ok());
    for (const std::size_t at : {1u, 4u, 12u}) {
        Knots thrower;
        thrower.residuals = [&](const std::vector<double>& y) {
            if (thrower.points.size() == at) throw std::runtime_error("disk full");
            return linear(y);
        };
        try {
            least_squares_with({}, {thrower, space, 7, 100});
            FAIL() << "swallowed";
        } catch (const std::runtime_error& problem) {
            EXPECT_STREQ(problem.what(), "disk full");
        }
        EXPECT_EQ(thrower.points.size(), at);
    }
}

TEST(LeastSquares, a_step_that_would_differentiate_noise_is_refused) {
    Knots knots;
    knots.residuals = linear;
    const SearchSpace space = three_knots();
    for (const double step : {0.0, 1e-6, 0.029, 0.11}) {
        LeastSquaresOptions options;
        options.difference_step = step;
        EXPECT_THROW(least_squares_with(options, {knots, space, 7, 10}), std::invalid_argument);
    }
}

}  // namespace
}  // namespace gradwright
