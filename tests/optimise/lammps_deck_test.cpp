// What LAMMPS is told and what is read back, without LAMMPS: conversions, deck, data, dumps, and the
// comparison.
#include "optimise/lammps_deck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "dem/random.h"
#include "dem/stage.h"
#include "optimise/lammps_crosscheck.h"
#include "optimise/lammps_law.h"
#include "optimise/lammps_run.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Scene small_scene() {
    Scene s;
    s.dispenser_length = 0.5e-3;
    s.width = 0.26e-3;
    s.land = 0.4e-3;
    s.platform_length = 0.6e-3;
    s.second_land = 0.5e-3;
    s.powder[0].material = {"A", 7980, 200e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 200e9, 0.3, ""};
    s.wall = s.powder[0].material;
    return s;
}

/// Four grains by hand, no fixed ones; bodies as the machine builds them are not needed here.
Stage hand_made_stage() {
    Stage stage;
    stage.labelled = true;
    stage.bed.x = {1e-4, 2e-4, 3e-4, 4e-4};
    stage.bed.y = {1e-4, 1e-4, 1e-4, 1e-4};
    stage.bed.z = {2e-5, 2e-5, 2e-5, 2e-5};
    stage.bed.radius = {10e-6, 20e-6, 15e-6, 12e-6};
    stage.bed.material = {0, 1, 0, 1};
    stage.bed.facts.packing_fraction = 0.5;
    GrainSpec rough;
    rough.x = 5e-5, rough.y = 5e-5, rough.z = -1e-4, rough.radius = 20e-6, rough.material = 2,
    rough.fixed = true;
    stage.fixed = {rough, rough};
    Body back, blade;
    back.axis = 0;
    blade.kind = Body::Kind::box;
    blade.x0 = -1e-3, blade.x1 = kBladeStart, blade.z1 = 1;
    stage.bodies = {back, blade};
    stage.blade = 1;
    return stage;
}

std::vector<double> numbers_in(const std::string& text) {
    std::istringstream words(text);
    std::vector<double> out;
    for (std::string word; words >> word;) {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        if (*end == '\0') out.push_back(value);
    }
    return out;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> out;
    for (std::string line; std::getline(stream, line);) out.push_back(line);
    return out;
}

class Folder : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "gradwright lammps XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string file(const std::string& text) const {
        std::ofstream(folder_ / "dump") << text;
        return (folder_ / "dump").string();
    }
    fs::path folder_;
};

TEST(LammpsLaw, the_tsuji_number_gives_our_damping) {
    for (const double e : {0.05, 0.2, 0.5, 0.616, 0.9, 1.0}) {
        const double beta = -std::log(e) / std::hypot(std::log(e), std::numbers::pi);
        EXPECT_NEAR(tsuji_damping(tsuji_number(e)), std::sqrt(5.0) * beta, 1e-12) << e;
    }
    EXPECT_NEAR(tsuji_number(0.5), 0.36665, 5e-6);  // the number of a deck that was run and measured
}

TEST(LammpsLaw, walls_get_the_moduli_that_its_own_formulas_turn_into_ours) {
    const LammpsLaw law(small_scene());
    const double softened = 200e9 * 1e-4, nu = 0.3;
    const double e_star = softened / (2 * (1 - nu * nu)), shear = softened / (2 * (1 + nu));
    const double g_star8 = 8 * shear / (2 * (2 - nu));
    const auto n = numbers_in(law.wall(0));  // E, tsuji, nu, kt, x, mu, k_roll, gamma_roll, mu_roll
    ASSERT_EQ(n.size(), 9u);
    EXPECT_NEAR(n[0] / (2 * (1 - n[2])), e_star, 1e-9 * e_star);
    EXPECT_NEAR(n[3], g_star8, 1e-9 * g_star8);
    EXPECT_NEAR(n[4], std::sqrt(2 * (1 - nu) / (2 - nu)),
                1e-12);  // sqrt(S_t/S_n) between equals: Mindlin's ratio
    EXPECT_EQ(n[5], 0.64);
    EXPECT_EQ(n[8], 0.1);
    EXPECT_THAT(law.wall(0), Not(HasSubstr("jkr")));
    EXPECT_THAT(law.wall(0, true), HasSubstr(" 0 damping tsuji"));
}

TEST(LammpsLaw, pairs_get_the_modulus_that_mixes_with_itself_to_ours_and_half_the_work_of_adhesion) {
    Scene scene = small_scene();
    scene.powder[1].material.youngs_modulus = 150e9;
    const LammpsLaw law(scene);
    const double c = (1 - 0.09) / (200e9 * 1e-4) + (1 - 0.09) / (150e9 * 1e-4);
    const auto n = numbers_in(law.pair(0, 1));  // E, tsuji, nu, gamma, kt, ...
    EXPECT_NEAR(2 * (1 - n[2] * n[2]) / n[0], c, 1e-12 * c);
    EXPECT_NEAR(n[3], 0.5 * 0.02 * std::pow(1e-4, 0.4), 1e-15);
    scene.interaction.work_of_adhesion = 0;
    EXPECT_THAT(LammpsLaw(scene).pair(0, 1), HasSubstr("hertz/material"));
    scene.interaction.rolling_friction = 0;
    EXPECT_THAT(LammpsLaw(scene).pair(0, 1), Not(HasSubstr("rolling")));
}

TEST(LammpsDeck, initialises_once_because_walls_lose_their_damping_at_each_further_time) {
    const Scene scene = small_scene();
    LammpsDeckOptions options;
    options.shots = {0.6e-3, 0.9e-3};
    int runs = 0, initialised = 0;
    for (const std::string& line : lines_of(lammps_deck(scene, hand_made_stage(), options))) {
        if (line.rfind("run ", 0) != 0) continue;
        ++runs;
        if (line.find("pre no") == std::string::npos) ++initialised;
    }
    EXPECT_EQ(runs, 5);  // two shots, the platform's end, the heap's length, coming to rest
    EXPECT_EQ(initialised, 1);
}

TEST(LammpsDeck, names_every_pair_and_a_wall_for_each_powder) {
    const Scene scene = small_scene();
    Stage stage = hand_made_stage();
    const std::string deck = lammps_deck(scene, stage, {});
    for (const char* pair : {"1 1", "1 2", "1 3", "2 2", "2 3", "3 3"})
        EXPECT_THAT(deck, HasSubstr("\npair_coeff " + std::string(pair) + " jkr "));
    for (const char* fix : {"fix wall0_a a ", "fix wall0_b b ", "fix blade_a a ", "fix blade_b b "})
        EXPECT_THAT(deck, HasSubstr(fix));
    EXPECT_THAT(deck, HasSubstr("boundary sf p s"));
    EXPECT_THAT(deck, Not(HasSubstr("processors")));
    stage.labelled = false;
    EXPECT_THAT(lammps_deck(scene, stage, {}), Not(HasSubstr("blade_b")));
    EXPECT_THAT(lammps_deck(scene, stage, {2, {}, false}), HasSubstr("processors 2 1 1"));
}

TEST(LammpsDeck, the_blade_does_as_much_work_as_one_that_yields_on_a_grain_pressed_in_by_its_radius) {
    Body blade;
    EXPECT_EQ(wall_softening(blade), 1);
    blade.yield_ratio = 0.006;
    const double r = 20e-6, k = 4.0 / 3.0 * 1.7e7 * std::sqrt(r);  // Hertz: k overlap^(3/2)
    double ours = 0, theirs = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double overlap = r * (i + 0.5) / n;
        ours += k * std::pow(std::min(overlap, blade.yield_ratio * r), 1.5) * r / n;
        theirs += wall_softening(blade) * k * std::pow(overlap, 1.5) * r / n;
    }
    EXPECT_NEAR(theirs / ours, 1, 0.005);  // ours: but for the way to the yield point

    const Scene scene = small_scene();
    Stage stage = hand_made_stage();
    stage.bodies[1].yield_ratio = 0.006;
    const LammpsLaw law(scene);
    const std::string deck = lammps_deck(scene, stage, {}), soft = law.wall(0, false, wall_softening(blade));
    EXPECT_NE(soft, law.wall(0));
    EXPECT_THAT(deck, HasSubstr("fix blade_a a wall/gran/region granular " + soft));
    EXPECT_THAT(deck, HasSubstr("granular " + law.wall(0)));  // the other walls are as hard as they were
    EXPECT_THAT(lammps_deck(scene, stage, {1, {}, true}), Not(HasSubstr(soft)));
}

TEST(LammpsDeck, data_holds_fixed_grains_first_and_each_grain_with_its_own_density) {
    const Scene scene = small_scene();
    const std::string data = lammps_bed(scene, hand_made_stage());
    EXPECT_THAT(data, HasSubstr("\n6 atoms\n"));
    const auto lines = lines_of(data);
    const auto first = std::find(lines.begin(), lines.end(), "Atoms # sphere") + 2;
    ASSERT_EQ(lines.end() - first, 6);
    EXPECT_EQ(numbers_in(first[1]), (std::vector<double>{2, 3, 40e-6, 7980, 5e-5, 5e-5, -1e-4}));
    EXPECT_EQ(numbers_in(first[3]), (std::vector<double>{4, 2, 40e-6, 8200, 2e-4, 1e-4, 2e-5}));
    EXPECT_EQ(numbers_in(first[4]), (std::vector<double>{5, 1, 30e-6, 7980, 3e-4, 1e-4, 2e-5}));
}

TEST(LammpsDeck, refuses_what_a_block_cannot_be) {
    Scene scene = small_scene();
    EXPECT_EQ(lammps_obstacle(scene), "");
    scene.blade_tip_radius = 50e-6;
    EXPECT_THAT(lammps_obstacle(scene), HasSubstr("tip_radius"));
}

TEST_F(Folder, a_dump_is_read_by_column_sorted_by_id_and_only_its_last_instant) {
    const LammpsDump dump = read_lammps_dump(
        file("ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff pp ss\n0 1\n0 1\n0 1\n"
             "ITEM: ATOMS id x yu z\n1 9 9 9\n"
             "ITEM: TIMESTEP\n20\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS ff pp ss\n0 1\n0 1\n0 1\n"
             "ITEM: ATOMS id x yu z\n7 0.5 -0.25 1e-3\n2 0.1 0.2 0.3\n5 nan 0 0\n"));
    EXPECT_EQ(dump.step, 20);
    EXPECT_EQ(dump.column("id"), (std::vector<double>{2, 5, 7}));
    EXPECT_EQ(dump.column("yu"), (std::vector<double>{0.2, 0, -0.25}));
    EXPECT_TRUE(std::isnan(dump.column("x")[1]));
    EXPECT_THROW(dump.column("fx"), LammpsError);
}

TEST_F(Folder, a_dump_that_is_cut_short_or_no_dump_is_refused) {
    const std::string head = "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n2\nITEM: ATOMS id x\n";
    EXPECT_THROW(read_lammps_dump(file(head + "1 0.5\n")), LammpsError);
    EXPECT_THROW(read_lammps_dump(file(head + "1 0.5\n2 word\n")), LammpsError);
    EXPECT_THROW(read_lammps_dump(file("nothing of the kind\n")), LammpsError);
    EXPECT_THROW(read_lammps_dump((folder_ / "absent").string()), LammpsError);
}

TEST(LammpsProgram, a_missing_program_is_told_with_the_line_that_installs_it) {
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    setenv("PATH", "/nowhere", 1);
    std::string mend;
    try {
        find_lammps(1);
    } catch (const LammpsError& error) {
        mend = error.mend;
    }
    setenv("PATH", path.c_str(), 1);
    EXPECT_THAT(mend, HasSubstr("apt-get install --no-install-recommends lammps"));
}

TEST(MeasureLayer, counts_what_lies_below_the_edge_over_the_platform_and_takes_the_missing_for_overflow) {
    Scene scene = small_scene();
    scene.allow_starved = true;
    const Stage stage = hand_made_stage();
    const auto volume = [](double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; };
    // grain 0 laid, 1 above the edge, 2 beyond the platform, 3 gone
    const std::vector<GrainPlace> places = {
        {0, 1.1e-3, 0.3e-3, -50e-6}, {1, 1.2e-3, 0, 10e-6}, {2, 1.6e-3, 0, -10e-6}};
    RunHealth health;
    health.status = "ok";
    const Layer layer = measure_layer(scene, stage, places, health);
    ASSERT_EQ(layer.size(), 1u);
    EXPECT_EQ(layer.origin_x[0], 1e-4);
    EXPECT_EQ(layer.deposit_x[0], 1.1e-3 - (0.5e-3 + 0.4e-3));
    EXPECT_EQ(layer.deposit_y[0], 0.3e-3);
    EXPECT_EQ(layer.is_a[0], 1);
    EXPECT_DOUBLE_EQ(layer.volume[0], volume(10e-6));
    EXPECT_DOUBLE_EQ(layer.overflow_solid_volume, volume(15e-6) + volume(12e-6));
    EXPECT_DOUBLE_EQ(layer.overflow_solid_volume_a, volume(15e-6));
    EXPECT_TRUE(health.ok());
    const Layer none = measure_layer(scene, stage, {}, health);
    EXPECT_EQ(none.size(), 0u);
    EXPECT_EQ(health.status, "starved");
}

CrosscheckRun run_with(std::vector<double> gi) {
    CrosscheckRun run;
    run.gi = std::move(gi);
    return run;
}

TEST(Crosscheck, compares_bed_by_bed_and_takes_the_noise_from_between_the_beds) {
    Crosscheck result;
    const double unknown = std::nan("");
    result.weight = {1, 0, 1, 1};
    result.ours.runs = {run_with({0.1, 0.9, 0.5, unknown}), run_with({0.3, 0.9, 0.7, 0.2})};
    result.lammps.runs = {run_with({0.2, 0.1, 0.5, 0.1}), run_with({0.2, 0.1, 0.9, 0.2})};
    compare_gradation(result);
    // differences that count: bin 0: 0.1, -0.1; bin 2: 0, 0.2; bin 3: undefined, 0
    EXPECT_NEAR(result.gi_rmse, std::sqrt((0.01 + 0.01 + 0 + 0.04 + 0) / 5), 1e-15);
    EXPECT_NEAR(result.gi_bias, 0.2 / 5, 1e-15);
    EXPECT_NEAR(result.gi_rmse_of_means, std::sqrt((0 + 0.01 + 0) / 3), 1e-15);
    // squares about the mean of two: half the squared difference; bin 3 of ours has one bed only
    EXPECT_NEAR(result.noise_rms, std::sqrt((0.04 / 2 + 0 + 0.04 / 2 + 0.16 / 2 + 0.01 / 2) / 5), 1e-15);
    EXPECT_EQ(result.gradation_agrees, result.gi_rmse <= 1.5 * result.noise_rms);
}

TEST(Crosscheck, chance_is_told_from_a_difference_by_the_signs_of_the_beds) {
    Random random(8);
    const auto beds = [&](int count, double shift) {
        Crosscheck result;
        result.weight = {1, 1, 0, 1};
        for (int k = 0; k < count; ++k) {
            result.ours.runs.push_back(
                run_with({0.2 + 0.03 * random.normal(), 0.5 + 0.03 * random.normal(), 9.0, 0.8}));
            result.lammps.runs.push_back(run_with(
                {0.2 + 0.03 * random.normal() + shift, 0.5 + 0.03 * random.normal() + shift, -9.0, 0.8}));
        }
        compare_gradation(result);
        return result;
    };
    // one sign in all beds: of 2^(n - 1) patterns only the seen one gives so large a mean
    const Crosscheck apart = beds(6, 0.3);
    EXPECT_EQ(apart.gi_p_value, 1.0 / 32);
    EXPECT_FALSE(apart.gradation_agrees);
    EXPECT_NEAR(apart.gi_bias, 0.2, 0.03);
    EXPECT_NEAR(apart.gi_bias_error, 0.02 / std::sqrt(6.0), 0.01);  // sqrt(2 + 2) 0.03 / 3 bins a bed
    // the same in both: p is uniform, so that one run in twenty is called different
    int different = 0;
    double sum = 0;
    constexpr int kTries = 400;
    for (int k = 0; k < kTries; ++k) {
        const Crosscheck same = beds(8, 0);
        different += !same.gradation_agrees;
        sum += same.gi_p_value;
    }
    EXPECT_NEAR(sum / kTries, 0.5, 4 * 0.29 / std::sqrt(double(kTries)));
    EXPECT_NEAR(different / double(kTries), kDiffersBelow,
                4 * std::sqrt(kDiffersBelow * (1 - kDiffersBelow) / kTries));
    // too few to tell anything by their signs: the ratio is looked at instead
    const Crosscheck few = beds(3, 0.3);
    EXPECT_EQ(few.gi_p_value, 0.25);
    EXPECT_FALSE(few.gradation_agrees);
    EXPECT_TRUE(std::isnan(beds(1, 0).gi_bias_error));
    EXPECT_TRUE(std::isnan(beds(0, 0).gi_p_value));
}

TEST(Crosscheck, heap_shape_is_the_solid_ahead_of_the_face_and_above_the_edge) {
    Snapshot shot;
    shot.blade_x = 1e-3;
    const auto add = [&](double x, double z) {
        shot.x.push_back(static_cast<float>(x));
        shot.z.push_back(static_cast<float>(z));
        shot.radius.push_back(20e-6f);
    };
    add(1.05e-3, 50e-6);  // first bin
    add(1.15e-3, 50e-6);  // second bin
    add(1.15e-3, 90e-6);
    add(1.15e-3, -10e-6);  // below the edge
    add(0.95e-3, 50e-6);   // behind the face
    const double width = 0.4e-3, volume = 4.0 / 3.0 * std::numbers::pi * std::pow(double(20e-6f), 3);
    const HeapShape heap = heap_shape(shot, width);
    ASSERT_EQ(heap.solid_depth.size(), 2u);
    EXPECT_NEAR(heap.solid_depth[1], 2 * volume / (kHeapBin * width), 1e-12);
    EXPECT_NEAR(heap.solid_section, 3 * volume / width, 1e-15);
    EXPECT_NEAR(heap.centre, (0.05e-3 + 2 * 0.15e-3) / 3, 1e-9);
    EXPECT_NEAR(heap.length, 0.15e-3, 1e-9);
    EXPECT_EQ(heap_shape(Snapshot{}, width).solid_section, 0);
}

}  // namespace
}  // namespace gradwright
