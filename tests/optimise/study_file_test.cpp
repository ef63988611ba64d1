// The study file: what a sound one becomes, and what every unsound one is told. bad_studies/ is the table of
// bad studies: each file ends with its expected messages, one "# expect:" line per problem, compared word for
// word.
#include "optimise/study_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "optimise/machine.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const fs::path kSource = GRADWRIGHT_SOURCE_DIR;

std::string text_of(const fs::path& file) {
    std::ifstream stream(file);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
}

std::vector<std::string> messages(const std::string& text, const std::string& name,
                                  const std::vector<std::string>& overrides = {}) {
    std::vector<std::string> result;
    try {
        parse_study(text, name, overrides);
    } catch (const InputError& error) {
        for (const InputProblem& problem : error.problems) result.push_back(problem.text());
    }
    return result;
}

/// The shortest sound study: everything else is a default.
const std::string kShort = R"([machine]
use = "coupon-rig"
[powder.A]
material = "SS17-4PH"
[powder.B]
material = "IN718"
[target]
shape = "linear"
from = { y = "0.4 mm", gi = 0.0 }
to = { y = "1.2 mm", gi = 1.0 }
)";

Study parsed(const std::string& more = "", const std::vector<std::string>& overrides = {}) {
    try {
        return parse_study(kShort + more, "short.toml", overrides);
    } catch (const InputError& error) {
        ADD_FAILURE() << report_of(error);
        return {};
    }
}

const InputEntry* input(const Study& study, const std::string& key) {
    const auto it = std::find_if(study.inputs.begin(), study.inputs.end(),
                                 [&](const InputEntry& e) { return e.key == key; });
    return it == study.inputs.end() ? nullptr : &*it;
}

std::string origin(const Study& study, const std::string& key) {
    const InputEntry* entry = input(study, key);
    return entry ? entry->origin : "missing";
}

// --- bad studies
// ----------------------------------------------------------------------------------------------------

class BadStudy : public testing::TestWithParam<std::string> {};

TEST_P(BadStudy, is_told_exactly_its_problems_all_at_once) {
    const fs::path folder = kSource / "tests" / "optimise" / "bad_studies";
    const std::string text = text_of(folder / (GetParam() + ".toml"));
    std::vector<std::string> expected;
    std::istringstream lines(text);
    const std::string mark = "# expect: ";
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(mark)) expected.push_back(line.substr(mark.size()));
    ASSERT_THAT(expected, Not(IsEmpty()));
    std::vector<std::string> obtained = messages(text, (folder / (GetParam() + ".toml")).string());
    for (std::string& message : obtained)
        for (auto at = message.find(folder.string() + "/"); at != std::string::npos;
             at = message.find(folder.string() + "/"))
            message.erase(at, folder.string().size() + 1);
    EXPECT_EQ(obtained, expected);
}

std::vector<std::string> bad_studies() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(kSource / "tests" / "optimise" / "bad_studies"))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

INSTANTIATE_TEST_SUITE_P(table, BadStudy, testing::ValuesIn(bad_studies()),
                         [](const auto& info) { return info.param; });

TEST(study_file, a_plate_that_is_only_spread_needs_no_workshop) {
    const Study study = read_study((kSource / "examples" / "01_linear_coupon.toml").string(),
                                   {"process.plate_thickness=\"0.2 mm\""});
    EXPECT_EQ(study.build.thickness, 0.2e-3);  // thinner than any slot that the default workshop cuts
    EXPECT_LT(study.build.thickness + 2 * study.build.slot_clearance, study.build.least_slot_width);
}

TEST(study_file, that_cannot_be_read_says_so) {
    try {
        read_study("no/such/study.toml");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(report_of(error), HasSubstr("no/such/study.toml: cannot be read"));
    }
}

TEST(study_file, with_any_line_missing_is_read_or_refused_but_never_half_read) {
    std::vector<std::string> lines;
    std::istringstream stream(text_of(kSource / "examples" / "01_linear_coupon.toml"));
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    for (std::size_t missing = 0; missing < lines.size(); ++missing) {
        std::string text;
        for (std::size_t i = 0; i < lines.size(); ++i)
            if (i != missing) text += lines[i] + "\n";
        try {
            const Study study = parse_study(text, "cut.toml");
            EXPECT_GT(study.bins.count, 0);
            EXPECT_GT(study.scene.gap, 0);
            EXPECT_FALSE(study.scene.powder[1].material.name.empty());
        } catch (const InputError& error) {
            EXPECT_THAT(error.problems, Not(IsEmpty())) << "without line " << missing + 1;
        }
    }
}

TEST(study_file, cut_off_at_any_byte_never_ends_in_anything_but_a_study_or_problems) {
    const std::string text = kShort + "[design_space]\ndosage_factor = { range = [2.0, 4.0], start = 3.0 }\n";
    for (std::size_t length = 0; length <= text.size(); ++length) {
        try {
            parse_study(text.substr(0, length), "cut.toml");
            EXPECT_GT(length, kShort.size() - 3);
        } catch (const InputError& error) {
            EXPECT_THAT(error.problems, Not(IsEmpty()));
        }
    }
}

TEST(study_file, report_numbers_every_problem) {
    try {
        parse_study("", "empty.toml");
        FAIL();
    } catch (const InputError& error) {
        const std::string report = report_of(error);
        EXPECT_EQ(std::count(report.begin(), report.end(), '\n'),
                  1 + static_cast<long>(error.problems.size()));
        EXPECT_THAT(report, HasSubstr("  1. empty.toml"));
    }
}

// --- overrides
// ------------------------------------------------------------------------------------------------------

TEST(overrides, replace_values_before_validation) {
    const Study study =
        parsed("", {"design_space.dosage_factor=[2.0, 4.0]", "process.layer_thickness=\"50 um\"",
                    "target.to.y=1.0 mm"});  // a shell has eaten the quotes of the last one
    EXPECT_TRUE(study.design_space.dosage_factor.free);
    EXPECT_EQ(study.design_space.dosage_factor.value, 3.0);
    EXPECT_EQ(study.scene.layer_thickness, 50e-6);
    EXPECT_EQ(study.target.y1, 1e-3);
    ASSERT_NE(input(study, "process.layer_thickness"), nullptr);
    EXPECT_EQ(input(study, "process.layer_thickness")->note, "--set");
}

TEST(overrides, are_named_instead_of_file_and_line_in_their_problems) {
    EXPECT_THAT(
        messages(kShort, "short.toml", {"process.layer_thickness=40", "process.wibble=1", "machine"}),
        ElementsAre("--set: machine: must have the form key.path=value; for instance --set "
                    "design_space.dosage_factor=3.5",
                    "--set: process.layer_thickness = 40: has no unit; write a string with its unit, such as "
                    "\"40 um\"",
                    HasSubstr("--set: process.wibble = 1: is not a known key")));
}

TEST(overrides, cannot_smuggle_in_other_keys) {
    EXPECT_THAT(messages(kShort, "short.toml", {"run.seed=2\n[objective]\ntolerance = 0.5"}),
                ElementsAre(HasSubstr("--set: run.seed")));
}

// --- a sound study
// --------------------------------------------------------------------------------------------------

TEST(study_defaults, are_those_of_the_paper_and_of_the_headers) {
    const Study study = parsed();
    EXPECT_EQ(study.name, "short");
    EXPECT_EQ(study.scene.layer_thickness, 40e-6);
    EXPECT_EQ(study.scene.gap, 40e-6 / 0.28);
    EXPECT_EQ(study.scene.roughness, 40e-6);
    EXPECT_EQ(study.scene.bed_depth, 8 * 40e-6);
    EXPECT_EQ(study.scene.dose_height, 2 * 40e-6);
    EXPECT_EQ(study.strip_width, 1.6e-3);
    EXPECT_EQ(study.bins.count, 8);
    EXPECT_EQ(study.scene.interaction.static_friction, 0.64);
    EXPECT_EQ(study.scene.interaction.work_of_adhesion, 0.02);
    EXPECT_EQ(study.scene.powder[0].material.density, 7980);
    EXPECT_EQ(study.scene.powder[1].material.youngs_modulus, 195e9);
    EXPECT_EQ(study.scene.powder[1].size.cut_low, 15e-6);
    EXPECT_EQ(study.scene.powder[1].size.cut_high, 80e-6);
    EXPECT_EQ(study.scene.wall.name, "geometry");
    EXPECT_EQ(study.footprint.x_high, 3.2e-3);
    EXPECT_EQ(study.footprint.y_high, 1.6e-3);
    EXPECT_TRUE(study.gap_steady);
    EXPECT_THAT(study.warnings, IsEmpty());
}

TEST(study_inputs, say_where_every_value_comes_from) {
    const Study study = parsed("[process]\nblade_speed = \"0.1 m/s\"\n");
    EXPECT_EQ(origin(study, "process.blade_speed"), "given");
    EXPECT_EQ(input(study, "process.blade_speed")->value, "0.1 m/s");  // in the user's own units
    EXPECT_EQ(input(study, "process.blade_speed")->unit, "m/s");
    EXPECT_EQ(origin(study, "process.layer_thickness"), "default");
    EXPECT_EQ(origin(study, "process.steady_packing"), "assumed");
    EXPECT_EQ(origin(study, "machine.dispenser.length"), "machine file");
    EXPECT_THAT(input(study, "powder.B.material.poissons_ratio")->note, HasSubstr("our default"));
    EXPECT_THAT(input(study, "powder.B.material.density")->note, HasSubstr("table 1"));
    for (const InputEntry& entry : study.inputs) {
        EXPECT_FALSE(entry.key.empty());
        EXPECT_FALSE(entry.value.empty()) << entry.key;
        EXPECT_THAT((std::vector<std::string>{"given", "default", "machine file", "assumed"}),
                    Contains(entry.origin));
        EXPECT_TRUE(entry.origin == "given" || !entry.note.empty()) << entry.key;
    }
}

TEST(study_reductions, fines_cut_keeps_d10_to_d90) {
    const Study study = parsed("[numerics]\nreductions = [\"fines_cut\"]\n");
    EXPECT_EQ(study.scene.powder[0].size.cut_low, 25e-6);
    EXPECT_EQ(study.scene.powder[1].size.cut_high, 62e-6);
    EXPECT_EQ(input(study, "powder.A.size.cut_low")->value, "25 um");
}

TEST(study_reductions, shallow_bed_is_three_median_grains_deep) {
    const Study study = parsed("[numerics]\nreductions = [\"shallow_bed\"]\n");
    EXPECT_DOUBLE_EQ(study.scene.bed_depth, 120e-6);
}

TEST(study_reductions, coarse_grains_in_the_map_or_everywhere) {
    const std::string numerics = "[numerics]\nreductions = [\"strip_map\", ";
    const Study map = parsed(numerics + "\"coarse_map\"]\n");
    EXPECT_DOUBLE_EQ(map.map_coarsening, 1.5);
    EXPECT_DOUBLE_EQ(map.full_coarsening, 1);
    const Design design = {};
    EXPECT_DOUBLE_EQ(scene_of(map, design, true, 1).powder[0].size.d50,
                     1.5 * scene_of(map, design, false, 1).powder[0].size.d50);
    EXPECT_THAT(map.warnings, Contains(HasSubstr("not for packing")));
    const Study everywhere =
        parsed(numerics + "\"coarse_grains\"]\nstrip_width = \"0.8 mm\"\ncoarse_factor = 2\n");
    EXPECT_DOUBLE_EQ(everywhere.map_coarsening, 2);
    EXPECT_DOUBLE_EQ(everywhere.full_coarsening, 2);
    EXPECT_DOUBLE_EQ(scene_of(everywhere, design, false, 1).gap, 2 * scene_of(map, design, false, 1).gap);
    EXPECT_THAT(parsed("[numerics]\ncoarse_factor = 2\n").warnings, Contains(HasSubstr("has no effect")));
    EXPECT_THAT(messages(kShort + numerics + "\"coarse_map\"]\ncoarse_factor = 9\n", "x.toml"),
                Contains(HasSubstr("numerics.coarse_factor = 9: must lie in [1, 4]")));
    EXPECT_TRUE(parsed(numerics + "\"early_stop\"]\n").scene.early_stop);
}

TEST(study_reductions, strip_map_is_ten_median_grains_wide) {
    const Study study = parsed("[numerics]\nreductions = [\"strip_map\"]\n");
    EXPECT_DOUBLE_EQ(study.strip_width, 0.4e-3);
    EXPECT_EQ(study.scene.width, 1.6e-3);
}

TEST(study_powders, b_takes_the_sizes_of_a_and_a_scales_with_its_median) {
    std::string text = kShort;
    text.insert(text.find("[powder.B]"), "size = { D50 = \"20 um\" }\n");
    const Study study = parse_study(text, "fine.toml");
    EXPECT_DOUBLE_EQ(study.scene.powder[0].size.d10, 12.5e-6);
    EXPECT_DOUBLE_EQ(study.scene.powder[0].size.cut_high, 40e-6);
    EXPECT_EQ(study.scene.powder[1].size.d50, 20e-6);
    EXPECT_EQ(study.scene.powder[1].size.d90, study.scene.powder[0].size.d90);
}

TEST(study_powders, a_material_of_ones_own_stands_in_the_study) {
    std::string text = kShort;
    const std::string named = "material = \"IN718\"";
    text.replace(
        text.find(named), named.size(),
        "material = { density = \"4.43 g/cm3\", youngs_modulus = \"114 GPa\", poissons_ratio = 0.33 }");
    const Study study = parse_study(text, "own.toml");
    EXPECT_DOUBLE_EQ(study.scene.powder[1].material.density, 4430);
    EXPECT_EQ(study.scene.powder[1].material.youngs_modulus, 114e9);
    EXPECT_EQ(study.scene.powder[1].material.poissons_ratio, 0.33);
}

TEST(study_interaction, work_of_adhesion_is_twice_the_surface_energy) {
    const Study study = parsed("[interaction]\nsurface_energy = \"10 mJ/m2\"\n");
    EXPECT_DOUBLE_EQ(study.scene.interaction.work_of_adhesion, 0.02);
}

TEST(study_dose, rises_with_the_platform_and_falls_with_the_dispenser) {
    const Study study = parsed("[design_space]\ndosage_factor = 3.0\n",
                               {"machine.platform.length=6.4 mm", "machine.dispenser.length=1.6 mm"});
    EXPECT_DOUBLE_EQ(study.scene.dose_height, 3 * 40e-6 * 6.4 / 1.6);
}

TEST(study_dose, a_chamber_keeps_its_headspace_while_the_floor_rises_further) {
    const Study study = parsed("[design_space]\nfill_fraction = { A = 0.95, B = 1.0 }\n");
    EXPECT_NEAR(study.scene.headspace[0], 0.05e-3, 1e-12);
    EXPECT_EQ(study.scene.headspace[1], 0);
}

TEST(study_dose, chambers_with_pistons_of_their_own_rise_each_by_its_share) {
    const Study study = parsed(
        "[design_space]\ndosage_factor = 3.0\ndose = { A = 1.2, B = [0.5, 1.0] }\n"
        "blade_speed = [\"50 mm/s\", \"150 mm/s\"]\nlayer_thickness = { range = [\"30 um\", \"60 um\"], "
        "start = "
        "\"50 um\" }\n");
    const DesignSpace& space = study.design_space;
    EXPECT_EQ(space.dose[0].value, 1.2);
    EXPECT_TRUE(space.dose[1].free);
    EXPECT_EQ(space.dose[1].value, 0.75);
    EXPECT_EQ(space.blade_speed.value, study.scene.blade_speed);  // the process's own lies inside
    EXPECT_EQ(space.layer_thickness.value, 50e-6);
    // start of the search and scene are one
    EXPECT_DOUBLE_EQ(study.scene.dose_height, 1.2 * 3 * 50e-6);
    EXPECT_NEAR(study.scene.headspace[1], (1.2 - 0.75) * 3 * 50e-6, 1e-15);
    EXPECT_DOUBLE_EQ(study.scene.gap, 50e-6 / study.steady_packing);
}

TEST(study_design_space, pairs_free_a_variable_and_start_says_where_to_begin) {
    const Study study = parsed(
        "[design_space]\ndosage_factor = { range = [2.0, 5.0], start = 2.5 }\nland = [\"1 mm\", \"6 mm\"]\n"
        "footprint_offset = \"0 mm\"\npartition = { family = \"straight\", angle = [\"-10 deg\", \"20 deg\"] "
        "}\n");
    const DesignSpace& space = study.design_space;
    EXPECT_EQ(space.dosage_factor.value, 2.5);
    EXPECT_EQ(space.dosage_factor.low, 2.0);
    EXPECT_EQ(space.land.high, 6e-3);
    EXPECT_EQ(space.land.value, 3.2e-3);  // the machine's own land lies inside the bounds
    EXPECT_FALSE(space.footprint_offset.free);
    EXPECT_DOUBLE_EQ(space.angle_deg.low, -10);
    EXPECT_DOUBLE_EQ(space.angle_deg.value, 5);
    EXPECT_DOUBLE_EQ(space.offset.high, 0.8e-3);  // half the width
    EXPECT_TRUE(space.partition_free);
}

TEST(study_design_space, points_fix_the_partition_and_start_frees_it) {
    const std::string points = "[[\"0 mm\", \"0.4 mm\"], [\"1.6 mm\", \"0.9 mm\"], [\"3.2 mm\", \"1.2 mm\"]]";
    const Study fixed = parsed("[design_space]\npartition = { points = " + points + " }\n");
    const Study free = parsed("[design_space]\npartition = { start = " + points + " }\n");
    EXPECT_FALSE(fixed.design_space.partition_free);
    EXPECT_TRUE(free.design_space.partition_free);
    ASSERT_EQ(free.design_space.given_points.size(), 3u);
    EXPECT_EQ(free.design_space.given_points[1].y, 0.9e-3);
    EXPECT_EQ(free.design_space.knots, 3);
}

TEST(study_target, zones_and_shapes_arrive_as_written) {
    const Study study = parsed(
        "zones = [{ from = \"0 mm\", to = \"0.2 mm\" }, { from = \"0.6 mm\", to = \"1 mm\", weight = 2.0 "
        "}]\n");
    ASSERT_EQ(study.target.zones.size(), 2u);
    EXPECT_EQ(study.target.zones[0].weight, 0);
    EXPECT_EQ(study.target.weight(0.8e-3), 2);
    EXPECT_NEAR(study.target(0.8e-3), 0.5, 1e-12);
}

/// The shortest study with another target.
std::string with_target(const std::string& target) {
    return kShort.substr(0, kShort.find("shape")) + target;
}

TEST(study_target, plateaus_and_a_b_a_arrive_as_written) {
    const Study plateaus = parse_study(
        with_target(
            "shape = \"plateaus\"\nlevels = [{ gi = 0.1, to = \"0.4 mm\" },\n  { gi = 0.5, from = \"0.7 "
            "mm\", to = \"0.9 mm\" },\n  { gi = 0.9, from = \"1.2 mm\" }]\n"),
        "levels.toml");
    EXPECT_NEAR(plateaus.target(0.2e-3), 0.1, 1e-12);
    EXPECT_NEAR(plateaus.target(0.55e-3), 0.3, 1e-12);
    EXPECT_NEAR(plateaus.target(0.8e-3), 0.5, 1e-12);
    EXPECT_NEAR(plateaus.target(1.5e-3), 0.9, 1e-12);
    EXPECT_EQ(input(plateaus, "target.levels[1].from")->value, "0.7 mm");
    const std::string ramps =
        "ramp_in = { from = \"0.3 mm\", to = \"0.5 mm\" }\nramp_out = { from = \"1.1 mm\", to = \"1.3 mm\" "
        "}\n";
    const Study band = parse_study(with_target("shape = \"aba\"\n" + ramps), "aba.toml");
    EXPECT_EQ(band.target(0), 1);
    EXPECT_EQ(band.target(0.8e-3), 0);
    EXPECT_THAT(band.warnings, IsEmpty());  // its ends are equal, but it is not flat
    EXPECT_EQ(origin(band, "target.gi_outer"), "default");
    EXPECT_EQ(
        parse_study(with_target("shape = \"aba\"\ngi_outer = 0.2\ngi_inner = 0.7\n" + ramps), "bab.toml")
            .target(0.8e-3),
        0.7);
    const std::string same =
        "shape = \"plateaus\"\nlevels = [{ gi = 0.5, to = \"0.4 mm\" }, { gi = 0.5, from = \"1 "
        "mm\" }]\n";
    EXPECT_THAT(parse_study(with_target(same), "flat.toml").warnings,
                Contains(HasSubstr("the same everywhere")));
}

TEST(study_target, weights_of_a_table_reach_the_bins_and_zones_win) {
    const fs::path folder = testing::TempDir();
    std::ofstream(folder / "line.csv") << "y_mm,gi,weight\n0,0,1\n0.8,0.5,0\n1.2,1,3\n";
    const std::string target = with_target("shape = \"table\"\nfile = \"line.csv\"\n");
    const std::string name = (folder / "table.toml").string();
    const Study study = parse_study(target, name);
    EXPECT_EQ(study.target.weight(0.5e-3), 1);
    EXPECT_EQ(study.target.weight(1e-3), 0);
    EXPECT_EQ(study.target.weight(1.5e-3), 3);
    const Study zoned =
        parse_study(target + "zones = [{ from = \"1 mm\", to = \"1.4 mm\", weight = 2 }]\n", name);
    EXPECT_EQ(zoned.target.weight(0.9e-3), 0);
    EXPECT_EQ(zoned.target.weight(1.3e-3), 2);
    EXPECT_EQ(zoned.target.weight(1.5e-3), 3);
}

TEST(study_target, beside_walls_two_d90_are_not_judged) {
    const Study study = parsed("[process]\nsides = \"frictional\"\n");
    EXPECT_DOUBLE_EQ(study.footprint.y_low, 2 * 62e-6);
    EXPECT_DOUBLE_EQ(study.footprint.y_high, 1.6e-3 - 2 * 62e-6);
}

TEST(study_warnings, name_doubtful_pairs_of_substrate_and_gap) {
    EXPECT_THAT(parsed("[process]\nsubstrate = \"plate\"\ngap = \"steady\"\n").warnings,
                ElementsAre(HasSubstr("belongs to a fused substrate")));
    EXPECT_THAT(parsed("[process]\ngap = \"layer\"\n").warnings,
                ElementsAre(HasSubstr("smaller than the largest grain"), HasSubstr("first layer's only")));
    EXPECT_EQ(parsed("[process]\nsubstrate = \"plate\"\n").scene.gap, 40e-6);
    EXPECT_EQ(parsed("[process]\ngap = \"150 um\"\n").scene.gap, 150e-6);
}

TEST(reductions, reduced_is_the_set_with_its_time_step_and_gives_way_to_what_is_written) {
    const auto study_of = [](const std::string& numerics) {
        return parse_study(
            std::string("[machine]\nuse = \"coupon-rig\"\n[powder.A]\nmaterial = \"SS17-4PH\"\n"
                        "[powder.B]\nmaterial = \"IN718\"\n[target]\nshape = \"linear\"\n"
                        "from = { y = \"0.4 mm\", gi = 0.0 }\nto = { y = \"1.2 mm\", gi = 1.0 }\n"
                        "[numerics]\n") +
                numerics,
            "reduced.toml");
    };
    const Study set = study_of("reductions = \"reduced\"");
    EXPECT_EQ(set.reductions, (std::vector<std::string>{kReduced.begin(), kReduced.end()}));
    EXPECT_EQ(set.scene.rayleigh_fraction, kReducedRayleighFraction);
    EXPECT_TRUE(set.scene.early_stop);
    EXPECT_EQ(
        study_of("reductions = \"reduced\"\ntime_step = { rayleigh_fraction = 0.1 }").scene.rayleigh_fraction,
        0.1);
    const Study list = study_of("reductions = [\"fines_cut\"]");
    EXPECT_EQ(list.scene.rayleigh_fraction, 0.2);
    EXPECT_FALSE(list.scene.early_stop);
    EXPECT_THROW(study_of("reductions = \"fines_cut\""), InputError);
}

TEST(study_name, is_text_whatever_it_looks_like) {
    EXPECT_EQ(parsed("", {"study.name=\"<script>alert(1)</script>\""}).name, "<script>alert(1)</script>");
}

// --- what ships
// -----------------------------------------------------------------------------------------------------

TEST(examples, are_sound_and_state_the_command_that_runs_them) {
    int studies = 0;
    for (const auto& entry : fs::directory_iterator(kSource / "examples")) {
        const std::string name = entry.path().stem().string();
        if (entry.path().extension() != ".toml" || name == "materials") continue;
        ++studies;
        EXPECT_THAT(text_of(entry.path()).substr(0, 120), HasSubstr("./gradwright ")) << name;
        EXPECT_THAT(text_of(entry.path()).substr(0, 120), HasSubstr("examples/" + name)) << name;
        try {
            EXPECT_THAT(read_study(entry.path().string()).warnings, IsEmpty()) << name;
        } catch (const InputError& error) {
            ADD_FAILURE() << report_of(error);
        }
    }
    EXPECT_GE(studies, 9);
}

TEST(examples, ask_for_the_targets_of_the_two_coupons) {
    const Study linear = read_study((kSource / "examples" / "01_linear_coupon.toml").string());
    EXPECT_NEAR(linear.target(0.6e-3), 0.25, 1e-12);
    EXPECT_EQ(linear.objective.tolerance, 0.04);
    EXPECT_EQ(linear.objective.x_drift_tolerance, 0.10);
    EXPECT_EQ(linear.footprint.x_low, 1.6e-3);
    EXPECT_DOUBLE_EQ(linear.scene.dose_height, 120e-6);
    EXPECT_DOUBLE_EQ(linear.scene.bed_depth, 120e-6);
    const Study sigmoid = read_study((kSource / "examples" / "02_sigmoid_coupon.toml").string());
    EXPECT_NEAR(sigmoid.target(0.6e-3), 0.1, 1e-12);
    EXPECT_NEAR(sigmoid.target(0.9e-3), 0.5, 1e-12);
    EXPECT_NEAR(sigmoid.target(1.2e-3), 0.9, 1e-12);
    // "The same machine": everything that moves a grain is equal.
    EXPECT_EQ(sigmoid.scene.dispenser_length, linear.scene.dispenser_length);
    EXPECT_EQ(sigmoid.scene.land, linear.scene.land);
    EXPECT_EQ(sigmoid.scene.gap, linear.scene.gap);
    EXPECT_EQ(sigmoid.scene.dose_height, linear.scene.dose_height);
    EXPECT_EQ(sigmoid.strip_width, linear.strip_width);
}

TEST(examples, of_the_paper_fixes_five_degrees_and_cuts_no_sizes) {
    const Study study = read_study((kSource / "examples" / "03_paper_five_degrees.toml").string());
    EXPECT_FALSE(study.design_space.partition_free);
    EXPECT_DOUBLE_EQ(study.design_space.angle_deg.value, 5);
    EXPECT_EQ(study.scene.powder[0].size.cut_low, 15e-6);
    EXPECT_EQ(study.scene.powder[0].size.cut_high, 80e-6);
    // The target is the sweep of the partition: L_d tan(5 deg) long, about the middle of the width.
    const double span = study.scene.dispenser_length * std::tan(5 * std::numbers::pi / 180);
    EXPECT_NEAR(study.target.y1 - study.target.y0, span, 1e-6);
    EXPECT_NEAR(0.5 * (study.target.y1 + study.target.y0), 0.5 * study.dispenser_width, 1e-9);
}

TEST(shipped_machines, can_each_be_used_and_own_up_to_what_nobody_measured) {
    const std::vector<MachineInfo> machines = shipped_machines();
    ASSERT_GE(machines.size(), 5u);
    for (const MachineInfo& machine : machines) {
        EXPECT_FALSE(machine.title.empty()) << machine.name;
        EXPECT_FALSE(machine.source.empty()) << machine.name;
        const Study study = parsed("", {"machine.use=\"" + machine.name + "\""});
        EXPECT_EQ(study.machine_name, machine.title);
        EXPECT_GE(machine.numbers.size(), 9u) << machine.name;
        for (const MachineNumber& number : machine.numbers) {
            const std::string name = machine.name + " " + number.key;
            EXPECT_FALSE(number.source.empty()) << name;
            EXPECT_EQ(number.measured, number.source.find("measure this") == std::string::npos) << name;
            EXPECT_EQ(origin(study, "machine." + number.key), number.measured ? "machine file" : "assumed")
                << name;
            const InputEntry* entry = input(study, "machine." + number.key);
            ASSERT_NE(entry, nullptr) << name;
            EXPECT_EQ(entry->note, number.source) << name;
            if (!number.measured) {
                EXPECT_THAT(study.warnings, Contains(HasSubstr("machine." + number.key))) << name;
            }
        }
    }
}

TEST(machine_file, has_every_number_overridden_by_the_study) {
    const std::vector<std::pair<std::string, std::string>> numbers = {
        {"dispenser.length", "7 mm"},  {"dispenser.width", "3 mm"},
        {"dispenser.depth", "5 mm"},   {"platform.length", "6 mm"},
        {"platform.width", "3 mm"},    {"land", "2 mm"},
        {"second_land", "4 mm"},       {"blade.tip_radius", "9 um"},
        {"blade.thickness", "0.8 mm"}, {"wall", "316L"}};
    ASSERT_EQ(numbers.size() + 1, machine_keys().size());  // and feed, which has one value only
    std::vector<std::string> set = {"machine.use=\"eos-m290\""};
    for (const auto& [key, value] : numbers) set.push_back(fmt::format("machine.{}=\"{}\"", key, value));
    const Study study = parsed("", set);
    for (const auto& [key, value] : numbers) {
        const InputEntry* entry = input(study, "machine." + key);
        ASSERT_NE(entry, nullptr) << key;
        EXPECT_EQ(entry->value, value) << key;
        EXPECT_EQ(entry->origin, "given") << key;
    }
    EXPECT_EQ(study.scene.wall.name, "316L");
    EXPECT_EQ(study.scene.second_land, 4e-3);
    EXPECT_EQ(study.scene.blade_tip_radius, 9e-6);
    for (const std::string& warning : study.warnings) EXPECT_THAT(warning, Not(HasSubstr("stand-in")));
}

TEST(machine_file, marks_a_number_without_a_source_as_a_stand_in) {
    const fs::path folder = fs::path(testing::TempDir()) / "machine without sources";
    fs::create_directories(folder);
    std::ofstream(folder / "rig.toml")
        << "title = \"rig\"\nland = \"2 mm\"\ndispenser = { length = \"3 mm\", width = { value = \"1.6 mm\", "
           "source = \"caliper\" } }\nplatform = { length = \"3 mm\" }\n";
    const std::vector<MachineNumber> numbers = machine_numbers("rig.toml", folder.string());
    ASSERT_EQ(numbers.size(), 4u);
    EXPECT_EQ(numbers[0].key, "dispenser.length");
    EXPECT_EQ(numbers[0].source, "no source given: measure this");
    EXPECT_FALSE(numbers[0].measured);
    EXPECT_EQ(numbers[1].source, "caliper");
    EXPECT_TRUE(numbers[1].measured);
    const Study study =
        parse_study(kShort.substr(kShort.find("[powder.A]")) + "[machine]\nuse = \"rig.toml\"\n",
                    (folder / "study.toml").string());
    EXPECT_EQ(origin(study, "machine.land"), "assumed");
    EXPECT_EQ(origin(study, "machine.dispenser.width"), "machine file");
    EXPECT_THAT(study.warnings, Contains(HasSubstr("machine.land (2 mm)")));
    fs::remove_all(folder);
}

}  // namespace
}  // namespace gradwright
