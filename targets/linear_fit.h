// Straight line through a profile, y = intercept + slope x, by ordinary least squares: what a paper means by
// "linear" and R2.
#pragma once
#include <span>

namespace gradwright {

struct LinearFit {
    double slope = 0, intercept = 0;  ///< NaN with fewer than two different x
    /// R2 = 1 - sum (y - line)^2 / sum (y - mean)^2; NaN when y does not vary.
    double r_squared = 0;
    /// Standard error of the slope from the standard errors of the points, taken as independent:
    /// sqrt(sum (x - mean)^2 s^2) / sum (x - mean)^2. NaN when any of them is unknown. It knows nothing of
    /// curvature: R2 does.
    double slope_standard_error = 0;
    int points = 0;  ///< points used
};

/// Points whose y is NaN are left out. `standard_error` may be empty. Sizes must agree
/// (std::invalid_argument).
LinearFit linear_fit(std::span<const double> x, std::span<const double> y,
                     std::span<const double> standard_error = {});

}  // namespace gradwright
