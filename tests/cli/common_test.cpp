// The parts of the front door that can be called without the program: output folders, durations, progress,
// estimates.
#include "cli/common.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cli/progress.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;

/// An empty folder that is the working folder while the test lives.
class WorkingFolder : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "gradwright_cli_XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
        before_ = fs::current_path();
        fs::current_path(folder_);
    }
    void TearDown() override {
        fs::current_path(before_);
        fs::remove_all(folder_);
    }
    fs::path folder_, before_;
};

using OutFolder = WorkingFolder;

TEST_F(OutFolder, without_out_the_runs_are_counted_up_from_one) {
    const CommonOptions options;
    EXPECT_EQ(make_out_folder(options, "coupon"), "runs/coupon/1");
    EXPECT_EQ(make_out_folder(options, "coupon"), "runs/coupon/2");
    EXPECT_EQ(make_out_folder(options, "other"), "runs/other/1");
    EXPECT_TRUE(fs::is_directory("runs/coupon/2"));
    EXPECT_EQ(make_out_folder(options, "linear coupon"), "runs/linear_coupon/1");
    EXPECT_EQ(make_out_folder(options, "../../etc"), "runs/study.._.._etc/1");
}

TEST_F(OutFolder, a_folder_with_something_in_it_is_refused_without_force) {
    CommonOptions options;
    options.out = "results";
    EXPECT_EQ(make_out_folder(options, "coupon"), "results");
    EXPECT_EQ(make_out_folder(options, "coupon"), "results");  // still empty
    std::ofstream("results/precious.txt") << "kept";
    try {
        make_out_folder(options, "coupon");
        FAIL() << "a folder with a file in it was accepted";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.code, ExitCode::usage);
        EXPECT_NE(failure.mend.find("--force"), std::string::npos);
    }
    options.force = true;
    EXPECT_EQ(make_out_folder(options, "coupon"), "results");
    EXPECT_TRUE(fs::exists("results/precious.txt"));
}

TEST_F(OutFolder, an_out_that_is_a_file_is_an_io_failure) {
    std::ofstream("results") << "a file";
    CommonOptions options;
    options.out = "results";
    try {
        make_out_folder(options, "coupon");
        FAIL() << "a file was accepted as a folder";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.code, ExitCode::io);
    }
}

TEST_F(OutFolder, the_cache_lies_under_xdg_cache_home_unless_it_is_named_or_switched_off) {
    setenv("XDG_CACHE_HOME", (folder_ / "xdg").c_str(), 1);
    CommonOptions options;
    EXPECT_EQ(cache_folder(options), (folder_ / "xdg" / "gradwright").string());
    EXPECT_TRUE(fs::is_directory(folder_ / "xdg" / "gradwright"));
    options.cache = (folder_ / "mine").string();
    EXPECT_EQ(cache_folder(options), options.cache);
    options.cache = "none";
    EXPECT_EQ(cache_folder(options), "");
    unsetenv("XDG_CACHE_HOME");
}

TEST(Duration, is_written_in_the_units_that_people_say) {
    EXPECT_EQ(duration_text(3.14), "3.1 s");
    EXPECT_EQ(duration_text(59.4), "59 s");
    EXPECT_EQ(duration_text(250), "4 min 10 s");
    EXPECT_EQ(duration_text(2 * 3600 + 5 * 60), "2 h 5 min");
    EXPECT_EQ(duration_text(10 * 86400), "10 days");
    EXPECT_EQ(duration_text(-1), "unknown");
}

TEST(TimeLeft, follows_from_the_share_done_since_the_stage_began) {
    // a quarter in 10 s leaves three quarters: 30 s
    EXPECT_DOUBLE_EQ(time_left(10, 0, 0.25), 30);
    // resumed at one half, half of the rest in 10 s: 10 s more
    EXPECT_DOUBLE_EQ(time_left(10, 0.5, 0.75), 10);
    EXPECT_DOUBLE_EQ(time_left(10, 0, 1), 0);
    EXPECT_LT(time_left(10, 0.5, 0.5), 0);
}

std::string written_by(ProgressLine::Mode mode) {
    std::FILE* stream = std::tmpfile();
    {
        ProgressLine progress(mode, stream);
        progress.update("spread", 0.25);
        progress.update("spread", 1.5);
    }
    std::rewind(stream);
    char text[4096] = {};
    const std::size_t size = std::fread(text, 1, sizeof text - 1, stream);
    std::fclose(stream);
    return std::string(text, size);
}

TEST(Progress, a_quiet_run_prints_nothing) {
    EXPECT_EQ(written_by(ProgressLine::Mode::silent), "");
}

TEST(Progress, off_a_terminal_nothing_is_printed_before_half_a_minute) {
    EXPECT_EQ(written_by(ProgressLine::Mode::lines), "");
}

TEST(Progress, on_a_terminal_the_bar_names_stage_and_share_and_leaves_a_clean_line) {
    const std::string text = written_by(ProgressLine::Mode::bar);
    EXPECT_NE(text.find("spread"), std::string::npos);
    EXPECT_NE(text.find(" 25 %"), std::string::npos);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K");
}

TEST(RunStatus, ends_in_the_exit_code_of_the_interface) {
    RunHealth health;
    health.status = "ok";
    EXPECT_EQ(exit_code_of(health), ExitCode::met);
    health.status = "interrupted";
    EXPECT_EQ(exit_code_of(health), ExitCode::interrupted);
    for (const char* status : {"diverged", "unstable_step", "jammed", "does_not_flow", "starved",
                               "not_settled", "overlap", "not_run"}) {
        health.status = status;
        EXPECT_EQ(exit_code_of(health), ExitCode::simulation_failed) << status;
    }
}

TEST(ErrorJson, carries_code_kind_and_every_problem) {
    const auto object = error_json(ExitCode::bad_input, "2 problems in the input", "",
                                   {{"a.toml", 3, "process.gap", "x", "is a length", "write 100 um"}, {}});
    EXPECT_EQ(object["error"]["code"], 3);
    EXPECT_EQ(object["error"]["kind"], "bad_input");
    ASSERT_EQ(object["error"]["problems"].size(), 2u);
    EXPECT_EQ(object["error"]["problems"][0]["line"], 3);
    EXPECT_EQ(object["error"]["problems"][0]["mend"], "write 100 um");
    EXPECT_TRUE(object["error"]["problems"][1]["line"].is_null());
}

}  // namespace
}  // namespace gradwright::cli
