// Several passes over fused metal, powder and a bare plate, on scenes of a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "dem/next_pass.h"
#include "dem/spread_file.h"
#include "dem/substrate.h"

namespace gradwright {
namespace {

constexpr double kAngle = 0.2;  // of the partition [rad]

Scene small_scene() {
    Scene s;
    s.dispenser_length = 0.4e-3;
    s.width = 0.26e-3;
    s.bed_depth = 60e-6;
    s.dose_height = 140e-6;
    s.land = 0.2e-3;
    s.platform_length = 0.45e-3;
    s.second_land = 0.5e-3;
    s.gap = 140e-6;
    s.blade_speed = 0.1;
    s.blade_thickness = 0.2e-3;
    s.early_stop = true;
    s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    for (auto& p : s.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    s.wall = s.powder[0].material;
    s.rayleigh_fraction = 0.3;
    s.allow_starved = true;
    s.seed = 3;
    return s;
}

Scene scene_on(Substrate substrate, int layers) {
    Scene s = small_scene();
    s.substrate = substrate;
    s.layers = layers;
    if (substrate != Substrate::fused) s.gap = s.layer_thickness = 70e-6;
    return s;
}

PartitionCurve partition_of(const Scene& scene) {
    return straight_partition(scene.dispenser_length, scene.width, kAngle, 0);
}

class Layers : public testing::Test {
  protected:
    static std::string cache() {
        return (std::filesystem::temp_directory_path() / ("gradwright-layers-" + std::to_string(::getpid())))
            .string();
    }
    static SpreadOptions options_with(int threads) {
        SpreadOptions options;
        options.threads = threads;
        options.cache_folder = cache();
        options.snapshots = 1;
        return options;
    }
    /// Spread once for all the tests that look at it.
    static const SpreadResult& spread(Substrate substrate) {
        static std::array<SpreadResult, 3> results;
        SpreadResult& result = results[static_cast<std::size_t>(substrate)];
        if (result.health.status == "not_run") {
            const Scene scene = scene_on(substrate, 2);
            const PartitionCurve partition = partition_of(scene);
            result = run_spread(scene, &partition, options_with(1));
        }
        return result;
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(cache()); }
};

std::vector<Layer> all_layers(const SpreadResult& spread) {
    std::vector<Layer> layers = spread.earlier;
    layers.push_back(spread.layer);
    return layers;
}

TEST_F(Layers, the_first_of_several_is_the_one_of_a_spread_of_one_bit_for_bit) {
    const SpreadResult& two = spread(Substrate::fused);
    ASSERT_TRUE(two.health.ok()) << two.health.reason;
    Scene one = scene_on(Substrate::fused, 2);
    one.bed_depth = one.floor_depth();  // the same bed: the second dose lies under the first
    one.layers = 1;
    const PartitionCurve partition = partition_of(one);
    const SpreadResult single = run_spread(one, &partition, options_with(1));
    ASSERT_TRUE(single.health.ok()) << single.health.reason;
    EXPECT_TRUE(single.earlier.empty());
    EXPECT_TRUE(single.passes.empty());
    const Layer& first = two.earlier.at(0);
    EXPECT_GT(first.size(), 20u);
    EXPECT_EQ(first.deposit_x, single.layer.deposit_x);
    EXPECT_EQ(first.deposit_y, single.layer.deposit_y);
    EXPECT_EQ(first.deposit_z, single.layer.deposit_z);
    EXPECT_EQ(first.origin_z, single.layer.origin_z);
    EXPECT_EQ(first.is_a, single.layer.is_a);
    EXPECT_EQ(first.overflow_solid_volume, single.layer.overflow_solid_volume);
    EXPECT_EQ(first.dosed_solid_volume, single.layer.dosed_solid_volume);
    EXPECT_EQ(two.snapshots.front().x, single.snapshots.front().x);
}

TEST_F(Layers, what_was_filled_in_is_laid_or_overflows_or_is_still_there) {
    for (const Substrate substrate : {Substrate::fused, Substrate::powder, Substrate::plate}) {
        const Scene scene = scene_on(substrate, 2);
        const SpreadResult& result = spread(substrate);
        ASSERT_TRUE(result.health.ok()) << result.health.reason;
        double before = 0, after = 0;
        for (const float r : result.snapshots.front().radius) before += sphere_volume(r);
        const Snapshot& last = result.snapshots.back();
        for (std::size_t i = 0; i < last.x.size(); ++i)
            if (last.x[i] < platform_end(scene)) after += sphere_volume(last.radius[i]);
        for (const Layer& layer : all_layers(result)) after += layer.overflow_solid_volume;
        for (const PassFacts& pass : result.passes) after += pass.carried_off_solid_volume;
        if (substrate == Substrate::fused)  // melted
            after += result.earlier.at(0).solid_volume() + result.passes.at(0).proud_solid_volume;
        EXPECT_NEAR(after / before, 1, 1e-5) << static_cast<int>(substrate);
    }
}

TEST_F(Layers, every_grain_keeps_its_powder_and_its_place_of_origin_and_is_laid_once) {
    for (const Substrate substrate : {Substrate::fused, Substrate::powder, Substrate::plate}) {
        const Scene scene = scene_on(substrate, 2);
        const PartitionCurve partition = partition_of(scene);
        const SpreadResult& result = spread(substrate);
        std::set<std::array<double, 3>> origins;
        std::size_t laid = 0, wrong = 0, of_a = 0;
        for (const Layer& layer : all_layers(result)) {
            EXPECT_GT(layer.size(), 10u);
            for (std::size_t i = 0; i < layer.size(); ++i, ++laid) {
                origins.insert({layer.origin_x[i], layer.origin_y[i], layer.origin_z[i]});
                of_a += layer.is_a[i];
                wrong += layer.is_a[i] != partition.on_side_a(layer.origin_x[i], layer.origin_y[i]);
                EXPECT_LT(layer.origin_x[i], scene.dispenser_length);
                EXPECT_GT(layer.origin_z[i], -scene.floor_depth() - 0.3 * scene.roughness);
                EXPECT_GE(layer.deposit_x[i], 0);
                EXPECT_LT(layer.deposit_x[i], scene.platform_length);
                EXPECT_LT(layer.deposit_z[i], 0);
            }
        }
        EXPECT_EQ(origins.size(), laid) << "a grain was laid twice";
        EXPECT_LE(wrong, laid / 50);
        EXPECT_GT(of_a, 0u);
        EXPECT_LT(of_a, laid);
        // the second dose comes from below the first
        const auto mean_z = [](const Layer& layer) {
            double sum = 0;
            for (const double z : layer.origin_z) sum += z;
            return sum / double(layer.size());
        };
        EXPECT_NEAR(mean_z(result.earlier.at(0)) - mean_z(result.layer), scene.dose_height,
                    0.4 * scene.dose_height);
    }
}

TEST_F(Layers, every_dose_is_one_rise_of_the_floor) {
    for (const Substrate substrate : {Substrate::fused, Substrate::powder, Substrate::plate}) {
        const Scene scene = scene_on(substrate, 2);
        const SpreadResult& result = spread(substrate);
        const double rise =
            scene.dose_height * scene.dispenser_length * scene.width * result.bed.packing_fraction;
        EXPECT_NEAR(result.earlier.at(0).dosed_solid_volume / rise, 1, 0.02);  // a grain
        EXPECT_DOUBLE_EQ(result.layer.dosed_solid_volume, rise);
        // Over the rim stands what lay less than h below the surface that the blade left, whose grains have
        // their centres half a grain and more below it.
        const double raised = result.passes.at(1).raised_solid_volume;
        EXPECT_LT(raised, 1.02 * rise);
        EXPECT_GT(raised, rise * (1 - scene.powder[0].size.d90 / scene.dose_height));
        // and that much leaves the dispenser: the blade finds the surface that it left
        EXPECT_NEAR((result.layer.solid_volume() + result.layer.overflow_solid_volume) / rise, 1, 0.15);
    }
}

TEST_F(Layers, the_powder_under_them_is_never_counted) {
    const Scene scene = scene_on(Substrate::powder, 1);
    RunHealth health;
    const SpreadOptions options = options_with(1);
    const Stage stage = set_stage(scene, nullptr, options, health);
    ASSERT_TRUE(health.ok()) << health.reason;
    EXPECT_GT(stage.substrate.x.size(), 30u);
    const SpreadResult result = spread_stage(scene, stage, options);
    ASSERT_TRUE(result.health.ok()) << result.health.reason;
    EXPECT_EQ(result.grains, static_cast<long>(stage.bed.x.size() + stage.substrate.x.size()));
    const Snapshot& last = result.snapshots.back();
    std::size_t lie = 0;
    for (std::size_t i = 0; i < last.x.size(); ++i)
        lie += last.x[i] >= platform_start(scene) && last.x[i] < platform_end(scene) && last.z[i] < 0;
    ASSERT_EQ(result.passes.at(0).carried_off_solid_volume, 0);
    EXPECT_GT(result.layer.size(), 10u);
    EXPECT_EQ(lie, result.layer.size() + stage.substrate.x.size());
    EXPECT_EQ(result.layer.gap, scene.gap);
}

TEST(MeasureLayer, leaves_out_the_substrate_and_what_lay_on_the_platform_and_tells_what_was_carried_off) {
    Scene scene = small_scene();
    Stage stage;
    stage.bed.x = {1e-4, 2e-4, 3e-4};
    stage.bed.y = stage.bed.z = {0, 0, 0};
    stage.bed.radius = {10e-6, 12e-6, 14e-6};
    stage.bed.material = {0, 0, 0};
    stage.substrate = stage.bed;
    stage.substrate.radius = {20e-6, 21e-6, 22e-6};
    Pass pass = first_pass(scene, stage);
    EXPECT_THAT(pass.stand, testing::ElementsAre(Stand::ahead, Stand::ahead, Stand::ahead, Stand::on_platform,
                                                 Stand::on_platform, Stand::on_platform));
    pass.stand[1] = Stand::on_platform;  // of an earlier layer
    pass.stand[2] = Stand::gone;
    const double over = platform_start(scene) + 1e-4, beyond = platform_end(scene) + 1e-5;
    // an earlier layer's grain is carried off, one of the substrate lies, one is carried off, one has left
    const std::vector<GrainPlace> places = {
        {0, over, 0, -5e-5}, {1, beyond, 0, -5e-5}, {3, over, 0, -5e-5}, {4, beyond, 0, 5e-5}};
    RunHealth health;
    health.status = "ok";
    const Layer layer = measure_layer(scene, stage, pass, places, health);
    ASSERT_EQ(layer.size(), 1u);
    EXPECT_EQ(layer.origin_x[0], 1e-4);
    EXPECT_EQ(layer.overflow_solid_volume, 0);
    EXPECT_DOUBLE_EQ(carried_off_solid(scene, stage, pass, places),
                     sphere_volume(12e-6) + sphere_volume(21e-6) + sphere_volume(22e-6));
}

TEST_F(Layers, the_powder_under_them_stands_below_the_blade_by_the_gap_and_holds_the_share_asked_for) {
    for (const double share : {1.0, 0.5, 0.0}) {
        Scene scene = scene_on(Substrate::powder, 1);
        scene.substrate_share_a = share;
        RunHealth health;
        const Bed bed = settled_substrate(scene, options_with(1), health);
        ASSERT_TRUE(health.ok()) << health.reason;
        double top = -1, a = 0, all = 0, square = 0;
        for (std::size_t i = 0; i < bed.x.size(); ++i) {
            const double v = sphere_volume(bed.radius[i]);
            top = std::max(top, bed.z[i] + bed.radius[i]);
            EXPECT_GT(bed.z[i], -scene.gap - scene.substrate_depth() - 0.3 * scene.roughness);
            EXPECT_GT(bed.x[i], platform_start(scene));
            EXPECT_LT(bed.x[i], platform_end(scene));
            a += bed.material[i] == 0 ? v : 0;
            all += v;
            square += v * v;
        }
        EXPECT_LE(top, -scene.gap);
        EXPECT_GT(top, -scene.gap - 10e-6);  // cut, not packed too low
        // single grains dealt by lot: sd sqrt(m (1 - m) sum V^2) / sum V
        EXPECT_NEAR(a / all, share, 3 * std::sqrt(share * (1 - share) * square) / all + 1e-12);
    }
}

TEST_F(Layers, the_next_pass_stands_one_dose_higher_and_one_layer_deeper_and_the_blade_is_back) {
    for (const Substrate substrate : {Substrate::fused, Substrate::plate}) {
        Scene scene = scene_on(substrate, 2);
        RunHealth health;
        const Stage stage = set_stage(scene, nullptr, options_with(1), health);
        ASSERT_TRUE(health.ok()) << health.reason;
        Engine engine(engine_options(scene, 1));
        for (const GrainSpec& grain : stage.fixed) engine.add_grain(grain);
        for (const Body& body : stage.bodies) engine.add_body(body);
        const int first = static_cast<int>(stage.fixed.size());
        add_bed(engine, stage.bed, false);
        // one grain on the land, one laid, one behind the platform
        const double r = 20e-6;
        std::vector<double> x = {scene.dispenser_length + 50e-6, platform_start(scene) + 0.1e-3,
                                 platform_end(scene) + 0.1e-3};
        State& s = engine.state();
        for (std::size_t k = 0; k < x.size(); ++k) {
            s.x[static_cast<std::size_t>(first) + k] = x[k];
            s.y[static_cast<std::size_t>(first) + k] = 0.13e-3;
            s.z[static_cast<std::size_t>(first) + k] =
                k == 1 ? -scene.gap + (substrate == Substrate::fused ? 1.5 : 1) * r : r;
            s.radius[static_cast<std::size_t>(first) + k] = r;
        }
        double floor_before = 0;
        std::size_t floor_grains = 0;
        for (std::size_t i = 0; i < s.size(); ++i)
            if (s.fixed[i] && s.x[i] < scene.dispenser_length) floor_before += s.z[i], ++floor_grains;
        engine.start_bodies();
        engine.advance(400);
        ASSERT_GT(engine.body_shift_x(stage.blade), 0);
        // one more on the land, about to roll down on the platform while all come to rest
        for (std::size_t i = 0; i < s.size(); ++i)
            if (s.id[i] == first + 3) {
                s.place[i] = {platform_start(scene) - 1e-6, 0.13e-3, r, r};
                s.vx[i] = 0.02;
            }
        const Pass pass = next_pass(scene, stage, first_pass(scene, stage), engine, first);
        ASSERT_EQ(engine.failed(), "");
        EXPECT_EQ(pass.number, 2);
        EXPECT_EQ(pass.floor_rise, scene.dose_height);
        EXPECT_EQ(engine.body_shift_x(stage.blade), 0);
        double floor_after = 0;
        for (std::size_t i = 0; i < s.size(); ++i)
            if (s.fixed[i] && s.x[i] < scene.dispenser_length) floor_after += s.z[i];
        EXPECT_NEAR((floor_after - floor_before) / double(floor_grains), scene.dose_height, 1e-12);
        EXPECT_EQ(pass.stand[0], Stand::ahead);
        EXPECT_EQ(pass.stand[1], substrate == Substrate::fused ? Stand::gone : Stand::on_platform);
        EXPECT_EQ(pass.stand[2], Stand::gone);
        // on metal it will be part of the layer; on powder it lies with what was laid before
        EXPECT_EQ(pass.stand[3], substrate == Substrate::fused ? Stand::ahead : Stand::on_platform);
        for (std::size_t i = 0; i < s.size(); ++i) {
            if (s.id[i] == first) {
                // up with the bed, and falling back on the land while the blade crosses the dispenser
                EXPECT_LT(s.z[i], r + scene.dose_height);
                EXPECT_GT(s.z[i], r);
            }
            if (s.id[i] == first + 1) {
                EXPECT_NEAR(s.z[i], -scene.gap - scene.layer_thickness + r, 0.1 * r) << "sunk with the plate";
            }
        }
        EXPECT_EQ(pass.gap, substrate == Substrate::fused ? scene.gap : scene.layer_thickness);
        if (stage.plate >= 0) {
            EXPECT_DOUBLE_EQ(engine.bodies()[static_cast<std::size_t>(stage.plate)].z1,
                             -scene.gap - scene.layer_thickness);
        }
    }
}

TEST(Fused, metal_is_another_draw_of_the_same_roughness_for_every_layer) {
    const Scene scene = small_scene();
    const auto first = fused_surface(scene, 1), second = fused_surface(scene, 2);
    ASSERT_EQ(first.size(), second.size());
    std::size_t same = 0;
    double mean = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].x, second[i].x);
        EXPECT_EQ(first[i].y, second[i].y);
        same += first[i].z == second[i].z;
        mean += (second[i].z - first[i].z) / double(first.size());
    }
    EXPECT_EQ(same, 0u);
    // a difference of two uniform draws of +-a has the deviation a sqrt(2/3)
    const double a = 0.1 * scene.roughness;
    EXPECT_LT(std::fabs(mean), 4 * a * std::sqrt(2.0 / 3 / double(first.size())));
}

TEST_F(Layers, one_two_and_three_threads_leave_the_same_bits) {
    Scene scene = scene_on(Substrate::powder, 2);
    scene.dispenser_length = scene.platform_length = 0.26e-3;
    scene.land = 20e-6;
    const PartitionCurve partition = partition_of(scene);
    const SpreadResult one = run_spread(scene, &partition, options_with(1));
    ASSERT_TRUE(one.health.ok()) << one.health.reason;
    for (const int threads : {2, 3}) {
        const SpreadResult other = run_spread(scene, &partition, options_with(threads));
        EXPECT_EQ(other.state_hash, one.state_hash) << threads;
        EXPECT_EQ(other.layer.deposit_x, one.layer.deposit_x) << threads;
        EXPECT_EQ(other.earlier.at(0).deposit_z, one.earlier.at(0).deposit_z) << threads;
        EXPECT_EQ(other.steps, one.steps);
    }
}

TEST_F(Layers, a_spread_of_several_is_kept_whole_and_one_of_one_layer_as_before) {
    const SpreadResult& two = spread(Substrate::powder);
    const std::string bytes = spread_bytes(two);
    SpreadResult read;
    ASSERT_TRUE(read_spread(bytes, read));
    EXPECT_EQ(read.earlier.at(0).origin_x, two.earlier.at(0).origin_x);
    EXPECT_EQ(read.passes.at(1).raised_solid_volume, two.passes.at(1).raised_solid_volume);
    EXPECT_TRUE(std::isfinite(two.health.deep_contact_share));
    EXPECT_EQ(read.health.deep_contact_share, two.health.deep_contact_share);
    EXPECT_EQ(spread_bytes(read), bytes);
    SpreadResult cut;
    EXPECT_FALSE(read_spread(bytes.substr(0, bytes.size() - 1), cut));
    SpreadResult plain = two;
    plain.earlier.clear();
    plain.passes.clear();
    EXPECT_TRUE(bytes.starts_with(spread_bytes(plain))) << "what a single layer writes has not changed";
}

TEST(SceneChecks, of_layers_tell_what_they_cost_and_what_cannot_be) {
    const Scene one = small_scene();
    Scene three = one;
    three.layers = 3;
    EXPECT_NE(one.canonical_text(), three.canonical_text());
    EXPECT_EQ(one.canonical_text().find("layers"), std::string::npos);
    EXPECT_EQ(one.canonical_text().find("substrate_share_a"), std::string::npos);
    const SceneCost a = estimate_cost(one), b = estimate_cost(three);
    const double h = one.dose_height, d = one.bed_depth;
    EXPECT_NEAR(b.grains / a.grains, (d + 3 * h) / (d + h), 1e-12);
    EXPECT_GT(b.memory_bytes, 1.5 * a.memory_bytes);
    const double way = one.dispenser_length + one.land + one.platform_length + 0.5 * one.second_land;
    EXPECT_GT(b.steps - a.steps, 1.999 * way / one.blade_speed / scene_time_step(one));
    Scene powder = one;
    powder.substrate = Substrate::powder;
    // a substrate as deep as the bed below the blade
    EXPECT_NEAR((estimate_cost(powder).grains - a.grains) / a.grains,
                d * powder.platform_length / ((d + h) * powder.dispenser_length), 1e-12);
    const auto fatal = [](const Scene& scene, const std::string& words) {
        for (const SceneProblem& problem : validate(scene))
            if (problem.fatal && problem.text.find(words) != std::string::npos) return true;
        return false;
    };
    EXPECT_FALSE(fatal(three, "process.layers"));
    three.layers = 8;  // 60 um + 7 x 140 um
    EXPECT_TRUE(fatal(three, "process.layers"));
    three.layers = 7;
    EXPECT_FALSE(fatal(three, "process.layers"));
    three.layers = 0;
    EXPECT_TRUE(fatal(three, "process.layers"));
    powder.substrate_share_a = 1.1;
    EXPECT_TRUE(fatal(powder, "substrate_share_a"));
}

TEST_F(Layers, the_energy_account_follows_one_pass_only) {
    SpreadOptions options = options_with(1);
    options.energy_account = true;
    const Scene scene = scene_on(Substrate::fused, 2);
    RunHealth health;
    const Stage stage = set_stage(scene, nullptr, options_with(1), health);
    const SpreadResult refused = spread_stage(scene, stage, options);
    EXPECT_EQ(refused.health.status, "invalid");
    EXPECT_THAT(refused.health.reason, testing::HasSubstr("process.layers"));
}

}  // namespace
}  // namespace gradwright
