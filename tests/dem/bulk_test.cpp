// Limits that need no spread: the edge of the time step, sticking, draining.
#include "dem/bulk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

/// The paper's powder without fines, drained for 60 ms from a box of some 800 grains.
ReposeResult drained(double friction, double rolling, double work_of_adhesion) {
    Scene scene;
    scene.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    scene.powder[1].material = scene.powder[0].material;
    for (auto& p : scene.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    scene.wall = scene.powder[0].material;
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
