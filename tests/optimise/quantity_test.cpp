// Numbers with units as studies write them, names a slip away from the right one, and the materials that
// ship.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "optimise/study_file.h"

namespace gradwright {
namespace {

TEST(shipped_materials, are_six_alloys_and_the_wall_each_with_the_source_of_every_number) {
    std::vector<std::string> names;
    for (const Material& material : shipped_materials()) {
        names.push_back(material.name);
        EXPECT_GT(material.density, 1000) << material.name;
        EXPECT_GT(material.youngs_modulus, 10e9) << material.name;
        for (const char* number : {"density: ", "Young's modulus: ", "Poisson's ratio: "})
            EXPECT_THAT(material.source, testing::HasSubstr(number)) << material.name;
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre("IN718", "SS17-4PH", "316L", "Ti-6Al-4V", "AlSi10Mg",
                                                     "CuCrZr", "geometry"));
}

TEST(quantity, reads_the_same_length_in_every_unit_to_the_last_bit) {
    EXPECT_EQ(parse_quantity("40 um", "length"), 40e-6);
    EXPECT_EQ(parse_quantity("40um", "length"), 40e-6);
    EXPECT_EQ(parse_quantity(" 0.04 mm ", "length"), 0.04e-3);
    EXPECT_EQ(parse_quantity("40 \u00b5m", "length"), 40e-6);
    EXPECT_EQ(parse_quantity("4e-5 m", "length"), 4e-5);
    EXPECT_EQ(parse_quantity("+3.2 mm", "length"), 3.2e-3);
}

TEST(quantity, knows_the_units_of_every_dimension) {
    EXPECT_EQ(parse_quantity("100 mm/s", "speed"), 0.1);
    EXPECT_EQ(parse_quantity("180 deg", "angle"), std::numbers::pi);
    EXPECT_EQ(parse_quantity("0.02 J/m2", "work_of_adhesion"), 0.02);
    EXPECT_EQ(parse_quantity("195 GPa", "pressure"), 195e9);
    EXPECT_DOUBLE_EQ(parse_quantity("8.2 g/cm3", "density"), 8200);
    EXPECT_EQ(parse_quantity("9.81 m/s2", "acceleration"), 9.81);
}

TEST(quantity, refuses_what_is_no_finite_number_with_a_unit_of_that_dimension) {
    for (const char* text : {"", "um", "40", "40 furlong", "40 mm/s", "nan um", "inf um", "-inf um",
                             "1e999 um", "0x10 um", "4 0 um", "40 um um", "1,5 mm", "++1 mm", "+-1 mm"})
        EXPECT_THROW(parse_quantity(text, "length"), std::invalid_argument) << text;
}

TEST(quantity, is_written_so_that_it_reads_back) {
    for (const char* dimension :
         {"length", "speed", "angle", "work_of_adhesion", "pressure", "density", "acceleration"})
        for (const double value : {0.0, 1e-7, 40e-6, 0.2e-3, 3.2e-3, 0.1, 1.0, 195e9}) {
            const std::string text = format_quantity(value, dimension);
            EXPECT_NEAR(parse_quantity(text, dimension), value, 5e-6 * value)
                << text;  // 6 significant digits
        }
    EXPECT_EQ(format_quantity(40e-6, "length"), "40 um");
    EXPECT_EQ(format_quantity(3.2e-3, "length"), "3.2 mm");
    EXPECT_EQ(format_quantity(0.1, "speed"), "100 mm/s");
}

TEST(nearest_name, finds_slips_of_the_pen_and_nothing_far_away) {
    const std::vector<std::string> names = {"tolerance", "x_drift_tolerance", "norm", "D10", "D50"};
    EXPECT_EQ(nearest_name("tolerence", names), "tolerance");
    EXPECT_EQ(nearest_name("NORM", names), "norm");
    EXPECT_EQ(nearest_name("nrom", names), "norm");
    EXPECT_EQ(nearest_name("drift", names), "x_drift_tolerance");
    EXPECT_EQ(nearest_name("banana", names), "");
    EXPECT_EQ(nearest_name("x", names), "");
}

}  // namespace
}  // namespace gradwright
