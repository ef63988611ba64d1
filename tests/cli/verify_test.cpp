// gradwright verify: what it says, and its exit code, for a sound and for a broken law.
#include "cli/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
    int code = -1;
    std::string out, err;
};

Outcome verify(const std::string& arguments) {
    std::string pattern = (fs::temp_directory_path() / "gradwright-verify-XXXXXX").string();
    if (!mkdtemp(pattern.data())) return {};
    const fs::path folder = pattern;
    const int status =
        std::system((std::string(GRADWRIGHT_PROGRAM) + " verify " + arguments + " >" +
                     (folder / "out").string() + " 2>" + (folder / "err").string() + " </dev/null")
                        .c_str());
    Outcome outcome;
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    for (const auto& [name, text] : {std::pair{"out", &outcome.out}, std::pair{"err", &outcome.err}}) {
        std::ostringstream all;
        all << std::ifstream(folder / name).rdbuf();
        *text = all.str();
    }
    fs::remove_all(folder);
    return outcome;
}

TEST(Verify, a_sound_law_is_green_and_the_exit_code_zero) {
    const Outcome outcome = verify("--only V1 --law double --json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto result = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(result["passed"], 18);
    EXPECT_EQ(result["failed"], 0);
    ASSERT_EQ(result["cases"].size(), 18u);
    for (const auto& one : result["cases"]) {
        EXPECT_EQ(one["id"], "V1");
        EXPECT_TRUE(one["pass"]);
        EXPECT_LE(one["error"].get<double>(), one["tolerance"].get<double>());
        for (const char* key : {"name", "quantity", "expected", "obtained", "source"})
            EXPECT_TRUE(one.contains(key));
    }
}

TEST(Verify, a_broken_law_is_red_by_name_and_the_exit_code_is_not_zero) {
    const Outcome outcome = verify("--only V1 --only V7 --law double --mutate lever_arm --quiet");
    EXPECT_EQ(outcome.code, 4);
    EXPECT_THAT(outcome.out, HasSubstr("RED"));
    EXPECT_THAT(outcome.out, HasSubstr("instant of rolling"));
    EXPECT_THAT(outcome.out, HasSubstr("red, in V7"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("test 1, glass")));
    EXPECT_THAT(outcome.out, HasSubstr("Every rung run that must see it does."));
}

TEST(Verify, a_rung_or_fault_that_is_not_there_is_a_usage_error_with_a_hint) {
    const Outcome rung = verify("--only V33");
    EXPECT_EQ(rung.code, 2);
    EXPECT_THAT(rung.err, HasSubstr("V16"));
    const Outcome fault = verify("--mutate dampling");
    EXPECT_EQ(fault.code, 2);
    EXPECT_THAT(fault.err, HasSubstr("did you mean 'damping'?"));
    const Outcome page = verify("--docs somewhere --only V1");
    EXPECT_EQ(page.code, 2);
    EXPECT_FALSE(fs::exists("somewhere"));
}

VerificationCase a_case(const std::string& id, bool pass) {
    VerificationCase c;
    c.id = id;
    c.name = "name";
    c.pass = pass;
    return c;
}

TEST(Verify, a_fault_that_goes_unseen_is_told) {
    Mutation fault;
    fault.name = "history";
    fault.red = {"V3", "V7"};
    const std::vector<VerificationRun> runs = {
        {Precision::double_law, {a_case("V3", false), a_case("V7", true)}}};
    const std::string text = verify_summary(runs, &fault);
    EXPECT_THAT(text, HasSubstr("1 of 2 cases pass; 1 red, in V3"));
    EXPECT_THAT(text, HasSubstr("UNSEEN by V7"));
}

TEST(Verify, a_number_that_is_none_is_null_in_json) {
    VerificationCase c = a_case("V2", false);
    c.obtained = std::numeric_limits<double>::quiet_NaN();
    const auto result = verify_json({{Precision::single_law, {c}}}, "damping");
    EXPECT_TRUE(result["cases"][0]["obtained"].is_null());
    EXPECT_EQ(result["cases"][0]["law"], "single");
    EXPECT_EQ(result["mutation"], "damping");
    EXPECT_EQ(result["failed"], 1);
}

}  // namespace
}  // namespace gradwright::cli
