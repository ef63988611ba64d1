// Size distribution: cuts, quantiles and the made set (physics.md 2).
#include "dem/size_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kMicron = 1e-6;
/// The reference page rounds to 0.1 um.
constexpr double kRounding = 0.05 * kMicron;

SizeDistribution fines_cut() {
    SizeDistribution size;
    size.cut_low = 25e-6;
    size.cut_high = 62e-6;
    return size;
}

TEST(size_distribution, default_powder_has_the_volume_quantiles_of_the_reference_page_after_the_cut) {
    const SizeDistribution size;
    EXPECT_NEAR(size.volume_quantile(0.1), 25.4 * kMicron, kRounding);
    EXPECT_NEAR(size.volume_quantile(0.5), 39.6 * kMicron, kRounding);
    EXPECT_NEAR(size.volume_quantile(0.9), 60.4 * kMicron, kRounding);
    EXPECT_NEAR(size.number_quantile(0.5), 28 * kMicron, 0.5 * kMicron);
}

TEST(size_distribution, fines_cut_has_the_volume_quantiles_of_the_reference_page) {
    // that page gives 28.6 / 39.8 / 54.8 for a set that was made; the cut distribution itself has 28.57
    // / 39.72 / 54.74
    constexpr double kMadeSet = 0.1 * kMicron;
    EXPECT_NEAR(fines_cut().volume_quantile(0.1), 28.6 * kMicron, kMadeSet);
    EXPECT_NEAR(fines_cut().volume_quantile(0.5), 39.8 * kMicron, kMadeSet);
    EXPECT_NEAR(fines_cut().volume_quantile(0.9), 54.8 * kMicron, kMadeSet);
}

TEST(size_distribution, wide_cuts_give_back_the_quantiles_asked_for) {
    SizeDistribution size;
    size.cut_low = 1e-9;
    size.cut_high = 1;
    size.d10 = 20e-6;
    size.d50 = 40e-6;
    size.d90 = 80e-6;
    EXPECT_NEAR(size.volume_quantile(0.1), 20 * kMicron, 1e-9 * kMicron);
    EXPECT_NEAR(size.volume_quantile(0.5), 40 * kMicron, 1e-9 * kMicron);
    EXPECT_NEAR(size.volume_quantile(0.9), 80 * kMicron, 1e-9 * kMicron);
    // number median of an uncut log-normal: D50 exp(-3 sigma^2)
    EXPECT_NEAR(size.number_quantile(0.5), size.d50 * std::exp(-3 * size.sigma() * size.sigma()),
                1e-9 * kMicron);
}

TEST(size_distribution, quantiles_end_at_the_cuts) {
    const SizeDistribution size = fines_cut();
    for (double p : {0.0, 1.0}) {
        const double cut = p == 0 ? size.cut_low : size.cut_high;
        EXPECT_NEAR(size.volume_quantile(p), cut, 1e-9 * cut);
        EXPECT_NEAR(size.number_quantile(p), cut, 1e-9 * cut);
    }
}

TEST(size_distribution, mean_grain_volume_is_the_integral_over_the_number_distribution) {
    for (const SizeDistribution& size : {SizeDistribution{}, fines_cut()}) {
        double sum = 0;
        const int n = 20000;
        for (int k = 0; k < n; ++k) sum += std::pow(size.number_quantile((k + 0.5) / n), 3);
        EXPECT_NEAR(size.mean_grain_volume() / (std::numbers::pi / 6 * sum / n), 1,
                    2e-4);  // midpoint rule, end corners
    }
}

TEST(size_distribution, a_set_drawn_by_number_has_the_quantiles_by_volume) {
    const SizeDistribution size;
    const Quantiles made = volume_quantiles(size.draw(4000, 3));
    // strata hold the number shares exactly; what is left is where the few coarsest grains fall in theirs
    EXPECT_NEAR(made.d10, size.volume_quantile(0.1), 0.2 * kMicron);
    EXPECT_NEAR(made.d50, size.volume_quantile(0.5), 0.2 * kMicron);
    EXPECT_NEAR(made.d90, size.volume_quantile(0.9), 0.4 * kMicron);
}

TEST(size_distribution, every_stratum_of_the_number_distribution_gets_one_grain_and_their_order_is_shuffled) {
    const SizeDistribution size;
    const std::size_t count = 500;
    std::vector<double> drawn = size.draw(count, 9);
    EXPECT_FALSE(std::is_sorted(drawn.begin(), drawn.end()));
    std::sort(drawn.begin(), drawn.end());
    for (std::size_t k = 0; k < count; ++k) {
        EXPECT_GE(drawn[k], size.number_quantile(static_cast<double>(k) / count) * (1 - 1e-12));
        EXPECT_LE(drawn[k], size.number_quantile((k + 1.0) / count) * (1 + 1e-12));
    }
}

TEST(size_distribution, the_same_seed_gives_the_same_bits_and_another_seed_others) {
    const SizeDistribution size;
    EXPECT_EQ(size.draw(100, 5), size.draw(100, 5));
    EXPECT_NE(size.draw(100, 5), size.draw(100, 6));
    EXPECT_TRUE(size.draw(0, 5).empty());
}

TEST(size_distribution, one_size_is_allowed) {
    SizeDistribution size;
    size.d10 = size.d90 = size.d50;
    EXPECT_EQ(size.draw(3, 1), std::vector<double>(3, size.d50));
    EXPECT_DOUBLE_EQ(size.mean_grain_volume(), std::numbers::pi / 6 * std::pow(size.d50, 3));
}

TEST(size_distribution, volume_quantiles_weigh_grains_by_volume) {
    // 8 grains of diameter 1 carry the volume of one of diameter 2: the volume median lies between, the
    // number median does not
    std::vector<double> diameters(8, 1.0);
    diameters.push_back(2.0);
    EXPECT_GT(volume_quantiles(diameters).d50, 1.0);
    EXPECT_DOUBLE_EQ(volume_quantiles(diameters).d10, 1.0);
    EXPECT_DOUBLE_EQ(volume_quantiles(diameters).d90, 2.0);
}

TEST(random, is_the_published_generator) {
    // xoshiro256** seeded by splitmix64(0): first words of splitmix64 are published as e220a8397b1dcdaf,
    // 6e789e6aa1b965f4, ... so the first output is rotl(word1 * 5, 7) * 9
    const std::uint64_t word = 0x6e789e6aa1b965f4ULL * 5;
    EXPECT_EQ(Random(0).next(), ((word << 7) | (word >> 57)) * 9);
}

TEST(random, moments_of_uniform_and_normal_numbers) {
    Random random(1);
    const int n = 200000;
    double u = 0, u2 = 0, z = 0, z2 = 0, z4 = 0;
    for (int k = 0; k < n; ++k) {
        const double a = random.uniform(), b = random.normal();
        u += a;
        u2 += a * a;
        z += b;
        z2 += b * b;
        z4 += b * b * b * b;
    }
    // 4 standard errors
    EXPECT_NEAR(u / n, 0.5, 4 * std::sqrt(1.0 / 12 / n));
    EXPECT_NEAR(u2 / n, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / n));
    EXPECT_NEAR(z / n, 0, 4 * std::sqrt(1.0 / n));
    EXPECT_NEAR(z2 / n, 1, 4 * std::sqrt(2.0 / n));
    EXPECT_NEAR(z4 / n, 3, 4 * std::sqrt(96.0 / n));
}

TEST(random, below_reaches_every_value_and_no_other) {
    Random random(2);
    std::set<std::uint64_t> seen;
    for (int k = 0; k < 1000; ++k) seen.insert(random.below(7));
    EXPECT_EQ(seen.size(), 7u);
    EXPECT_EQ(*seen.rbegin(), 6u);
}

}  // namespace
}  // namespace gradwright
