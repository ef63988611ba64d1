// gradwright compare as a user calls it, on strips of a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"
#include "tests/cli/small_study.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

class CompareVerb : public CalledProgram {
  protected:
    Outcome call(std::vector<std::string> more) const {
        std::ofstream(folder_ / "strip.toml") << kSmallStudy;
        std::vector<std::string> words{"compare", (folder_ / "strip.toml").string(), "--quiet", "--threads",
                                       "1"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
    std::filesystem::path work() const { return folder_ / "work"; }
};

TEST_F(CompareVerb, rows_are_written_as_the_schema_says_and_each_design_has_its_folder) {
    const Outcome outcome = call({"--strategies", "map,bobyqa", "--fidelity", "map", "--evaluations", "8",
                                  "--budget", "2", "--confirmations", "1", "--out", "out", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r, json::parse(content(work() / "out/comparison.json")));
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/compare.schema.json");
    const json schema = json::parse(file);
    for (const json& name : schema["required"]) EXPECT_TRUE(r.contains(name)) << name;
    ASSERT_EQ(r["strategies"].size(), 2u);
    for (const json& row : r["strategies"]) {
        for (const json& name : schema["properties"]["strategies"]["items"]["required"])
            EXPECT_TRUE(row.contains(name)) << name;
        EXPECT_EQ(row["spreads"], 2) << row;
        EXPECT_TRUE(row["confirmed_misfit"].is_number()) << row;
        EXPECT_GT(row["noise_floor"], 0);
        EXPECT_EQ(row["confirmations"], 1);
        const std::string folder = "out/" + row["name"].get<std::string>();
        EXPECT_TRUE(std::filesystem::exists(work() / folder / "result.json"));
        EXPECT_TRUE(std::filesystem::exists(work() / folder / "report.html"));
        EXPECT_FALSE(std::filesystem::is_empty(work() / folder / "judgement"));
    }
    EXPECT_EQ(r["strategies"][0]["name"], "map");
    EXPECT_THAT(r["strategies"][1]["native"].get<std::string>(), HasSubstr("LN_BOBYQA"));
    // for people, from the same beds
    const Outcome table = call({"--strategies", "map", "--budget", "2", "--confirmations", "1"});
    EXPECT_EQ(table.code, 0) << table.err;
    EXPECT_THAT(table.out, HasSubstr("strategy"));
    EXPECT_THAT(table.out, HasSubstr("judged on\n1 unseen bed "));
}

TEST_F(CompareVerb, what_cannot_be_compared_is_refused_before_anything_is_written) {
    const Outcome unknown = call({"--strategies", "map,bobyca"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("did you mean 'bobyqa'?"));
    EXPECT_THAT(call({"--strategies", "map,map"}).err, HasSubstr("named twice"));
    EXPECT_EQ(call({"--budget", "1"}).code, 2);
    EXPECT_EQ(call({"--fidelity", "lammps"}).code, 2);
    const Outcome single = call({"--set", "run.max_spreads=1"});
    EXPECT_EQ(single.code, 2);
    EXPECT_THAT(single.err, HasSubstr("--budget"));
    EXPECT_EQ(run({"compare", folder_.string()}).code, 2);  // a single folder
    EXPECT_EQ(run({"compare", folder_.string(), (folder_ / "strip.toml").string()}).code, 2);
    EXPECT_EQ(run({"compare", "a", "b"}).code, 2);
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(CompareVerb, finished_designs_stand_side_by_side_with_the_inputs_that_differ) {
    std::ofstream(folder_ / "strip.toml") << kSmallStudy;
    const std::string study = (folder_ / "strip.toml").string();
    const auto design = [&](const std::string& out, const std::string& dose) {
        return run({"design", study, "--quiet", "--threads", "1", "--budget", "2", "--no-spec", "--set",
                    "design_space.dosage_factor=" + dose, "--out", out})
            .code;
    };
    ASSERT_NE(design("three", "3.0"), 5);
    ASSERT_NE(design("deep/four", "4.0"), 5);
    const Outcome outcome = run({"compare", "three", "deep/four/", "--json", "--out", "both"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r, json::parse(content(work() / "both/comparison.json")));
    EXPECT_THAT(content(work() / "both/comparison.html"), HasSubstr("designs meet their target"));
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/designs.schema.json");
    const json schema = json::parse(file);
    for (const json& name : schema["required"]) EXPECT_TRUE(r.contains(name)) << name;
    for (const json& name : schema["properties"]["designs"]["items"]["required"])
        for (const json& row : r["designs"]) EXPECT_TRUE(row.contains(name)) << name;
    EXPECT_TRUE(r["same_target"]);
    ASSERT_EQ(r["designs"].size(), 2u);
    for (const auto& [k, folder] : {std::pair{0, "three"}, std::pair{1, "deep/four"}}) {
        const json own = json::parse(content(work() / folder / "result.json"));
        for (const char* key : {"verdict", "misfit", "profile", "design", "spreads"})
            EXPECT_EQ(r["designs"][std::size_t(k)][key], own[key]) << key;
    }
    EXPECT_EQ(r["designs"][1]["name"], "four");
    std::vector<std::string> keys;
    for (const json& one : r["differences"]) keys.push_back(one["key"]);
    EXPECT_THAT(keys, testing::Contains("design_space.dosage_factor"));
    EXPECT_THAT(keys, testing::Not(testing::Contains("process.blade_speed")));
    const Outcome table = run({"compare", "three", "deep/four"});
    EXPECT_EQ(table.code, 0);
    EXPECT_THAT(table.out, HasSubstr("design_space.dosage_factor"));
    // what is wrong with the folders is said of all of them at once
    const Outcome wrong = run({"compare", "three", "deep", "."});
    EXPECT_EQ(wrong.code, 6);
    EXPECT_THAT(wrong.err, testing::AllOf(HasSubstr("'deep' has no"), HasSubstr("'.' has no")));
    EXPECT_EQ(run({"compare", "three", "deep/four", "--budget", "3"}).code, 2);
    std::ofstream(work() / "three/report_data.json") << "{";
    EXPECT_EQ(run({"compare", "three", "deep/four"}).code, 3);
}

}  // namespace
