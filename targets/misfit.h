// Distance of a profile from its target, and what noise makes of it (inverse-design.md, Statistics). Spans of
// numbers only.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace gradwright {

enum class Norm { rmse, mean_absolute, max };

/// Weighted norm of residual = value - target. Bins with NaN value or weight 0 are left out.
///   rmse = sqrt(sum w r^2 / sum w), mean_absolute = sum w |r| / sum w, max = max over w > 0 of |r|; all in
///   GI units [-], 0 at equality. Returns NaN when no bin counts.
double norm_of(Norm norm, std::span<const double> residual, std::span<const double> weight);

struct Misfit {
    Norm norm = Norm::rmse;
    double value = 0;     ///< raw norm [-]
    double debiased = 0;  ///< sqrt(max(0, rmse^2 - noise_floor^2)) for rmse; for other norms see misfit.cpp
    double interval_low = 0,
           interval_high = 0;  ///< bounds of the true norm, 95 % each, one-sided: 90 % between them
    double noise_floor = 0;    ///< sqrt(sum w s_b^2 / sum w)
    double tolerance = 0;
};

enum class Verdict { met, not_met, undecided };
const char* to_string(Verdict verdict);
const char* to_string(Norm norm);

/// Misfit with its noise. `standard_error`: s_b of each bin of the *mean* profile, bins taken as independent.
/// NaN in a counting bin = noise unknown: interval NaN, so undecided. Each bound of the interval holds the
/// true norm with 95 % (tests on synthetic profiles of known truth): for rmse from the distribution of sum w
/// (delta_b + s_b z_b)^2, a non-central chi-squared mix matched in two moments; for the other norms bounds
/// that hold it with at least 95 % (formulas in misfit.cpp). `degrees`: degrees of freedom behind the
/// standard errors (GradationProfile::degrees), 0 = many. Few of them widen the interval by Student's t;
/// debiased value and noise floor stay.
Misfit misfit(Norm norm, std::span<const double> value, std::span<const double> target,
              std::span<const double> weight, std::span<const double> standard_error, double tolerance,
              double degrees = 0);

/// met: upper 95 % bound of the debiased misfit <= tolerance and noise_floor <= tolerance; not_met: lower
/// bound > tolerance; else undecided.
Verdict verdict_of(const Misfit& misfit);
/// `met` needs all met; any not_met wins; else undecided.
Verdict combine(Verdict a, Verdict b);

/// Chi-squared test of equality of two profiles: p-value of sum ((a-b)^2/(sa^2+sb^2)) over bins where both
/// are defined; 1 when there is none (nothing speaks against equality).
double equality_p_value(std::span<const double> a, std::span<const double> b,
                        std::span<const double> variance_a, std::span<const double> variance_b);
/// The same with standard errors, over the bins of weight > 0 where all four numbers are finite.
double bins_p_value(std::span<const double> a, std::span<const double> error_a, std::span<const double> b,
                    std::span<const double> error_b, std::span<const double> weight);

/// Half width of a simultaneous band in standard errors: band = gi -+ factor s_b (clip to [0, 1]) holds all
/// bins at once with `level`. Sidak: the level^(1/n) two-sided point of Student's t with `degrees` (0 = many:
/// the normal), n = bins with a standard error > 0 (1.96 for one bin, 2.77 for 9, many degrees).
double simultaneous_factor(std::span<const double> standard_error, double level = 0.95, double degrees = 0);

struct Band {
    double factor = 0;              ///< half width in standard errors [-]
    std::vector<double> low, high;  ///< GI in [0, 1]; NaN in a bin without a value or without an error
};

/// Simultaneous 95 % band of a profile over all its bins with a value and an error. `weight`, where given:
/// the band holds over the bins of weight > 0; the others are drawn with the same factor.
Band simultaneous_band(std::span<const double> gi, std::span<const double> standard_error, double degrees,
                       std::span<const double> weight = {});

}  // namespace gradwright
