// design --resume and status as a user calls them: killed at random instants and gone on with, to the same
// bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "dem/random.h"
#include "tests/cli/called_program.h"
#include "tests/cli/small_study.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

class Resume : public CalledProgram {
  protected:
    void SetUp() override {
        CalledProgram::SetUp();
        std::ofstream(study()) << kSmallStudy;
    }
    std::string study() const { return (folder_ / "small.toml").string(); }
    std::filesystem::path work() const { return folder_ / "work"; }
    std::vector<std::string> words(const std::string& out, bool resume) const {
        std::vector<std::string> words{"design",  study(),  "--out",     (work() / out).string(),
                                       "--quiet", "--json", "--threads", "1"};
        if (resume) words.push_back("--resume");
        return words;
    }
    /// Begins the program and kills it after so many seconds; true when it had ended by itself before.
    bool killed_after(double seconds, const std::vector<std::string>& arguments) const {
        const pid_t child = fork();
        if (child == 0) {
            setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
            if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(126);
            std::vector<char*> argv{const_cast<char*>(GRADWRIGHT_PROGRAM)};
            for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
            argv.push_back(nullptr);
            execv(GRADWRIGHT_PROGRAM, argv.data());
            _exit(127);
        }
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        return WIFEXITED(status);
    }
    /// The result without what hangs on the clock and the place.
    json lasting(const std::string& out) const {
        json result = json::parse(content(work() / out / "result.json"));
        strip(result);
        return result;
    }
    static void strip(json& at) {
        if (at.is_object()) {
            for (const char* key : {"seconds", "seconds_cold", "stage_seconds", "files", "provenance", "date",
                                    "from_cache", "warnings"})
                at.erase(key);
            for (auto& [key, value] : at.items()) strip(value);
        } else if (at.is_array()) {
            for (json& value : at) strip(value);
        }
    }
};

TEST_F(Resume, killed_at_random_instants_it_ends_in_the_same_bits) {
    const auto begun = std::chrono::steady_clock::now();
    const Outcome whole = run(words("whole", false));
    ASSERT_TRUE(whole.code == 0 || whole.code == 4) << whole.err;
    const double duration = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const json expected = lasting("whole");
    // GRADWRIGHT_KILLS=50 by hand; no instant hangs on how fast this machine is
    const char* wanted = std::getenv("GRADWRIGHT_KILLS");
    const int kills = wanted ? std::atoi(wanted) : 12;
    gradwright::Random random(20);
    int killed = 0, chains = 0;
    while (killed < kills) {
        const std::string out = "chain" + std::to_string(chains++);
        // a chain is given up to a quarter of the whole each time, so that most die several times
        for (int tries = 0; tries < 40 && killed < kills; ++tries) {
            if (killed_after(random.uniform() * (0.25 + 0.03 * tries) * duration, words(out, true))) break;
            ++killed;
        }
        const Outcome end = run(words(out, true));
        ASSERT_EQ(end.code, whole.code) << end.err;
        ASSERT_TRUE(lasting(out) == expected) << out << json::diff(expected, lasting(out));
    }
    RecordProperty("kills", killed);
    RecordProperty("chains", chains);
}

TEST_F(Resume, of_a_finished_run_computes_nothing_again_and_says_the_same) {
    const Outcome first = run(words("done", false));
    ASSERT_TRUE(first.code == 0 || first.code == 4) << first.err;
    const json expected = lasting("done");
    const std::size_t entries =
        std::distance(std::filesystem::directory_iterator(work() / "done" / "journal"),
                      std::filesystem::directory_iterator{});
    std::filesystem::remove(study());  // everything it needs stands in the folder
    const Outcome again =
        run({"design", "--resume", (work() / "done").string(), "--json", "--quiet", "--threads", "1"});
    EXPECT_EQ(again.code, first.code) << again.err;
    EXPECT_TRUE(lasting("done") == expected) << json::diff(expected, lasting("done"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(work() / "done" / "journal"),
                            std::filesystem::directory_iterator{}),
              entries);
    const json a = json::parse(first.out), b = json::parse(again.out);
    EXPECT_LT(b["seconds"], 0.3 * a["seconds"].get<double>());
    EXPECT_GT(b["seconds_cold"], 0.7 * a["seconds_cold"].get<double>());

    const Outcome status = run({"status", (work() / "done").string(), "--json"});
    ASSERT_EQ(status.code, 0) << status.err;
    const json told = json::parse(status.out);
    EXPECT_EQ(told["state"], "finished");
    EXPECT_EQ(told["spreads"], a["spreads"]["map"].get<int>() + a["spreads"]["full"].get<int>());
    const json schema =
        json::parse(content(std::filesystem::path(GRADWRIGHT_SOURCE_DIR) / "docs/schema/status.schema.json"));
    for (const json& name : schema["required"]) EXPECT_TRUE(told.contains(name)) << name;
    for (const json& row : told["evaluations"])
        for (const json& name : schema["properties"]["evaluations"]["items"]["required"])
            EXPECT_TRUE(row.contains(name)) << name;
}

TEST_F(Resume, refuses_a_changed_study_and_shows_the_difference) {
    ASSERT_FALSE(killed_after(0.5, words("half", false)));
    const Outcome dead = run({"status", (work() / "half").string()});
    EXPECT_EQ(dead.code, 0) << dead.err;
    EXPECT_THAT(dead.out, HasSubstr("died"));
    EXPECT_THAT(dead.out, HasSubstr("design --resume"));

    std::vector<std::string> other = words("half", true);
    other.insert(other.end(), {"--set", "process.blade_speed=\"150 mm/s\"", "--seed", "9"});
    const Outcome refused = run(other);
    EXPECT_EQ(refused.code, 3) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("process.blade_speed: 200 mm/s there, 150 mm/s now"));
    EXPECT_THAT(refused.err, HasSubstr("run.seed: 1 there, 9 now"));
    std::vector<std::string> search = words("half", true);
    search.insert(search.end(), {"--strategy", "bobyqa"});
    EXPECT_THAT(run(search).err, HasSubstr("--strategy: map there, bobyqa now"));
}

TEST_F(Resume, says_what_is_missing) {
    std::vector<std::string> nowhere{"design", study(), "--resume"};
    EXPECT_EQ(run(nowhere).code, 2);
    EXPECT_THAT(run(nowhere).err, HasSubstr("--out OUT --resume"));
    std::filesystem::create_directory(work() / "other");
    std::ofstream(work() / "other" / "letter.txt") << "x";
    const Outcome foreign = run({"design", "--resume", (work() / "other").string()});
    EXPECT_EQ(foreign.code, 6) << foreign.err;
    EXPECT_THAT(foreign.err, HasSubstr("no run.json"));
    EXPECT_EQ(run({"status", (work() / "other").string()}).code, 6);
    EXPECT_EQ(run({"design"}).code, 2);
    EXPECT_EQ(run({"design", study(), "--resume", "--force", "--out", "x"}).code, 2);
}

}  // namespace
