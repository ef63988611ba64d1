// crosscheck as a user meets it without LAMMPS: exit codes, the line that mends it, and nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"

namespace {

using testing::HasSubstr;

const std::string kStudy = std::string(GRADWRIGHT_SOURCE_DIR) + "/examples/01_linear_coupon.toml";
const char* const kNoPath = "env PATH=/nowhere ";

TEST_F(CalledProgram, crosscheck_without_lammps_is_told_how_to_install_it) {
    const Outcome outcome = run({"crosscheck", "lammps", kStudy, "--out", "out", "--json"}, kNoPath);
    EXPECT_EQ(outcome.code, 7) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("apt-get install --no-install-recommends lammps"));
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["error"]["code"], 7);
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(CalledProgram, evaluate_at_fidelity_lammps_without_it_is_the_same_failure) {
    const Outcome outcome = run({"evaluate", kStudy, "--fidelity", "lammps"}, kNoPath);
    EXPECT_EQ(outcome.code, 7) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("apt-get install --no-install-recommends lammps"));
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(CalledProgram, crosscheck_names_the_engines_it_has) {
    const Outcome outcome = run({"crosscheck", "lamps", kStudy});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("did you mean 'lammps'"));
    EXPECT_EQ(run({"crosscheck", "lammps"}).code, 2);
    EXPECT_EQ(run({"crosscheck", "lammps", kStudy, "--seeds", "1"}).code, 2);  // no noise from one bed
    EXPECT_EQ(run({"crosscheck", "lammps", "absent.toml"}, kNoPath).code, 6);
}

TEST_F(CalledProgram, a_search_on_lammps_is_refused) {
    const Outcome outcome = run({"design", kStudy, "--strategy", "bobyqa", "--fidelity", "lammps"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("crosscheck lammps"));
    EXPECT_TRUE(wrote_nothing());
}

}  // namespace
