// The verbs bulk and limits as a user calls them, on a few hundred grains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/called_program.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string kStudy = std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/bulk.toml";

class BulkVerbs : public CalledProgram {};

TEST_F(BulkVerbs, bulk_gives_packing_and_slope_and_says_when_there_is_no_slope) {
    const std::vector<std::string> box{"--length", "0.6 mm", "--height", "0.26 mm", "--quiet"};
    const auto call = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"bulk", kStudy};
        words.insert(words.end(), box.begin(), box.end());
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    };
    const Outcome dry = call({"--json", "--set", "interaction.work_of_adhesion=\"0 J/m2\""});
    ASSERT_EQ(dry.code, 0) << dry.err;
    const json r = json::parse(dry.out);
    EXPECT_EQ(r["status"], "ok");
    EXPECT_GT(r["packing_fraction"], 0.45);
    EXPECT_EQ(r["bond_number"], 0);
    EXPECT_GT(r["angle_of_repose_deg"], 15);
    EXPECT_LT(r["angle_of_repose_deg"], 50);
    EXPECT_GT(r["angle_standard_error_deg"], 0);
    // adhesive: nothing slides, nothing is fitted, and the text says so instead of a nan
    const Outcome sticky = call({});
    ASSERT_EQ(sticky.code, 0) << sticky.err;
    EXPECT_THAT(sticky.out, HasSubstr("stands upright"));
    EXPECT_THAT(sticky.out, testing::Not(HasSubstr("nan")));
    EXPECT_TRUE(wrote_nothing());
}

TEST_F(BulkVerbs, bulk_refuses_a_box_too_small_and_a_length_it_cannot_read) {
    EXPECT_EQ(run({"bulk", kStudy, "--width", "0.1 mm"}).code, 2);
    const Outcome unread = run({"bulk", kStudy, "--height", "tall"});
    EXPECT_EQ(unread.code, 2);
    EXPECT_THAT(unread.err, HasSubstr("--height"));
}

TEST_F(BulkVerbs, limits_runs_the_named_cases_and_refuses_others) {
    const Outcome one = run({"limits", "--only", "grains-1", "--json", "--quiet"});
    const Outcome unknown = run({"limits", "--only", "no-such-case"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("no-such-case"));
    ASSERT_EQ(one.code, 0) << one.err;
    const json r = json::parse(one.out);
    ASSERT_EQ(r["cases"].size(), 1u);
    EXPECT_TRUE(r["cases"][0]["pass"]);
}

}  // namespace
