// Misfits and verdicts on profiles whose true misfit is known.
#include "targets/misfit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Fixed numbers for the synthetic profiles: splitmix64 and Box-Muller.
class Noise {
  public:
    explicit Noise(std::uint64_t seed) : state_(seed) {}
    double uniform() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
    }
    double normal() {
        const double radius = std::sqrt(-2 * std::log(1 - uniform()));
        return radius * std::cos(2 * std::numbers::pi * uniform());
    }

  private:
    std::uint64_t state_;
};

/// A true deviation of 8 bins and the standard errors of its bins.
struct Case {
    const char* name;
    std::vector<double> deviation, s;
};

std::vector<Case> cases(double m) {
    const std::vector<double> even(8, 0.02), ramp = {0.003, 0.003, 0.02, 0.02, 0.02, 0.02, 0.003, 0.003},
                                             one_noisy = {0.01, 0.01, 0.01, 0.03, 0.01, 0.01, 0.01, 0.01};
    return {{"all bins alike", {m, -m, m, -m, m, m, -m, -m}, even},
            {"one bin", {0, 0, 0, m, 0, 0, 0, 0}, even},
            {"ramp bins, quiet plateaus", {0, 0, m, -m, m, m, 0, 0}, ramp},
            {"plateaus only", {m, m, 0, 0, 0, 0, m, m}, ramp},
            {"the noisiest bin alone", {0, 0, 0, m, 0, 0, 0, 0}, one_noisy}};
}

struct Counts {
    double low = 0, high = 0;        ///< shares of realisations whose bound holds the truth
    double debiased = 0, value = 0;  ///< means
};

/// `degrees` > 0: standard errors are themselves estimated from that many degrees, as a chi-squared number
/// common to all bins.
Counts simulate(Norm norm, const Case& c, int realisations, int degrees = 0) {
    const std::vector<double> weight(8, 1), target(8, 0.5);
    const double truth = norm_of(norm, c.deviation, weight);
    Noise noise(404);
    Counts counts;
    std::vector<double> value(8), s(8);
    for (int r = 0; r < realisations; ++r) {
        double chi = degrees > 0 ? 0 : 1;
        for (int k = 0; k < degrees; ++k) chi += std::pow(noise.normal(), 2) / degrees;
        for (int b = 0; b < 8; ++b) {
            value[b] = target[b] + c.deviation[b] + c.s[b] * noise.normal();
            s[b] = c.s[b] * std::sqrt(chi);
        }
        const Misfit m = misfit(norm, value, target, weight, s, 0.04, degrees);
        counts.low += m.interval_low <= truth;
        counts.high += m.interval_high >= truth;
        counts.debiased += m.debiased;
        counts.value += m.value;
        EXPECT_LE(m.interval_low, m.debiased + 1e-9);
        EXPECT_GE(m.interval_high, m.debiased - 1e-9);
    }
    counts.low /= realisations;
    counts.high /= realisations;
    counts.debiased /= realisations;
    counts.value /= realisations;
    return counts;
}

// ---- norms
// ------------------------------------------------------------------------------------------------------------------------

TEST(misfit, norms_are_their_formulas_and_zero_at_equality) {
    const std::vector<double> residual = {0.1, -0.3, 0.2}, weight = {1, 2, 1};
    EXPECT_DOUBLE_EQ(norm_of(Norm::rmse, residual, weight), std::sqrt((0.01 + 2 * 0.09 + 0.04) / 4));
    EXPECT_DOUBLE_EQ(norm_of(Norm::mean_absolute, residual, weight), (0.1 + 2 * 0.3 + 0.2) / 4);
    EXPECT_DOUBLE_EQ(norm_of(Norm::max, residual, weight), 0.3);
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        EXPECT_EQ(norm_of(norm, std::vector<double>(3, 0), weight), 0);
    }
}

TEST(misfit, undefined_and_do_not_care_bins_are_left_out) {
    const std::vector<double> residual = {kNan, 5, 0.2}, weight = {1, 0, 3};
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        EXPECT_DOUBLE_EQ(norm_of(norm, residual, weight), 0.2);
        EXPECT_TRUE(std::isnan(norm_of(norm, residual, std::vector<double>{1, 0, 0})));
    }
    const Misfit m = misfit(Norm::rmse, std::vector<double>{kNan, 1, 0.52}, std::vector<double>{0.5, 0, 0.5},
                            std::vector<double>{1, 0, 1}, std::vector<double>{kNan, kNan, 0.01}, 0.04);
    EXPECT_NEAR(m.value, 0.02, 1e-15);
    EXPECT_NEAR(m.noise_floor, 0.01, 1e-15);
}

TEST(misfit, rmse_is_debiased_by_the_noise_floor) {
    const std::vector<double> value = {0.55, 0.45, 0.5}, target(3, 0.5), weight = {1, 1, 2},
                              s = {0.02, 0.04, 0.01};
    const Misfit m = misfit(Norm::rmse, value, target, weight, s, 0.04);
    EXPECT_NEAR(m.noise_floor, std::sqrt((0.0004 + 0.0016 + 2 * 0.0001) / 4), 1e-15);
    EXPECT_NEAR(m.debiased, std::sqrt(m.value * m.value - m.noise_floor * m.noise_floor), 1e-15);
    const Misfit noisy = misfit(Norm::rmse, value, target, weight, std::vector<double>(3, 0.2), 0.04);
    EXPECT_EQ(noisy.debiased, 0);
    EXPECT_EQ(noisy.interval_low, 0);
    EXPECT_GT(noisy.interval_high, 0);
}

TEST(misfit, without_noise_the_interval_is_the_value) {
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        const Misfit m = misfit(norm, std::vector<double>{0.6, 0.5}, std::vector<double>{0.5, 0.5},
                                std::vector<double>{1, 1}, std::vector<double>{0, 0}, 0.04);
        EXPECT_EQ(m.interval_low, m.value);
        EXPECT_EQ(m.interval_high, m.value);
        EXPECT_EQ(m.debiased, m.value);
    }
}

// ---- intervals
// ----------------------------------------------------------------------------------------------------------------------

TEST(misfit, both_bounds_of_the_rmse_hold_the_truth_in_95_percent_of_profiles) {
    for (double m : {0.02, 0.04, 0.1}) {
        for (const Case& c : cases(m)) {
            const Counts counts = simulate(Norm::rmse, c, 2000);
            EXPECT_GT(counts.low, 0.92) << c.name << " " << m;
            EXPECT_GT(counts.high, 0.92) << c.name << " " << m;
        }
        // with equal weights and errors the distribution is exact: not wider than stated either, once m
        // clears the noise
        if (m >= 0.04) {
            const Counts exact = simulate(Norm::rmse, cases(m)[0], 4000);
            EXPECT_NEAR(exact.low, 0.95, 0.015);
            EXPECT_NEAR(exact.high, 0.95, 0.015);
        }
    }
}

TEST(misfit, both_bounds_of_the_other_norms_hold_the_truth_in_at_least_95_percent) {
    for (Norm norm : {Norm::mean_absolute, Norm::max}) {
        for (double m : {0.02, 0.04, 0.1}) {
            for (const Case& c : cases(m)) {
                const Counts counts = simulate(norm, c, 2000);
                EXPECT_GT(counts.low, 0.935) << to_string(norm) << " " << c.name << " " << m;
                EXPECT_GT(counts.high, 0.935) << to_string(norm) << " " << c.name << " " << m;
            }
        }
        // and they are no empty promise: far above the noise a bound that one bin decides is near its nominal
        // level
        EXPECT_LT(simulate(Norm::max, cases(0.2)[1], 2000).high, 0.97);
        EXPECT_LT(simulate(Norm::mean_absolute, cases(0.2)[0], 2000).low, 0.97);
        EXPECT_LT(simulate(Norm::mean_absolute, cases(0.2)[0], 2000).high, 0.97);
    }
}

TEST(misfit, debiased_value_is_nearer_the_truth_than_the_value) {
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        const Case c = cases(0.03)[0];
        const Counts counts = simulate(norm, c, 2000);
        EXPECT_LT(std::abs(counts.debiased - 0.03), std::abs(counts.value - 0.03) + 0.004) << to_string(norm);
        // no deviation at all: most of what noise feigns is taken off
        const Counts none = simulate(norm, cases(0.0)[0], 2000);
        EXPECT_LT(none.debiased, 0.5 * none.value) << to_string(norm);
    }
}

TEST(misfit, bounds_hold_when_the_errors_are_known_from_few_degrees) {
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        for (const Case& c : cases(0.06)) {
            const Counts counts = simulate(norm, c, 1000, 4);
            EXPECT_GT(counts.low, 0.92) << to_string(norm) << " " << c.name;
            EXPECT_GT(counts.high, 0.92) << to_string(norm) << " " << c.name;
        }
    }
    // they would not, were the degrees not said
    const Misfit many = misfit(Norm::rmse, std::vector<double>{0.6, 0.5}, std::vector<double>{0.5, 0.5},
                               std::vector<double>{1, 1}, std::vector<double>{0.03, 0.03}, 0.04);
    const Misfit few = misfit(Norm::rmse, std::vector<double>{0.6, 0.5}, std::vector<double>{0.5, 0.5},
                              std::vector<double>{1, 1}, std::vector<double>{0.03, 0.03}, 0.04, 3);
    EXPECT_LT(few.interval_low, many.interval_low);
    EXPECT_GT(few.interval_high, many.interval_high);
    EXPECT_EQ(few.debiased, many.debiased);
    EXPECT_EQ(few.noise_floor, many.noise_floor);
}

TEST(misfit, luck_with_the_noise_proves_nothing) {
    // a profile that lies on the target although its bins are uncertain by 0.05 each
    for (Norm norm : {Norm::rmse, Norm::mean_absolute, Norm::max}) {
        const Misfit m = misfit(norm, std::vector<double>(6, 0.5), std::vector<double>(6, 0.5),
                                std::vector<double>(6, 1), std::vector<double>(6, 0.05), 0.02);
        EXPECT_EQ(m.value, 0);
        EXPECT_GT(m.interval_high, 0.02) << to_string(norm);
        EXPECT_EQ(verdict_of(m), Verdict::undecided);
    }
}

TEST(misfit, unknown_noise_or_no_bins_leave_the_verdict_open) {
    const std::vector<double> half(3, 0.5), one(3, 1);
    const Misfit unknown = misfit(Norm::rmse, half, half, one, std::vector<double>(3, kNan), 0.04);
    EXPECT_EQ(verdict_of(unknown), Verdict::undecided);
    const Misfit empty =
        misfit(Norm::rmse, half, half, std::vector<double>(3, 0), std::vector<double>(3, 0.01), 0.04);
    EXPECT_TRUE(std::isnan(empty.value));
    EXPECT_EQ(verdict_of(empty), Verdict::undecided);
}

// ---- verdicts
// -----------------------------------------------------------------------------------------------------------------------

TEST(verdict, needs_the_upper_bound_and_the_noise_floor_below_the_tolerance) {
    Misfit m;
    m.tolerance = 0.04;
    m.interval_low = 0.01;
    m.interval_high = 0.03;
    m.noise_floor = 0.02;
    EXPECT_EQ(verdict_of(m), Verdict::met);
    m.noise_floor = 0.05;
    EXPECT_EQ(verdict_of(m), Verdict::undecided);
    m.noise_floor = 0.02;
    m.interval_high = 0.05;
    EXPECT_EQ(verdict_of(m), Verdict::undecided);
    m.interval_low = 0.045;
    EXPECT_EQ(verdict_of(m), Verdict::not_met);
}

TEST(verdict, combined_is_met_only_when_both_are_and_not_met_when_either_is) {
    using enum Verdict;
    EXPECT_EQ(combine(met, met), met);
    EXPECT_EQ(combine(met, undecided), undecided);
    EXPECT_EQ(combine(undecided, not_met), not_met);
    EXPECT_EQ(combine(not_met, met), not_met);
    EXPECT_STREQ(to_string(not_met), "not_met");
}

TEST(verdict, wrong_verdicts_at_the_tolerance_stay_within_8_percent) {
    // true rms exactly at, a little above and a little below the tolerance: the worst places for met and for
    // not_met
    const double tolerance = 0.04;
    Noise noise(77);
    for (double truth : {0.0401, 0.0399}) {
        int wrong = 0;
        const int n = 3000;
        for (int r = 0; r < n; ++r) {
            std::vector<double> value(8), s(8, 0.015);
            for (int b = 0; b < 8; ++b) value[b] = 0.5 + truth * (b % 2 ? 1 : -1) + s[b] * noise.normal();
            const Verdict verdict = verdict_of(misfit(Norm::rmse, value, std::vector<double>(8, 0.5),
                                                      std::vector<double>(8, 1), s, tolerance));
            wrong += verdict == (truth > tolerance ? Verdict::met : Verdict::not_met);
        }
        EXPECT_LT(wrong, 0.08 * n);
        EXPECT_GT(wrong, 0.02 * n);
    }
}

// ---- equality and bands
// ---------------------------------------------------------------------------------------------------------------

TEST(equality, p_value_of_two_bins_is_the_closed_form) {
    // chi-squared with 2 degrees: upper tail exp(-x/2)
    for (double x : {0.1, 1.0, 5.0, 40.0}) {
        const double d = std::sqrt(x);
        EXPECT_NEAR(equality_p_value(std::vector<double>{d, 0}, std::vector<double>{0, 0},
                                     std::vector<double>{0.5, 1}, std::vector<double>{0.5, 1}) /
                        std::exp(-0.5 * x),
                    1, 1e-10);
    }
    // one bin: erfc(|d|/sqrt 2)
    EXPECT_NEAR(equality_p_value(std::vector<double>{1.5}, std::vector<double>{0}, std::vector<double>{1},
                                 std::vector<double>{0}),
                std::erfc(1.5 / std::numbers::sqrt2), 1e-12);
}

TEST(equality, p_values_of_equal_profiles_are_uniform) {
    Noise noise(9);
    int below_5 = 0, below_50 = 0;
    const int n = 4000;
    for (int r = 0; r < n; ++r) {
        std::vector<double> a(8), b(8);
        for (int k = 0; k < 8; ++k) {
            a[k] = 0.03 * noise.normal();
            b[k] = 0.01 * noise.normal();
        }
        a[3] = kNan;  // an undefined bin is left out, and not counted
        const double p = equality_p_value(a, b, std::vector<double>(8, 9e-4), std::vector<double>(8, 1e-4));
        below_5 += p < 0.05;
        below_50 += p < 0.5;
    }
    EXPECT_NEAR(below_5 / static_cast<double>(n), 0.05, 0.012);
    EXPECT_NEAR(below_50 / static_cast<double>(n), 0.5, 0.03);
}

TEST(equality, exact_numbers_are_equal_or_not) {
    const std::vector<double> zero(1, 0);
    EXPECT_EQ(equality_p_value(zero, zero, zero, zero), 1);
    EXPECT_EQ(equality_p_value(std::vector<double>{0.1}, zero, zero, zero), 0);
}

TEST(band, factor_is_the_sidak_point) {
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}), 1.959964, 1e-6);
    EXPECT_NEAR(simultaneous_factor(std::vector<double>(9, 0.1)), 2.7655, 1e-3);
    // bins without noise or without a value need no room
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1, 0, kNan}), 1.959964, 1e-6);
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}, 0.99), 2.575829, 1e-6);
}

TEST(band, factor_takes_student_s_t_for_few_degrees) {
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}, 0.95, 1), 12.7062, 1e-3);  // tables of t
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}, 0.95, 3), 3.18245, 1e-4);
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}, 0.95, 10), 2.22814, 1e-4);
    EXPECT_NEAR(simultaneous_factor(std::vector<double>{0.1}, 0.95, 1000), 1.96234, 1e-4);
}

TEST(band, holds_all_bins_at_once_with_its_level) {
    Noise noise(31);
    const double factor = simultaneous_factor(std::vector<double>(8, 0.02));
    int inside = 0;
    const int n = 4000;
    for (int r = 0; r < n; ++r) {
        bool all = true;
        for (int b = 0; b < 8; ++b) all &= std::abs(noise.normal()) <= factor;
        inside += all;
    }
    EXPECT_NEAR(inside / static_cast<double>(n), 0.95, 0.012);
}

TEST(band, of_a_profile_stays_a_gradation_index_and_leaves_unknown_bins_unknown) {
    const std::vector<double> gi = {0.01, 0.5, kNan, 0.6, 0.7}, error = {0.02, 0.02, 0.02, kNan, 0.02};
    const Band band = simultaneous_band(gi, error, 0);
    EXPECT_NEAR(band.factor, 2.387738, 1e-5);  // Sidak, three bins
    EXPECT_EQ(band.low[0], 0);
    EXPECT_NEAR(band.high[1], 0.5 + 0.02 * band.factor, 1e-12);
    EXPECT_TRUE(std::isnan(band.low[2]) && std::isnan(band.high[2]) && std::isnan(band.low[3]));
    const Band judged = simultaneous_band(gi, error, 0, std::vector<double>{0, 1, 1, 1, 0});
    EXPECT_NEAR(judged.factor, 1.959964, 1e-5);
    EXPECT_NEAR(judged.high[4], 0.7 + 0.02 * judged.factor, 1e-12);
}

}  // namespace
}  // namespace gradwright
