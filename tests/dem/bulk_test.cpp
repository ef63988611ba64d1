// Bulk checks and limits, one small case of each row of docs/bulk.md and docs/hard-cases.md: the edge of the
// time step, sticking, draining, layers against gap, speed and substrate, and what a factor does to GI.
#include "dem/bulk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem/gradation.h"
#include "dem/partition.h"
#include "dem/stability.h"

namespace gradwright {
namespace {

TEST(StabilityEdge, an_undamped_grain_between_plates_is_stable_to_the_leapfrogs_two_over_omega) {
    // Without friction the plates make one spring: w^2 = 2 S_n/m with S_n = 2 E* sqrt(r delta), both plates
    // of the grain's material. Leapfrog: dt w < 2.
    StabilitySetup setup;
    setup.packing = StabilityPacking::wedge;
    setup.interaction = {};
    setup.interaction.work_of_adhesion = setup.interaction.static_friction =
        setup.interaction.rolling_friction = 0;
    setup.interaction.coefficient_of_restitution = 1;
    for (const double overlap : {0.03, 0.2}) {
        setup.overlap = overlap;
        const StabilityEdge edge = stability_edge(setup);
        // in units of r sqrt(rho/E): w = sqrt(2 * 2/(2 (1 - nu^2)) sqrt(delta/r) / (4/3 pi)), T_R = pi sqrt(2
        // (1 + nu)) / (0.1631 nu + 0.8766), nu = 0.3
        const double w = std::sqrt(2 / 0.91 * std::sqrt(overlap) / (4.0 / 3.0 * std::numbers::pi));
        const double rayleigh = std::numbers::pi * std::sqrt(2.6) / (0.1631 * 0.3 + 0.8766);
        EXPECT_NEAR(edge.edge() / (2 / w / rayleigh), 1, 0.04) << overlap;  // bisected to 3 %
    }
}

TEST(StabilityEdge, of_the_papers_law_in_a_dense_heap_is_above_twice_the_default_step) {
    EXPECT_LE(Scene{}.rayleigh_fraction, 0.5 * kStabilityEdge);
    StabilitySetup setup;  // the paper's law; of its rolling models the spring comes lowest
    setup.interaction.work_of_adhesion = 0;
    setup.interaction.rolling_model = RollingModel::spring;
    const StabilityEdge edge = stability_edge(setup);
    EXPECT_NEAR(edge.overlap, 0.03, 0.01);
    EXPECT_GT(edge.stable, kStabilityEdge);
    EXPECT_LT(edge.unstable, 1);  // the search can find one
}

/// The paper's powder without fines, both chambers alike.
Scene papers_powder() {
    Scene scene;
    scene.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    scene.powder[1].material = scene.powder[0].material;
    for (auto& p : scene.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    scene.wall = scene.powder[0].material;
    return scene;
}

/// Drained for 60 ms from a box of some 800 grains.
ReposeResult drained(double friction, double rolling, double work_of_adhesion) {
    Scene scene = papers_powder();
    scene.interaction.work_of_adhesion = work_of_adhesion;
    scene.interaction.static_friction = friction;
    scene.interaction.rolling_friction = rolling;
    scene.interaction.rolling_model = RollingModel::spring;
    SpreadOptions options;
    options.threads = 1;
    return drain(scene, {.length = 0.6e-3, .width = 0.26e-3, .height = 0.26e-3, .longest = 0.06}, options);
}

TEST(Repose, rough_grains_stay_smooth_ones_run_out_and_adhesive_ones_stand) {
    const ReposeResult rough = drained(0.64, 0.1, 0), smooth = drained(0.05, 0, 0),
                       sticky = drained(0.64, 0.1, 0.02);
    for (const auto* r : {&rough, &smooth, &sticky}) ASSERT_TRUE(r->health.ok()) << r->health.reason;
    EXPECT_GT(rough.left_fraction, smooth.left_fraction + 0.1);
    EXPECT_GT(rough.angle_deg, smooth.angle_deg + 5);
    EXPECT_LT(rough.left, rough.grains);
    // Bond number above 10: a bed of a quarter of a millimetre, six grains high, does not lose one of them
    EXPECT_GT(sticky.bond_number, 10);
    EXPECT_TRUE(sticky.at_rest);
    EXPECT_EQ(sticky.left, sticky.grains);
    EXPECT_TRUE(std::isnan(sticky.angle_deg));
}

/// A strip of some 600 grains, laid on a platform of 1 mm.
Scene short_strip() {
    Scene scene = papers_powder();
    scene.dispenser_length = 0.6e-3;
    scene.width = 0.26e-3;
    scene.bed_depth = 40e-6;
    scene.dose_height = 160e-6;
    scene.land = 0.4e-3;
    scene.platform_length = 1e-3;
    scene.second_land = 0.4e-3;
    scene.gap = 140e-6;
    scene.blade_speed = 0.05;
    scene.blade_thickness = 0.2e-3;
    scene.allow_starved = true;
    return scene;
}

Layer laid(const Scene& scene) {
    SpreadOptions options;
    options.threads = 1;
    SpreadResult result = run_spread(scene, nullptr, options);
    EXPECT_EQ(result.health.status, "ok") << result.health.reason;
    return std::move(result.layer);
}

/// The strip as it is, laid once for all tests of this program.
const Layer& base_layer() {
    static const Layer layer = laid(short_strip());
    return layer;
}

/// Packing over the part [from, to) of the platform.
double packing_between(const Layer& layer, double from, double to) {
    double solid = 0;
    for (std::size_t i = 0; i < layer.size(); ++i)
        if (layer.deposit_x[i] >= from && layer.deposit_x[i] < to) solid += layer.volume[i];
    return solid / (layer.gap * layer.width * (to - from));
}

TEST(LayerPacking, a_gap_of_one_grain_holds_less_than_one_of_two_and_a_half) {
    const Layer& wide = base_layer();
    Scene scene = short_strip();
    scene.gap = 55e-6;
    const Layer narrow = laid(scene);
    EXPECT_LT(narrow.packing_fraction(), 0.75 * wide.packing_fraction());
    EXPECT_GT(narrow.packing_fraction(), 0.02);
    EXPECT_LT(wide.packing_fraction(), 0.64);
}

TEST(LayerPacking, a_fast_blade_leaves_one_flight_of_the_platforms_edge_empty) {
    const Layer& slow = base_layer();  // flight v sqrt(2 gap/g): 0.27 mm
    Scene scene = short_strip();
    scene.blade_speed = 0.15;  // 0.80 mm
    const Layer fast = laid(scene);
    EXPECT_GT(packing_between(slow, 0.2e-3, 0.5e-3), 0.15);
    EXPECT_LT(packing_between(fast, 0, 0.4e-3), 0.3 * packing_between(slow, 0, 0.4e-3));
    EXPECT_LT(fast.capture_fraction(), slow.capture_fraction());
}

TEST(LayerPacking, a_bare_plate_is_covered_as_a_fused_layer_is_and_adhesion_is_not_what_empties_it) {
    Scene scene = short_strip();
    scene.gap = 99e-6;  // 1.8 D90
    const double fused = laid(scene).packing_fraction();
    scene.substrate = Substrate::plate;
    const double bare = laid(scene).packing_fraction();
    scene.interaction.work_of_adhesion = 0;
    const double dry = laid(scene).packing_fraction();
    EXPECT_NEAR(bare / fused, 1, 0.3);
    EXPECT_NEAR(dry / bare, 1, 0.3);
    EXPECT_GT(bare, 0.14);  // what a blade at the paper's speed leaves on so short a platform
}

TEST(LayerPacking, friction_moves_the_gi_no_more_than_another_bed_does) {
    Scene scene = short_strip();
    const PartitionCurve partition = straight_partition(scene.dispenser_length, scene.width, 10, 0);
    const auto gi = [&](const Layer& layer) {
        return homogeneous_profile({&layer, 1}, partition, 0.3e-3, 1e-3, {.width = 0.065e-3, .count = 4}, {})
            .gi;
    };
    const auto rms = [](const std::vector<double>& a, const std::vector<double>& b) {
        double sum = 0;
        for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
        return std::sqrt(sum / static_cast<double>(a.size()));
    };
    const auto base = gi(base_layer());
    scene.seed = 2;
    const double noise = rms(gi(laid(scene)), base);
    scene.seed = 1;
    scene.interaction.static_friction = 0.3;
    const double friction = rms(gi(laid(scene)), base);
    EXPECT_GT(friction, 0);  // the factor reached the run
    EXPECT_LT(friction, 2 * noise + 0.02);
    EXPECT_LT(noise, 0.2);
}

TEST(Coverage, counts_cells_of_each_part_against_the_mean_of_all) {
    Layer layer;
    layer.width = 0.4e-3;
    layer.platform_length = 2e-3;
    layer.gap = 1e-4;
    for (int k = 0; k < 10; ++k) {  // one grain in every cell of the first half, none in the second
        layer.deposit_x.push_back(0.1e-3 + 0.2e-3 * (k % 5));
        layer.deposit_y.push_back(k < 5 ? 0.1e-3 : 0.3e-3);
        layer.volume.push_back(1e-15);
    }
    const auto share = coverage_along(layer, 2);
    ASSERT_EQ(share.size(), 2u);
    EXPECT_EQ(share[0], 1);
    EXPECT_EQ(share[1], 0);
    EXPECT_EQ(coverage_along(Layer{}, 3), std::vector<double>(3, 0));
}

TEST(Sticking, a_small_grain_rolls_off_a_saddle_of_large_ones_as_without_slip_and_falls) {
    for (const double ratio : {3.0, 20.0}) {
        SaddleSetup setup;
        setup.size_ratio = ratio;
        const SaddleResult r = roll_off_saddle(setup);
        EXPECT_NEAR(r.time / r.expected_time, 1, 0.01) << "size ratio " << ratio;
        EXPECT_TRUE(r.fell) << "size ratio " << ratio;
        EXPECT_LT(r.farthest_angle_deg, 90) << "size ratio " << ratio;  // nothing pulls it upwards
    }
}

TEST(Sticking, with_half_step_velocities_it_runs_round_below_the_large_ones) {
    SaddleSetup setup;
    setup.late_velocity = true;
    const SaddleResult r = roll_off_saddle(setup);
    EXPECT_FALSE(r.fell);
    EXPECT_GT(r.farthest_angle_deg, 150);
}

}  // namespace
}  // namespace gradwright
