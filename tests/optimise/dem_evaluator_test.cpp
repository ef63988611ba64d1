// How a labelled spread is read: every grain for every y where that holds, bins of their own grains where
// not.
#include "optimise/dem_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "optimise/map_evaluator.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

Evaluation spread_once(const Study& study, const Heap& heap, std::uint64_t seed = 5) {
    RunOptions options;
    options.spread = engine(heap, std::make_shared<Calls>());
    SpreadRunner runner(options);
    return DemEvaluator(study, runner, nullptr).evaluate(start_design(study), seed);
}

Study periodic_coupon() {
    Study study = coupon();
    study.scene.sides = Sides::periodic;
    return study;
}

double rms(const std::vector<double>& values, const std::vector<double>& weight) {
    return norm_of(Norm::rmse, values, weight);
}

TEST(DemEvaluator, like_powders_between_periodic_sides_are_read_from_every_grain_with_less_noise) {
    const Study study = periodic_coupon();
    const Heap heap;
    const Truth expected = truth(heap, study, start_design(study), true);
    double of_bins = 0, of_all = 0;
    for (int seed = 1; seed <= 10; ++seed) {
        const Evaluation got = spread_once(study, heap, seed);
        ASSERT_TRUE(got.every_grain);
        EXPECT_TRUE(got.health.warnings.empty());
        std::vector<double> all = got.profile.gi, bins = got.plain_check.gi;
        for (std::size_t b = 0; b < all.size(); ++b) {
            all[b] -= expected.gi[b];
            bins[b] -= expected.gi[b];
        }
        of_all += std::pow(rms(all, got.weight), 2) / 10;
        of_bins += std::pow(rms(bins, got.weight), 2) / 10;
        EXPECT_LT(rms(got.profile.standard_error, got.weight),
                  0.75 * rms(got.plain_check.standard_error, got.weight));
        EXPECT_LT(got.drift.noise_floor, got.plain_check_drift.noise_floor);
    }
    EXPECT_LT(of_all, 0.5 * of_bins);
}

TEST(DemEvaluator,
     what_a_bed_went_to_one_side_is_not_blamed_on_the_partition_unless_a_slot_tells_the_sides_apart) {
    Heap heap;
    heap.bed_aside = 20e-6;
    double error[2] = {0, 0};  // mean square, without and with a slot
    for (const bool slot : {false, true}) {
        Study study = periodic_coupon();
        study.scene.plate_thickness = slot ? 50e-6 : 0;
        EXPECT_EQ(spreads_like_its_image(study), !slot);
        const Truth expected = truth(heap, study, start_design(study), true);
        for (int seed = 1; seed <= 12; ++seed) {
            const Evaluation got = spread_once(study, heap, seed);
            ASSERT_TRUE(got.every_grain) << seed;
            std::vector<double> off = got.profile.gi;
            for (std::size_t b = 0; b < off.size(); ++b) off[b] -= expected.gi[b];
            error[slot] += std::pow(rms(off, got.weight), 2) / 12;
        }
    }
    // 1.25 a millimetre times 20 um is 0.025 where nothing else moves the profile
    EXPECT_GT(std::sqrt(error[1]), 0.015);
    EXPECT_LT(error[0], 0.5 * error[1]);
}

TEST(DemEvaluator, unlike_powders_are_read_each_by_its_own_grains_with_less_noise) {
    Study study = periodic_coupon();
    study.scene.powder[1].material.density = 4309;
    Heap heap;
    heap.b_shift = 0.15;
    heap.b_more = 1.3;
    const Truth expected = truth(heap, study, start_design(study), true);
    double of_bins = 0, of_all = 0, square = 0;
    int counted = 0;
    for (int seed = 1; seed <= 10; ++seed) {
        const Evaluation got = spread_once(study, heap, seed);
        ASSERT_TRUE(got.every_grain) << seed;
        std::vector<double> all = got.profile.gi, bins = got.plain_check.gi;
        for (std::size_t b = 0; b < all.size(); ++b) {
            all[b] -= expected.gi[b];
            bins[b] -= expected.gi[b];
            if (!(got.weight[b] > 0)) continue;
            square += std::pow(all[b] / got.profile.standard_error[b], 2);
            ++counted;
        }
        of_all += std::pow(rms(all, got.weight), 2) / 10;
        of_bins += std::pow(rms(bins, got.weight), 2) / 10;
    }
    EXPECT_LT(of_all, 0.6 * of_bins);
    EXPECT_LT(square / counted, 1.5);  // no further from the truth than its standard errors say
}

TEST(DemEvaluator, the_band_of_every_grain_holds_the_truth_at_its_rate) {
    // beds that share a shift of their own, as ours do: 40 beds, 2 misses expected at 5 %
    const Study study = periodic_coupon();
    Heap heap;
    heap.bed_shift = 0.01;
    const Truth expected = truth(heap, study, start_design(study), true);
    int misses = 0;
    for (int seed = 1; seed <= 40; ++seed) {
        const Evaluation got = spread_once(study, heap, seed);
        const Band band =
            simultaneous_band(got.profile.gi, got.profile.standard_error, got.profile.degrees, got.weight);
        for (std::size_t b = 0; b < got.weight.size(); ++b)
            if (got.weight[b] > 0 && !(band.low[b] <= expected.gi[b] && expected.gi[b] <= band.high[b])) {
                ++misses;
                break;
            }
    }
    EXPECT_LE(misses, 7);
}

TEST(DemEvaluator, transport_that_depends_on_y_sends_it_back_to_the_bins) {
    Heap heap;
    heap.across = 0.5;
    const Study study = periodic_coupon();
    const Evaluation got = spread_once(study, heap);
    EXPECT_FALSE(got.every_grain);
    ASSERT_EQ(got.health.warnings.size(), 1u);
    EXPECT_NE(got.health.warnings[0].find("contradict"), std::string::npos);
    // what is quoted are the bins
    Study walls = coupon();
    const Evaluation bins = spread_once(walls, heap);
    ASSERT_EQ(bins.profile.gi.size(), got.profile.gi.size());
    for (std::size_t b = 1; b + 1 < bins.profile.gi.size(); ++b)
        EXPECT_NEAR(got.profile.gi[b], bins.profile.gi[b], 1e-12) << b;
    EXPECT_TRUE(got.plain_check.gi.empty());
}

TEST(DemEvaluator, walls_unequal_fills_and_stray_labels_are_read_from_bins) {
    const auto plain = [](const Study& study, const Heap& heap) {
        const Evaluation got = spread_once(study, heap);
        return !got.every_grain && got.plain_check.gi.empty() && got.health.warnings.empty();
    };
    EXPECT_TRUE(plain(coupon(), {}));
    Study study = periodic_coupon();
    study.design_space.fill_fraction[1].value = 0.8;
    EXPECT_TRUE(plain(study, {}));
    study = periodic_coupon();
    study.scene.powder[1].material.density = 4309;
    study.scene.share_a = {0.9, 0.1};  // a side is no powder
    EXPECT_TRUE(plain(study, {}));
    Heap heap;
    heap.stray = 0.05;
    EXPECT_TRUE(plain(periodic_coupon(), heap));
}

}  // namespace
}  // namespace gradwright
