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
    EXPECT_NEAR(order.waste_fraction, 0.5, 1e-12);
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

ScaledHeap heap_with(const std::vector<double>& order, double machine = 28.9) {
    ScaledHeap heap;
    heap.turnovers = machine;
    for (std::size_t k = 0; k < order.size(); ++k) {
        HeapOrder strip;
        strip.turnovers = kTurnovers[k];
        strip.profile = order[k];
        strip.drift = 0.3;
        strip.profile_rest = 0.02;
        heap.strips.push_back(strip);
    }
    heap.law = fit_order_law({kTurnovers.data(), order.size()}, order);
    carry_errors(heap);
    return heap;
}

TEST(HeapOrder, a_machine_carries_the_envelope_and_the_scatter) {
    const ScaledHeap heap = heap_with(orders(known_law(), kTurnovers));
    EXPECT_NEAR(heap.profile_error, std::hypot(0.6 * std::exp(-28.9 / 9), 0.02), 1e-3);
    // the drift's envelope lies above every strip: here above the last
    EXPECT_NEAR(heap.drift_error, 0.3 * std::exp((14.6 - 28.9) / 9), 2e-3);
    EXPECT_TRUE(heap.health.warnings.empty());
}

TEST(HeapOrder, a_longest_strip_beyond_the_law_is_carried_as_it_is) {
    std::vector<double> order = orders(known_law(), kTurnovers);
    order.back() = 0.5;
    const ScaledHeap heap = heap_with(order);
    EXPECT_GE(heap.profile_error, 0.5);
    EXPECT_GE(heap.drift_error, 0.3);
    ASSERT_EQ(heap.health.warnings.size(), 1u);
    EXPECT_THAT(heap.health.warnings[0], HasSubstr("more order"));
}

TEST(HeapOrder, without_a_law_the_last_order_is_carried) {
    const ScaledHeap heap = heap_with({-0.4, -0.3, -0.2, 0.1});
    EXPECT_NEAR(heap.profile_error, std::hypot(0.1, 0.02), 1e-12);
    EXPECT_NEAR(heap.drift_error, 0.3, 1e-12);
    EXPECT_EQ(heap.health.warnings.size(), 1u);
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
tolerance = 0.1
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
    // a mixed heap: straight from (0, 80) to (100, 20) or its mirror; the error carried is in every bin of
    // the ramp
    const auto points = result.design.partition.clipped(study.scene.dispenser_length, study.dispenser_width);
    EXPECT_NEAR(std::fabs(points.back().y - points.front().y), 60e-3, 4e-3);
    const double carried = result.extrapolated->profile_error;
    EXPECT_GT(carried, 0.005);
    for (std::size_t b = 6; b < 14; ++b) {
        EXPECT_NEAR(result.predicted.profile.gi[b], result.target[b], 0.03) << b;
        const double here =
            carried * std::numbers::sqrt2 * std::sin(std::numbers::pi * result.predicted.profile.gi[b]);
        EXPECT_GT(result.predicted.profile.standard_error[b], here) << b;
        EXPECT_NEAR(result.predicted.profile.standard_error[b], here, 0.01) << b;
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
    const Scene strip = scaled_strip(study, 6.4e-3, 3, 5);
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

TEST(ScaleUp, a_mixed_layer_is_even_and_spreads_sideways_as_the_strips_do) {
    const Study study = parse_study(kMachine, "machine.toml");
    ScaledHeap heap = heap_with(orders(known_law(), kTurnovers));
    heap.lateral = 0.2;
    heap.strips.back().capture_fraction = 0.6;
    heap.strips.back().bed_packing = 0.55;
    const Layer layer = mixed_layer(study, start_design(study), heap);
    const HeapOrder order = heap_order(layer, scene_of(study, start_design(study), true, 1), 0.2, 0.8);
    EXPECT_NEAR(order.profile, 0, 1e-3);
    EXPECT_NEAR(order.drift, 0, 3e-3);
    EXPECT_NEAR(order.lateral, 0.2, 0.002);
    EXPECT_NEAR(order.capture_fraction, 0.6, 1e-9);
}

}  // namespace
}  // namespace gradwright
