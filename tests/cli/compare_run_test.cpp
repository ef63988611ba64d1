// gradwright compare as a user calls it, on strips of a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A strip of two hundred soft grains: seconds a spread.
const std::string kStudy = R"([study]
name = "a strip of seconds"
[machine]
dispenser = { length = "0.35 mm", width = "0.5 mm", depth = "1 mm" }
platform  = { length = "0.35 mm" }
land = "0.1 mm"
second_land = "0.3 mm"
blade = { thickness = "0.1 mm" }
[process]
blade_speed = "200 mm/s"
allow_starved = true
[powder.A]
material = "SS17-4PH"
size = { D10 = "32 um", D50 = "40 um", D90 = "50 um", cut_low = "30 um", cut_high = "55 um" }
[powder.B]
material = "IN718"
[interaction]
work_of_adhesion = "0 J/m2"
[target]
shape = "linear"
from = { y = "0.15 mm", gi = 0.0 }
to   = { y = "0.35 mm", gi = 1.0 }
footprint = { x = ["0.05 mm", "0.35 mm"] }
bin_width = "50 um"
[design_space]
partition = { family = "straight" }
dosage_factor = 3.0
[numerics]
softening = 4e-5
bed_depth = "40 um"
reductions = ["strip_map"]
strip_width = "0.23 mm"
)";

class CompareVerb : public CalledProgram {
  protected:
    Outcome call(std::vector<std::string> more) const {
        std::ofstream(folder_ / "strip.toml") << kStudy;
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
