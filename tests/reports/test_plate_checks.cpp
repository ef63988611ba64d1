// What a workshop can make of a plate, and what the plate leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reports/spec_fixture.h"

namespace gradwright {
namespace {

using namespace fixture;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

TEST(PlateChecks, pass_for_what_can_be_built) {
    for (const auto& [s, f] : every_kind())
        for (const PlateCheck& check : plate_checks(s, plates_of(s, f.design)))
            EXPECT_TRUE(check.passed) << check.id << ": " << check.text;
}

TEST(PlateChecks, each_fails_where_it_should) {
    const auto failed = [](const Study& study, const std::vector<PlanPoint>& points,
                           const std::vector<PlanPoint>& second = {}) {
        FinishedDesign finished = bent();
        finished.design.partition.points = points;
        finished.design.partition.second = second;
        std::vector<std::string> ids;
        for (const PlateCheck& check : plate_checks(study, plates_of(study, finished.design)))
            if (!check.passed) ids.push_back(check.id);
        return ids;
    };
    const Study study = large();
    // 2 mm between two bends of 45 deg whose tangents take 2 x 1.25 mm tan(22.5 deg) = 1.04 mm: enough; 1 mm:
    // not
    EXPECT_THAT(failed(study, {{0, 0.02},
                               {0.05, 0.02},
                               {0.05 + 0.002 * std::sqrt(0.5), 0.02 + 0.002 * std::sqrt(0.5)},
                               {0.1, 0.0214}}),
                IsEmpty());
    EXPECT_THAT(failed(study, {{0, 0.02},
                               {0.05, 0.02},
                               {0.05 + 0.001 * std::sqrt(0.5), 0.02 + 0.001 * std::sqrt(0.5)},
                               {0.1, 0.0207}}),
                ElementsAre("bends"));
    Study tight = study;
    tight.build.bend_radius = 0.2e-3;
    EXPECT_THAT(failed(tight, {{0, 0.02}, {0.05, 0.02}, {0.1, 0.03}}), ElementsAre("bend_radius"));
    Study thick = study;
    thick.build.printed = true;
    thick.build.thickness = 3e-3;  // folded back onto itself within its own thickness
    EXPECT_THAT(failed(thick, {{0, 0.02}, {0.05, 0.02}, {0.0505, 0.021}, {0.05, 0.022}, {0.1, 0.04}}),
                testing::Contains("outline"));
    EXPECT_THAT(failed(study, {{0, 0.0301}, {0.1, 0.0301}}, {{0.1, 0.0298}, {0, 0.0298}}),
                ElementsAre("plates_apart"));
    EXPECT_THAT(failed(study, {{0, 0.02}, {0.05, 0.0001}, {0.1, 0.02}}),
                ElementsAre("in_the_well", "withdrawal"));
    EXPECT_THAT(failed(study, {{0, 0.0002}, {0.1, 0.02}}), ElementsAre("slot_corner"));
    EXPECT_THAT(failed(study, {{0, 0.02}, {0.003, 0.03}, {0.1, 0.03}}), testing::Contains("slot_angle"));
    Study coarse = study;
    coarse.build.least_slot_width = 0.6e-3;
    EXPECT_THAT(failed(coarse, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("slot_width"));
    Study leaky = study;
    leaky.build.clearance = finest_d10(study);
    EXPECT_THAT(failed(leaky, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("clearance"));
    // the machine around it, where it is known
    Study machine = study;
    machine.build.wall_thickness = machine.build.slot_depth;
    EXPECT_THAT(failed(machine, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("wall_thickness"));
    machine.build.wall_thickness = machine.build.slot_depth + 1e-6;
    EXPECT_THAT(failed(machine, {{0, 0.02}, {0.1, 0.03}}), IsEmpty());
    machine.build.headroom = 0.04 + machine.build.grip - machine.build.clearance - 1e-6;
    EXPECT_THAT(failed(machine, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("withdrawal"));
    machine.build.headroom += 2e-6;
    EXPECT_THAT(failed(machine, {{0, 0.02}, {0.1, 0.03}}), IsEmpty());
    // a bend 1 mm inside the wall: its arc takes 0.4 mm of it, a tab's cut half the sheet at this slant
    const Study tabs = with_tabs(study);
    EXPECT_THAT(failed(tabs, {{0, 0.02}, {0.001, 0.0205}, {0.1, 0.03}}), IsEmpty());
    EXPECT_THAT(failed(tabs, {{0, 0.02}, {0.0003, 0.02015}, {0.1, 0.0202}}), testing::Contains("tabs"));
    Study wide = tabs;
    wide.build.end_clearance = finest_d10(study);
    EXPECT_THAT(failed(wide, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("end_gap"));
}

TEST(PlateChecks, general_tolerances_are_iso_2768_m) {
    for (const auto& [length_mm, tolerance_mm] : {std::pair{0.5, 0.1},
                                                  {3.0, 0.1},
                                                  {3.001, 0.1},
                                                  {6.0, 0.1},
                                                  {6.001, 0.2},
                                                  {30.0, 0.2},
                                                  {30.001, 0.3},
                                                  {120.0, 0.3},
                                                  {120.001, 0.5},
                                                  {400.0, 0.5},
                                                  {400.001, 0.8}})
        EXPECT_DOUBLE_EQ(linear_tolerance(length_mm * 1e-3), tolerance_mm * 1e-3) << length_mm;
}

TEST(PlateChecks, a_slot_is_simulated_only_with_this_plate_at_full_depth) {
    Study study = large();
    const FinishedDesign finished = straight(study, 20);
    const auto effect = [&] {
        return slot_effect(study, finished.design, plates_of(study, finished.design));
    };
    EXPECT_FALSE(effect().simulated);
    EXPECT_THAT(effect().text, StartsWith("NOT SIMULATED"));
    study.scene.plate_thickness = study.build.thickness;
    EXPECT_FALSE(effect().simulated);  // the bed is shallower than the dispenser
    study.scene.bed_depth = study.scene.dispenser_depth;
    EXPECT_TRUE(effect().simulated);
    study.scene.plate_thickness = 0.2e-3;
    EXPECT_FALSE(effect().simulated);
    // a triangle at 30 deg of repose holds the slot's area t D
    const SlotEffect e = effect();
    EXPECT_NEAR(0.5 * e.depth * e.width, study.build.thickness * study.scene.dispenser_depth, 1e-12);
    EXPECT_NEAR(e.depth / (e.width / 2), std::tan(30 * kDegree), 1e-12);
    EXPECT_NEAR(e.volume, study.build.thickness * 0.1 / std::cos(20 * kDegree) * study.scene.dispenser_depth,
                1e-12);
}

}  // namespace
}  // namespace gradwright
