// Hard cases end as they must, the stability edge is where the code says it is, and nothing sticks on a
// saddle.
#include "dem/hard_cases.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "dem/stability.h"

namespace gradwright {
namespace {

class HardCases : public testing::TestWithParam<std::size_t> {
  protected:
    static std::string folder() {
        return (std::filesystem::temp_directory_path() / ("gradwright-hard-" + std::to_string(::getpid())))
            .string();
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(folder()); }
};

TEST_P(HardCases, ends_as_it_must) {
    SpreadOptions options;
    options.threads = 1;
    options.cache_folder = folder();
    const HardCase c = run_hard_case(hard_cases()[GetParam()], options);
    EXPECT_TRUE(c.pass) << c.tried << "\n  must: " << c.expected << "\n  happened: " << c.happened;
    EXPECT_FALSE(c.happened.empty());
    EXPECT_EQ(c.happened.find("nan"), std::string::npos) << c.happened;
}

INSTANTIATE_TEST_SUITE_P(All, HardCases, testing::Range<std::size_t>(0, hard_cases().size()),
                         [](const auto& info) {
                             std::string name = hard_cases()[info.param].id;
                             for (char& c : name)
                                 if (c == '-' || c == '.') c = '_';
                             return name;
                         });

}  // namespace
}  // namespace gradwright
