// Noise of a gradation: what the bands of each estimator promise, held against layers laid many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem/block_variance.h"
#include "dem/gradation.h"
#include "dem/homogeneous_estimator.h"
#include "tests/dem/known_layer.h"
#include "tests/dem/synthetic_layer.h"

namespace gradwright {
namespace {

struct Coverage {
    double pointwise = 0, error_ratio = 0;  ///< share; rms standard error over true scatter
};

/// Share of bins in which gi -+ t s holds the mean of all realisations; t = 95 % point for the degrees
/// stated.
template <class Estimate>
Coverage coverage_of(int realisations, Estimate&& estimate) {
    std::vector<GradationProfile> profiles;
    for (int r = 0; r < realisations; ++r) profiles.push_back(estimate(r));
    const std::size_t bins = profiles.front().gi.size();
    std::vector<double> truth(bins, 0);
    for (const auto& p : profiles) {
        for (std::size_t b = 0; b < bins; ++b) truth[b] += p.gi[b] / realisations;
    }
    // 97.5 % points of Student's t from a table, linear in 1/d between
    const auto student = [](double d) {
        const std::vector<std::pair<double, double>> table = {
            {0, 1.95996},      {1.0 / 30, 2.0423}, {1.0 / 10, 2.2281}, {1.0 / 6, 2.4469},
            {1.0 / 4, 2.7764}, {1.0 / 3, 3.1824},  {1.0 / 2, 4.3027}};
        for (std::size_t k = 1; k < table.size(); ++k) {
            if (1 / d <= table[k].first) {
                const double share = (1 / d - table[k - 1].first) / (table[k].first - table[k - 1].first);
                return table[k - 1].second + share * (table[k].second - table[k - 1].second);
            }
        }
        return 4.3027;
    };
    Coverage result;
    double scatter = 0, error = 0;
    for (const auto& p : profiles) {
        for (std::size_t b = 0; b < bins; ++b) {
            const double off = p.gi[b] - truth[b];
            result.pointwise += std::abs(off) <= student(p.degrees) * p.standard_error[b];
            scatter += off * off * realisations / (realisations - 1);
            error += p.standard_error[b] * p.standard_error[b];
        }
    }
    result.pointwise /= static_cast<double>(realisations * bins);
    result.error_ratio = std::sqrt(error / scatter);
    return result;
}

TEST(noise, band_of_plain_bins_covers_when_grains_share_origins_and_the_heap_turns) {
    const Coverage coverage = coverage_of(300, [](int r) {
        const Layer layer = synthetic::make_layer(correlated(), 1000 + r);
        return plain_profile(layer, hard_labels(layer, kCurve), kFootprint, kBins, 1);
    });
    EXPECT_GT(coverage.pointwise, 0.90);
    EXPECT_LT(coverage.pointwise, 0.99);
    EXPECT_NEAR(coverage.error_ratio, 1, 0.15);
}

TEST(noise, independent_grains_alone_would_not_cover) {
    // the same layers with the variance of independent grains: the reason for the blocks
    double inside = 0;
    const int n = 100;
    std::vector<GradationProfile> profiles;
    for (int r = 0; r < n; ++r) {
        const Layer layer = synthetic::make_layer(correlated(), 1000 + r);
        profiles.push_back(plain_profile(layer, hard_labels(layer, kCurve), kFootprint, kBins, 1));
    }
    std::vector<double> truth(8, 0);
    for (const auto& p : profiles) {
        for (int b = 0; b < 8; ++b) truth[b] += p.gi[b] / n;
    }
    for (const auto& p : profiles) {
        for (int b = 3; b < 6; ++b) {
            inside += std::abs(p.gi[b] - truth[b]) <= 1.96 * std::sqrt(p.gi[b] * (1 - p.gi[b]) / p.n_eff[b]);
        }
    }
    EXPECT_LT(inside / (3 * n), 0.88);
}

TEST(noise, band_of_the_homogeneous_estimator_covers) {
    const Coverage coverage = coverage_of(300, [](int r) {
        synthetic::Law strip = correlated();
        strip.width = 0.4e-3;
        strip.grains = 1200;
        strip.patch_y = 0.2e-3;
        const Layer layer = synthetic::make_layer(strip, 1000 + r);
        HomogeneousOptions options;
        options.resamples = 1;
        return homogeneous_profile(std::span(&layer, 1), kCurve, 1.6e-3, 3.2e-3, kBins, options);
    });
    EXPECT_GT(coverage.pointwise, 0.90);
    EXPECT_LT(coverage.pointwise, 0.99);
    EXPECT_NEAR(coverage.error_ratio, 1, 0.15);
}

TEST(noise, band_of_pooled_layers_covers_when_beds_differ) {
    // each bed has a shift of its own, which no block of one layer can know: three layers can
    const Coverage coverage = coverage_of(200, [](int r) {
        std::vector<Layer> layers;
        for (int l = 0; l < 4; ++l) {
            synthetic::Law strip = correlated();
            strip.width = 0.4e-3;
            strip.grains = 600;
            Random bed(77000 + 10 * r + l);
            strip.start += 0.05 * bed.normal();
            layers.push_back(synthetic::make_layer(strip, 5000 + 10 * r + l));
        }
        HomogeneousOptions options;
        options.resamples = 1;
        return homogeneous_profile(layers, kCurve, 1.6e-3, 3.2e-3, kBins, options);
    });
    EXPECT_GT(coverage.pointwise, 0.90);
    EXPECT_LT(coverage.pointwise, 0.99);
    EXPECT_NEAR(coverage.error_ratio, 1, 0.15);
}

TEST(noise, band_of_the_mean_of_three_replicates_covers_when_beds_differ) {
    const Coverage coverage = coverage_of(150, [](int r) {
        std::vector<GradationProfile> replicates;
        for (int l = 0; l < 3; ++l) {
            synthetic::Law law = correlated();
            law.grains = 2000;
            Random bed(88000 + 10 * r + l);
            law.start += 0.04 * bed.normal();
            const Layer layer = synthetic::make_layer(law, 9000 + 10 * r + l);
            replicates.push_back(plain_profile(layer, hard_labels(layer, kCurve), kFootprint, kBins, 1));
        }
        return mean_profile(replicates);
    });
    EXPECT_GT(coverage.pointwise, 0.90);
    EXPECT_LT(coverage.pointwise, 0.99);
    EXPECT_NEAR(coverage.error_ratio, 1, 0.15);
}

TEST(noise, band_of_the_drift_covers) {
    const Coverage coverage = coverage_of(300, [](int r) {
        const Layer layer = synthetic::make_layer(correlated(), 1000 + r);
        const XDrift drift = plain_drift(layer, hard_labels(layer, kCurve), kFootprint, kBins, 1);
        GradationProfile as_profile;
        as_profile.gi = drift.difference;
        as_profile.standard_error = drift.standard_error;
        as_profile.degrees = drift.degrees;
        return as_profile;
    });
    EXPECT_GT(coverage.pointwise, 0.90);
    EXPECT_LT(coverage.pointwise, 0.99);
    EXPECT_NEAR(coverage.error_ratio, 1, 0.15);
}

TEST(noise, plateau_keeps_the_variance_of_the_grain_not_seen) {
    std::vector<std::array<double, 3>> grains;
    for (int i = 0; i < 100; ++i) grains.push_back({1.6e-3 + 1.6e-3 * (i + 0.5) / 100, 0.1e-3, 1});
    const GradationProfile profile =
        plain_profile(layer_of(grains), std::vector<double>(100, 1), kFootprint, kBins, 1);
    const double p0 = 1.0 / 102;
    EXPECT_NEAR(profile.standard_error[0], std::sqrt(p0 * (1 - p0) / 100), 1e-15);
}

TEST(noise, drift_along_x_is_not_taken_for_noise) {
    // labels that change linearly along x and nothing else: the mean is certain, only its trend is large
    std::vector<std::array<double, 3>> grains;
    std::vector<double> label;
    for (int i = 0; i < 1000; ++i) {
        grains.push_back({1.6e-3 + 1.6e-3 * (i + 0.5) / 1000, 0.1e-3, 1});
        label.push_back((i + 0.5) / 1000);
    }
    // what is left is the floor of a plateau, p0 (1 - p0)/n_eff = 1e-6
    const GradationProfile profile = plain_profile(layer_of(grains), label, kFootprint, kBins, 1);
    EXPECT_LT(profile.standard_error[0], 1.5e-3);
    std::vector<BinMoments> bins(1, BinMoments(5));
    for (int i = 0; i < 1000; ++i) bins[0].add(i / 200, grains[i][0], 1, label[i]);
    EXPECT_LT(bin_variances(bins, BlockTrend::linear, BinGrains::own).variance[0], 2e-6);
    EXPECT_GT(bin_variances(bins, BlockTrend::none, BinGrains::own).variance[0], 1e-3);
}

TEST(noise, mean_of_two_replicates_propagates_their_own_errors) {
    GradationProfile a;
    a.y_m = {0.1e-3, 0.3e-3};
    a.gi = {0.4, std::numeric_limits<double>::quiet_NaN()};
    a.standard_error = {0.03, std::numeric_limits<double>::quiet_NaN()};
    a.volume = {1, 0};
    a.n_eff = {200, 0};
    a.degrees = 5;
    GradationProfile b = a;
    b.gi = {0.5, 0.9};
    b.standard_error = {0.04, 0.05};
    b.volume = {1, 1};
    b.n_eff = {200, 100};
    const GradationProfile mean = mean_profile(std::vector<GradationProfile>{a, b});
    EXPECT_DOUBLE_EQ(mean.gi[0], 0.45);
    EXPECT_DOUBLE_EQ(mean.standard_error[0], 0.025);
    EXPECT_DOUBLE_EQ(mean.gi[1], 0.9);
    EXPECT_DOUBLE_EQ(mean.standard_error[1], 0.05);
    EXPECT_DOUBLE_EQ(mean.degrees, 10);
}

TEST(noise, variance_of_three_replicates_adds_up_to_what_lies_between_them) {
    std::vector<GradationProfile> replicates(3);
    const double values[3][2] = {{0.40, 0.70}, {0.46, 0.66}, {0.52, 0.71}};
    for (int r = 0; r < 3; ++r) {
        replicates[r].y_m = {0.1e-3, 0.3e-3};
        replicates[r].gi = {values[r][0], values[r][1]};
        replicates[r].standard_error = {0.03, 0.03};
        replicates[r].volume = {1, 1};
        replicates[r].n_eff = {200, 200};
    }
    const GradationProfile mean = mean_profile(replicates);
    const double between =
        0.0036 / 3 + 0.0007 / 3;  // sample variances 0.0036 and 0.0007 of the two bins, of a mean of 3
    EXPECT_NEAR(std::pow(mean.standard_error[0], 2) + std::pow(mean.standard_error[1], 2), between, 1e-12);
    EXPECT_GT(mean.standard_error[0], mean.standard_error[1]);
}

TEST(noise, the_same_input_gives_the_same_bits) {
    const Layer layer = synthetic::make_layer(correlated(), 21);
    const std::vector<double> label = hard_labels(layer, kCurve);
    EXPECT_EQ(plain_profile(layer, label, kFootprint, kBins, 1).standard_error,
              plain_profile(layer, label, kFootprint, kBins, 1).standard_error);
}

// ---- fields: cells over x and y
// ------------------------------------------------------------------------------------------------

}  // namespace
}  // namespace gradwright
