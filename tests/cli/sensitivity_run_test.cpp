// gradwright sensitivity as a user calls it, on a strip of a hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"
#include "tests/cli/small_study.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

class SensitivityVerb : public CalledProgram {
  protected:
    Outcome call(std::vector<std::string> more) const {
        std::ofstream(folder_ / "strip.toml") << kSmallStudy;
        std::vector<std::string> words{"sensitivity", (folder_ / "strip.toml").string(),
                                       "--quiet",     "--threads",
                                       "1",           "--samples",
                                       "8",           "--band-plates",
                                       "20"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
};

TEST_F(SensitivityVerb, ranks_labels_on_one_map_and_writes_what_it_says) {
    const Outcome outcome = call({"--json", "--out", "out"});
    ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r, json::parse(content(folder_ / "work/out/sensitivity.json")));
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/sensitivity.schema.json");
    const json schema = json::parse(file);
    for (const json& name : schema["required"]) EXPECT_TRUE(r.contains(name.get<std::string>())) << name;
    for (const char* list : {"ranked", "labels", "motion"})
        for (const json& row : r[list])
            for (const json& name : schema["properties"][list]["items"]["required"])
                EXPECT_TRUE(row.contains(name.get<std::string>())) << list << ": " << name;
    for (const json& row : r["budget"]["dimensions"])
        for (const json& name :
             schema["properties"]["budget"]["properties"]["dimensions"]["items"]["required"])
            EXPECT_TRUE(row.contains(name.get<std::string>())) << name;
    EXPECT_EQ(r["status"], "ok");
    EXPECT_EQ(r["spreads"]["map"], 1);
    EXPECT_EQ(r["budget"]["check_on_maps"]["plates"], 20);
    for (std::size_t k = 1; k < r["ranked"].size(); ++k)
        EXPECT_GE(r["ranked"][k - 1]["gi_rms"], r["ranked"][k]["gi_rms"]);
    EXPECT_THAT(content(folder_ / "work/out/tornado.svg"), HasSubstr("noise floor"));
    EXPECT_GE(r["budget"]["gi_error_promised"], r["budget"]["noise_floor"]);
}

TEST_F(SensitivityVerb, says_what_it_cannot_do) {
    Outcome outcome = call({"--strips", "3"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--strips 3: a line through"));
    outcome = call({"--class", "x"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("has f, m, c and v"));
    EXPECT_EQ(run({"sensitivity", "nowhere.toml"}).code, 6);
}

TEST_F(SensitivityVerb, text_names_the_dimension_that_matters_most_first) {
    const Outcome outcome = call({});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("Tolerance budget, ISO 2768-1 m"));
    EXPECT_THAT(outcome.out, HasSubstr("What moves grains was not varied: --strips "));
    EXPECT_THAT(outcome.out, HasSubstr("plate y"));
}

}  // namespace
