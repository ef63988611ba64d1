// crosscheck and evaluate with LAMMPS at work, on a scene of some hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/cli/called_program.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// A coupon of a third in length and width, of the physics of the shipped examples. The part begins one
/// flight of a grain, v sqrt(2 gap/g) = 0.3 mm, behind the platform's edge; bins of 50 um, so that some lie
/// outside the side margins.
const char* const kTinyStudy = GRADWRIGHT_SOURCE_DIR "/docs/crosscheck.toml";

class LammpsAtWork : public CalledProgram {
  protected:
    void SetUp() override {
        CalledProgram::SetUp();
        fs::copy_file(kTinyStudy, folder_ / "work" / "tiny.toml");
    }
};

TEST_F(LammpsAtWork, crosscheck_gives_every_field_and_keeps_the_decks) {
    const Outcome outcome = run({"crosscheck", "lammps", "tiny.toml", "--seeds", "2", "--threads", "1",
                                 "--ranks", "2", "--out", "out", "--json"});
    // 4: few grains and two beds may differ by more than the noise allows; the forces may not
    EXPECT_TRUE(outcome.code == 0 || outcome.code == 4) << outcome.code << outcome.err;
    const json result = json::parse(outcome.out);
    EXPECT_EQ(outcome.code == 0, result["forces_agree"] && result["gradation_agrees"]);
    EXPECT_EQ(result["status"], "ok");
    EXPECT_TRUE(result["forces_agree"]);
    EXPECT_LE(result["two_body_max_relative_error"].get<double>(), 1e-9);
    for (const char* engine : {"gradwright", "lammps"}) {
        const json& one = result["engines"][engine];
        EXPECT_FALSE(one["version"].get<std::string>().empty());
        EXPECT_GT(one["seconds"].get<double>(), 0);
        EXPECT_GT(one["grain_steps_per_second"].get<double>(), 0);
        EXPECT_EQ(one["ranks_or_threads"], std::string(engine) == "lammps" ? 2 : 1);
    }
    EXPECT_THAT(result["engines"]["lammps"]["version"].get<std::string>(), HasSubstr("20"));
    EXPECT_NEAR(result["speed_ratio"].get<double>(),
                result["engines"]["lammps"]["seconds"].get<double>() /
                    result["engines"]["gradwright"]["seconds"].get<double>(),
                1e-12);
    EXPECT_GT(result["gi_rmse"].get<double>(), 0);
    EXPECT_GT(result["noise_rms"].get<double>(), 0);
    EXPECT_FALSE(result["differences"].empty());
    ASSERT_EQ(result["beds"].size(), 2u);
    for (const json& bed : result["beds"]) {
        const json &ours = bed["gradwright"], &theirs = bed["lammps"];
        EXPECT_EQ(ours["grains"], theirs["grains"]);  // the same bed
        // The same process: a layer of the same amount, within what chance does to some tens of grains.
        EXPECT_GT(theirs["laid"].get<int>(), 10);
        EXPECT_LT(theirs["packing_fraction"].get<double>(), 0.6);
        const double ratio =
            theirs["capture_fraction"].get<double>() / ours["capture_fraction"].get<double>();
        EXPECT_GT(ratio, 0.5);
        EXPECT_LT(ratio, 2.0);
        // The blade went the same way in both, but for the last heap's length.
        EXPECT_NEAR(theirs["steps"].get<double>() / ours["steps"].get<double>(), 1, 0.25);
        EXPECT_EQ(ours["heap"]["blade_x_m"], theirs["heap"]["blade_x_m"]);
        EXPECT_GT(theirs["heap"]["solid_section_m2"].get<double>(), 0);
        EXPECT_EQ(theirs["warnings"].dump().find("went through"), std::string::npos);
    }
    for (const json& file : result["files"])
        EXPECT_TRUE(fs::is_regular_file(folder_ / "work" / "out" / file.get<std::string>())) << file;
}

TEST_F(LammpsAtWork, speed_times_both_engines_on_the_same_bed_at_rest_and_in_flow) {
    const Outcome outcome =
        run({"crosscheck", "lammps", "tiny.toml", "--speed", "--steps", "50", "--out", "out", "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    ASSERT_EQ(result["speed"].size(), 2u);
    for (const json& one : result["speed"]) {
        EXPECT_GT(one["grains"].get<int>(), 100);
        double best = 0;
        for (const json& speed : one["lammps_by_skin"]) best = std::max(best, speed.get<double>());
        EXPECT_EQ(one["lammps_grain_steps_per_second"].get<double>(), best);
        EXPECT_NEAR(one["speed_ratio"].get<double>(),
                    one["gradwright_grain_steps_per_second"].get<double>() / best, 1e-9);
    }
    EXPECT_EQ(result["threads"], 1);
    EXPECT_EQ(result["ranks"], 1);
    // what flows in ours flows in LAMMPS from the first step on: its data file holds the velocities
    for (const char* state : {"settled", "flowing"}) {
        std::ifstream data(folder_ / "work" / "out" / state / "bed.data");
        std::string line;
        while (std::getline(data, line) && line != "Velocities") {
        }
        double id = 0, vx = 0, vy = 0, rest = 0, sum = 0;
        long moving = 0;
        while (data >> id >> vx >> vy >> rest >> rest >> rest >> rest)
            if (vy != 0) sum += vy, ++moving;
        if (std::string(state) == "settled") {
            EXPECT_EQ(moving, 0);
        } else {
            ASSERT_GT(moving, 100);
            EXPECT_GT(sum / double(moving), 0.04);  // the blade's speed is 0.05 m/s
        }
    }
}

TEST_F(LammpsAtWork, evaluate_at_fidelity_lammps_gives_the_fields_of_a_full_spread) {
    const Outcome outcome =
        run({"evaluate", "tiny.toml", "--fidelity", "lammps", "--threads", "1", "--out", "out", "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    EXPECT_EQ(result["fidelity"], "lammps");
    EXPECT_EQ(result["status"], "ok");
    EXPECT_GT(result["capture_fraction"].get<double>(), 0.01);
    EXPECT_LT(result["capture_fraction"].get<double>(), 1);
    EXPECT_GT(result["grain_steps"].get<double>(), 0);
    EXPECT_TRUE(fs::is_regular_file(folder_ / "work" / "out" / "lammps" / "spread-1" / "in.spread"));
    // A on one side and B on the other: a rising gradation, whatever the noise. Only the bins that count: the
    // first and the last one meet across the periodic seam.
    std::vector<double> gi;
    const json& weight = result["profile"]["weight"];
    for (std::size_t b = 0; b < weight.size(); ++b)
        if (weight[b].get<double>() > 0) gi.push_back(result["profile"]["gi"][b].get<double>());
    ASSERT_GE(gi.size(), 3u);
    EXPECT_GT(gi.back() - gi.front(), 0.3);
}

}  // namespace
