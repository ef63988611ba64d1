// From coupon to machine: orders of layers whose kernel is known in closed form, the law found again, what a
// design carries.
#include "optimise/heap_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem/random.h"
#include "optimise/design_run.h"
#include "optimise/spread_runner.h"
#include "optimise/study_file.h"
#include "tests/optimise/map_run.h"

namespace gradwright {
namespace {

using testing::HasSubstr;
using testing_heap::Calls;

/// Even deposits; origin of the grain at share eta of the platform, quantile u: `origin(eta, u)`, all in
/// shares.
template <class Origin>
Layer layer_of(Origin origin, double dispenser_length = 3.2e-3, int along = 240, int per_place = 80) {
    Layer layer;
    layer.dispenser_length = layer.platform_length = dispenser_length;
    layer.width = 0.4e-3;
    layer.gap = 143e-6;
    for (int i = 0; i < along; ++i)
        for (int k = 0; k < per_place; ++k) {
            const double eta = (i + 0.5) / along, u = (k + 0.5) / per_place;
            layer.deposit_x.push_back(eta * layer.platform_length);
            layer.origin_x.push_back(origin(eta, u) * dispenser_length);
            layer.deposit_y.push_back(0.2e-3 + 40e-6 * (k % 2 ? 1 : -1));
            layer.origin_y.push_back(0.2e-3);
            layer.deposit_z.push_back(-70e-6);
            layer.origin_z.push_back(0);
            layer.volume.push_back(3e-14);
            layer.radius.push_back(20e-6);
            layer.is_a.push_back(0);
        }
    layer.dosed_solid_volume = 2 * layer.solid_volume();
    layer.overflow_solid_volume = layer.solid_volume();
    layer.bed_packing = 0.55;
    return layer;
}

Scene scene_of_three_layers(double dispenser_length = 3.2e-3) {
    Scene scene;
    scene.dispenser_length = scene.platform_length = dispenser_length;
    scene.layer_thickness = 40e-6;
    scene.dose_height = 120e-6;
    for (Powder& powder : scene.powder) powder.size.d50 = 40e-6;
    return scene;
}

/// Origin at quantile u of the density 1 + sqrt(2) pi o cos(pi xi), whose W - xi = sqrt(2) o sin(pi xi):
/// bisection.
double origin_with_order(double order, double u) {
    double low = 0, high = 1;
    for (int step = 0; step < 50; ++step) {
        const double xi = 0.5 * (low + high);
        (xi + std::numbers::sqrt2 * order * std::sin(std::numbers::pi * xi) < u ? low : high) = xi;
    }
    return 0.5 * (low + high);
}

TEST(HeapOrder, a_mixed_heap_has_none) {
    const HeapOrder order =
        heap_order(layer_of([](double, double u) { return u; }), scene_of_three_layers(), 0.2, 0.8);
    EXPECT_NEAR(order.profile, 0, 0.01);
    EXPECT_NEAR(order.profile_rest, 0, 0.01);
    EXPECT_NEAR(order.drift, 0, 0.01);
    EXPECT_NEAR(order.capture_fraction, 0.5, 1e-12);
    EXPECT_NEAR(order.turnovers, std::sqrt(3.2 / 0.12), 1e-12);
    EXPECT_NEAR(order.dosage_factor, 3, 1e-12);
    // 40 um either way: variance 1600 um2 = D50^2
    EXPECT_NEAR(order.lateral * order.turnovers, 1, 1e-9);
}

TEST(HeapOrder, the_slowest_mode_is_found_with_its_sign) {
    for (const double o : {0.15, -0.1}) {
        const HeapOrder order =
            heap_order(layer_of([o](double, double u) { return origin_with_order(o, u); }),
                       scene_of_three_layers(), 0, 1);
        EXPECT_NEAR(order.profile, o, 0.01) << o;
        EXPECT_NEAR(order.profile_rest, 0, 0.01) << o;
        EXPECT_NEAR(order.drift, 0, 0.01) << o;
    }
}

TEST(HeapOrder, last_in_first_out_is_told_in_closed_form) {
    // origin = 1 - eta / 2: over the whole platform W = max(0, 2 xi - 1), so that W - xi is a triangle of
    // height -1/2, whose mode is sqrt(2) (-1/2) 8 / (2 pi^2); first and last third are steps 5/6..1 and
    // 1/2..2/3
    const HeapOrder order =
        heap_order(layer_of([](double eta, double) { return 1 - 0.5 * eta; }, 3.2e-3, 960, 2),
                   scene_of_three_layers(), 0, 1);
    EXPECT_NEAR(order.profile, -std::numbers::sqrt2 * 2 / (std::numbers::pi * std::numbers::pi), 0.01);
    // W_last - W_first: rises over 1/2..2/3, 1 until 5/6, falls to 1: int = 1/6 + 2 (1/6) / 3
    EXPECT_NEAR(order.drift, std::sqrt(1.0 / 6 + 2.0 / 18), 0.02);
}

TEST(HeapOrder, a_footprint_without_grains_is_refused) {
    EXPECT_THROW(heap_order(layer_of([](double, double u) { return u; }), scene_of_three_layers(), 1, 2),
                 std::invalid_argument);
}

const std::vector<double> kTurnovers = {3.65, 4.2, 5.2, 6.3, 7.3, 10.3, 14.6};

std::vector<double> orders(const OrderLaw& law, const std::vector<double>& at) {
    std::vector<double> result;
    for (const double n : at) result.push_back(law.at(n));
    return result;
}

OrderLaw known_law() {
    OrderLaw law;
    law.amplitude = 0.6;
    law.memory = 9;
    law.turn = 13;
    law.phase = 2.4;
    return law;
}

TEST(HeapOrder, the_law_is_found_again) {
    const OrderLaw known = known_law();
    const OrderLaw found = fit_order_law(kTurnovers, orders(known, kTurnovers));
    ASSERT_TRUE(found.fitted);
    EXPECT_NEAR(found.amplitude, known.amplitude, 1e-3);
    EXPECT_NEAR(found.memory, known.memory, 0.02);
    EXPECT_NEAR(found.turn, known.turn, 0.02);
    EXPECT_NEAR(std::cos(found.phase - known.phase), 1, 1e-4);
    EXPECT_LT(found.collapse_error, 1e-4);
    EXPECT_NEAR(found.longest_miss, 0, 1e-3);
    EXPECT_NEAR(found.longest_envelope, known.envelope(14.6), 1e-3);
    EXPECT_NEAR(found.at(30), known.at(30), 1e-3);
}

TEST(HeapOrder, scatter_is_the_collapse_error) {
    std::vector<double> turnovers, order;
    Random random(3);
    for (int i = 0; i < 60; ++i) {
        turnovers.push_back(3 + 0.25 * i);
        order.push_back(known_law().at(turnovers.back()) + 0.03 * random.normal());
    }
    EXPECT_NEAR(fit_order_law(turnovers, order).collapse_error, 0.03, 0.006);
}

TEST(HeapOrder, four_strips_are_too_few_for_four_parameters) {
    const std::vector<double> four(kTurnovers.begin(), kTurnovers.begin() + 4);
    EXPECT_FALSE(fit_order_law(four, orders(known_law(), four)).fitted);
}

/// Strips of these lengths [mm] at dosage 3, whose W - xi is order x sqrt(2) sin(pi xi), and its drift
/// `drift` of that.
ScaledHeap heap_with(const std::vector<double>& lengths, const std::vector<double>& order, double drift,
                     double machine = 100) {
    ScaledHeap heap;
    heap.length = machine * 1e-3;
    for (std::size_t k = 0; k < order.size(); ++k) {
        HeapOrder strip;
        strip.dispenser_length = lengths[k] * 1e-3;
        strip.dosage_factor = 3;
        strip.turnovers = std::sqrt(lengths[k] / 0.12);
        strip.profile = order[k];
        strip.drift = std::fabs(drift * order[k]);
        for (int i = 1; i < 40; ++i) {
            strip.share.push_back(order[k] * std::numbers::sqrt2 * std::sin(std::numbers::pi * i / 40.0));
            strip.share_drift.push_back(drift * strip.share.back());
        }
        heap.strips.push_back(strip);
    }
    return heap;
}

TEST(HeapOrder, a_machine_carries_the_last_step_once_for_every_doubling) {
    ScaledHeap heap = heap_with({3.2, 6.4, 12.8}, {-0.3, 0.1, 0.15}, 0.1, 12.8 * 8);
    carry_errors(heap, 3);
    EXPECT_NEAR(heap.longest, 12.8e-3, 1e-12);
    EXPECT_NEAR(heap.nearest.profile, 0.15, 1e-12);
    // rms over 39 points of a sine between zeros: sqrt(40/39) of the rms over the whole
    const double points = std::sqrt(40.0 / 39);
    EXPECT_NEAR(heap.profile_step, 0.05 * points, 1e-9);
    EXPECT_NEAR(heap.profile_error, std::sqrt(3.0) * 0.05 * points, 1e-9);
    // its steps are small, sqrt(3) 0.005, but one of the strips drifted by 0.1 x 0.3
    EXPECT_NEAR(heap.drift_step, 0.005 * points, 1e-9);
    EXPECT_NEAR(heap.drift_error, 0.03, 1e-9);
}

TEST(HeapOrder, a_step_over_two_doublings_counts_as_two) {
    ScaledHeap heap = heap_with({3.2, 12.8}, {0.1, 0.3}, 0, 25.6);
    carry_errors(heap, 3);
    EXPECT_NEAR(heap.profile_step, 0.2 / std::numbers::sqrt2 * std::sqrt(40.0 / 39), 1e-9);
    EXPECT_NEAR(heap.profile_error, heap.profile_step, 1e-12);
}

TEST(HeapOrder, other_doses_are_no_steps_in_length) {
    ScaledHeap heap = heap_with({3.2, 6.4}, {0.1, 0.15}, 0);
    HeapOrder other = heap_with({6.4}, {0.35}, 0).strips[0];
    other.dosage_factor = 1;  // more turnovers than any
    other.turnovers = 99;
    heap.strips.push_back(other);
    carry_errors(heap, 3);
    EXPECT_NEAR(heap.nearest.profile, 0.15, 1e-12);
    EXPECT_NEAR(heap.profile_step, 0.05 * std::sqrt(40.0 / 39), 1e-9);
    EXPECT_NEAR(heap.dose_step, 0.2 * std::sqrt(40.0 / 39), 1e-9);
    EXPECT_THROW(carry_errors(heap, 1), std::invalid_argument);
}

/// Strips whose heaps follow the law; `worse`: order on top of it.
SpreadFunction rolling_engine(std::shared_ptr<Calls> calls, double scale = 0.3) {
    return [calls, scale](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        (partition ? calls->full_seeds : calls->map_seeds).push_back(scene.seed);
        calls->map_widths.push_back(scene.dispenser_length);
        SpreadResult result;
        result.health.status = "ok";
        const double order = scale * known_law().at(heap_turnovers(scene));
        result.layer = layer_of([order](double, double u) { return origin_with_order(order, u); },
                                scene.dispenser_length);
        result.layer.packing_seed = scene.seed;
        result.grains = long(result.layer.size());
        result.state_hash = "rolling";
        return result;
    };
}

const std::string kMachine = R"(
[machine]
name = "long"
dispenser = { length = "100 mm", width = "100 mm", depth = "100 mm" }
platform = { length = "100 mm", width = "100 mm" }
land = "20 mm"
[process]
steady_packing = 0.28
[powder.A]
material = "SS17-4PH"
[powder.B]
material = "IN718"
[target]
shape = "linear"
from = { y = "20 mm", gi = 0.0 }
to = { y = "80 mm", gi = 1.0 }
footprint = { x = ["20 mm", "80 mm"], y = ["10 mm", "90 mm"] }
bin_width = "5 mm"
[design_space]
partition = { family = "straight" }
dosage_factor = 3.0
[objective]
tolerance = 0.25
x_drift_tolerance = 0.2
[numerics]
reductions = "reduced"
[scale_up]
lengths = ["1.6 mm", "3.2 mm", "6.4 mm", "12.8 mm", "25.6 mm"]
dosage_factors = [2, 3, 4.5]
)";

TEST(ScaleUp, a_long_machine_is_designed_from_strips_and_says_so) {
    const Study study = parse_study(kMachine, "machine.toml");
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    options.spread = rolling_engine(calls);
    const StudyResult result = run_map_strategy(study, options);
    EXPECT_EQ(calls->map_seeds.size(), 7u);  // five lengths, two more doses
    EXPECT_TRUE(calls->full_seeds.empty());
    EXPECT_LE(*std::max_element(calls->map_widths.begin(), calls->map_widths.end()), 25.6e-3 * (1 + 1e-9));
    ASSERT_TRUE(result.extrapolated);
    EXPECT_EQ(result.spreads_map, 7);
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    EXPECT_THAT(result.message, HasSubstr("Extrapolated from 7 strips"));
    EXPECT_NEAR(result.extrapolated->turnovers, std::sqrt(100 / 0.12), 1e-9);
    // nearly mixed: straight from about (0, 80) to (100, 20) or its mirror; the error carried is in every bin
    // of the ramp
    const auto points = result.design.partition.clipped(study.scene.dispenser_length, study.dispenser_width);
    EXPECT_NEAR(std::fabs(points.back().y - points.front().y), 60e-3, 6e-3);
    const double carried = result.extrapolated->profile_error;
    EXPECT_GT(carried, 0.002);
    for (std::size_t b = 6; b < 14; ++b) {
        EXPECT_NEAR(result.predicted.profile.gi[b], result.target[b], 0.03) << b;
        // the straight partition crosses y at this share of the dispenser's length
        const auto& line = result.design.partition.points;
        const double y = result.predicted.profile.y_m[b];
        const double at =
            line[0].x + (y - line[0].y) / (line.back().y - line[0].y) * (line.back().x - line[0].x);
        const double here =
            carried * std::numbers::sqrt2 * std::sin(std::numbers::pi * std::clamp(at / 0.1, 0.0, 1.0));
        EXPECT_GE(result.predicted.profile.standard_error[b], here - 1e-3) << b;
        EXPECT_NEAR(result.predicted.profile.standard_error[b], here, 0.03) << b;
        EXPECT_NEAR(result.band_low[b],
                    std::max(0.0, result.predicted.profile.gi[b] -
                                      common_factor(3) * result.predicted.profile.standard_error[b]),
                    1e-12)
            << b;
    }
    // one error for all bins: the bound does not shrink with their number. t(3) at 95 %: 2.353
    EXPECT_NEAR(common_factor(3), 3.182, 0.001);
    EXPECT_GE(result.misfit.interval_high, result.misfit.value + 2.352 * result.misfit.noise_floor);
}

TEST(ScaleUp, it_has_no_full_spreads) {
    const Study study = parse_study(kMachine, "machine.toml");
    auto calls = std::make_shared<Calls>();
    RunOptions options;
    options.spread = rolling_engine(calls);
    const Evaluation evaluation = evaluate_once(study, start_design(study), Fidelity::full, 1, options);
    EXPECT_EQ(evaluation.health.status, "invalid");
    EXPECT_THAT(evaluation.health.reason, HasSubstr("scale_up"));
    EXPECT_TRUE(calls->full_seeds.empty());
}

TEST(ScaleUp, strips_keep_the_machines_proportions) {
    const Study study = parse_study(kMachine, "machine.toml");
    const Scene strip = scaled_strip(study, start_design(study), 6.4e-3, 3, 5);
    EXPECT_DOUBLE_EQ(strip.platform_length, 6.4e-3);
    EXPECT_NEAR(strip.land, 1.28e-3, 1e-12);
    EXPECT_NEAR(strip.dose_height, 120e-6, 1e-12);
    EXPECT_NEAR(strip.width, 0.4e-3, 1e-12);
    EXPECT_EQ(strip.sides, Sides::periodic);
    const auto plan = scale_up_plan(study, 3);
    ASSERT_EQ(plan.size(), 7u);
    EXPECT_NEAR(plan[5].first, 6.4e-3, 1e-12);
    EXPECT_NEAR(plan[5].second, 2, 1e-12);
    EXPECT_NEAR(plan[6].second, 4.5, 1e-12);
}

TEST(ScaleUp, the_longest_layer_is_stretched_and_wanders_as_a_random_walk) {
    const Study study = parse_study(kMachine, "machine.toml");
    ScaledHeap heap = heap_with({6.4, 12.8}, {0.1, 0.15}, 0);
    carry_errors(heap, 3);
    heap.turnovers = std::sqrt(100 / 0.12);
    heap.kernel = layer_of([](double, double u) { return origin_with_order(0.15, u); }, 12.8e-3);
    const Layer layer = stretched_layer(study, start_design(study), heap);
    const HeapOrder order = heap_order(layer, scene_of(study, start_design(study), true, 1), 0.2, 0.8);
    EXPECT_NEAR(order.profile, 0.15, 0.01);
    EXPECT_NEAR(order.dispenser_length, 0.1, 1e-12);
    EXPECT_NEAR(order.capture_fraction, heap.kernel.capture_fraction(), 1e-12);
    EXPECT_NEAR(layer.packing_fraction(), heap.kernel.packing_fraction(), 1e-9);
    // 40 um either way on the strip: the variance grows with the turnovers
    EXPECT_NEAR(order.lateral * order.turnovers, heap.turnovers / heap.nearest.turnovers, 1e-6);
}

TEST(ScaleUp, another_dose_that_fails_is_left_out_and_the_own_dose_ends_the_run) {
    const Study study = parse_study(kMachine, "machine.toml");
    for (const double bad : {2.0, 3.0}) {
        auto calls = std::make_shared<Calls>();
        RunOptions options;
        const SpreadFunction sound = rolling_engine(calls);
        options.spread = [&](const Scene& scene, const PartitionCurve* partition, const SpreadOptions& more) {
            SpreadResult result = sound(scene, partition, more);
            if (std::fabs(scene.dose_height - bad * 40e-6) < 1e-9) {
                result.health.status = "starved";
                result.health.reason = "nothing left";
            }
            return result;
        };
        const StudyResult result = run_map_strategy(study, options);
        if (bad == 2.0) {
            ASSERT_TRUE(result.extrapolated);
            EXPECT_EQ(result.extrapolated->strips.size(), 6u);
            EXPECT_THAT(result.warnings, testing::Contains(HasSubstr("left out")));
        } else {
            EXPECT_EQ(result.termination, "failed");
            EXPECT_THAT(result.message, HasSubstr("strip of 1.6 mm"));
        }
    }
}

}  // namespace
}  // namespace gradwright
