// Statistics of a noisy distance. Model: residual r_b = delta_b + s_b z_b with independent standard normal
// z_b; wanted is the norm of the true delta, not of r, which noise makes larger.
//
// rmse. T = sum w r^2 / W, W = sum w, has mean m^2 + f^2 with m the true rms and f the noise floor, f^2 = sum
// w s^2 / W; so m^2 = T - f^2 (debiased). T is a mix of non-central chi-squared variables with variance 2 a
// f^2 + 4 b m^2,
//   a = sum w^2 s^4 / (W sum w s^2),   b = sum w^2 s^2 delta^2 / (W sum w delta^2), delta taken from r,
// and is matched in mean and variance (Satterthwaite 1946) by T ~ g chi'^2(f^2/g, m^2/g) with g = max(a, b):
// exact when all w s^2 are equal (a = b), on the safe side otherwise. Bounds of m: the values at which the T
// seen lies at the 95 % and the 5 % point. Where T is even smaller than noise alone would make it, the upper
// bound is that of a T at its median under noise alone (power-constrained limit, Cowan et al. 2011): luck
// with the noise must not prove a small misfit. Standard errors from few degrees of freedom d
// (block_variance.h): the probabilities are averaged over the f^2 that may stand behind the one estimated,
// f^2 d/chi^2_d. That is Snedecor's F without deviation and Student's t far above the noise.
//
// mean_absolute. E|delta + s z| = |delta| + s beta(|delta|/s), beta(t) = 2 (phi(t) - t F(-t)), sqrt(2/pi) at
// 0 and falling to 0.
//   debiased = sum w (|r| - s beta(|r|/s - 1/2)) / W, not below 0
//   low = sum w (|r| - s c beta(|r|/s - 2)) / W - t e,  high = sum w |r| / W + t e,  e^2 = sum w^2 s^2 / W^2
// with beta(t < 0) = beta(0), t the 95 % point of Student, c = the 95 % bound of true over estimated s (1 for
// many degrees). No unbiased estimate of |delta| exists; the offsets 1/2 and 2 were chosen because beta at
// |r| itself takes off half of what is due where delta = 0. Both bounds are on the safe side: |r| has no
// larger deviation than r, and its mean is not below |delta|.
//
// max. high = max(|r| + t s): the bin of the true maximum alone keeps it safe. low = max(|r| - t' s), t' from
// Sidak over all counting bins at 95 %. debiased = max(|r| - c' s), c' = median of the largest of n normal
// numbers, F(c')^n = 1/2, n = bins within 3 s of the largest. (Rejected for both: the pattern of the
// residuals scaled by one factor, with simulated noise: its bounds held a true mean_absolute in as little as
// 78 % of cases when one bin carried all of it.)
#include "targets/misfit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTail = 0.05;  // each one-sided bound leaves 5 %

double normal_cdf(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// argument in [low, high] where the falling function crosses `value`, by bisection.
template <class Function>
double where_falls_to(Function&& falling, double value, double low, double high) {
    for (int i = 0; i < 48; ++i) {
        const double middle = 0.5 * (low + high);
        (falling(middle) > value ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// z with P(Z <= z) = p, by bisection.
double normal_point(double p) {
    return where_falls_to([](double z) { return normal_cdf(-z); }, 1 - p, -40, 40);
}

/// t with P(T <= t) = p >= 1/2 for Student's t; degrees 0 = many. With T = sqrt(d) tan(a) the density becomes
/// Gamma((d+1)/2)/(sqrt(pi) Gamma(d/2)) cos(a)^(d-1): smooth, so Simpson's rule over 40 steps is exact to
/// 1e-6.
double student_point(double p, double degrees) {
    if (degrees <= 0 || degrees > 1e4) return normal_point(p);
    const double d = std::max(1.0, degrees);
    const double front =
        std::exp(std::lgamma(0.5 * (d + 1)) - std::lgamma(0.5 * d)) / std::sqrt(std::numbers::pi);
    const auto upper_tail = [&](double angle) {
        double sum = 1 + std::pow(std::cos(angle), d - 1);
        for (int k = 1; k < 40; ++k) sum += (k % 2 ? 4 : 2) * std::pow(std::cos(angle * k / 40), d - 1);
        return 0.5 - front * sum * angle / 120;
    };
    return std::sqrt(d) * std::tan(where_falls_to(upper_tail, 1 - p, 0, 0.5 * std::numbers::pi));
}

/// P(chi'^2(nu, lambda) <= x), approximation of Sankaran (Biometrika 50, 1963, 199): (x/(nu + lambda))^h is
/// nearly normal. For lambda = 0 that of Wilson and Hilferty. Within 0.004 of the exact value for nu >= 1
/// near the 5 % and 95 % points.
double noncentral_chi_squared_cdf(double x, double nu, double lambda) {
    if (x <= 0) return 0;
    const double k = nu + lambda, k2 = nu + 2 * lambda, k3 = nu + 3 * lambda;
    const double h = 1 - 2 * k * k3 / (3 * k2 * k2), p = k2 / (k * k), m = (h - 1) * (1 - 3 * h);
    const double mean = 1 + h * p * (h - 1 - 0.5 * (2 - h) * m * p);
    const double deviation = h * std::sqrt(2 * p) * (1 + 0.5 * m * p);
    return normal_cdf((std::pow(x / k, h) - mean) / deviation);
}

/// Upper tail of the chi-squared distribution: regularised incomplete gamma Q(nu/2, x/2), by series below the
/// mean and by continued fraction (modified Lentz) above (Press et al., Numerical Recipes, 6.2).
double chi_squared_upper_tail(double x, double nu) {
    const double a = 0.5 * nu, t = 0.5 * x;
    if (t <= 0) return 1;
    const double front = std::exp(-t + a * std::log(t) - std::lgamma(a));
    if (t < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000 && term > 1e-16 * sum; ++n) {
            term *= t / (a + n);
            sum += term;
        }
        return std::clamp(1 - front * sum, 0.0, 1.0);
    }
    const double tiny = 1e-300;
    double b = t + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = an * d + b;
        if (std::abs(d) < tiny) d = tiny;
        c = b + an / c;
        if (std::abs(c) < tiny) c = tiny;
        d = 1 / d;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return std::clamp(front * h, 0.0, 1.0);
}

/// Bins that count, packed.
struct Counting {
    std::vector<double> residual, weight, s;
    double total_weight = 0, noise_floor = 0, degrees = 0;
};

bool counted(double residual, double weight) {
    return !std::isnan(residual) && weight > 0;
}

/// chi^2_d/d at its p point (Wilson and Hilferty); 1 for many degrees.
double mean_square_point(double p, double degrees) {
    if (degrees <= 0) return 1;
    const double c = 2 / (9 * degrees);
    return std::pow(std::max(0.05, 1 - c + normal_point(p) * std::sqrt(c)), 3);
}

void rmse_statistics(const Counting& bins, Misfit& result) {
    const double seen = result.value * result.value, floor2 = bins.noise_floor * bins.noise_floor;
    result.debiased = std::sqrt(std::max(0.0, seen - floor2));
    double sum4 = 0, sum2 = 0, cross = 0;
    for (std::size_t b = 0; b < bins.s.size(); ++b) {
        const double ws2 = bins.weight[b] * bins.s[b] * bins.s[b];
        sum4 += ws2 * ws2;
        sum2 += ws2;
        cross += ws2 * bins.weight[b] * bins.residual[b] * bins.residual[b];
    }
    const double w = bins.total_weight, by_noise = sum4 / (w * sum2);
    const double g = seen > 0 ? std::max(by_noise, cross / (w * w * seen)) : by_noise, nu = floor2 / g;
    std::vector<double> scale = {1};  // true over estimated f^2, equally likely values
    if (bins.degrees > 0) {
        constexpr int kValues = 12;
        scale.clear();
        for (int k = 0; k < kValues; ++k)
            scale.push_back(1 / mean_square_point((k + 0.5) / kValues, bins.degrees));
    }
    const auto below = [&](double t, double m) {
        double sum = 0;
        for (double u : scale) sum += noncentral_chi_squared_cdf(t / (g * u), nu, m * m / (g * u));
        return sum / static_cast<double>(scale.size());
    };
    const double widest = std::sqrt(*std::max_element(scale.begin(), scale.end()));
    const double far = 2 * (result.value + 4 * widest * bins.noise_floor);
    result.interval_low = below(seen, 0) > 1 - kTail
                              ? where_falls_to([&](double m) { return below(seen, m); }, 1 - kTail, 0, far)
                              : 0;
    const double median = where_falls_to([&](double t) { return 1 - below(t, 0); }, 0.5, 0, 4 * floor2);
    const double high_of = std::max(seen, median);
    result.interval_high = where_falls_to([&](double m) { return below(high_of, m); }, kTail, 0, far);
}

/// beta(t) of the text: what noise adds to |delta| = t s, in units of s.
double folding_bias(double t) {
    t = std::max(t, 0.0);
    return 2 * (std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi) - t * normal_cdf(-t));
}

void mean_absolute_statistics(const Counting& bins, Misfit& result) {
    double debiased = 0, low = 0, square = 0;
    const double larger_s = 1 / std::sqrt(mean_square_point(kTail, bins.degrees));
    for (std::size_t b = 0; b < bins.s.size(); ++b) {
        const double size = std::abs(bins.residual[b]), s = bins.s[b], w = bins.weight[b] / bins.total_weight;
        debiased += w * (s > 0 ? size - s * folding_bias(size / s - 0.5) : size);
        low += w * (s > 0 ? size - s * larger_s * folding_bias(size / s - 2) : size);
        square += w * w * s * s;
    }
    const double margin = student_point(1 - kTail, bins.degrees) * std::sqrt(square);
    result.debiased = std::max(0.0, debiased);
    result.interval_low = std::max(0.0, low - margin);
    result.interval_high = result.value + margin;
}

void max_statistics(const Counting& bins, Misfit& result) {
    const double n = static_cast<double>(bins.s.size());
    int rivals = 0;
    for (std::size_t b = 0; b < bins.s.size(); ++b) {
        rivals += std::abs(bins.residual[b]) + 3 * bins.s[b] >= result.value;
    }
    const double all_bins = student_point(0.5 + 0.5 * std::pow(1 - kTail, 1 / n), bins.degrees);
    const double one_bin = student_point(1 - kTail, bins.degrees);
    const double median_of_rivals = normal_point(std::pow(0.5, 1.0 / rivals));
    for (std::size_t b = 0; b < bins.s.size(); ++b) {
        const double size = std::abs(bins.residual[b]), s = bins.s[b];
        result.debiased = std::max(result.debiased, size - median_of_rivals * s);
        result.interval_low = std::max(result.interval_low, size - all_bins * s);
        result.interval_high = std::max(result.interval_high, size + one_bin * s);
    }
}

}  // namespace

double norm_of(Norm norm, std::span<const double> residual, std::span<const double> weight) {
    double total = 0, sum = 0, largest = 0;
    for (std::size_t b = 0; b < residual.size(); ++b) {
        if (!counted(residual[b], weight[b])) continue;
        total += weight[b];
        sum += weight[b] * (norm == Norm::rmse ? residual[b] * residual[b] : std::abs(residual[b]));
        largest = std::max(largest, std::abs(residual[b]));
    }
    if (total <= 0) return kNan;
    switch (norm) {
        case Norm::rmse:
            return std::sqrt(sum / total);
        case Norm::mean_absolute:
            return sum / total;
        case Norm::max:
            return largest;
    }
    return kNan;
}

const char* to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::met:
            return "met";
        case Verdict::not_met:
            return "not_met";
        case Verdict::undecided:
            return "undecided";
    }
    return "undecided";
}

const char* to_string(Norm norm) {
    switch (norm) {
        case Norm::rmse:
            return "rmse";
        case Norm::mean_absolute:
            return "mean_absolute";
        case Norm::max:
            return "max";
    }
    return "rmse";
}

Misfit misfit(Norm norm, std::span<const double> value, std::span<const double> target,
              std::span<const double> weight, std::span<const double> standard_error, double tolerance,
              double degrees) {
    Misfit result;
    result.norm = norm;
    result.tolerance = tolerance;
    Counting bins;
    bins.degrees = degrees;
    double noise = 0;
    for (std::size_t b = 0; b < value.size(); ++b) {
        const double residual = value[b] - target[b];
        if (!counted(residual, weight[b])) continue;
        bins.residual.push_back(residual);
        bins.weight.push_back(weight[b]);
        bins.s.push_back(standard_error[b]);
        bins.total_weight += weight[b];
        noise += weight[b] * standard_error[b] * standard_error[b];
    }
    result.value = norm_of(norm, bins.residual, bins.weight);
    bins.noise_floor = bins.total_weight > 0 ? std::sqrt(noise / bins.total_weight) : kNan;
    result.noise_floor = bins.noise_floor;
    if (std::isnan(result.value) || std::isnan(result.noise_floor)) {
        // no bin counts, or the noise is unknown: nothing can be proved, verdict_of says undecided
        result.debiased = result.value;
        result.interval_low = result.interval_high = kNan;
    } else if (result.noise_floor <= 1e-12 * std::max(1e-300, result.value) || result.noise_floor == 0) {
        result.debiased = result.interval_low = result.interval_high = result.value;
    } else if (norm == Norm::rmse) {
        rmse_statistics(bins, result);
    } else if (norm == Norm::mean_absolute) {
        mean_absolute_statistics(bins, result);
    } else {
        max_statistics(bins, result);
    }
    return result;
}

Verdict verdict_of(const Misfit& misfit) {
    if (misfit.interval_high <= misfit.tolerance && misfit.noise_floor <= misfit.tolerance)
        return Verdict::met;
    if (misfit.interval_low > misfit.tolerance) return Verdict::not_met;
    return Verdict::undecided;
}

Verdict combine(Verdict a, Verdict b) {
    if (a == Verdict::not_met || b == Verdict::not_met) return Verdict::not_met;
    return a == Verdict::met && b == Verdict::met ? Verdict::met : Verdict::undecided;
}

double equality_p_value(std::span<const double> a, std::span<const double> b,
                        std::span<const double> variance_a, std::span<const double> variance_b) {
    double sum = 0;
    int bins = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double difference = a[k] - b[k], variance = variance_a[k] + variance_b[k];
        if (std::isnan(difference) || std::isnan(variance)) continue;
        if (variance <= 0) {
            if (difference != 0) return 0;  // two exact numbers that differ
            continue;
        }
        sum += difference * difference / variance;
        ++bins;
    }
    return bins > 0 ? chi_squared_upper_tail(sum, bins) : 1;
}

double bins_p_value(std::span<const double> a, std::span<const double> error_a, std::span<const double> b,
                    std::span<const double> error_b, std::span<const double> weight) {
    std::vector<double> x, y, variance_x, variance_y;
    for (std::size_t k = 0; k < weight.size(); ++k) {
        if (!(weight[k] > 0) || !std::isfinite(a[k] + b[k] + error_a[k] + error_b[k])) continue;
        x.push_back(a[k]);
        y.push_back(b[k]);
        variance_x.push_back(error_a[k] * error_a[k]);
        variance_y.push_back(error_b[k] * error_b[k]);
    }
    return equality_p_value(x, y, variance_x, variance_y);
}

double simultaneous_factor(std::span<const double> standard_error, double level, double degrees) {
    const auto bins = std::count_if(standard_error.begin(), standard_error.end(),
                                    [](double s) { return std::isfinite(s) && s > 0; });
    const double each = std::pow(level, 1.0 / std::max<double>(1, static_cast<double>(bins)));
    return student_point(0.5 + 0.5 * each, degrees);
}

Band simultaneous_band(std::span<const double> gi, std::span<const double> standard_error, double degrees,
                       std::span<const double> weight) {
    std::vector<double> counting(standard_error.begin(), standard_error.end());
    for (std::size_t b = 0; b < counting.size(); ++b)
        if (!std::isfinite(gi[b]) || (!weight.empty() && !(weight[b] > 0))) counting[b] = 0;
    Band band;
    band.factor = simultaneous_factor(counting, 0.95, degrees);
    for (std::size_t b = 0; b < gi.size(); ++b) {
        const double half = b < standard_error.size() ? band.factor * standard_error[b]
                                                      : std::numeric_limits<double>::quiet_NaN();
        // clamping must not turn an undefined error into a number: std::max(0, NaN) is 0
        const bool known = std::isfinite(gi[b]) && std::isfinite(half);
        band.low.push_back(known ? std::max(0.0, gi[b] - half) : std::numeric_limits<double>::quiet_NaN());
        band.high.push_back(known ? std::min(1.0, gi[b] + half) : std::numeric_limits<double>::quiet_NaN());
    }
    return band;
}

}  // namespace gradwright
