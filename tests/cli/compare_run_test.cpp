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
    const Outcome folder = run({"compare", folder_.string()});
    EXPECT_EQ(folder.code, 2);
    EXPECT_THAT(folder.err, HasSubstr("is a folder: finished designs cannot be laid side by side yet"));
    EXPECT_EQ(run({"compare", "a", "b"}).code, 2);
    EXPECT_TRUE(wrote_nothing());
}

}  // namespace
