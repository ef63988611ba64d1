// gradwright init: the study it writes is sound for every machine, powder and shape that ships, scaled to the
// machine, marks what nobody has measured, and takes the place of no file.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "called_program.h"
#include "cli/check.h"
#include "optimise/study_draft.h"
#include "optimise/study_file.h"

namespace {

namespace fs = std::filesystem;
using gradwright::DraftOptions;
using gradwright::MachineInfo;
using gradwright::Study;
using gradwright::StudyDraft;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kPowders = {"IN718", "SS17-4PH", "316L", "Ti-6Al-4V", "AlSi10Mg", "CuCrZr"};

DraftOptions options(const std::string& machine) {
    DraftOptions result;
    result.machine = machine;
    result.powder = {"SS17-4PH", "IN718"};
    return result;
}

/// As `check` does; its problems as one text, empty when sound.
std::string problems_of(const std::string& text) {
    try {
        const Study study = gradwright::parse_study(text, "draft.toml");
        gradwright::cli::refuse_impossible(study, gradwright::cli::estimate(study, 1));
    } catch (const gradwright::InputError& error) {
        return gradwright::report_of(error);
    }
    return {};
}

TEST(study_draft, is_sound_for_every_machine_with_every_pair_of_powders_and_every_shape) {
    for (const MachineInfo& machine : gradwright::shipped_machines()) {
        DraftOptions draft = options(machine.name);
        for (const char* target : gradwright::kDraftTargets) {
            draft.target = target;
            const std::string text = gradwright::draft_study(draft).text;
            ASSERT_EQ(problems_of(text), "") << machine.name << target << "\n" << text;
        }
        draft.target = "linear";
        for (const std::string& a : kPowders)
            for (const std::string& b : kPowders) {
                draft.powder = {a, b};
                const std::string text = gradwright::draft_study(draft).text;
                ASSERT_EQ(problems_of(text), "") << machine.name << a << b << "\n" << text;
            }
    }
}

TEST(study_draft, scales_target_and_footprint_to_the_machine) {
    for (const MachineInfo& machine : gradwright::shipped_machines()) {
        const StudyDraft draft = gradwright::draft_study(options(machine.name));
        const Study study = gradwright::parse_study(draft.text, "draft.toml");
        EXPECT_NEAR(study.target.at(0, 0.25 * study.dispenser_width), 0, 1e-6) << machine.name;
        EXPECT_NEAR(study.target.at(0, 0.50 * study.dispenser_width), 0.5, 1e-6) << machine.name;
        EXPECT_NEAR(study.target.at(0, 0.75 * study.dispenser_width), 1, 1e-6) << machine.name;
        EXPECT_LE(study.footprint.x_high, study.scene.platform_length * (1 + 1e-9)) << machine.name;
        EXPECT_GE(study.footprint.x_high - study.footprint.x_low,
                  0.5 * study.scene.platform_length * (1 - 1e-9));
        // bins are wide enough to show a gradation, and there are enough of them to show its shape
        EXPECT_GE(study.bins.width, 5 * 40e-6 * (1 - 1e-9)) << machine.name;
        EXPECT_GE(study.bins.count, 8) << machine.name;
        EXPECT_NEAR(study.bins.count * study.bins.width, study.dispenser_width, 1e-6 * study.dispenser_width);
    }
}

TEST(study_draft, spreads_the_coupon_and_extrapolates_the_machines_that_are_too_large) {
    for (const MachineInfo& machine : gradwright::shipped_machines()) {
        const StudyDraft draft = gradwright::draft_study(options(machine.name));
        EXPECT_EQ(draft.scale_up, machine.name != "coupon-rig") << machine.name;
        const Study study = gradwright::parse_study(draft.text, "draft.toml");
        EXPECT_EQ(study.scale_up.on(), draft.scale_up) << machine.name;
    }
}

TEST(study_draft, gives_the_sizes_of_both_powders_and_the_layer_as_asked) {
    DraftOptions draft = options("coupon-rig");
    draft.size = {gradwright::GrainSizes{18e-6, 30e-6, 46e-6}, gradwright::GrainSizes{40e-6, 55e-6, 80e-6}};
    draft.layer_thickness = 60e-6;
    const StudyDraft written = gradwright::draft_study(draft);
    const Study study = gradwright::parse_study(written.text, "draft.toml");
    EXPECT_EQ(study.scene.powder[0].size.d10, 18e-6);
    EXPECT_EQ(study.scene.powder[0].size.d90, 46e-6);
    EXPECT_EQ(study.scene.powder[1].size.d50, 55e-6);
    EXPECT_EQ(study.scene.layer_thickness, 60e-6);
    for (const std::string& key : written.measure) EXPECT_THAT(key, Not(HasSubstr("size")));
    const StudyDraft stand_ins = gradwright::draft_study(options("coupon-rig"));
    EXPECT_THAT(stand_ins.measure, testing::IsSupersetOf({"powder.A.size", "powder.B.size"}));
    EXPECT_THAT(stand_ins.text, HasSubstr("# measure this: a usual gas-atomised powder"));
}

TEST(study_draft, with_the_machines_numbers_uncommented_is_the_same_machine_but_measured) {
    for (const MachineInfo& machine : gradwright::shipped_machines()) {
        const std::string text = gradwright::draft_study(options(machine.name)).text;
        const std::string measured = std::regex_replace(
            text, std::regex("\n# ((dispenser|platform|land|second_land|blade)[a-z_.]* = )"), "\n$1");
        ASSERT_NE(text, measured);
        ASSERT_EQ(problems_of(measured), "") << measured;
        const Study before = gradwright::parse_study(text, "draft.toml");
        const Study after = gradwright::parse_study(measured, "draft.toml");
        EXPECT_EQ(after.scene.dispenser_length, before.scene.dispenser_length);
        EXPECT_EQ(after.scene.second_land, before.scene.second_land);
        EXPECT_EQ(after.scene.blade_thickness, before.scene.blade_thickness);
        for (const std::string& warning : after.warnings) EXPECT_THAT(warning, Not(HasSubstr("stand-ins")));
    }
}

TEST(study_draft, comments_every_value_or_its_group_and_gives_every_dimension_its_unit) {
    const std::string text = gradwright::draft_study(options("eos-m290")).text;
    std::istringstream lines(text);
    std::string before;
    for (std::string line; std::getline(lines, line); before = line) {
        if (line.empty() || line[0] == '#' || line[0] == '[' || line[0] == ']' || line[0] == ' ') continue;
        const bool self_explaining = line.starts_with("name") || line.starts_with("norm") ||
                                     line.starts_with("partition") || line.starts_with("material") ||
                                     line.starts_with("to ");
        EXPECT_TRUE(self_explaining || line.find("# ") != std::string::npos || before.starts_with("#"))
            << line;
    }
}

class Init : public CalledProgram {
  protected:
    const std::vector<std::string> kCall = {"init",       "my.toml",  "--machine",  "coupon-rig",
                                            "--powder-a", "SS17-4PH", "--powder-b", "IN718"};
    std::vector<std::string> with(const std::vector<std::string>& more) const {
        std::vector<std::string> call = kCall;
        call.insert(call.end(), more.begin(), more.end());
        return call;
    }
};

TEST_F(Init, writes_a_study_that_check_takes_and_says_what_to_measure) {
    const Outcome outcome = run(kCall);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("gradwright check my.toml"));
    EXPECT_EQ(outcome.err, "");
    const Outcome checked = run({"check", "my.toml", "--json"});
    ASSERT_EQ(checked.code, 0) << checked.err;
    EXPECT_EQ(json::parse(checked.out)["study"], "my");
    const Outcome evaluated = run({"evaluate", "my.toml", "--fidelity", "kinematic", "--json"});
    EXPECT_EQ(evaluated.code, 0) << evaluated.err;
}

TEST_F(Init, takes_the_place_of_no_file_without_force) {
    std::ofstream(folder_ / "work" / "my.toml") << "mine";
    const Outcome outcome = run(kCall);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--force"));
    EXPECT_EQ(content(folder_ / "work" / "my.toml"), "mine");
    EXPECT_EQ(run(with({"--force"})).code, 0);
    EXPECT_THAT(content(folder_ / "work" / "my.toml"), HasSubstr("[machine]"));
}

TEST_F(Init, refuses_unknown_and_missing_names_with_the_list_of_valid_ones) {
    const std::string machines = "valid: aconity-mini, concept-laser-mlab, coupon-rig, eos-m290, eosint-m280";
    const std::string powders = "valid: 316L, AlSi10Mg, CuCrZr, IN718, SS17-4PH, Ti-6Al-4V";
    struct Case {
        std::vector<std::string> call;
        std::string says;
    };
    const std::vector<Case> cases = {
        {{"init", "my.toml", "--machine", "eos-m920"}, machines},
        {{"init", "my.toml", "--machine", "eos-m920"}, "did you mean 'eos-m290'?"},
        {{"init", "my.toml"}, machines},
        {{"init", "my.toml", "--machine", "coupon-rig", "--powder-a", "IN781"}, powders},
        {{"init", "my.toml", "--machine", "coupon-rig", "--powder-a", "geometry"}, powders},
        {{"init", "my.toml", "--machine", "coupon-rig", "--powder-a", "IN718"}, "--powder-b is missing"},
        {with({"--target", "ramp"}), "valid: linear, sigmoid, step, plateaus, aba"},
        {with({"--size-a", "20 um, 35, 55 um"}), "the unit is missing"},
        {with({"--size-a", "55 um, 35 um, 20 um"}), "D10 < D50 < D90"},
        {with({"--layer", "-40 um"}), "must be > 0"},
    };
    for (const Case& one : cases) {
        const Outcome outcome = run(one.call);
        EXPECT_EQ(outcome.code, 2) << one.says;
        EXPECT_THAT(outcome.err, HasSubstr(one.says));
        EXPECT_EQ(outcome.out, "");
    }
    EXPECT_EQ(run({"init", "my.toml", "--machine", "nowhere.toml"}).code, 6);
    EXPECT_EQ(run({"init", ".", "--machine", "coupon-rig", "--powder-a", "316L", "--powder-b", "IN718"}).code,
              6);
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Init, tells_all_that_is_wrong_with_its_options_at_once) {
    const Outcome outcome = run({"init", "my.toml", "--machine", "eos-m920", "--powder-a", "IN781",
                                 "--powder-b", "316L", "--size-b", "55 um, 35 um, 20 um", "--layer", "40"});
    EXPECT_EQ(outcome.code, 2);
    for (const char* said :
         {"4 problems", "did you mean 'eos-m290'?", "--powder-a 'IN781'", "--size-b", "--layer '40'"})
        EXPECT_THAT(outcome.err, HasSubstr(said));
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Init, names_a_machine_file_relative_to_the_study) {
    fs::create_directories(folder_ / "work" / "rigs");
    fs::create_directories(folder_ / "work" / "studies");
    fs::copy_file(fs::path(GRADWRIGHT_SOURCE_DIR) / "examples" / "machines" / "coupon-rig.toml",
                  folder_ / "work" / "rigs" / "ours.toml");
    const Outcome outcome = run({"init", "studies/first.toml", "--machine", "rigs/ours.toml", "--powder-a",
                                 "316L", "--powder-b", "CuCrZr", "--size-a", "20 um,35 um,55 um", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["machine"], "../rigs/ours.toml");
    EXPECT_EQ(object["scale_up"], false);
    EXPECT_THAT(object["measure"].dump(), Not(HasSubstr("powder.A.size")));
    EXPECT_EQ(run({"check", "studies/first.toml"}).code, 0);
}

TEST_F(Init, tells_what_a_machine_file_has_wrong_and_writes_nothing) {
    std::ofstream(folder_ / "work" / "hopper.toml")
        << "feed = \"hopper\"\ndispenser = { length = \"3 mm\", width = \"1.6\" }\nplatform = { length = \"3 "
           "mm\" }\n";
    const Outcome outcome =
        run({"init", "my.toml", "--machine", "hopper.toml", "--powder-a", "316L", "--powder-b", "CuCrZr"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("hopper.toml:1: machine.feed = \"hopper\""));
    EXPECT_THAT(outcome.err,
                HasSubstr("hopper.toml:2: machine.dispenser.width = \"1.6\": the unit is missing"));
    EXPECT_FALSE(fs::exists(folder_ / "work" / "my.toml"));
}

TEST_F(Init, writes_to_stdout_for_a_dash) {
    std::vector<std::string> call = kCall;
    call[1] = "-";
    const Outcome outcome = run(call);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(problems_of(outcome.out), "");
    EXPECT_TRUE(wrote_nothing());
}

}  // namespace
