// Plates against closed forms: sizes, ends, bends, chambers beside them.
#include <gtest/gtest.h>

#include "tests/reports/spec_fixture.h"

namespace gradwright {
namespace {

using namespace fixture;

double outline_area(const Plate& plate, double sagitta) {
    std::vector<PlanPoint> outline;
    const auto stations = plate.stations(sagitta);
    for (const Station& s : stations) outline.push_back(s[1]);
    for (auto s = stations.rbegin(); s != stations.rend(); ++s) outline.push_back((*s)[0]);
    double twice = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const PlanPoint &p = outline[i], &q = outline[(i + 1) % outline.size()];
        twice += p.x * q.y - q.x * p.y;
    }
    return twice / 2;
}

TEST(Plate, straight_reaches_into_its_slots_and_has_the_closed_forms_size) {
    const Study study = large();
    const double t = study.build.thickness, angle = 20 * kDegree;
    const auto plates = plates_of(study, straight(study, 20).design);
    ASSERT_EQ(plates.size(), 1u);
    const Plate& plate = plates[0];
    // cut square: the deepest corner stays one clearance off the slot's bottom
    const double deep = study.build.slot_depth - study.build.slot_clearance - t / 2 * std::sin(angle);
    const double expected = (0.1 + 2 * deep) / std::cos(angle);
    EXPECT_NEAR(plate.middle_length(), expected, 1e-12);
    EXPECT_NEAR(plate.height(), 0.04 - study.build.clearance + study.build.grip, 1e-15);
    EXPECT_NEAR(plate.volume(), t * expected * plate.height(), 1e-18);
    EXPECT_EQ(plate.faces(), 6);
    EXPECT_EQ(plate.ends[0].at.wall, WallEnd::Wall::rear);
    EXPECT_EQ(plate.ends[1].at.wall, WallEnd::Wall::platform);
    EXPECT_NEAR(plate.ends[0].at.offset, 0.03 - 0.05 * std::tan(angle), 1e-12);
    EXPECT_NEAR(plate.ends[1].at.offset, 0.03 + 0.05 * std::tan(angle), 1e-12);
    EXPECT_NEAR(plate.ends[0].slot_along, (t + 2 * study.build.slot_clearance) / std::cos(angle), 1e-12);
    const auto box = plate.box(1e-6);
    EXPECT_NEAR(box[0].x, -(study.build.slot_depth - study.build.slot_clearance), 1e-12);
    EXPECT_NEAR(box[1].x, 0.1 + study.build.slot_depth - study.build.slot_clearance, 1e-12);
}

TEST(Plate, a_steep_partition_ends_on_the_side_walls) {
    const Study study = large();
    const auto plates = plates_of(study, straight(study, 70).design);
    ASSERT_EQ(plates.size(), 1u);
    EXPECT_EQ(plates[0].ends[0].at.wall, WallEnd::Wall::side_low);
    EXPECT_EQ(plates[0].ends[1].at.wall, WallEnd::Wall::side_high);
    EXPECT_NEAR(plates[0].ends[1].at.offset, 0.05 + 0.03 / std::tan(70 * kDegree), 1e-12);
    EXPECT_NEAR(plates[0].ends[1].slant, 20 * kDegree, 1e-12);
}

TEST(Plate, held_by_tabs_its_ends_are_cut_off_beside_the_walls) {
    const Study study = with_tabs(large());
    const double t = study.build.thickness, angle = 20 * kDegree, c = study.build.end_clearance;
    const Plate plate = plates_of(study, straight(study, 20).design)[0];
    ASSERT_TRUE(plate.tabs());
    EXPECT_EQ(plate.z_seat, -3e-3);
    // cut square: the corner that leads stays one clearance off the wall
    const double gap = (c + t / 2 * std::sin(angle)) / std::cos(angle);
    const double below = 0.1 / std::cos(angle) - 2 * gap;
    EXPECT_NEAR(plate.middle_length() - plate.ends[0].cut - plate.ends[1].cut, below, 1e-12);
    EXPECT_NEAR(plate.volume(),
                t * (plate.middle_length() * (study.build.grip + 3e-3) +
                     below * (0.04 - study.build.clearance - 3e-3)),
                1e-18);
    EXPECT_EQ(plate.faces(), 10);
    // the plate rises along x: its left corner leads at the rear wall, its right one at the platform's
    EXPECT_EQ(plate.ends[0].gap_side, 1);
    EXPECT_EQ(plate.ends[1].gap_side, 0);
    const auto volume = chamber_volumes(study, straight(study, 20).design, {plate}, {0, 10e-3});
    const auto area = chamber_areas(study, straight(study, 20).design, {plate});
    EXPECT_NEAR(volume[0], area[0] * 0.04 + t * gap * 0.037, 1e-15);
    EXPECT_NEAR(volume[1], area[1] * 0.03 + t * gap * 0.030, 1e-15);  // filled to below the seats
    const FlatPattern flat = flat_pattern(plate);
    const auto outline = flat.outline();
    ASSERT_EQ(outline.size(), 8u);
    double twice = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        const PlanPoint &p = outline[i], &q = outline[(i + 1) % 8];
        twice += p.x * q.y - q.x * p.y;
    }
    EXPECT_NEAR(twice / 2 * t, plate.volume(), 1e-15);  // straight: the blank is the plate
}

TEST(Plate, bends_keep_the_strip_as_wide_as_the_sheet) {
    const Study study = large();
    const auto plates = plates_of(study, bent().design);
    ASSERT_EQ(plates.size(), 1u);
    const Plate& plate = plates[0];
    ASSERT_TRUE(plate.rounded);
    ASSERT_EQ(plate.turns.size(), 2u);
    EXPECT_GT(plate.turns[0], 0);
    EXPECT_LT(plate.turns[1], 0);
    const double m = study.build.bend_radius + study.build.thickness / 2;
    double middle = length_of(plate.corners);
    for (const double q : plate.turns) middle += m * (std::abs(q) - 2 * std::tan(std::abs(q) / 2));
    EXPECT_NEAR(plate.middle_length(), middle, 1e-12);
    EXPECT_EQ(plate.faces(), 2 * 5 + 4);
    // chords of a finer sagitta come to the exact area
    EXPECT_NEAR(outline_area(plate, 1e-10), study.build.thickness * middle, 1e-13);
    for (const Station& s : plate.stations(1e-6))
        EXPECT_NEAR(std::hypot(s[0].x - s[1].x, s[0].y - s[1].y), study.build.thickness, 1e-12);
}

TEST(Plate, a_curve_that_leaves_and_comes_back_makes_two_plates) {
    const Study study = large();
    FinishedDesign finished = bent();
    finished.design.partition.points = {{0, 0.05}, {0.04, 0.07}, {0.06, 0.07}, {0.1, 0.05}};
    const auto plates = plates_of(study, finished.design);
    ASSERT_EQ(plates.size(), 2u);
    EXPECT_EQ(plates[0].name, "P");
    EXPECT_EQ(plates[1].name, "P-2");
    EXPECT_EQ(plates[0].ends[1].at.wall, WallEnd::Wall::side_high);
    EXPECT_NEAR(plates[0].ends[1].at.offset, 0.02, 1e-9);
    EXPECT_NEAR(plates[1].ends[0].at.offset, 0.08, 1e-9);
}

TEST(Plate, chambers_and_plate_fill_the_dispenser) {
    Study study = large();
    for (const FinishedDesign& finished : {straight(study, 20), bent(), pair_of_curves()}) {
        const auto plates = plates_of(study, finished.design);
        const auto net = chamber_areas(study, finished.design, plates);
        double inside = 0;  // of the strips: their length between the walls
        for (const Plate& plate : plates) inside += plate.middle_length();
        const double slots = study.build.thickness * inside - (0.1 * 0.06 - net[0] - net[1]);
        // what is left is the strips' ends in the walls: less than slot depth each, more than nothing
        EXPECT_GT(slots, 0);
        EXPECT_LT(slots, 2 * static_cast<double>(plates.size()) * study.build.slot_depth *
                             study.build.thickness * 1.2);
        const auto ideal = ideal_areas(study, finished.design);
        EXPECT_LT(net[0], ideal[0]);
        EXPECT_LT(net[1], ideal[1]);
    }
    // straight along the dispenser: half the plate off each side, exactly
    const FinishedDesign along = straight(study, 0);
    const auto net = chamber_areas(study, along.design, plates_of(study, along.design));
    EXPECT_NEAR(net[0], 0.1 * (0.03 - study.build.thickness / 2), 1e-15);
    EXPECT_NEAR(net[1], net[0], 1e-15);
}

TEST(Plate, one_bend_moves_its_corner_from_one_chamber_to_the_other) {
    const Study study = large();
    FinishedDesign finished = bent();
    finished.design.partition.points = {{0, 0.02}, {0.05, 0.02}, {0.1, 0.05}};  // a left bend
    const auto plates = plates_of(study, finished.design);
    Study sharp = study;
    sharp.build.printed = true;
    const auto round = chamber_areas(study, finished.design, plates),
               mitred = chamber_areas(sharp, finished.design, plates_of(sharp, finished.design));
    const double q = std::atan2(0.03, 0.05), r = study.build.bend_radius, t = study.build.thickness;
    EXPECT_NEAR(round[0] - mitred[0], -r * r * (std::tan(q / 2) - q / 2), 1e-15);
    EXPECT_NEAR(round[1] - mitred[1], (r + t) * (r + t) * (std::tan(q / 2) - q / 2), 1e-15);
}

}  // namespace
}  // namespace gradwright
