#include "targets/linear_fit.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace gradwright {

LinearFit linear_fit(std::span<const double> x, std::span<const double> y,
                     std::span<const double> standard_error) {
    if (x.size() != y.size() || (!standard_error.empty() && standard_error.size() != x.size()))
        throw std::invalid_argument("linear fit: x, y and standard errors must be equally many");
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    LinearFit fit{kNan, kNan, kNan, kNan, 0};
    double mean_x = 0, mean_y = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (std::isnan(y[i])) continue;
        mean_x += x[i];
        mean_y += y[i];
        ++fit.points;
    }
    if (fit.points < 2) return fit;
    mean_x /= fit.points;
    mean_y /= fit.points;
    double xx = 0, xy = 0, yy = 0, error = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (std::isnan(y[i])) continue;
        const double dx = x[i] - mean_x, dy = y[i] - mean_y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
        const double s = standard_error.empty() ? kNan : standard_error[i];
        error += dx * dx * s * s;
    }
    if (!(xx > 0)) return fit;
    fit.slope = xy / xx;
    fit.intercept = mean_y - fit.slope * mean_x;
    // sum (y - line)^2 = yy - xy^2/xx
    if (yy > 0) fit.r_squared = xy * xy / (xx * yy);
    fit.slope_standard_error = std::sqrt(error) / xx;
    return fit;
}

}  // namespace gradwright
