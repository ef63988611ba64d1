// gradwright reach as a user calls it, on a strip of a hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"
#include "tests/cli/small_study.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Of so few grains only generous tolerances can be told.
const std::string kStudy = kSmallStudy + "[objective]\ntolerance = 0.9\nx_drift_tolerance = 1.9\n";

class ReachVerb : public CalledProgram {
  protected:
    Outcome call(std::vector<std::string> more) const {
        std::ofstream(folder_ / "strip.toml") << kStudy;
        std::vector<std::string> words{
            "reach", (folder_ / "strip.toml").string(), "--quiet", "--threads", "1", "--grid", "3"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
};

void has_all(const json& object, const json& schema, const std::string& where) {
    for (const json& name : schema["required"])
        EXPECT_TRUE(object.contains(name.get<std::string>())) << where << ": " << name;
}

TEST_F(ReachVerb, limits_are_told_as_json_and_written_with_out_and_the_design_can_be_evaluated) {
    const Outcome outcome = call({"--json", "--out", "out"});
    ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r, json::parse(content(folder_ / "work/out/reach.json")));
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/reach.schema.json");
    const json schema = json::parse(file);
    has_all(r, schema, "reach");
    has_all(r["own"], schema["properties"]["own"], "own");
    for (const char* name : {"ramp", "shift", "sigmoid"}) {
        const json& scan = schema["properties"][name];
        has_all(r[name], scan, name);
        ASSERT_FALSE(r[name]["points"].empty()) << name;
        for (const json& point : r[name]["points"]) {
            has_all(point, scan["properties"]["points"]["items"], name);
            has_all(point["misfit"], scan["properties"]["points"]["items"]["properties"]["misfit"], name);
        }
    }
    EXPECT_EQ(r["status"], "ok");
    EXPECT_EQ(r["reachable"], true);
    EXPECT_EQ(r["binds"]["limit"], "none");
    EXPECT_DOUBLE_EQ(r["ramp"]["resolution_m"].get<double>(), 12.5e-6);  // a quarter of a bin
    EXPECT_LE(r["ramp"]["low_m"], r["ramp"]["high_m"]);
    EXPECT_EQ(r["map"]["spreads"], 1);
    // the map is kept, and the design is one that `evaluate` takes
    EXPECT_FALSE(std::filesystem::is_empty(folder_ / "work/out/journal"));
    const Outcome evaluated = run({"evaluate", (folder_ / "strip.toml").string(), "--fidelity", "kinematic",
                                   "--design", "out/reach.json", "--json"});
    ASSERT_EQ(evaluated.code, 0) << evaluated.err;
    EXPECT_EQ(json::parse(evaluated.out)["design"]["partition"]["points_m"],
              r["design"]["partition"]["points_m"]);
}

TEST_F(ReachVerb, a_target_out_of_reach_ends_with_4_and_names_the_limit) {
    const Outcome outcome = call({"--set", "objective.tolerance=0.04"});
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("NOT reachable"));
    EXPECT_THAT(outcome.out, HasSubstr("What binds is the "));
    EXPECT_THAT(outcome.out, HasSubstr("full width of a linear ramp [mm]"));
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(ReachVerb, what_makes_no_sense_is_refused_before_anything_is_spread) {
    const Outcome fixed = call({"--set",
                                "design_space.partition={family=\"straight\", angle=\"5 deg\", "
                                "offset=\"0 mm\"}"});
    EXPECT_EQ(fixed.code, 3);
    EXPECT_THAT(fixed.err, HasSubstr("design_space.partition: is fixed"));
    EXPECT_EQ(call({"--grid", "2"}).code, 2);
    const Outcome bare = call({"--resolution", "50"});
    EXPECT_EQ(bare.code, 2);
    EXPECT_THAT(bare.err, HasSubstr("--resolution '50'"));
    EXPECT_EQ(call({"--resolution", "0.1 um"}).code, 2);
    EXPECT_EQ(call({"--resolution", "4 mm"}).code, 2);
}

}  // namespace
