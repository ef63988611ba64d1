// The built program called as a user calls it, in an empty working folder with a cache of its own.
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

struct Outcome {
    int code = -1;
    std::string out, err;
};

class CalledProgram : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "gradwright call XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
        std::filesystem::create_directory(folder_ / "work");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static std::string quoted(const std::string& text) {
        std::string result = "'";
        for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return result + "'";
    }
    static std::string content(const std::filesystem::path& file) {
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        return text.str();
    }
    /// `before`: words in front of the program, such as "env PATH=/nowhere ".
    Outcome run(const std::vector<std::string>& arguments, const std::string& before = "") const {
        std::string command = "cd " + quoted((folder_ / "work").string()) +
                              " && XDG_CACHE_HOME=" + quoted((folder_ / "cache").string()) + " " + before +
                              quoted(GRADWRIGHT_PROGRAM);
        for (const std::string& argument : arguments) command += " " + quoted(argument);
        command += " >" + quoted((folder_ / "out").string()) + " 2>" + quoted((folder_ / "err").string()) +
                   " </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(folder_ / "out"),
                content(folder_ / "err")};
    }
    /// Nothing lies in the working folder.
    bool wrote_nothing() const { return std::filesystem::is_empty(folder_ / "work"); }

    std::filesystem::path folder_;
};
