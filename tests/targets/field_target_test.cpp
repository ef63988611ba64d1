// Fields: a gradation over x and y. Expected values from a bilinear g = a + b x + c y + d x y, which the
// interpolation reproduces and whose mean over a rectangle is its value at the centre.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "targets/target.h"

namespace gradwright {
namespace {

/// [-], x and y in m.
double bilinear(double x, double y) {
    return 0.1 + 50 * x + 200 * y + 5e4 * x * y;
}

class CsvFile {
  public:
    explicit CsvFile(const std::string& text)
        : path_(testing::TempDir() + "gradwright_field_" + std::to_string(getpid()) + ".csv") {
        std::ofstream(path_, std::ios::binary) << text;
    }
    ~CsvFile() { std::remove(path_.c_str()); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

Target read(const std::string& csv) {
    const CsvFile file(csv);
    return field_target(file.path());
}

std::string message_of(const std::string& csv) {
    const CsvFile file(csv);
    try {
        field_target(file.path());
    } catch (const std::runtime_error& error) {
        std::string text = error.what();
        for (auto at = text.find(file.path()); at != std::string::npos; at = text.find(file.path()))
            text.replace(at, file.path().size(), "f");
        return text;
    }
    return "";
}

/// Uneven grid x 1, 1.5, 3 mm, y 0, 1, 1.6 mm, the lines out of order and the columns too.
std::string table() {
    std::string text = "gi,y_um,note,x_mm\n";
    for (const double y : {1e-3, 0.0, 1.6e-3})
        for (const double x : {3e-3, 1e-3, 1.5e-3})
            text += std::to_string(bilinear(x, y)) + "," + std::to_string(y * 1e6) + ",n," +
                    std::to_string(x * 1e3) + "\n";
    return text;
}

TEST(field_target, is_bilinear_between_its_points_and_constant_beyond) {
    const Target field = read(table());
    ASSERT_TRUE(field.is_field());
    EXPECT_TRUE(problems(field).empty());
    for (const double x : {1e-3, 1.2e-3, 1.5e-3, 2.9e-3, 3e-3})
        for (const double y : {0.0, 0.31e-3, 1e-3, 1.59e-3})
            EXPECT_NEAR(field.at(x, y), bilinear(x, y), 1e-6) << x << " " << y;
    EXPECT_NEAR(field.at(0, 0.5e-3), bilinear(1e-3, 0.5e-3), 1e-6);
    EXPECT_NEAR(field.at(5e-3, 9e-3), bilinear(3e-3, 1.6e-3), 1e-6);
}

TEST(field_target, mean_over_a_cell_of_a_bilinear_field_is_its_value_at_the_centre) {
    const Target field = read(table());
    EXPECT_NEAR(field.over_x(1.6e-3, 2.4e-3).bin_mean(0.2e-3, 0.5e-3), bilinear(2e-3, 0.35e-3), 1e-6);
    // across grid lines too, where a bilinear function stays one
    EXPECT_NEAR(field.over_x(1.1e-3, 2.9e-3).bin_mean(0.8e-3, 1.4e-3), bilinear(2e-3, 1.1e-3), 1e-6);
    // as it is read, the mean along x is that over its whole grid
    EXPECT_NEAR(field(0.4e-3), bilinear(2e-3, 0.4e-3), 1e-6);
    const auto [low, high] = field.gi_range();
    EXPECT_NEAR(low, bilinear(1e-3, 0), 1e-6);
    EXPECT_NEAR(high, bilinear(3e-3, 1.6e-3), 1e-6);
}

TEST(field_target, a_weight_holds_from_its_point_to_the_next_in_x_and_in_y_and_zones_win) {
    Target field = read("x_mm,y_mm,gi,weight\n1,0,0,1\n2,0,0,2\n3,0,0,4\n1,1,1,8\n2,1,1,16\n3,1,1,0\n");
    EXPECT_EQ(field.weight(1.5e-3, 0.5e-3), 1);
    EXPECT_EQ(field.weight(2e-3, 0.5e-3), 2);
    EXPECT_EQ(field.weight(9e-3, 0.5e-3), 4);
    EXPECT_EQ(field.weight(0, 7e-3), 8);
    EXPECT_EQ(field.weight(3e-3, 1e-3), 0);
    // x 1.5 to 2.5 mm: halves of 1 | 2 below y = 1 mm and of 8 | 16 above it, a quarter of y above
    Target::Weight over = field.weight_over(1.5e-3, 2.5e-3, 0.7e-3, 1.1e-3);
    EXPECT_NEAR(over.mean, 0.75 * (1 + 2) / 2 + 0.25 * (8 + 16) / 2, 1e-12);
    EXPECT_EQ(over.least, 1);
    field.zones = {{0, 0.8e-3, 3, 2e-3, 2.25e-3}};
    EXPECT_EQ(field.weight(2.1e-3, 0.5e-3), 3);
    EXPECT_EQ(field.weight(1.9e-3, 0.5e-3), 1);
    over = field.weight_over(2e-3, 2.5e-3, 0.6e-3, 1e-3);
    EXPECT_NEAR(over.mean, 2 + 0.25 * (3 - 2), 1e-12);  // half of x and half of y lie in the zone
}

TEST(field_target, every_fault_of_a_file_is_named_with_its_line) {
    EXPECT_EQ(message_of("x_mm,y_mm,gi,weight\n0,0,0.5,1\n1,0,1.5,1\n0,1,half,1\n1,1,0.5,-1\n1,2\n"),
              "f:3: gi = 1.5 must lie in 0 .. 1\n"
              "f:4: '0,1,half,1': x, y and gi must be finite numbers with a decimal point\n"
              "f:5: weight = '-1' must be a number in 0 .. 1e+06, 0 for don't care\n"
              "f:6: '1,2' has 2 column(s), 4 are needed: x, y, gi, weight");
    EXPECT_EQ(message_of("x_mm,y_mm,gi\n0,0,0\n1,0,0\n0,1,1\n"),
              "f: no line has x = 1 mm, y = 1 mm: the points must fill a rectangular grid");
    EXPECT_EQ(message_of("x_mm,y_mm,gi\n0,0,0\n1,0,0\n0,1,1\n1,1,1\n1,1,1\n"),
              "f:6: x = 1 mm, y = 1 mm stands in line 5 already");
    EXPECT_EQ(message_of("x_mm,y_mm,gi\n0,0,0\n1,0,0\n"), "f: 2 x and 1 y, at least 2 of each are needed");
    EXPECT_EQ(message_of("x_mm,gi\n0,0\n"),
              "f:1: header 'x_mm,gi' must name the columns x_m, x_mm or x_um, y_m, y_mm or y_um, and gi; "
              "weight is free");
    EXPECT_EQ(message_of("x,y,gi,weight\n0,0,0,0\n1,0,0,0\n0,1,1,0\n1,1,1,0\n"),
              "f: every weight is 0: give at least one line a weight above 0");
    EXPECT_EQ(message_of("\n# nothing\n"), "f: no data line");
}

TEST(field_target, says_in_one_line_what_it_asks_for) {
    EXPECT_NE(read(table()).describe().find("field of 3 x 3 points from "), std::string::npos);
    EXPECT_NE(read(table()).describe().find(", x = 1 to 3 mm, y = 0 to 1.6 mm, GI 0.15 to 0.81"),
              std::string::npos)
        << read(table()).describe();
}

}  // namespace
}  // namespace gradwright
