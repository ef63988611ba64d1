// Every search method on the same problems, whose optimum is known in closed form.
#include "optimise/bounded_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dem/random.h"

namespace gradwright {
namespace {

using Point = std::vector<double>;

bool local(SearchMethod method) {
    return method == SearchMethod::bobyqa || method == SearchMethod::cobyla || method == SearchMethod::sbplx;
}

/// What a class of methods may be asked for: evaluations, and how near to the optimum they must end.
struct Asked {
    int budget;
    double distance;  ///< largest error of a variable, in a box of one
};
Asked asked(SearchMethod method) {
    if (local(method)) return {600, 2e-3};
    return method == SearchMethod::isres ? Asked{6000, 0.02} : Asked{3000, 5e-3};
}

BoundedSearch box(SearchMethod method, std::size_t variables) {
    BoundedSearch search;
    search.method = method;
    search.low.assign(variables, 0);
    search.high.assign(variables, 1);
    search.start.assign(variables, 0.5);
    search.step.assign(variables, 0.2);
    search.budget = asked(method).budget;
    return search;
}

/// Axes of different curvature, coupled; minimum 0 at `optimum`.
double quadratic(const Point& x, const Point& optimum) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double d = x[i] - optimum[i];
        sum += double(1 + 2 * i) * d * d;
        all += d;
    }
    return sum + 0.5 * all * all;
}

double farthest(const Point& x, const Point& y) {
    double most = 0;
    for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::fabs(x[i] - y[i]));
    return most;
}

class EveryMethod : public testing::TestWithParam<SearchMethod> {};

TEST_P(EveryMethod, finds_the_optimum_of_a_shifted_quadratic) {
    const Point optimum = {0.31, 0.62, 0.44};
    const auto found = minimise([&](const Point& x) { return quadratic(x, optimum); }, box(GetParam(), 3));
    EXPECT_LT(farthest(found.best, optimum), asked(GetParam()).distance) << found.native;
    if (local(GetParam())) {
        EXPECT_EQ(found.termination, "converged") << found.native;
    }
}

TEST_P(EveryMethod, goes_down_the_valley_of_rosenbrock) {
    // x in [-1.5, 2.5]^2 as a box of one; minimum 0 at (1, 1), start (-1.1, 1.7): about 30. COBYLA's linear
    // model crawls along the curved floor: a thousandth of the start is asked of it, of all others 1e-5.
    const auto value = [](const Point& x) {
        const double u = 4 * x[0] - 1.5, v = 4 * x[1] - 1.5;
        return 100 * (v - u * u) * (v - u * u) + (1 - u) * (1 - u);
    };
    BoundedSearch search = box(GetParam(), 2);
    search.start = {0.1, 0.8};
    search.budget = local(GetParam()) ? 1500 : 20000;
    search.x_tolerance = 1e-7;
    const auto found = minimise(value, search);
    EXPECT_LT(found.value, value(search.start) * (GetParam() == SearchMethod::cobyla ? 0.03 : 3e-4))
        << found.native << " " << found.evaluations;
    EXPECT_EQ(found.value, value(found.best));
}

TEST_P(EveryMethod, an_optimum_outside_is_found_on_the_bound_and_never_beyond) {
    const Point optimum = {0, 0.4, 1};
    bool outside = false;
    const auto found = minimise(
        [&](const Point& x) {
            for (const double number : x) outside = outside || number < 0 || number > 1;
            return (x[0] + 0.3) * (x[0] + 0.3) + (x[1] - 0.4) * (x[1] - 0.4) + (x[2] - 1.5) * (x[2] - 1.5);
        },
        box(GetParam(), 3));
    EXPECT_LT(farthest(found.best, optimum), asked(GetParam()).distance) << found.native;
    EXPECT_FALSE(outside);
}

TEST_P(EveryMethod, noise_costs_no_more_than_its_own_height) {
    // Noise of sd 0.01 on every value: the record may be deceived by some sd, the true value there too.
    const Point optimum = {0.31, 0.62, 0.44};
    Random random(3);
    const auto found = minimise(
        [&](const Point& x) { return quadratic(x, optimum) + 0.01 * random.normal(); }, box(GetParam(), 3));
    EXPECT_LT(quadratic(found.best, optimum), 0.05) << found.native;  // 0.29 at the start
}

TEST_P(EveryMethod, a_kink_is_no_trap) {
    const auto value = [](const Point& x) { return std::fabs(x[0] - 0.3) + 2 * std::fabs(x[1] - 0.7); };
    const auto found = minimise(value, box(GetParam(), 2));
    // 0.6 at the start. COBYLA's linear model comes to rest on the steeper crease: two thirds are gone there.
    EXPECT_LT(found.value, GetParam() == SearchMethod::cobyla ? 0.21 : 0.03) << found.native;
}

TEST_P(EveryMethod, spends_its_budget_to_the_last_evaluation_and_not_one_more) {
    // A valley of four variables that none of them has walked through in forty steps.
    for (const int budget : {1, 2, 5, 17, 40}) {
        int calls = 0;
        BoundedSearch search = box(GetParam(), 4);
        search.budget = budget;
        const auto found = minimise(
            [&](const Point& x) {
                ++calls;
                double sum = 0;
                for (int i = 0; i < 3; ++i) {
                    const double u = 4 * x[i] - 1.5, v = 4 * x[i + 1] - 1.5;
                    sum += 100 * (v - u * u) * (v - u * u) + (1 - u) * (1 - u);
                }
                return sum;
            },
            search);
        EXPECT_EQ(calls, budget);
        EXPECT_EQ(found.evaluations, budget);
        EXPECT_EQ(found.termination, "budget") << found.native;
    }
}

TEST_P(EveryMethod, the_best_is_the_best_of_all_that_was_seen_and_no_worse_than_the_start) {
    double least = std::numeric_limits<double>::infinity();
    Point where;
    BoundedSearch search = box(GetParam(), 3);
    search.start = {0.9, 0.2, 0.8};
    search.budget = 23;
    const auto value = [](const Point& x) { return quadratic(x, {0.85, 0.25, 0.75}); };
    const auto found = minimise(
        [&](const Point& x) {
            if (value(x) < least) {
                least = value(x);
                where = x;
            }
            return value(x);
        },
        search);
    EXPECT_EQ(found.value, least);
    EXPECT_EQ(found.best, where);
    EXPECT_LE(found.value, value(search.start));
}

TEST_P(EveryMethod, the_same_seed_gives_the_same_bits) {
    const auto value = [](const Point& x) { return quadratic(x, {0.1, 0.9, 0.2}); };
    BoundedSearch search = box(GetParam(), 3);
    search.budget = 60;
    search.seed = 5;
    const auto a = minimise(value, search), b = minimise(value, search);
    EXPECT_EQ(a.best, b.best);
    EXPECT_EQ(a.native, b.native);
    search.seed = 6;
    const bool random = GetParam() == SearchMethod::crs || GetParam() == SearchMethod::isres;
    EXPECT_EQ(minimise(value, search).best != a.best, random);
}

TEST_P(EveryMethod, an_exception_of_the_objective_arrives_with_its_text) {
    for (const int at : {1, 4, 30}) {
        int calls = 0;
        try {
            minimise(
                [&](const Point& x) -> double {
                    if (++calls == at) throw std::runtime_error("disk full");
                    return quadratic(x, {0.1, 0.9, 0.2, 0.7});
                },
                box(GetParam(), 4));
            FAIL() << "swallowed";
        } catch (const std::runtime_error& problem) {
            EXPECT_STREQ(problem.what(), "disk full");
        }
        EXPECT_EQ(calls, at);
    }
}

TEST_P(EveryMethod, a_stop_ends_it_with_the_best_so_far) {
    int calls = 0;
    BoundedSearch search = box(GetParam(), 3);
    search.stop = [&] { return calls >= 5; };
    double least = 1e9;
    const auto found = minimise(
        [&](const Point& x) {
            ++calls;
            least = std::min(least, quadratic(x, {0.1, 0.9, 0.2}));
            return quadratic(x, {0.1, 0.9, 0.2});
        },
        search);
    EXPECT_EQ(found.termination, "interrupted");
    EXPECT_EQ(calls, 5);
    EXPECT_EQ(found.value, least);
    // before anything was evaluated
    search.stop = [] { return true; };
    const auto nothing = minimise([&](const Point&) { return ++calls, 0.0; }, search);
    EXPECT_EQ(nothing.termination, "interrupted");
    EXPECT_EQ(nothing.best, search.start);
    EXPECT_EQ(calls, 5);
}

TEST_P(EveryMethod, one_free_variable_is_searched_and_fixed_ones_stay) {
    BoundedSearch search = box(GetParam(), 2);
    search.low[1] = search.high[1] = search.start[1] = 0.25;
    search.start[0] = 0.9;
    const auto found = minimise(
        [](const Point& x) {
            EXPECT_EQ(x[1], 0.25);
            return (x[0] - 0.3) * (x[0] - 0.3);
        },
        search);
    EXPECT_NEAR(found.best[0], 0.3, asked(GetParam()).distance) << found.native;
    search.low = search.high = search.start;
    EXPECT_THROW(minimise([](const Point&) { return 0.0; }, search), std::invalid_argument);
}

TEST_P(EveryMethod, values_that_are_no_numbers_are_never_the_best) {
    int calls = 0;
    BoundedSearch search = box(GetParam(), 3);
    search.budget = 400;
    const auto found = minimise(
        [&](const Point& x) {
            if (++calls % 7 == 0) return std::numeric_limits<double>::quiet_NaN();
            return quadratic(x, {0.31, 0.62, 0.44});
        },
        search);
    EXPECT_TRUE(std::isfinite(found.value));
    EXPECT_LT(found.value, quadratic({0.5, 0.5, 0.5}, {0.31, 0.62, 0.44}));
}

TEST_P(EveryMethod, has_a_name_that_finds_it) {
    EXPECT_EQ(search_method(to_string(GetParam())), GetParam());
    EXPECT_FALSE(search_method("bobyca"));
}

INSTANTIATE_TEST_SUITE_P(BoundedSearch, EveryMethod, testing::ValuesIn(kSearchMethods),
                         [](const auto& method) { return std::string(to_string(method.param)); });

}  // namespace
}  // namespace gradwright
