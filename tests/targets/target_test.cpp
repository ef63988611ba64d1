// Targets: shapes, closed-form bin means, tables and zones.
#include "targets/target.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace gradwright {
namespace {

Target table_of(std::vector<double> y, std::vector<double> gi) {
    Target target;
    target.shape = TargetShape::table;
    target.table_y = std::move(y);
    target.table_gi = std::move(gi);
    return target;
}

Target three_levels() {
    return plateaus_target({{0.1, 0, 0.4e-3}, {0.5, 0.7e-3, 0.9e-3}, {0.9, 1.25e-3, 0}});
}

/// Midpoint sum: what a bin mean is by definition.
double numeric_mean(const Target& target, double low, double high) {
    const int n = 20000;
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += target(low + (high - low) * (k + 0.5) / n);
    return sum / n;
}

/// A CSV file that lives as long as the test.
class CsvFile {
  public:
    explicit CsvFile(const std::string& text)
        : path_(testing::TempDir() + std::to_string(::getpid()) + "-gradwright_target_test.csv") {
        std::ofstream(path_, std::ios::binary) << text;
    }
    ~CsvFile() { std::remove(path_.c_str()); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

std::string message_of(const std::string& csv) {
    const CsvFile file(csv);
    try {
        table_target(file.path());
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

TEST(target, linear_ramp_passes_its_points_and_is_constant_beyond) {
    const Target ramp = linear_target(0.4e-3, 0.1, 1.2e-3, 0.9);
    EXPECT_DOUBLE_EQ(ramp(0.4e-3), 0.1);
    EXPECT_DOUBLE_EQ(ramp(0.8e-3), 0.5);
    EXPECT_DOUBLE_EQ(ramp(1.2e-3), 0.9);
    EXPECT_DOUBLE_EQ(ramp(0), 0.1);
    EXPECT_DOUBLE_EQ(ramp(2e-3), 0.9);
    // given from the far side it is the same ramp
    const Target back = linear_target(1.2e-3, 0.9, 0.4e-3, 0.1);
    for (double y : {0.0, 0.5e-3, 1.1e-3, 1.6e-3}) EXPECT_DOUBLE_EQ(back(y), ramp(y));
    EXPECT_DOUBLE_EQ(back.bin_mean(0.3e-3, 0.5e-3), ramp.bin_mean(0.3e-3, 0.5e-3));
}

TEST(target, sigmoid_passes_10_50_and_90_percent_at_its_width) {
    const Target sigmoid = sigmoid_target(0.9e-3, 0.6e-3);
    EXPECT_DOUBLE_EQ(sigmoid(0.9e-3), 0.5);
    EXPECT_NEAR(sigmoid(0.6e-3), 0.1, 1e-15);
    EXPECT_NEAR(sigmoid(1.2e-3), 0.9, 1e-15);
    EXPECT_NEAR(sigmoid_target(0.9e-3, 0.6e-3, 0.8, 0.2)(0.6e-3), 0.8 - 0.1 * 0.6, 1e-15);
}

TEST(target, step_belongs_to_its_upper_side) {
    const Target step = step_target(0.8e-3, 0.2, 0.7);
    EXPECT_DOUBLE_EQ(step(0.8e-3), 0.7);
    EXPECT_DOUBLE_EQ(step(0.7999e-3), 0.2);
    EXPECT_DOUBLE_EQ(step.bin_mean(0.75e-3, 0.95e-3), 0.25 * 0.2 + 0.75 * 0.7);
}

TEST(target, bin_means_are_the_integrals_of_the_shape) {
    const std::vector<Target> targets = {linear_target(0.4e-3, 0, 1.2e-3, 1),
                                         sigmoid_target(0.9e-3, 0.6e-3),
                                         sigmoid_target(0.9e-3, 1e-6, 0.1, 0.8),
                                         step_target(0.83e-3),
                                         table_of({0.1e-3, 0.35e-3, 0.5e-3, 1.3e-3}, {0.2, 0.9, 0.3, 1.0}),
                                         three_levels(),
                                         aba_target(0.9, 0.2, 0.31e-3, 0.5e-3, 1.1e-3, 1.27e-3)};
    for (const Target& target : targets) {
        for (int bin = 0; bin < 8; ++bin) {
            const double low = bin * 0.2e-3, high = (bin + 1) * 0.2e-3;
            EXPECT_NEAR(target.bin_mean(low, high), numeric_mean(target, low, high), 5e-5)
                << target.describe() << bin;
        }
    }
    // 1.5 bins over the foot of a ramp of slope 1250 /m: 0.1 mm of it carry the mean 0.0625
    EXPECT_NEAR(linear_target(0.4e-3, 0, 1.2e-3, 1).bin_mean(0.3e-3, 0.5e-3), 0.5 * 0.0625, 1e-12);
}

TEST(target, plateaus_hold_their_levels_and_are_joined_by_straight_ramps) {
    const Target target = three_levels();
    for (const double y : {-1.0, 0.0, 0.4e-3}) EXPECT_DOUBLE_EQ(target(y), 0.1) << y;
    for (const double y : {0.7e-3, 0.8e-3, 0.9e-3}) EXPECT_DOUBLE_EQ(target(y), 0.5) << y;
    for (const double y : {1.25e-3, 1.6e-3, 1.0}) EXPECT_DOUBLE_EQ(target(y), 0.9) << y;
    EXPECT_NEAR(target(0.5e-3), 0.1 + 0.4 * (0.1 / 0.3), 1e-12);
    EXPECT_NEAR(target(1.0e-3), 0.5 + 0.4 * (0.1 / 0.35), 1e-12);
    // a bin of 0.2 mm with 0.1 mm of the first level and 0.1 mm of a ramp of slope 0.4/0.3 mm
    EXPECT_NEAR(target.bin_mean(0.3e-3, 0.5e-3), 0.1 + 0.5 * 0.5 * 0.4 * (0.1 / 0.3), 1e-12);
    EXPECT_TRUE(problems(target).empty());
    EXPECT_EQ(
        target.describe(),
        "plateaus: GI 0.1 up to y = 0.4 mm, 0.5 from 0.7 to 0.9 mm, 0.9 from 1.25 mm on, straight between");
    // any number of levels, falling ones and a peak of no length among them
    const Target peak =
        plateaus_target({{0, 0, 0.2e-3}, {1, 0.5e-3, 0.5e-3}, {0.3, 0.8e-3, 1e-3}, {0, 1.2e-3, 0}});
    EXPECT_TRUE(problems(peak).empty());
    EXPECT_DOUBLE_EQ(peak(0.5e-3), 1);
    EXPECT_NEAR(peak(0.35e-3), 0.5, 1e-12);
    EXPECT_NEAR(peak(1.1e-3), 0.15, 1e-12);
    EXPECT_EQ(peak.gi_range(), std::pair(0.0, 1.0));
}

TEST(target, aba_is_a_band_of_one_powder_between_the_other) {
    const Target band = aba_target(1, 0, 0.3e-3, 0.5e-3, 1.1e-3, 1.3e-3);
    EXPECT_DOUBLE_EQ(band(0), 1);
    EXPECT_NEAR(band(0.4e-3), 0.5, 1e-12);
    EXPECT_DOUBLE_EQ(band(0.8e-3), 0);
    EXPECT_NEAR(band(1.2e-3), 0.5, 1e-12);
    EXPECT_DOUBLE_EQ(band(2e-3), 1);
    EXPECT_NEAR(band.bin_mean(0.2e-3, 0.4e-3), 0.5 * 1 + 0.5 * 0.75, 1e-12);
    EXPECT_EQ(band.describe().find("A-B-A: GI 1 up to y = 0.3 mm, 0 from 0.5 to 1.1 mm, 1 from 1.3 mm on"),
              0u);
    EXPECT_EQ(aba_target(0, 1, 0.3e-3, 0.5e-3, 1.1e-3, 1.3e-3).describe().find("B-A-B"), 0u);
    EXPECT_EQ(problems(aba_target(1, -0.5, 0.3e-3, 0.2e-3, 1.1e-3, 1.3e-3)).size(), 3u);  // two points, one y
}

TEST(target, a_third_column_weighs_from_its_line_to_the_next_and_beyond_the_ends) {
    const CsvFile file("weight,y_mm,gi\n2,0.2,0\n0,0.6,0.3\n0,0.8,0.9\n1,1.0,1\n");
    Target target = table_target(file.path());
    EXPECT_EQ(target.weight(-1), 2);
    EXPECT_EQ(target.weight(0.5999e-3), 2);
    EXPECT_EQ(target.weight(0.6e-3), 0);
    EXPECT_EQ(target.weight(0.9999e-3), 0);
    EXPECT_EQ(target.weight(1e-3), 1);
    EXPECT_EQ(target.weight(1), 1);
    EXPECT_EQ(target.zones.size(), 3u);  // neighbours of one weight are one zone
    EXPECT_TRUE(problems(target).empty());
    EXPECT_NE(
        target.describe().find("; below 0.6 mm weight 2; 0.6 to 1 mm don't care; from 1 mm on weight 1"),
        std::string::npos)
        << target.describe();
    target.zones.push_back({0.7e-3, 0.8e-3, 5});  // a zone of the study wins
    EXPECT_EQ(target.weight(0.75e-3), 5);
    const CsvFile bare("0.0002 , 0 , 3\n0.001,1,0\n");
    EXPECT_EQ(table_target(bare.path()).weight(0.5e-3), 3);
}

TEST(target, bad_weights_are_told_with_their_lines) {
    const std::string message = message_of("y_mm,gi,weight\n0,0,-1\n1,0.5,x\n2,0.7\n3,1,1\n");
    EXPECT_NE(message.find(":2: weight = '-1' must be a number in 0 .."), std::string::npos) << message;
    EXPECT_NE(message.find(":3: weight = 'x'"), std::string::npos) << message;
    EXPECT_NE(message.find(":4: '2,0.7' has 2 column(s), 3 are needed: y, gi, weight"), std::string::npos)
        << message;
    EXPECT_NE(message_of("y_mm,gi,weight\n0,0,0\n1,1,0\n").find("every weight is 0"), std::string::npos);
}

TEST(target, far_tails_of_the_sigmoid_neither_overflow_nor_leave_the_range) {
    const Target sigmoid = sigmoid_target(0, 1e-6);
    EXPECT_DOUBLE_EQ(sigmoid.bin_mean(-1, -0.9), 0);
    EXPECT_NEAR(sigmoid.bin_mean(0.9, 1), 1, 1e-12);
    EXPECT_DOUBLE_EQ(sigmoid(-1), 0);
    EXPECT_DOUBLE_EQ(sigmoid(1), 1);
}

TEST(target, later_zones_win_and_outside_all_zones_the_weight_is_one) {
    Target target = linear_target(0, 0, 1e-3, 1);
    target.zones = {{0, 1e-3, 2}, {0.4e-3, 0.6e-3, 0}};
    EXPECT_EQ(target.weight(0.3e-3), 2);
    EXPECT_EQ(target.weight(0.4e-3), 0);
    EXPECT_EQ(target.weight(0.6e-3), 2);  // half-open
    EXPECT_EQ(target.weight(1e-3), 1);
    EXPECT_NE(target.describe().find("don't care"), std::string::npos);
}

TEST(target, table_reads_units_from_its_header_in_any_column_order) {
    const CsvFile file("\xef\xbb\xbf# measured line\ngi, y_mm\r\n0.0, 0.2\r\n0.5, 0.6\r\n\r\n1.0, 1.0\r\n");
    const Target target = table_target(file.path());
    ASSERT_EQ(target.table_y.size(), 3u);
    EXPECT_DOUBLE_EQ(target.table_y[1], 0.6e-3);
    EXPECT_DOUBLE_EQ(target(0.4e-3), 0.25);
    EXPECT_DOUBLE_EQ(target(0), 0);
    EXPECT_DOUBLE_EQ(target(5e-3), 1);
    EXPECT_TRUE(problems(target).empty());
    EXPECT_EQ(target.table_file, file.path());
}

TEST(target, table_without_header_is_in_metres) {
    const CsvFile file("0.0002;0\n0.0010;1\n");
    EXPECT_DOUBLE_EQ(table_target(file.path())(0.6e-3), 0.5);
}

TEST(target, a_bad_table_names_file_line_and_rule_of_every_fault) {
    const std::string message = message_of("y_um,gi\n100,0\n200,1.5\n150,0.5\nx,1\n300\n");
    EXPECT_NE(message.find("gradwright_target_test.csv:3: gi = 1.5 must lie in 0 .. 1"), std::string::npos)
        << message;
    EXPECT_NE(message.find(":4: y = 150 must be greater"), std::string::npos) << message;
    EXPECT_NE(message.find(":5: 'x,1'"), std::string::npos) << message;
    EXPECT_NE(message.find(":6: '300' has 1 column(s)"), std::string::npos) << message;
    EXPECT_NE(message_of("depth,gi\n1,0\n2,1\n").find(":1: header"), std::string::npos);
    EXPECT_NE(message_of("1,0\n").find("at least 2"), std::string::npos);
    EXPECT_THROW(table_target("no such file.csv"), std::runtime_error);
    EXPECT_NE(message_of("0,0\n1,nan\n").find("finite"), std::string::npos);
}

TEST(target, sound_targets_have_no_problems) {
    EXPECT_TRUE(problems(linear_target(0.4e-3, 0, 1.2e-3, 1)).empty());
    EXPECT_TRUE(problems(sigmoid_target(0.9e-3, 0.6e-3)).empty());
    EXPECT_TRUE(problems(step_target(0.9e-3)).empty());
}

TEST(target, all_problems_are_told_at_once) {
    Target target = linear_target(1e-3, -0.1, 1e-3, 1.2);
    target.zones = {{1e-3, 1e-3, -1}};
    EXPECT_EQ(problems(target).size(), 5u);
    EXPECT_EQ(problems(sigmoid_target(0, 0)).size(), 1u);
    EXPECT_EQ(problems(table_of({0, 1, 1}, {0, 2, 1})).size(), 2u);
    EXPECT_EQ(problems(table_of({}, {})).size(), 1u);
}

TEST(target, description_speaks_in_millimetres) {
    EXPECT_NE(linear_target(0.4e-3, 0, 1.2e-3, 1).describe().find("0.4 mm"), std::string::npos);
    EXPECT_NE(sigmoid_target(0.9e-3, 0.6e-3).describe().find("10-90 % width 0.6 mm"), std::string::npos);
}

}  // namespace
}  // namespace gradwright
