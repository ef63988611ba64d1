// The built program, called as a user calls it: exit codes, what stands on which stream, hints, and what is
// written where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

struct Outcome {
    int code = -1;
    std::string out, err;
};

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

std::string content(const fs::path& file) {
    std::ifstream stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// Each test has an empty working folder and its own cache.
class Program : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "gradwright program XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
        fs::create_directory(folder_ / "work");
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// `before`: words in front of the program, such as "timeout 2 ".
    Outcome run(const std::vector<std::string>& arguments, const std::string& before = "") const {
        std::string command = "cd " + quoted((folder_ / "work").string()) +
                              " && XDG_CACHE_HOME=" + quoted((folder_ / "cache").string()) + " " + before +
                              quoted(GRADWRIGHT_PROGRAM);
        for (const std::string& argument : arguments) command += " " + quoted(argument);
        command += " >" + quoted((folder_ / "out").string()) + " 2>" + quoted((folder_ / "err").string()) +
                   " </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(folder_ / "out"),
                content(folder_ / "err")};
    }
    /// Nothing lies in the working folder.
    bool wrote_nothing() const { return fs::is_empty(folder_ / "work"); }

    fs::path folder_;
};

std::string example(const std::string& name) {
    return std::string(GRADWRIGHT_SOURCE_DIR) + "/examples/" + name;
}
const std::string kLinear = example("01_linear_coupon.toml");

std::vector<std::string> studies() {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(example("")))
        if (entry.path().extension() == ".toml" && std::isdigit(entry.path().filename().string()[0]))
            files.push_back(entry.path().string());
    return files;
}

TEST_F(Program, without_a_verb_prints_its_help_as_a_usage_error) {
    const Outcome outcome = run({});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("design"));
}

TEST_F(Program, help_lists_every_verb_and_the_exit_codes) {
    for (const char* call : {"help", "--help", "-h"}) {
        const Outcome outcome = run({call});
        EXPECT_EQ(outcome.code, 0) << call;
        for (const char* word :
             {"design", "evaluate", "check", "report", "bench", "materials", "machines", "130 interrupted"})
            EXPECT_THAT(outcome.out, HasSubstr(word)) << call;
        EXPECT_EQ(outcome.err, "") << call;
    }
}

TEST_F(Program, help_of_a_verb_is_the_same_by_either_way) {
    const Outcome outcome = run({"help", "design"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("--strategy"));
    EXPECT_EQ(outcome.out, run({"design", "--help"}).out);
}

TEST_F(Program, version_says_what_it_was_built_from) {
    EXPECT_THAT(run({"version"}).out, HasSubstr("gradwright 0."));
    EXPECT_EQ(run({"--version"}).out, run({"version"}).out);
    EXPECT_TRUE(json::parse(run({"version", "--json"}).out).contains("compiler"));
}

TEST_F(Program, an_unknown_verb_is_a_usage_error_with_the_nearest_name) {
    const Outcome outcome = run({"desing", kLinear});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("did you mean 'design'?"));
}

TEST_F(Program, an_unknown_option_is_a_usage_error_with_the_nearest_name) {
    for (const char* wrong : {"--stratgy=map", "--stratgy"}) {
        const Outcome outcome = run({"design", kLinear, wrong});
        EXPECT_EQ(outcome.code, 2) << wrong;
        EXPECT_THAT(outcome.err, HasSubstr("did you mean '--strategy'?")) << wrong;
    }
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Program, a_study_or_an_option_in_the_place_of_the_verb_is_told_as_such) {
    std::ofstream(folder_ / "work" / "mine.toml") << "";
    const Outcome study = run({"mine.toml", "--json"});
    EXPECT_EQ(study.code, 2);
    EXPECT_THAT(study.err, HasSubstr("'gradwright check mine.toml', 'gradwright design mine.toml'"));
    const Outcome option = run({"-c", "mine.toml"});
    EXPECT_EQ(option.code, 2);
    EXPECT_THAT(option.err, HasSubstr("unknown option '-c' in the place of the verb"));
    EXPECT_THAT(run({"--verison"}).err, HasSubstr("did you mean '--version'?"));
}

TEST_F(Program, values_that_an_option_does_not_take_are_usage_errors) {
    const std::vector<std::vector<std::string>> calls = {
        {"design"},
        {"design", kLinear, "--strategy", "bobyca"},
        {"design", kLinear, "--threads", "many"},
        {"design", kLinear, "--threads", "0"},
        {"design", kLinear, "--budget", "-3"},
        {"design", kLinear, "--fidelity", "full"},
        {"design", kLinear, "--strategy", "mf", "--fidelity", "full"},
        {"design", kLinear, "--strategy", "ceres", "--fidelity", "ful"},
        {"evaluate", kLinear, "--fidelity", "ful"},
        {"check", kLinear, "--set", "process.layer_thickness"},
        {"check", kLinear, "another.toml"},
        {"help", "desing"},
    };
    for (const auto& call : calls) {
        const Outcome outcome = run(call);
        EXPECT_EQ(outcome.code, 2) << testing::PrintToString(call) << outcome.err;
        EXPECT_EQ(outcome.out, "") << testing::PrintToString(call);
        EXPECT_THAT(outcome.err, HasSubstr("gradwright:")) << testing::PrintToString(call);
    }
    EXPECT_THAT(run({"evaluate", kLinear, "--fidelity", "ful"}).err, HasSubstr("did you mean 'full'?"));
    EXPECT_THAT(run({"design", kLinear, "--strategy", "bobyca"}).err, HasSubstr("did you mean 'bobyqa'?"));
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Program, a_study_that_cannot_be_opened_is_a_file_error_with_the_nearest_file) {
    const Outcome outcome = run({"check", example("01_linear_coupn.toml")});
    EXPECT_EQ(outcome.code, 6);
    EXPECT_THAT(outcome.err, HasSubstr("did you mean '01_linear_coupon.toml'?"));
    EXPECT_EQ(run({"check", example("")}).code, 6);
    EXPECT_EQ(run({"evaluate", kLinear, "--fidelity", "kinematic", "--design", "nowhere.json"}).code, 6);
    EXPECT_EQ(run({"report", "nowhere"}).code, 6);
}

TEST_F(Program, a_bad_study_is_refused_with_all_its_problems_and_nothing_is_written) {
    const std::vector<std::string> call = {"design", kLinear,
                                           "--set",  "process.layer_thickness=\"-40 um\"",
                                           "--set",  "process.blade_sped=\"50 mm/s\"",
                                           "--set",  "interaction.static_friction=-1"};
    const Outcome outcome = run(call);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("layer_thickness"));
    EXPECT_THAT(outcome.err, HasSubstr("blade_speed"));  // the nearest valid key
    EXPECT_THAT(outcome.err, HasSubstr("static_friction"));
    EXPECT_TRUE(wrote_nothing());

    std::vector<std::string> with_json = call;
    with_json.push_back("--json");
    const json object = json::parse(run(with_json).out);
    EXPECT_EQ(object["error"]["code"], 3);
    EXPECT_GE(object["error"]["problems"].size(), 3u);
    for (const json& problem : object["error"]["problems"]) {
        EXPECT_FALSE(problem["key"].get<std::string>().empty());
        EXPECT_FALSE(problem["rule"].get<std::string>().empty());
    }
}

TEST_F(Program, a_file_that_is_no_toml_is_bad_input_with_its_line) {
    std::ofstream(folder_ / "work" / "broken.toml") << "[machine]\nname = \"a\"\n[process\n";
    const Outcome outcome = run({"check", "broken.toml"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("broken.toml:3"));
}

TEST_F(Program, usage_and_file_errors_are_told_in_json_too) {
    EXPECT_EQ(json::parse(run({"check", "nowhere.toml", "--json"}).out)["error"]["code"], 6);
    EXPECT_EQ(json::parse(run({"chek", "--json"}).out)["error"]["kind"], "usage");
    EXPECT_EQ(json::parse(run({"check", kLinear, "--jobs", "--json"}).out)["error"]["code"], 2);
}

TEST_F(Program, check_accepts_every_example_and_lists_every_input) {
    const auto files = studies();
    ASSERT_GE(files.size(), 3u);
    for (const std::string& file : files) {
        const Outcome outcome = run({"check", file});
        EXPECT_EQ(outcome.code, 0) << file << "\n" << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("layer_thickness")) << file;
        EXPECT_THAT(outcome.out, HasSubstr("grain-steps")) << file;
    }
}

TEST_F(Program, check_gives_origin_and_cost_in_json) {
    const Outcome outcome = run({"check", kLinear, "--json", "--seed", "77", "--threads", "2"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    std::map<std::string, json> inputs;
    for (const json& input : object["inputs"]) inputs[input["key"].get<std::string>()] = input;
    ASSERT_TRUE(inputs.count("process.layer_thickness"));
    EXPECT_EQ(inputs["process.layer_thickness"]["origin"], "given");
    ASSERT_TRUE(inputs.count("run.seed"));
    EXPECT_THAT(inputs["run.seed"]["value"].dump(), HasSubstr("77"));
    ASSERT_EQ(object["spreads"].size(), 2u);
    for (const json& spread : object["spreads"]) {
        EXPECT_GT(spread["grains"].get<double>(), 100);
        // seconds = grain-steps / (speed per core x threads)
        const double speed = object["assumed"]["grain_steps_per_second_per_core"];
        EXPECT_NEAR(spread["seconds"].get<double>(), spread["grain_steps"].get<double>() / (2 * speed),
                    1e-9 * spread["seconds"].get<double>());
    }
    // A full-width bed is four strips wide: 1.6 mm over 0.4 mm
    const double ratio =
        object["spreads"][1]["grains"].get<double>() / object["spreads"][0]["grains"].get<double>();
    EXPECT_NEAR(ratio, 4, 0.2);
}

TEST_F(Program, check_refuses_a_dose_that_starves_the_layer) {
    const Outcome outcome = run({"check", kLinear, "--set", "design_space.dosage_factor=1.0"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("starve"));
    EXPECT_THAT(outcome.err, HasSubstr("raise dosage_factor"));
}

TEST_F(Program, materials_and_machines_parse_and_name_their_sources) {
    const json materials = json::parse(run({"materials", "--json"}).out);
    std::map<std::string, json> by_name;
    for (const json& row : materials["materials"]) {
        by_name[row["name"].get<std::string>()] = row;
        EXPECT_FALSE(row["source"].get<std::string>().empty()) << row["name"];
    }
    ASSERT_TRUE(by_name.count("IN718"));
    EXPECT_EQ(by_name["IN718"]["density_kg_m3"], 8200);  // table 1 of the paper
    const json machines = json::parse(run({"machines", "--json"}).out);
    ASSERT_FALSE(machines["machines"].empty());
    for (const json& row : machines["machines"])
        EXPECT_TRUE(fs::exists(row["file"].get<std::string>())) << row;
    EXPECT_THAT(run({"materials"}).out, HasSubstr("IN718"));
    EXPECT_EQ(run({"machines"}).code, 0);
}

TEST_F(Program, evaluate_without_out_prints_and_writes_nothing) {
    const Outcome outcome = run({"evaluate", kLinear, "--fidelity", "kinematic", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    EXPECT_EQ(object["fidelity"], "kinematic");
    EXPECT_EQ(object["profile"]["y_m"].size(), object["profile"]["gi"].size());
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Program, evaluate_with_out_writes_there_and_overwrites_only_by_force) {
    const std::vector<std::string> call = {"evaluate", kLinear, "--fidelity", "kinematic",
                                           "--quiet",  "--out", "here"};
    const Outcome first = run(call);
    ASSERT_EQ(first.code, 0) << first.err;
    EXPECT_EQ(first.err, "");
    const fs::path file = folder_ / "work" / "here" / "evaluation.json";
    EXPECT_EQ(json::parse(content(file))["fidelity"], "kinematic");
    const Outcome second = run(call);
    EXPECT_EQ(second.code, 2);
    EXPECT_THAT(second.err, HasSubstr("--force"));
    std::vector<std::string> forced = call;
    forced.push_back("--force");
    EXPECT_EQ(run(forced).code, 0);
}

TEST_F(Program, evaluate_takes_the_design_of_a_result) {
    // A partition along x at y = 0.8 mm with A at larger y: the kinematic profile is the step itself.
    std::ofstream(folder_ / "work" / "step.json")
        << R"({"design": {"partition": {"family": "polyline", "points_m": [[0, 0.0008], [0.0032, 0.0008]]}}})";
    const Outcome outcome =
        run({"evaluate", kLinear, "--fidelity", "kinematic", "--design", "step.json", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    const auto& y = object["profile"]["y_m"];
    for (std::size_t b = 0; b < y.size(); ++b) {
        const double from_step = y[b].get<double>() - 0.8e-3;
        if (std::abs(from_step) < 0.35e-3) continue;  // blurred by the lateral spread
        EXPECT_NEAR(object["profile"]["gi"][b].get<double>(), from_step > 0 ? 1 : 0, 0.01) << y[b];
    }
    std::ofstream(folder_ / "work" / "bad.json")
        << R"({"design": {"partition": {"points_m": [[0, 0]]}, "dosage_factor": -1}})";
    const Outcome bad = run({"evaluate", kLinear, "--fidelity", "kinematic", "--design", "bad.json"});
    EXPECT_EQ(bad.code, 3);
    EXPECT_THAT(bad.err, HasSubstr("at least two points"));
    EXPECT_THAT(bad.err, HasSubstr("dosage_factor"));
}

TEST_F(Program, evaluate_gives_the_composition_when_asked_for) {
    const Outcome outcome = run({"evaluate", kLinear, "--fidelity", "kinematic", "--composition",
                                 "--melt-depth", "100 um", "--melt-width", "300 um", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json object = json::parse(outcome.out);
    const json& composition = object["composition"];
    EXPECT_EQ(composition["y_m"], object["profile"]["y_m"]);
    for (std::size_t b = 0; b < composition["y_m"].size(); ++b) {
        const double gi = object["profile"]["gi"][b];
        const double mass = 7980 * gi / (7980 * gi + 8200 * (1 - gi));  // table 1 of the paper
        const json &steel = composition["alloys"]["A"]["wt"], &nickel = composition["alloys"]["B"]["wt"];
        EXPECT_NEAR(composition["wt_fe"][b].get<double>(),
                    mass * steel["Fe"].get<double>() + (1 - mass) * nickel["Fe"].get<double>(), 1e-9);
        EXPECT_NEAR(composition["wt_ni"][b].get<double>(),
                    mass * steel["Ni"].get<double>() + (1 - mass) * nickel["Ni"].get<double>(), 1e-9);
    }
    EXPECT_NEAR(composition["melt"]["dilution"].get<double>(), 0.6, 1e-12);  // 40 um of 100 um are new
    EXPECT_FALSE(json::parse(run({"evaluate", kLinear, "--fidelity", "kinematic", "--json"}).out)
                     .contains("composition"));
    EXPECT_THAT(run({"evaluate", kLinear, "--fidelity", "kinematic", "--composition"}).out,
                HasSubstr("wt% Fe"));
}

TEST_F(Program, evaluate_refuses_melt_pools_and_figures_that_cannot_be) {
    const std::vector<std::string> call = {"evaluate", kLinear, "--fidelity", "kinematic"};
    const auto with = [&](const std::vector<std::string>& more) {
        std::vector<std::string> all = call;
        all.insert(all.end(), more.begin(), more.end());
        return run(all);
    };
    EXPECT_EQ(with({"--melt-depth", "100 um"}).code, 2);
    EXPECT_THAT(with({"--melt-depth", "100", "--melt-width", "120 um"}).err,
                HasSubstr("between 1 um and 10 mm"));
    EXPECT_THAT(with({"--melt-depth", "100 parsec", "--melt-width", "120 um"}).err, HasSubstr("parsec"));
    EXPECT_THAT(with({"--melt-depth", "30 um", "--melt-width", "120 um"}).err, HasSubstr("would not bond"));
    EXPECT_EQ(with({"--melt-depth", "1e-4", "--melt-width", "1.2e-4"}).code, 0);  // bare numbers are metres
    const Outcome figures = with({"--figures"});
    EXPECT_EQ(figures.code, 2);
    EXPECT_THAT(figures.err, HasSubstr("--fidelity full"));
    // a powder of one's own without a composition
    const Outcome unknown = with(
        {"--composition", "--set", "powder.B.material={density=\"8000 kg/m3\", youngs_modulus=\"200 GPa\"}"});
    EXPECT_EQ(unknown.code, 3);
    EXPECT_THAT(unknown.err, HasSubstr("composition"));
    EXPECT_EQ(with({"--composition", "--set",
                    "powder.B.material={density=\"8000 kg/m3\", youngs_modulus=\"200 GPa\", "
                    "composition={wt={Cu=\"balance\", Cr=1.0}}}"})
                  .code,
              0);
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(Program, a_signal_ends_a_design_with_130_and_whole_files) {
    // The example packs for minutes: the signal always comes before the end.
    for (const char* signal : {"INT", "TERM"}) {
        const Outcome outcome =
            run({"design", kLinear, "--cache", "none", "--threads", "1", "--json", "--out", signal},
                std::string("timeout --preserve-status --signal=") + signal + " 2 ");
        EXPECT_EQ(outcome.code, 130) << outcome.err;
        const json object = json::parse(outcome.out);
        EXPECT_EQ(object["termination"], "interrupted");
        EXPECT_EQ(object["target_met"], false);
        EXPECT_EQ(json::parse(content(folder_ / "work" / signal / "result.json")), object);
    }
}

TEST_F(Program, a_forced_design_leaves_nothing_of_the_earlier_one_and_touches_no_other_file) {
    const fs::path out = folder_ / "work" / "out";
    fs::create_directories(out / "journal");
    for (const char* name : {"journal/000001_full.json", "particles_0007.vtkhdf"})
        std::ofstream(out / name) << "old";
    for (const char* name : {"journal/notes.txt", "thesis.tex"}) std::ofstream(out / name) << "mine";
    run({"design", kLinear, "--cache", "none", "--threads", "1", "--quiet", "--out", "out", "--force"},
        "timeout --preserve-status --signal=INT 1 ");
    EXPECT_FALSE(fs::exists(out / "journal/000001_full.json"));
    EXPECT_FALSE(fs::exists(out / "particles_0007.vtkhdf"));
    EXPECT_TRUE(fs::exists(out / "journal/notes.txt"));
    EXPECT_TRUE(fs::exists(out / "thesis.tex"));
}

}  // namespace
