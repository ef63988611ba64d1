// Morris and Sobol against closed forms: Ishigami's function, Sobol's G-function, a straight line.
#include "optimise/sensitivity_indices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gradwright {
namespace {

constexpr double kA = 7, kB = 0.1, kPi = std::numbers::pi;

std::optional<std::vector<double>> ishigami(const std::vector<double>& u) {
    const auto angle = [&](int i) { return kPi * (2 * u[std::size_t(i)] - 1); };
    const double value = std::sin(angle(0)) + kA * std::pow(std::sin(angle(1)), 2) +
                         kB * std::pow(angle(2), 4) * std::sin(angle(0));
    return std::vector{value};
}
// Ishigami and Homma 1990: V = a^2/8 + b pi^4/5 + b^2 pi^8/18 + 1/2
const double kV1 = 0.5 * std::pow(1 + kB * std::pow(kPi, 4) / 5, 2), kV2 = kA * kA / 8,
             kV13 = kB * kB * std::pow(kPi, 8) * (1.0 / 18 - 1.0 / 50), kV = kV1 + kV2 + kV13;

TEST(Sobol, indices_of_ishigamis_function) {
    const SobolIndices got = sobol_indices(ishigami, 3, 4000, 1);
    EXPECT_EQ(got.evaluations, 5 * 4000);
    EXPECT_EQ(got.rows, 4000);
    EXPECT_NEAR(got.mean[0], kA / 2, 3 * std::sqrt(kV / 8000));
    // three standard errors; 3.51 is the function's kurtosis
    EXPECT_NEAR(got.variance[0], kV, 3 * kV * std::sqrt((3.51 - 1) / 8000));
    const double first[] = {kV1 / kV, kV2 / kV, 0}, total[] = {(kV1 + kV13) / kV, kV2 / kV, kV13 / kV};
    for (std::size_t i = 0; i < 3; ++i) {
        const SobolIndex& s = got.index[i][0];
        EXPECT_NEAR(s.first, first[i], 3 * s.first_error) << i;
        EXPECT_NEAR(s.total, total[i], 3 * s.total_error) << i;
        EXPECT_LT(s.first_error, 0.04);
        EXPECT_LT(s.total_error, 0.03);
        EXPECT_LT(s.first_low, s.first);
        EXPECT_GT(s.total_high, s.total);
    }
}

TEST(Sobol, indices_of_the_g_function) {
    const double a[] = {0, 1, 4.5, 9};
    const UnitModel g = [&](const std::vector<double>& u) {
        double product = 1;
        for (std::size_t i = 0; i < 4; ++i) product *= (std::fabs(4 * u[i] - 2) + a[i]) / (1 + a[i]);
        return std::optional(std::vector{product, -2 * product});
    };
    double part[4], all = 1;
    for (int i = 0; i < 4; ++i) all *= 1 + (part[i] = 1 / (3 * (1 + a[i]) * (1 + a[i])));
    const SobolIndices got = sobol_indices(g, 4, 4000, 2);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t o = 0; o < 2; ++o) {  // a factor changes no index
            const SobolIndex& s = got.index[i][o];
            EXPECT_NEAR(s.first, part[i] / (all - 1), 3 * s.first_error) << i;
            EXPECT_NEAR(s.total, part[i] * all / (1 + part[i]) / (all - 1), 3 * s.total_error) << i;
        }
}

TEST(Sobol, the_error_falls_with_the_root_of_the_sample) {
    const auto error = [](int n) {
        double sum = 0;
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            const SobolIndices got = sobol_indices(ishigami, 3, n, seed);
            sum +=
                std::pow(got.index[0][0].first - kV1 / kV, 2) + std::pow(got.index[1][0].total - kV2 / kV, 2);
        }
        return std::sqrt(sum / 24);
    };
    const double order = std::log(error(200) / error(3200)) / std::log(3200 / 200.0);
    EXPECT_NEAR(order, 0.5, 0.15);
}

TEST(Sobol, an_output_that_does_not_vary_has_no_indices) {
    const SobolIndices got =
        sobol_indices([](const std::vector<double>&) { return std::optional(std::vector{3.0}); }, 2, 10, 1);
    EXPECT_EQ(got.index[1][0].first, 0);
    EXPECT_EQ(got.index[1][0].total, 0);
    EXPECT_EQ(got.variance[0], 0);
}

TEST(Sobol, rows_with_a_failed_run_are_left_out_and_counted) {
    int calls = 0;
    const SobolIndices got = sobol_indices(
        [&](const std::vector<double>& u) -> std::optional<std::vector<double>> {
            if (++calls % 10 == 0) return {};
            return ishigami(u);
        },
        3, 400, 1);
    EXPECT_EQ(got.failed, calls / 10);
    EXPECT_EQ(got.rows, 400 - got.failed);
    EXPECT_NEAR(got.index[1][0].total, kV2 / kV, 3 * got.index[1][0].total_error);
}

TEST(Morris, a_straight_line_has_its_slopes_and_no_scatter) {
    const MorrisScreening got = morris_screening(
        [](const std::vector<double>& u) {
            return std::optional(std::vector{3 * u[0] - 2 * u[1], u[0] * u[2]});
        },
        4, 10, 1);
    EXPECT_EQ(got.evaluations, 5 * 10);
    EXPECT_NEAR(got.effect[0][0].mean, 3, 1e-12);
    EXPECT_NEAR(got.effect[1][0].mean, -2, 1e-12);
    EXPECT_NEAR(got.effect[1][0].mean_absolute, 2, 1e-12);
    EXPECT_NEAR(got.effect[1][0].deviation, 0, 1e-12);
    EXPECT_EQ(got.effect[3][0].mean_absolute, 0);
    EXPECT_GT(got.effect[0][1].deviation, 0.1);  // its effect is the other input
    EXPECT_EQ(got.effect[2][0].effects, 10);
}

TEST(Morris, steps_stay_in_the_cube_and_on_the_grid) {
    morris_screening(
        [](const std::vector<double>& u) {
            for (const double x : u) {
                EXPECT_GE(x, -1e-12);
                EXPECT_LE(x, 1 + 1e-12);
                EXPECT_NEAR(3 * x, std::round(3 * x), 1e-9);
            }
            return std::optional(std::vector{u[0]});
        },
        5, 20, 3);
}

TEST(Morris, effects_beside_a_failed_run_are_left_out_and_counted) {
    const MorrisScreening got = morris_screening(
        [](const std::vector<double>& u) -> std::optional<std::vector<double>> {
            if (u[0] > 0.9) return {};
            return std::vector{u[0] + 2 * u[1]};
        },
        2, 40, 1);
    EXPECT_GT(got.failed, 0);
    EXPECT_LT(got.effect[0][0].effects, 40);
    EXPECT_NEAR(got.effect[0][0].mean, 1, 1e-12);
    EXPECT_NEAR(got.effect[1][0].mean, 2, 1e-12);
}

}  // namespace
}  // namespace gradwright
