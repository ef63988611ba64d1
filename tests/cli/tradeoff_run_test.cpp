// gradwright tradeoff as a user calls it, on strips of a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"
#include "tests/cli/small_study.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

class TradeoffVerb : public CalledProgram {
  protected:
    Outcome call(std::vector<std::string> more) const {
        std::ofstream(folder_ / "strip.toml") << kSmallStudy;
        // slowly, so that a dozen grains are laid and not six: a level that lays none is starved
        std::vector<std::string> words{
            "tradeoff", (folder_ / "strip.toml").string(), "--quiet", "--threads", "1",
            "--set",    "process.blade_speed=\"60 mm/s\""};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
    std::filesystem::path work() const { return folder_ / "work"; }
};

TEST_F(TradeoffVerb, levels_are_held_against_the_finest_and_written_as_json_and_page) {
    const Outcome outcome =
        call({"--seeds", "2", "--level", "study", "--level", "coarse x 1.25", "--out", "out", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r, json::parse(content(work() / "out/tradeoff.json")));
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/tradeoff.schema.json");
    const json schema = json::parse(file);
    for (const json& name : schema["required"]) EXPECT_TRUE(r.contains(name)) << name;
    ASSERT_EQ(r["levels"].size(), 3u);
    for (const json& level : r["levels"]) {
        for (const json& name : schema["properties"]["levels"]["items"]["required"])
            EXPECT_TRUE(level.contains(name)) << name;
        EXPECT_EQ(level["status"], "ok") << level["reason"];
        EXPECT_EQ(level["beds"].size(), 2u);
        EXPECT_GT(level["seconds"], 0);
    }
    EXPECT_EQ(r["levels"][0]["name"], "finest");
    EXPECT_EQ(r["levels"][0]["gi_rmse"], 0);
    EXPECT_EQ(r["levels"][0]["speed_up"], 1);
    const json &study = r["levels"][1], &coarse = r["levels"][2];
    EXPECT_LT(study["steps"], r["levels"][0]["steps"]);
    EXPECT_LT(coarse["grains"], r["levels"][0]["grains"]);
    EXPECT_EQ(coarse["reductions"]["coarse_factor"], 1.25);
    EXPECT_GT(r["noise_rms"], 0);
    EXPECT_FALSE(r["recommended"].get<std::string>().empty());
    // the page's script reads it
    EXPECT_EQ(r["provenance"]["host"]["threads"], 1);
    EXPECT_TRUE(r["provenance"]["host"]["isa"].is_string());
    const std::string page = content(work() / "out/tradeoff.html");
    EXPECT_THAT(page, HasSubstr("Recommended: "));
    EXPECT_EQ(page.find("http://"), page.find("http://www.w3.org"));  // nothing is fetched
}

TEST_F(TradeoffVerb, a_plan_tells_levels_and_cost_and_writes_nothing) {
    const Outcome outcome = call({"--plan"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("coarse x 1.5"));
    EXPECT_THAT(outcome.out, HasSubstr("3 beds each"));
    EXPECT_TRUE(std::filesystem::is_empty(work()));
}

TEST_F(TradeoffVerb, a_level_that_is_not_there_and_a_single_bed_are_refused) {
    const Outcome unknown = call({"--level", "coarse x 1.6"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("did you mean 'coarse x 1.5'?"));
    EXPECT_EQ(call({"--seeds", "1"}).code, 2);
    EXPECT_EQ(call({"--around", "nothing"}).code, 2);
}

}  // namespace
