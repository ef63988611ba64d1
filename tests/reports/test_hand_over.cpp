// What to fill, when it is marked, and what is engraved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reports/fill_sheet.h"
#include "tests/reports/spec_fixture.h"

namespace gradwright {
namespace {

using namespace fixture;
using testing::HasSubstr;
using testing::Not;

TEST(HandOver, what_to_fill_follows_from_areas_densities_and_dosage) {
    Study study = large();
    study.build.bulk_density = {4400, 0};
    study.build.density_tolerance = 0.02;
    study.scene.bed_depth = 1.05e-3;
    FinishedDesign finished = straight(study, 0);
    finished.bed_packing = 0.55;
    finished.packing_simulated = true;
    finished.waste_fraction = 0.2;
    finished.waste_a_share = 0.25;
    const HandOver over = hand_over(study, finished);
    const double area = 0.1 * (0.03 - study.build.thickness / 2), depth = 0.04;
    const ChamberPlan &a = over.fill.chambers[0], &b = over.fill.chambers[1];
    EXPECT_NEAR(a.volume, area * depth, 1e-15);
    EXPECT_TRUE(a.measured);
    EXPECT_NEAR(a.mass, area * depth * 4400, 1e-9);
    EXPECT_FALSE(b.measured);
    EXPECT_NEAR(b.bulk_density, 0.55 * 8200, 1e-9);
    // both ends at 30 mm, +-0.2 mm each; half the plate's length for each end
    const double moved = 2 * 0.5 * over.plates[0].middle_length() * 0.2e-3;
    EXPECT_NEAR(a.mass_tolerance, 0.02 * a.mass + moved * depth * 4400, 1e-12);
    // half of what the plate took in the well, half of the two slots
    const double slots =
        2 * study.build.slot_depth * (study.build.thickness + 2 * study.build.slot_clearance);
    EXPECT_NEAR(a.top_up, (0.1 * study.build.thickness / 2 + slots / 2) * depth * 4400, 1e-12);
    const double rise = 3 * study.scene.layer_thickness;
    EXPECT_NEAR(over.fill.rise, rise, 1e-15);
    EXPECT_EQ(over.fill.layers, static_cast<int>(std::floor((depth - 1.05e-3) / rise)));
    EXPECT_GE(over.fill.left_over, 1.05e-3);
    const double half = 0.1 * 0.03;
    EXPECT_NEAR(over.fill.dosed, rise * half * (4400 + 0.55 * 8200), 1e-12);
    ASSERT_TRUE(over.fill.overflow);
    const double solid = rise * half * (4400 / 7980.0 + 0.55);
    EXPECT_NEAR(*over.fill.overflow, 0.2 * solid * (0.25 * 7980 + 0.75 * 8200), 1e-12);
    EXPECT_NEAR(*over.fill.overflow_a, 0.25 * 7980 / (0.25 * 7980 + 0.75 * 8200), 1e-12);
    EXPECT_THAT(fill_html(study, over), HasSubstr("SIMULATED: MEASURE BEFORE USE"));
    EXPECT_THAT(fill_html(study, over), HasSubstr("never return it to either chamber"));
}

TEST(HandOver, a_mass_and_its_tolerance_share_unit_and_decimals) {
    EXPECT_EQ(mass_text(2.23194, 0.07974), "2.232 \u00b1 0.080 kg");
    EXPECT_EQ(mass_text(0.01234, 0.0012), "12.3 \u00b1 1.2 g");
    EXPECT_EQ(mass_text(3.4e-6, 12e-6), "3 \u00b1 12 mg");
    EXPECT_EQ(mass_text(0.5, 0.000123), "500.00 \u00b1 0.12 g");
}

TEST(HandOver, says_how_a_plate_with_tabs_is_put_in_and_checked) {
    const Study study = with_tabs(large());
    const std::string html = fill_html(study, hand_over(study, straight(study, 20)));
    EXPECT_THAT(html, HasSubstr("into the notches of the rim"));
    EXPECT_THAT(html, HasSubstr("lower it by 12.5 um"));
    EXPECT_THAT(html, HasSubstr("gap between the plate&#39;s ends and the walls"));
    EXPECT_THAT(html, Not(HasSubstr("with the slots in the walls")));
    EXPECT_THAT(fill_html(large(), hand_over(large(), straight(large(), 20))),
                HasSubstr("with the slots in the walls"));
    // a plate across the dispenser has no arrow to look for
    EXPECT_THAT(html, HasSubstr("the engraved arrow"));
    EXPECT_THAT(fill_html(large(), hand_over(large(), straight(large(), 80))),
                Not(HasSubstr("the engraved arrow")));
}

TEST(HandOver, is_marked_unless_the_target_is_met_by_what_can_be_built) {
    const Study study = large();
    FinishedDesign finished = straight(study, 20);
    EXPECT_EQ(hand_over(study, finished).mark, "");
    finished.verdict = "undecided";
    EXPECT_EQ(hand_over(study, finished).first_line, "NOT VERIFIED: verdict undecided");
    finished.verdict = "not_met";
    EXPECT_EQ(hand_over(study, finished).mark, "NOT VERIFIED: target not met");
    finished.verdict = "met";
    finished.extrapolated = true;
    EXPECT_EQ(hand_over(study, finished).mark, "NOT VERIFIED: extrapolated from strips");
    finished.termination = "failed";
    EXPECT_EQ(hand_over(study, finished).mark, "NOT VERIFIED: the design failed");
    finished = straight(study, 20);
    finished.design.partition.points = {{0, 0.0002}, {0.1, 0.02}};
    EXPECT_EQ(hand_over(study, finished).mark, "CANNOT BE BUILT AS DRAWN: slot_corner");
    finished.design.partition.points = {{0, 0.2}, {0.1, 0.2}};
    EXPECT_THROW(hand_over(study, finished), std::invalid_argument);
}

TEST(HandOver, the_id_is_the_plates) {
    Study study = large();
    const std::string id = hand_over(study, bent()).id;
    EXPECT_EQ(hand_over(study, bent()).id, id);
    FinishedDesign other = bent();
    other.verdict = "undecided";  // the same metal
    EXPECT_EQ(hand_over(study, other).id, id);
    study.build.thickness = 0.4e-3;
    EXPECT_NE(hand_over(study, bent()).id, id);
}

TEST(Drawing, dimensions_the_ends_and_nothing_by_angle) {
    const Study study = large();
    const FinishedDesign finished = straight(study, 20);
    const HandOver over = hand_over(study, finished);
    const std::string html = fill_html(study, over);
    EXPECT_THAT(html, HasSubstr("11.801 \u00b10.2 mm"));  // 30 - 50 tan 20 deg
    EXPECT_THAT(html, HasSubstr("48.199 \u00b10.3 mm"));
    EXPECT_THAT(html, Not(HasSubstr("20.00 deg")));
}

}  // namespace
}  // namespace gradwright
