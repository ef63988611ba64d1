// The installed library: put under a temporary prefix, moved away from it, found by a program of one's own in
// a clean folder, built and run; and the installed program, which finds its data beside itself.
#include <gmock/gmock.h>

#include <cmath>

#include "called_program.h"
#include "small_study.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Library : public CalledProgram {
  protected:
    /// A shell command in the test's folder; its output is the failure's text.
    void shell(const std::string& command) const {
        const std::string log = (folder_ / "log").string();
        ASSERT_EQ(std::system(("cd " + quoted(folder_.string()) + " && { " + command + "; } >" + quoted(log) +
                               " 2>&1")
                                  .c_str()),
                  0)
            << command << "\n"
            << content(log);
    }
    std::string said() const { return content(folder_ / "log"); }
};

TEST_F(Library, installed_and_moved_is_found_built_against_and_run) {
    const fs::path moved = folder_ / "moved here";
    shell("cmake --install " + quoted(GRADWRIGHT_BINARY_DIR) + " --prefix " +
          quoted((folder_ / "first").string()));
    fs::rename(folder_ / "first", moved);
    shell("cp -r " + quoted(std::string(GRADWRIGHT_SOURCE_DIR) + "/examples/library") + " source");
    shell("cmake -G Ninja -S source -B build -DCMAKE_PREFIX_PATH=" + quoted(moved.string()) +
          " -DCMAKE_BUILD_TYPE=Release");
    shell("cmake --build build");
    std::ofstream(folder_ / "small.toml") << kSmallStudy;
    shell("OMP_NUM_THREADS=1 ./build/saw_cut small.toml 20");
    std::istringstream lines(said());
    std::string line;
    std::getline(lines, line);
    EXPECT_THAT(line, HasSubstr(" grains, "));
    std::getline(lines, line);
    // Ten bins of 0.05 mm over 0.5 mm. A lies above a rising cut: each laid grain is B up to some y and A
    // from there on, so that GI never falls, in the strip as in the picture. Where it rises is chance, with
    // so few.
    std::vector<std::array<double, 4>> rows;
    for (std::array<double, 4> row; lines >> row[0] >> row[1] >> row[2] >> row[3];) rows.push_back(row);
    ASSERT_EQ(rows.size(), 10u) << said();
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(rows[i][0], 0.05 * (i + 0.5), 1e-3);
    for (const int column : {1, 3}) {
        for (std::size_t i = 1; i < rows.size(); ++i)
            EXPECT_GE(rows[i][column], rows[i - 1][column]) << said();
        EXPECT_GT(rows[9][column] - rows[0][column], 0.3) << said();
    }
    // the study's mistakes arrive as problems
    shell("./build/saw_cut source/CMakeLists.txt 20; test $? = 3");

    // the program finds its machines beside itself
    shell(quoted((moved / "bin" / "gradwright").string()) + " machines");
    EXPECT_THAT(said(),
                HasSubstr((moved / "share" / "gradwright" / "machines" / "coupon-rig.toml").string()));
    for (const char* file : {"share/gradwright/materials.toml", "share/gradwright/01_linear_coupon.toml",
                             "share/doc/gradwright/README.md", "share/doc/gradwright/docs/targets.md",
                             "include/gradwright/dem/spread.h"})
        EXPECT_TRUE(fs::exists(moved / file)) << file;
    // what is installed knows neither the first prefix nor the source tree
    shell("! grep -rlF -e " + quoted((folder_ / "first").string()) + " -e " + quoted(GRADWRIGHT_SOURCE_DIR) +
          " " + quoted((moved / "lib").string()) + " --include=*.cmake");
}

TEST_F(Library, of_another_minor_version_is_not_taken) {
    shell("cmake --install " + quoted(GRADWRIGHT_BINARY_DIR) + " --prefix there");
    fs::create_directory(folder_ / "source");
    std::ofstream(folder_ / "source" / "CMakeLists.txt")
        << "cmake_minimum_required(VERSION 3.25)\nproject(p LANGUAGES C CXX)\nfind_package(gradwright 0.2 "
           "REQUIRED)\n";
    shell("! cmake -G Ninja -S source -B build -DCMAKE_PREFIX_PATH=\"$PWD/there\"");
    EXPECT_THAT(said(), HasSubstr("compatible with requested version \"0.2\""));
}

}  // namespace
