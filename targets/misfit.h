// Distance of a profile from its target, and what noise makes of it (inverse-design.md, Statistics). Spans of numbers only.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace gradwright {

enum class Norm { rmse, mean_absolute, max };

/// Weighted norm of residual = value - target. Bins with NaN value or weight 0 are left out.
///   rmse = sqrt(sum w r^2 / sum w), mean_absolute = sum w |r| / sum w, max = max over w > 0 of |r|; all in GI units [-],
///   0 at equality. Returns NaN when no bin counts.
double norm_of(Norm norm, std::span<const double> residual, std::span<const double> weight);

struct Misfit {
    Norm norm = Norm::rmse;
    double value = 0;     ///< raw norm [-]
    double debiased = 0;  ///< sqrt(max(0, rmse^2 - noise_floor^2)) for rmse; for other norms see misfit.cpp
    double interval_low = 0, interval_high = 0;  ///< 95 % two-sided... bounds used one-sidedly by the verdict at 95 % each
    double noise_floor = 0;                      ///< sqrt(sum w s_b^2 / sum w)
    double tolerance = 0;
};

enum class Verdict { met, not_met, undecided };
const char* to_string(Verdict verdict);
const char* to_string(Norm norm);

/// Misfit with its noise. `standard_error`: s_b of each bin of the *mean* profile. `degrees` = replicates behind s_b (>= 3: from
/// replicates, else bootstrap). The interval comes from the distribution of sum w (delta_b + s_b z_b)^2 (non-central chi-squared mix,
/// moment-matched or simulated with a fixed seed), inverted for the true rms; covers 95 % by test on synthetic profiles.
Misfit misfit(Norm norm, std::span<const double> value, std::span<const double> target, std::span<const double> weight,
              std::span<const double> standard_error, double tolerance);

/// met: upper 95 % bound of the debiased misfit <= tolerance and noise_floor <= tolerance; not_met: lower bound > tolerance; else
/// undecided.
Verdict verdict_of(const Misfit& misfit);
/// `met` needs all met; any not_met wins; else undecided.
Verdict combine(Verdict a, Verdict b);

/// Chi-squared test of equality of two profiles: p-value of sum ((a-b)^2/(sa^2+sb^2)) over bins where both are defined.
double equality_p_value(std::span<const double> a, std::span<const double> b, std::span<const double> variance_a,
                        std::span<const double> variance_b);

}  // namespace gradwright
