// Packing, the bed cache and the spread on scenes of a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "dem/bed.h"
#include "dem/bench.h"
#include "dem/engine.h"
#include "tests/dem/tiny_scene.h"

namespace gradwright {
namespace {

/// A bed of about 150 grains, to be packed several times.
Scene smallest_scene() {
    Scene s = tiny_scene();
    s.dispenser_length = 0.26e-3;
    s.bed_depth = 20e-6;
    s.dose_height = 50e-6;
    return s;
}

void expect_same_bits(const Bed& a, const Bed& b) {
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.z, b.z);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.material, b.material);
    EXPECT_EQ(a.facts.packing_fraction, b.facts.packing_fraction);
    EXPECT_EQ(a.facts.steps, b.facts.steps);
    EXPECT_EQ(a.facts.made_d10_d50_d90, b.facts.made_d10_d50_d90);
}

TEST(Packing, a_bed_so_soft_that_its_steps_are_long_settles_too) {
    // 750 steps are longer than the time after which grains sleep: what sleeps would press on nothing
    Scene scene = smallest_scene();
    scene.softening = 1e-5;
    scene.interaction.work_of_adhesion = 0;
    SpreadOptions options;
    options.threads = 1;
    RunHealth health;
    const Bed bed = pack_bed(scene, nullptr, options, health);
    EXPECT_EQ(health.status, "ok") << health.reason;
    EXPECT_NEAR(bed.facts.carried_weight_ratio, 1, 0.01);
    EXPECT_GT(750 * scene_time_step(scene), 0.3e-3);
}

TEST(Packing, a_bed_settles_and_its_facts_say_so) {
    const Scene scene = tiny_scene();
    SpreadOptions options;
    options.threads = 1;
    RunHealth health;
    const Bed bed = pack_bed(scene, nullptr, options, health);
    ASSERT_EQ(health.status, "ok") << health.reason;
    EXPECT_GT(bed.x.size(), 300u);
    const BedFacts& f = bed.facts;
    EXPECT_GT(f.packing_fraction, 0.45);
    EXPECT_LT(f.packing_fraction, 0.65);
    EXPECT_LT(f.speed_number, 0.01);
    EXPECT_NEAR(f.carried_weight_ratio, 1, 0.01);
    EXPECT_GT(f.mean_coordination, 2.5);
    EXPECT_LT(f.mean_coordination, 7);
    EXPECT_LT(f.max_overlap_ratio, 0.02);
    EXPECT_FALSE(f.from_cache);
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        EXPECT_GT(bed.z[i], -scene.bed_depth - 0.3 * scene.roughness);
        EXPECT_GE(bed.y[i], 0);
        EXPECT_LT(bed.y[i], scene.width);
        EXPECT_EQ(bed.material[i], 0);
    }
}

TEST(Packing, grains_lie_on_their_side_of_the_partition) {
    const Scene scene = smallest_scene();
    const auto partition = straight_partition(scene.dispenser_length, scene.width, 0.2, 0);
    SpreadOptions options;
    options.threads = 1;
    RunHealth health;
    const Bed bed = pack_bed(scene, &partition, options, health);
    ASSERT_EQ(health.status, "ok") << health.reason;
    std::size_t wrong = 0;
    double volume[2] = {};
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        wrong += (bed.material[i] == 0) != partition.on_side_a(bed.x[i], bed.y[i]);
        volume[bed.material[i]] += sphere_volume(bed.radius[i]);
    }
    EXPECT_LE(wrong, bed.x.size() / 50);  // what crossed while the last grains settled
    EXPECT_GT(volume[0] / (volume[0] + volume[1]), 0.35);
    EXPECT_LT(volume[0] / (volume[0] + volume[1]), 0.65);
}

TEST(Packing, a_premix_fills_each_chamber_with_its_shares_of_both_powders) {
    for (const bool same_size : {true, false}) {
        Scene scene = smallest_scene();
        scene.dispenser_length = 0.4e-3;
        scene.share_a = {0.75, 0.2};
        if (!same_size) scene.powder[1].size.d50 = 45e-6;
        const auto partition = straight_partition(scene.dispenser_length, scene.width, 0.2, 0);
        SpreadOptions options;
        options.threads = 1;
        RunHealth health;
        const Bed bed = pack_bed(scene, &partition, options, health);
        ASSERT_EQ(health.status, "ok") << health.reason;
        double of_a[2] = {}, all[2] = {}, square[2] = {};
        for (std::size_t i = 0; i < bed.x.size(); ++i) {
            const int chamber = partition.on_side_a(bed.x[i], bed.y[i]) ? 0 : 1;
            const double v = sphere_volume(bed.radius[i]);
            all[chamber] += v;
            square[chamber] += v * v;
            if (bed.material[i] == 0) of_a[chamber] += v;
        }
        for (const int chamber : {0, 1}) {
            const double m = scene.share_a[chamber];
            // single grains dealt by lot: sd sqrt(m (1 - m) sum V^2) / sum V
            const double sd = std::sqrt(m * (1 - m) * square[chamber]) / all[chamber];
            EXPECT_NEAR(of_a[chamber] / all[chamber], m, 3 * sd) << same_size;
            EXPECT_LT(sd, 0.08);
        }
    }
}

TEST(Packing, two_curves_hold_one_powder_between_them_with_and_without_their_plates) {
    for (const double thickness : {0.0, 40e-6}) {
        Scene scene = smallest_scene();
        scene.plate_thickness = thickness;
        const double length = scene.dispenser_length, width = scene.width;
        const PartitionCurve pair{{{0, 0.3 * width}, {length, 0.35 * width}},
                                  {{length, 0.75 * width}, {0, 0.7 * width}}};
        SpreadOptions options;
        options.threads = 1;
        RunHealth health;
        const Bed bed = pack_bed(scene, &pair, options, health);
        ASSERT_EQ(health.status, "ok") << health.reason;
        std::size_t wrong = 0;
        double volume[2] = {};
        for (std::size_t i = 0; i < bed.x.size(); ++i) {
            wrong += (bed.material[i] == 0) != pair.on_side_a(bed.x[i], bed.y[i]);
            volume[bed.material[i]] += sphere_volume(bed.radius[i]);
        }
        // with plates the slots collapse and grains cross: a few in a hundred
        EXPECT_LE(wrong, bed.x.size() / (thickness > 0 ? 5 : 50)) << thickness;
        EXPECT_NEAR(volume[0] / (volume[0] + volume[1]), 0.4, 0.1) << thickness;
    }
}

TEST(Packing, a_plate_between_the_chambers_is_withdrawn_and_its_slot_collapses) {
    Scene scene = tiny_scene();
    scene.plate_thickness = 60e-6;
    scene.interaction.work_of_adhesion = 0;  // a cut this shallow in the adhesive powder stands by itself
    const auto partition = straight_partition(scene.dispenser_length, scene.width, 0, 0);
    SpreadOptions options;
    options.threads = 1;
    std::vector<std::string> stages;
    options.progress = [&](const Progress& p) {
        if (stages.empty() || stages.back() != p.stage) stages.push_back(p.stage);
    };
    RunHealth health;
    const Bed bed = pack_bed(scene, &partition, options, health);
    ASSERT_EQ(health.status, "ok") << health.reason;
    EXPECT_EQ(stages, (std::vector<std::string>{"pack", "withdraw"}));
    // The slot, 60 um wide over the whole depth, is gone: grains stand in it, and of both powders.
    std::size_t inside[2] = {}, crossed = 0;
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        const double side = partition.signed_distance(bed.x[i], bed.y[i]);
        // a periodic bed has a second border at y = 0, where no plate stood
        if (std::fabs(side) < 0.5 * scene.plate_thickness) ++inside[bed.material[i]];
        crossed += std::fabs(side) < 0.25 * scene.width && (bed.material[i] == 0) != (side > 0);
    }
    EXPECT_GT(inside[0], 3u);
    EXPECT_GT(inside[1], 3u);
    // Who fell across the middle keeps the powder he was filled in as, which an ideal partition cannot show.
    EXPECT_GT(crossed, 0u);
    EXPECT_LT(bed.facts.speed_number, 0.01);
    EXPECT_NEAR(bed.facts.carried_weight_ratio, 1, 0.01);
}

class Cache : public testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("gradwright-bed-cache-" + std::to_string(::getpid()));
        std::filesystem::remove_all(folder_);
        options_.threads = 1;
        options_.cache_folder = folder_;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path only_file() const {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) files.push_back(entry.path());
        EXPECT_EQ(files.size(), 1u);
        return files.front();
    }
    Bed bed() {
        RunHealth health;
        Bed b = cached_bed(smallest_scene(), nullptr, options_, health);
        EXPECT_EQ(health.status, "ok") << health.reason;
        return b;
    }
    std::filesystem::path folder_;
    SpreadOptions options_;
};

TEST_F(Cache, a_kept_bed_has_the_bits_of_the_packed_one_and_a_damaged_one_is_made_anew) {
    const Bed packed = bed();
    EXPECT_FALSE(packed.facts.from_cache);
    const Bed kept = bed();
    EXPECT_TRUE(kept.facts.from_cache);
    expect_same_bits(packed, kept);
    EXPECT_GT(kept.facts.seconds_cold, 0);

    const auto file = only_file();
    const auto size = std::filesystem::file_size(file);
    std::filesystem::resize_file(file, size / 2);
    const Bed after_cut = bed();
    EXPECT_FALSE(after_cut.facts.from_cache);
    expect_same_bits(packed, after_cut);
    EXPECT_EQ(std::filesystem::file_size(file), size);

    {
        std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
        bytes.seekg(static_cast<std::streamoff>(size * 3 / 5));
        const char byte = static_cast<char>(bytes.get());
        bytes.seekp(static_cast<std::streamoff>(size * 3 / 5));
        bytes.put(static_cast<char>(byte ^ 0x10));
    }
    const Bed after_flip = bed();
    EXPECT_FALSE(after_flip.facts.from_cache);
    expect_same_bits(packed, after_flip);
    EXPECT_TRUE(bed().facts.from_cache);
}

TEST(Failure, a_time_step_beyond_the_edge_is_refused_with_the_knob) {
    Scene scene = smallest_scene();
    scene.rayleigh_fraction = 0.41;
    SpreadOptions options;
    options.threads = 1;
    const auto result = run_spread(scene, nullptr, options);
    EXPECT_EQ(result.health.status, "unstable_step");
    EXPECT_THAT(result.health.reason, testing::HasSubstr("rayleigh_fraction"));
    EXPECT_EQ(result.layer.size(), 0u);
}

class Spread : public testing::Test {
  protected:
    static SpreadResult spread(const Scene& scene, const PartitionCurve* partition, int threads) {
        SpreadOptions options;
        options.threads = threads;
        options.cache_folder =
            (std::filesystem::temp_directory_path() / ("gradwright-spread-" + std::to_string(::getpid())))
                .string();
        options.snapshots = 1;
        return run_spread(scene, partition, options);
    }
    static void TearDownTestSuite() {
        std::filesystem::remove_all(std::filesystem::temp_directory_path() /
                                    ("gradwright-spread-" + std::to_string(::getpid())));
    }
};

TEST_F(Spread, one_and_three_threads_leave_the_same_bits_and_no_grain_is_lost) {
    const Scene scene = tiny_scene();
    const auto one = spread(scene, nullptr, 1);
    ASSERT_EQ(one.health.status, "ok") << one.health.reason;
    const auto three = spread(scene, nullptr, 3);
    EXPECT_EQ(one.state_hash, three.state_hash);
    EXPECT_EQ(one.layer.deposit_y, three.layer.deposit_y);

    const double platform = scene.dispenser_length + scene.land, end = platform + scene.platform_length;
    double before = 0, rest = 0;
    for (const float r : one.snapshots.front().radius) before += sphere_volume(r);
    const Snapshot& last = one.snapshots.back();
    for (std::size_t i = 0; i < last.x.size(); ++i)
        if (last.x[i] < end && (last.x[i] < platform || last.z[i] >= 0))
            rest += sphere_volume(last.radius[i]);
    EXPECT_GT(one.layer.size(), 20u);
    EXPECT_NEAR((one.layer.solid_volume() + one.layer.overflow_solid_volume + rest) / before, 1, 1e-5);
    EXPECT_LT(one.layer.solid_volume(), one.layer.dosed_solid_volume);
    for (std::size_t i = 0; i < one.layer.size(); ++i) {
        EXPECT_GE(one.layer.deposit_x[i], 0);
        EXPECT_LT(one.layer.deposit_x[i], scene.platform_length);
        EXPECT_LT(one.layer.origin_x[i], scene.dispenser_length);
        EXPECT_TRUE(std::isfinite(one.layer.deposit_z[i]));
    }
}

TEST_F(Spread, a_labelled_run_carries_both_materials_and_their_masses) {
    Scene scene = tiny_scene();
    const auto partition = straight_partition(scene.dispenser_length, scene.width, 0.3, 0);
    const auto labelled = spread(scene, &partition, 1);
    ASSERT_EQ(labelled.health.status, "ok") << labelled.health.reason;
    ASSERT_TRUE(labelled.layer.labelled);
    std::size_t a = 0, wrong = 0;
    for (std::size_t i = 0; i < labelled.layer.size(); ++i) {
        a += labelled.layer.is_a[i];
        wrong += labelled.layer.is_a[i] !=
                 partition.on_side_a(labelled.layer.origin_x[i], labelled.layer.origin_y[i]);
    }
    EXPECT_GT(a, 0u);
    EXPECT_LT(a, labelled.layer.size());
    EXPECT_LE(wrong, labelled.layer.size() / 50);
    // B's density alone moves the grains: a run that dropped it would leave the same bits
    scene.powder[1].material.density = 7000;
    const auto lighter = spread(scene, &partition, 1);
    EXPECT_NE(lighter.state_hash, labelled.state_hash);
}

TEST_F(Spread, each_material_of_the_scene_has_its_own_mass_and_stiffness_in_the_engine) {
    Scene scene = tiny_scene();
    scene.powder[1].material.density = 4000;
    Engine engine(engine_options(scene, 1));
    engine.add_grain({.radius = 20e-6, .material = 0});
    engine.add_grain({.x = 1e-3, .radius = 20e-6, .material = 1});
    EXPECT_NEAR(engine.state().mass[0], 7980 * sphere_volume(20e-6), 1e-18);
    EXPECT_NEAR(engine.state().mass[1], 4000 * sphere_volume(20e-6), 1e-18);
    const double reduced = 0.91 * (1 / 210e5 + 1 / 195e5);  // (1 - nu^2)(1/E1 + 1/E2), E softened by 1e-4
    EXPECT_NEAR(engine.pair_constants(0, 1).e_star * reduced, 1, 1e-12);
    EXPECT_NEAR(engine.pair_constants(0, 0).e_star * 2 * 0.91 / 210e5, 1, 1e-12);
}

TEST(SceneChecks, more_grains_than_the_memory_holds_are_refused_before_they_are_made) {
    Scene scene = tiny_scene();
    const auto refused = [](const Scene& of) {
        for (const SceneProblem& problem : validate(of))
            if (problem.fatal && problem.text.find("GB of memory") != std::string::npos) return true;
        return false;
    };
    EXPECT_FALSE(refused(scene));
    scene.dispenser_length = scene.platform_length = scene.width = 10;  // 1e12 grains
    EXPECT_TRUE(refused(scene));
}

TEST(Reductions, coarse_grains_keep_the_plan_and_scale_what_stands_upright) {
    const Scene fine = tiny_scene();
    const Scene coarse = coarse_grained(fine, 1.5);
    EXPECT_EQ(coarse_grained(fine, 1).canonical_text(), fine.canonical_text());
    for (const auto& [grown, was] :
         {std::pair{coarse.gap, fine.gap},
          {coarse.layer_thickness, fine.layer_thickness},
          {coarse.dose_height, fine.dose_height},
          {coarse.bed_depth, fine.bed_depth},
          {coarse.roughness, fine.roughness},
          {coarse.powder[1].size.d90, fine.powder[1].size.d90},
          {coarse.powder[0].size.cut_low, fine.powder[0].size.cut_low},
          {coarse.interaction.work_of_adhesion, fine.interaction.work_of_adhesion}})
        EXPECT_DOUBLE_EQ(grown, 1.5 * was);
    EXPECT_EQ(coarse.dispenser_length, fine.dispenser_length);
    EXPECT_EQ(coarse.width, fine.width);
    EXPECT_EQ(coarse.land, fine.land);
    EXPECT_EQ(coarse.platform_length, fine.platform_length);
    EXPECT_EQ(coarse.powder[0].material.density, fine.powder[0].material.density);
    // bed and heights grow with the grain, the plan does not: 1/k^2 of the grains, a time step k times as
    // long
    const SceneCost a = estimate_cost(fine), b = estimate_cost(coarse);
    EXPECT_NEAR(b.grains / a.grains, 1 / 2.25, 0.01);
    EXPECT_NEAR(scene_time_step(coarse) / scene_time_step(fine), 1.5, 1e-12);
    EXPECT_LT(b.grain_steps, a.grain_steps / 2.25 / 1.3);
    // what the same powder sticks at: Gamma/(rho d v^2) is kept
    EXPECT_DOUBLE_EQ(coarse.interaction.work_of_adhesion / coarse.powder[0].size.d50,
                     fine.interaction.work_of_adhesion / fine.powder[0].size.d50);
}

TEST(Reductions, an_early_stop_spares_steps_and_lays_the_same_grains_but_for_the_last_of_them) {
    Scene scene = tiny_scene();
    SpreadOptions options;
    options.threads = 1;
    const SpreadResult whole = run_spread(scene, nullptr, options);
    scene.early_stop = true;
    const SpreadResult early = run_spread(scene, nullptr, options);
    ASSERT_TRUE(whole.health.ok()) << whole.health.reason;
    ASSERT_TRUE(early.health.ok()) << early.health.reason;
    EXPECT_LT(early.steps, whole.steps);
    EXPECT_NEAR(double(early.layer.size()), double(whole.layer.size()), 0.1 * double(whole.layer.size()));
    EXPECT_NE(scene.canonical_text(), tiny_scene().canonical_text()) << "the caches must tell them apart";
}

TEST(Bench, a_flowing_grain_takes_no_more_than_400_bytes) {
    // near pairs come and go: the list is made anew many times, in its own place
    BenchOptions options;
    options.scene = smallest_scene();
    options.grains = {1200};
    options.states = {"flowing"};
    options.steps = 300;
    const BenchCase flowing = run_bench(options).cases.at(0);
    EXPECT_LT(flowing.steps_per_near_list, 60);
    EXPECT_GT(flowing.near_pairs_per_grain, 1.5);
    EXPECT_LE(flowing.bytes_per_grain, 400);
}

TEST(Bench, a_large_bed_is_copies_of_a_small_one_without_a_seam) {
    BenchOptions options;
    options.scene = smallest_scene();
    options.grains = {150};
    options.steps = 300;
    const BenchCase one = run_bench(options).cases.at(0);
    // twice the width in two copies: the same tile twice, pressed and touching as in the one
    options.grains = {300};
    options.largest_packed = 150;
    const BenchCase two = run_bench(options).cases.at(0);
    EXPECT_EQ(two.grains, 2 * one.grains);
    EXPECT_NEAR(two.contacts_per_grain, one.contacts_per_grain, 0.1);
    EXPECT_EQ(two.awake_share, 1);
    EXPECT_TRUE(std::isnan(two.core_round_trip));
    options.threads = {2};
    const BenchCase shared = run_bench(options).cases.at(0);
    EXPECT_EQ(shared.state_hash, two.state_hash);
    if (std::thread::hardware_concurrency() > 1) {
        EXPECT_GT(shared.core_round_trip, 5e-9);
    }
}

}  // namespace
}  // namespace gradwright
