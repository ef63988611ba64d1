// The straight line: exact on lines, by the textbook formulas elsewhere.
#include "targets/linear_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace gradwright {
namespace {

using Numbers = std::vector<double>;

TEST(linear_fit, finds_a_line_exactly_and_leaves_undefined_points_out) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const LinearFit fit = linear_fit(Numbers{1, 2, 3, 5}, Numbers{-1, nan, 3, 7});
    EXPECT_NEAR(fit.slope, 2, 1e-14);
    EXPECT_NEAR(fit.intercept, -3, 1e-14);
    EXPECT_NEAR(fit.r_squared, 1, 1e-14);
    EXPECT_EQ(fit.points, 3);
    EXPECT_TRUE(std::isnan(fit.slope_standard_error));
}

TEST(linear_fit, r_squared_is_the_share_of_the_variance_that_the_line_explains) {
    // x = -1, 0, 1; y = 0, 3, 0: slope 0, nothing explained
    EXPECT_NEAR(linear_fit(Numbers{-1, 0, 1}, Numbers{0, 3, 0}).r_squared, 0, 1e-14);
    // y = 0, 3, 2: mean 5/3, sxy = 2, sxx = 2: slope 1; residuals -2/3, 4/3, -2/3: sum of squares 24/9;
    // total 25/9 + 16/9 + 1/9 = 42/9: R2 = 1 - 24/42
    const LinearFit fit = linear_fit(Numbers{-1, 0, 1}, Numbers{0, 3, 2});
    EXPECT_NEAR(fit.slope, 1, 1e-14);
    EXPECT_NEAR(fit.intercept, 5.0 / 3, 1e-14);
    EXPECT_NEAR(fit.r_squared, 1 - 24.0 / 42, 1e-14);
}

TEST(linear_fit, standard_error_of_the_slope_comes_from_those_of_the_points) {
    // sqrt(1 x 0.3^2 + 0 + 1 x 0.4^2) / 2
    const LinearFit fit = linear_fit(Numbers{-1, 0, 1}, Numbers{0, 1, 2}, Numbers{0.3, 9, 0.4});
    EXPECT_NEAR(fit.slope_standard_error, 0.25, 1e-14);
}

TEST(linear_fit, without_two_different_x_nothing_is_found) {
    EXPECT_TRUE(std::isnan(linear_fit(Numbers{1}, Numbers{2}).slope));
    EXPECT_TRUE(std::isnan(linear_fit(Numbers{1, 1}, Numbers{2, 3}).slope));
    EXPECT_TRUE(std::isnan(linear_fit(Numbers{1, 2}, Numbers{3, 3}).r_squared));
    EXPECT_THROW(linear_fit(Numbers{1, 2}, Numbers{3}), std::invalid_argument);
}

}  // namespace
}  // namespace gradwright
