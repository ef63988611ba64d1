// Charts: what is drawn, and that odd data do no harm.
#include "dem/verification/line_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gradwright {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

Chart chart_of(std::vector<double> x, std::vector<double> y, ChartSeries::Look look) {
    Chart c;
    c.title = "Force < 1 & more";
    ChartSeries s;
    s.name = "engine";
    s.look = look;
    s.x = std::move(x);
    s.y = std::move(y);
    c.series = {s};
    return c;
}

TEST(Charts, every_point_is_drawn_and_one_stands_in_the_legend) {
    const std::string svg = charts_svg({chart_of({1, 2, 3}, {1, 4, 9}, ChartSeries::Look::points)});
    EXPECT_EQ(count(svg, "<circle"), 4u);
    EXPECT_THAT(svg, HasSubstr("Force &lt; 1 &amp; more"));
    EXPECT_THAT(svg, HasSubstr(">engine</text>"));
}

TEST(Charts, a_hole_in_the_data_breaks_the_line) {
    const double hole = std::numeric_limits<double>::quiet_NaN();
    const std::string svg =
        charts_svg({chart_of({1, 2, 3, 4, 5}, {1, 2, hole, 4, 5}, ChartSeries::Look::line)});
    const auto start = svg.find("<path d=\"");
    const std::string path = svg.substr(start, svg.find('"', start + 9) - start);
    EXPECT_EQ(count(path, "M"), 2u);
    EXPECT_EQ(count(path, "L"), 2u);
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Charts, a_log_axis_leaves_out_what_has_no_logarithm) {
    Chart c = chart_of({0, 1, 10, 1000}, {1, 2, 3, 4}, ChartSeries::Look::points);
    c.log_x = true;
    const std::string svg = charts_svg({c});
    EXPECT_EQ(count(svg, "<circle"), 4u);  // three points and the legend's
    EXPECT_THAT(svg, HasSubstr(">100</text>"));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(Charts, empty_and_constant_data_still_give_a_picture) {
    const std::string svg = charts_svg(
        {chart_of({}, {}, ChartSeries::Look::line), chart_of({1, 2}, {3, 3}, ChartSeries::Look::line)});
    EXPECT_THAT(svg, HasSubstr("width=\"800\""));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
}

}  // namespace
}  // namespace gradwright
