// The drawing and partition.json: outlines, dimensions, well-formed XML.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "reports/partition_drawing.h"
#include "reports/partition_file.h"
#include "reports/wording.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

using ::testing::HasSubstr;

double area(const std::vector<PlanPoint>& outline) {  // shoelace, > 0 when counter-clockwise
    double twice = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const PlanPoint &p = outline[i], &q = outline[(i + 1) % outline.size()];
        twice += p.x * q.y - q.x * p.y;
    }
    return twice / 2;
}

TEST(PartitionDrawing, outlines_have_the_chambers_areas_for_every_direction) {
    const double length = 3.2e-3, width = 1.6e-3;
    for (int degrees = -90; degrees <= 90; degrees += 15) {
        const PartitionCurve curve = straight_partition(length, width, degrees * M_PI / 180, 0.2e-3);
        for (const bool reversed : {false, true}) {
            PartitionCurve directed = curve;
            if (reversed) std::reverse(directed.points.begin(), directed.points.end());
            const auto outlines = chamber_outlines(directed, length, width);
            const double expected = directed.area_a(length, width);
            EXPECT_NEAR(area(outlines[0]), expected, 1e-12) << degrees << reversed;
            EXPECT_NEAR(area(outlines[1]), length * width - expected, 1e-12) << degrees << reversed;
        }
    }
}

TEST(PartitionDrawing, a_partition_outside_leaves_one_chamber) {
    PartitionCurve above;
    above.points = {{0, 3e-3}, {1e-3, 3e-3}};  // A, its left, lies beyond the dispenser
    const auto outlines = chamber_outlines(above, 3.2e-3, 1.6e-3);
    EXPECT_TRUE(outlines[0].empty());
    EXPECT_NEAR(area(outlines[1]), 3.2e-3 * 1.6e-3, 1e-15);
}

TEST(PartitionDrawing, letters_stand_in_their_chambers) {
    const Study study = fixture::study();
    const PartitionCurve curve = fixture::result(study).design.partition;
    const auto centres = chamber_centres(curve, 3.2e-3, 1.6e-3);
    EXPECT_TRUE(curve.on_side_a(centres[0].x, centres[0].y));
    EXPECT_FALSE(curve.on_side_a(centres[1].x, centres[1].y));
}

/// Tags open and close in order, and only the five entities of XML are used.
void expect_well_formed(const std::string& xml) {
    std::vector<std::string> open;
    const std::regex tag(R"(<(/?)([A-Za-z][A-Za-z0-9]*)((?:[^<>"]|"[^"<]*")*?)(/?)>)");
    for (std::sregex_iterator it(xml.begin(), xml.end(), tag), end; it != end; ++it) {
        const auto& match = *it;
        if (match[1] == "/") {
            ASSERT_FALSE(open.empty());
            ASSERT_EQ(open.back(), match[2]);
            open.pop_back();
        } else if (match[4] != "/") {
            open.push_back(match[2]);
        }
    }
    EXPECT_TRUE(open.empty());
    EXPECT_FALSE(std::regex_search(xml, std::regex("&(?!(amp|lt|gt|quot|#39);)")));
}

TEST(PartitionDrawing, svg_is_well_formed_and_shows_every_corner_in_mm) {
    const Study study = fixture::study("a <b> & \"c\"");
    const StudyResult result = fixture::result(study);
    const std::string svg = partition_svg(study, result);
    expect_well_formed(svg);
    EXPECT_THAT(svg, HasSubstr("a &lt;b&gt; &amp; &quot;c&quot;"));
    for (const PlanPoint& point : result.design.partition.points)
        for (double ordinate : {point.x, point.y})
            EXPECT_THAT(svg, HasSubstr(fmt::format(">{}<", millimetres(ordinate))));
    for (const char* words : {">A<", ">B<", "spreading direction", "SS17-4PH", "IN718", ">3.200<", ">1.600<"})
        EXPECT_THAT(svg, HasSubstr(words));
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(PartitionDrawing, svg_holds_for_any_size_and_without_a_partition) {
    Study study = fixture::study();
    StudyResult result = fixture::result(study);
    study.scene.dispenser_length = 0.25;  // a production machine
    study.dispenser_width = 0.25;
    result.design.partition.points = {{0, 0.1}, {0.25, 0.12}};
    expect_well_formed(partition_svg(study, result));
    EXPECT_THAT(partition_svg(study, result), HasSubstr("1 : "));
    result.design.partition.points.clear();
    expect_well_formed(partition_svg(study, result));
}

TEST(PartitionFile, ends_are_offsets_along_the_walls) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const auto object = partition_json(study, result);
    EXPECT_NEAR(object["ends"]["first"]["offset_mm"].get<double>(),
                result.design.partition.points.front().y * 1e3, 1e-9);
    EXPECT_NEAR(object["ends"]["last"]["offset_mm"].get<double>(),
                result.design.partition.points.back().y * 1e3, 1e-9);
    const double area_a = object["sides"]["A"]["area_m2"], area_b = object["sides"]["B"]["area_m2"];
    EXPECT_NEAR(area_a + area_b, study.scene.dispenser_length * study.dispenser_width, 1e-15);
    EXPECT_EQ(object["points_m"].size(), object["points_mm"].size());
}

TEST(PartitionRows, segments_carry_length_and_angle_and_the_last_has_none) {
    const Study study = fixture::study();
    Design design;
    design.partition.points = {{0, 0.5e-3}, {1.6e-3, 0.5e-3}, {3.2e-3, 1.3e-3}};
    const auto rows = partition_rows(study, design);
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_NEAR(rows[0].length_mm, 1.6, 1e-9);
    EXPECT_NEAR(rows[0].angle_deg, 0, 1e-9);
    EXPECT_NEAR(rows[1].angle_deg, std::atan2(0.8, 1.6) * 180 / M_PI, 1e-9);
    EXPECT_TRUE(std::isnan(rows[2].length_mm));
}

/// B, a band of A, B; both curves leave through the ends.
PartitionCurve band(bool a_between) {
    PartitionCurve pair{{{0, 0.4e-3}, {3.2e-3, 0.6e-3}}, {{3.2e-3, 1.2e-3}, {0, 1.0e-3}}};
    if (!a_between) {
        std::reverse(pair.points.begin(), pair.points.end());
        std::reverse(pair.second.begin(), pair.second.end());
    }
    return pair;
}

TEST(PartitionDrawing, outlines_of_two_curves_have_the_chambers_areas) {
    const double length = 3.2e-3, width = 1.6e-3;
    for (const bool a_between : {true, false}) {
        const auto outlines = chamber_outlines(band(a_between), length, width);
        const double inner = 0.6e-3 * length;
        EXPECT_NEAR(area(outlines[a_between ? 0 : 1]), inner, 1e-12);
        EXPECT_NEAR(area(outlines[a_between ? 1 : 0]), length * width - inner, 1e-12);
        // one curve beyond the wall: the other divides the dispenser alone
        PartitionCurve one = band(a_between);
        for (PlanPoint& point : one.second) point.y += width;
        EXPECT_NEAR(area(chamber_outlines(one, length, width)[a_between ? 0 : 1]), 1.1e-3 * length, 1e-12);
    }
}

TEST(PartitionDrawing, two_curves_have_three_letters_each_in_its_own_chamber) {
    for (const bool a_between : {true, false}) {
        const PartitionCurve pair = band(a_between);
        const auto letters = chamber_letters(pair, 3.2e-3, 1.6e-3);
        ASSERT_EQ(letters.size(), 3u);
        for (const ChamberLetter& letter : letters)
            EXPECT_EQ(pair.on_side_a(letter.at.x, letter.at.y), letter.side == 0);
        EXPECT_EQ(letters[2].side, a_between ? 1u : 0u);
        const double apart = letters[2].at.y - letters[letters[2].side].at.y;
        EXPECT_GT(std::abs(apart), 0.6e-3);  // beyond the band, not beside the other letter
    }
}

TEST(PartitionFile, two_curves_come_with_both_their_points_and_ends) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    result.design.family = Family::two_curves;
    result.design.partition = band(true);
    const auto object = partition_json(study, result);
    EXPECT_EQ(object["points_m"].size(), 2u);
    EXPECT_EQ(object["points2_m"].size(), 2u);
    EXPECT_EQ(object["corners"][2]["name"], "Q1");
    EXPECT_NEAR(object["ends2"]["last"]["offset_mm"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(object["sides"]["A"]["area_m2"].get<double>(), 0.6e-3 * 3.2e-3, 1e-12);
    EXPECT_EQ(object["partition"]["family"], "two_curves");
    EXPECT_EQ(object["partition"]["between"], "A");
    const std::string svg = partition_svg(study, result);
    expect_well_formed(svg);
    EXPECT_THAT(svg, HasSubstr(">Q2<"));
    EXPECT_THAT(svg, HasSubstr("A between them"));
}

TEST(PartitionDrawing, a_smooth_curve_is_drawn_whole_and_dimensioned_at_a_dozen_corners) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    result.design.family = Family::sigmoid;
    result.design.partition.points.clear();
    for (int i = 0; i <= 30; ++i)
        result.design.partition.points.push_back({3.2e-3 * i / 30, 0.8e-3 + 0.01e-3 * i});
    const std::string svg = partition_svg(study, result);
    expect_well_formed(svg);
    std::size_t corners = 0;
    for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1))
        ++corners;
    EXPECT_LE(corners, 16u);  // two of the datum
    EXPECT_GE(corners, 10u);
    EXPECT_THAT(svg, HasSubstr("Smooth"));
    const auto rows = partition_rows(study, result.design);
    EXPECT_EQ(rows.size(), 31u);
}

}  // namespace
}  // namespace gradwright
