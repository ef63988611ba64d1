// The hand-over: plates against closed forms, each file read back, by OpenCASCADE where it is the STEP's
// reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "optimise/build_section.h"
#include "optimise/partition_family.h"
#include "reports/dxf_file.h"
#include "reports/fill_sheet.h"
#include "reports/partition_drawing.h"
#include "reports/safe_write.h"
#include "reports/sha256.h"
#include "reports/spec_folder.h"
#include "reports/spec_json.h"
#include "reports/stl_file.h"
#include "tests/reports/fixture.h"
#if GRADWRIGHT_TEST_STEP
#include "tests/reports/step_reader.h"
#endif

namespace gradwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr double kDegree = std::numbers::pi / 180;

FinishedDesign straight(const Study& study, double degrees, double offset = 0) {
    FinishedDesign finished;
    finished.verdict = "met";
    finished.design.family = Family::straight;
    finished.design.partition =
        straight_partition(study.scene.dispenser_length, study.dispenser_width, degrees * kDegree, offset);
    finished.design.dosage_factor = 3;
    finished.design.land = study.scene.land;
    return finished;
}

/// A dispenser of 100 x 60 x 40 mm, in which sheet of 0.5 mm is thin.
Study large() {
    Study study = fixture::study("large machine");
    study.scene.dispenser_length = study.scene.platform_length = 0.1;
    study.dispenser_width = study.scene.width = 0.06;
    study.scene.dispenser_depth = 0.04;
    study.build.thickness = 0.5e-3;
    study.build.bend_radius = 1e-3;
    study.build.k_factor = din_k_factor(1e-3, 0.5e-3);
    return study;
}

FinishedDesign bent() {
    FinishedDesign finished;
    finished.verdict = "met";
    finished.design.partition.points = {{0, 0.01}, {0.04, 0.02}, {0.07, 0.04}, {0.1, 0.045}};
    finished.design.dosage_factor = 2;
    finished.waste_fraction = 0.2;
    finished.waste_a_share = 0.25;
    return finished;
}

FinishedDesign pair_of_curves() {
    FinishedDesign finished = bent();
    finished.design.family = Family::two_curves;
    finished.design.partition.points = {{0, 0.04}, {0.05, 0.045}, {0.1, 0.04}};
    finished.design.partition.second = {{0.1, 0.02}, {0.05, 0.015}, {0, 0.02}};
    return finished;
}

FinishedDesign smooth(Study& study) {
    study.build.printed = true;
    study.build.thickness = 1e-3;
    FinishedDesign finished = bent();
    finished.design.family = Family::spline;
    finished.design.partition.points =
        spline_through(std::vector<PlanPoint>{{0, 0.01}, {0.03, 0.015}, {0.06, 0.04}, {0.1, 0.05}});
    return finished;
}

double length_of(const std::vector<PlanPoint>& line) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        sum += std::hypot(line[i + 1].x - line[i].x, line[i + 1].y - line[i].y);
    return sum;
}

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

// --- plates

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

// --- checks

TEST(PlateChecks, pass_for_what_can_be_built) {
    Study study = large();
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    for (const auto& [s, f] : {std::pair{study, straight(study, 20)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}})
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
    EXPECT_THAT(failed(study, {{0, 0.02}, {0.05, 0.0001}, {0.1, 0.02}}), ElementsAre("in_the_well"));
    EXPECT_THAT(failed(study, {{0, 0.0002}, {0.1, 0.02}}), ElementsAre("slot_corner"));
    EXPECT_THAT(failed(study, {{0, 0.02}, {0.003, 0.03}, {0.1, 0.03}}), testing::Contains("slot_angle"));
    Study coarse = study;
    coarse.build.least_slot_width = 0.6e-3;
    EXPECT_THAT(failed(coarse, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("slot_width"));
    Study leaky = study;
    leaky.build.clearance = finest_d10(study);
    EXPECT_THAT(failed(leaky, {{0, 0.02}, {0.1, 0.03}}), ElementsAre("clearance"));
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

// --- flat pattern

TEST(FlatPattern, is_straight_lengths_and_bend_allowances) {
    const Study study = large();
    const Plate plate = plates_of(study, bent().design)[0];
    const FlatPattern flat = flat_pattern(plate);
    const double r = study.build.bend_radius, t = study.build.thickness, k = study.build.k_factor;
    EXPECT_NEAR(k, (0.65 + 0.5 * std::log10(2.0)) / 2, 1e-15);  // DIN 6935
    double expected = length_of(plate.corners);
    for (const double q : plate.turns)
        expected += std::abs(q) * (r + k * t) - 2 * (r + t / 2) * std::tan(std::abs(q) / 2);
    EXPECT_NEAR(flat.length, expected, 1e-15);
    ASSERT_EQ(flat.bends.size(), 2u);
    const double first =
        std::hypot(plate.corners[1].x - plate.corners[0].x, plate.corners[1].y - plate.corners[0].y) -
        (r + t / 2) * std::tan(plate.turns[0] / 2);
    EXPECT_NEAR(flat.bends[0].at, first + plate.turns[0] * (r + k * t) / 2, 1e-15);
    EXPECT_EQ(flat.arrow, 1);
    EXPECT_NEAR(flat.rim, study.scene.dispenser_depth - study.build.clearance, 1e-15);
    EXPECT_DOUBLE_EQ(din_k_factor(10e-3, 1e-3), 0.5);
}

TEST(Dxf, reads_back_as_outline_and_bends_on_their_layers) {
    const Study study = large();
    const auto plates = plates_of(study, pair_of_curves().design);
    std::vector<FlatPattern> flats;
    for (const Plate& plate : plates) flats.push_back(flat_pattern(plate));
    const std::string text = dxf_text(flats, {"NOT VERIFIED: for a test \u00b1", "GW-01234567", {"note"}});
    EXPECT_THAT(text, StartsWith("999\nNOT VERIFIED: for a test ?\n"));
    for (const char c : text) ASSERT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f));
    std::istringstream stream(text);
    std::vector<std::pair<int, std::string>> pairs;
    for (std::string code, value; std::getline(stream, code) && std::getline(stream, value);)
        pairs.emplace_back(std::stoi(code), value);
    EXPECT_EQ(pairs.back(), std::pair(0, std::string("EOF")));
    // entities: kind, layer, coordinates
    std::vector<std::array<double, 2>> outline;
    std::vector<double> bends;
    std::set<std::string> layers, declared;
    std::string kind, layer;
    bool in_layers = false;
    for (const auto& [code, value] : pairs) {
        if (code == 0) kind = value;
        if (code == 2 && kind == "TABLE") in_layers = value == "LAYER";
        if (code == 2 && kind == "LAYER" && in_layers) declared.insert(value);
        if (code == 8) layer = value;
        if (code == 8) layers.insert(value);
        if (code == 10 && kind == "VERTEX") outline.push_back({std::stod(value), 0});
        if (code == 20 && kind == "VERTEX") outline.back()[1] = std::stod(value);
        if (code == 10 && kind == "LINE" && layer == "BEND") bends.push_back(std::stod(value));
    }
    for (const std::string& used : layers) EXPECT_TRUE(declared.contains(used)) << used;
    EXPECT_THAT(declared, testing::IsSupersetOf({"CUT", "BEND", "ETCH", "DIM"}));
    ASSERT_EQ(outline.size(), 8u);
    ASSERT_EQ(bends.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(outline[4 * i + 2][0] - outline[4 * i][0], flats[i].length * 1e3, 1e-6);
        EXPECT_NEAR(outline[4 * i + 2][1] - outline[4 * i][1], flats[i].height * 1e3, 1e-6);
        EXPECT_NEAR(bends[i], flats[i].bends[0].at * 1e3, 1e-6);
    }
    EXPECT_GT(outline[4][1], outline[2][1]);  // the second lies clear of the first
}

// --- STL

TEST(Stl, is_closed_and_holds_the_plate) {
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    const Study study = large();
    for (const auto& [s, f] : {std::pair{study, straight(study, -35)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}}) {
        const auto plates = plates_of(s, f.design);
        std::istringstream text(stl_text(plates, "GW-1 first\nline"));
        std::string word;
        std::getline(text, word);
        EXPECT_EQ(word, "solid GW-1 first line");
        std::map<std::pair<MeshPoint, MeshPoint>, int> edges;
        double volume = 0;  // [mm3], divergence theorem
        std::vector<MeshPoint> corner;
        while (text >> word) {
            if (word != "vertex") continue;
            MeshPoint p;
            text >> p[0] >> p[1] >> p[2];
            corner.push_back(p);
            if (corner.size() < 3) continue;
            const auto& [a, b, c] = std::tie(corner[0], corner[1], corner[2]);
            for (int i = 0; i < 3; ++i) ++edges[{corner[i], corner[(i + 1) % 3]}];
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0])) /
                      6;
            corner.clear();
        }
        ASSERT_FALSE(edges.empty());
        for (const auto& [edge, count] : edges) {
            EXPECT_EQ(count, 1);
            EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
        }
        double expected = 0, bends = 0;
        for (const Plate& plate : plates) {
            expected += plate.volume() * 1e9;
            bends += static_cast<double>(plate.turns.size());
        }
        // chords stand off by 2 um at most, over a bend's arc; the file has six decimals
        const double arcs = s.build.printed ? 0 : bends * 2 * 2e-3 * 1.5 * 60;
        EXPECT_NEAR(volume, expected, arcs + 1e-3);
        EXPECT_GT(volume, 0);  // the normals point out
    }
}

// --- SHA-256

TEST(Sha256, gives_the_published_digests) {  // FIPS 180-4, examples of NIST's cryptographic toolkit
    EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sha256(std::string(1000000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// --- fill sheet

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
    EXPECT_NEAR(a.top_up, 0.1 * study.build.thickness / 2 * depth * 4400, 1e-12);
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

// --- the folder

class SpecFolder : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "gradwright_spec_XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string written(const std::string& name) const { return read_file(folder_ + "/" + name); }
    std::string folder_;
};

TEST_F(SpecFolder, gives_the_same_bytes_twice_and_a_manifest_over_them) {
    const Study study = large();
    FinishedDesign finished = bent();
    finished.verdict = "undecided";
    const HandOver over = hand_over(study, finished);
    const SpecFiles files = write_spec(study, finished, over, StepSchema::ap214, folder_ + "/1");
    write_spec(study, finished, over, StepSchema::ap214, folder_ + "/2");
    EXPECT_EQ(files.step, step_available());
    EXPECT_EQ(written("1/manifest.sha256"), written("2/manifest.sha256"));
    std::istringstream manifest(written("1/manifest.sha256"));
    std::size_t lines = 0;
    for (std::string digest, name; manifest >> digest >> name; ++lines)
        EXPECT_EQ(sha256(written("1/" + name)), digest) << name;
    EXPECT_EQ(lines + 1, files.names.size());
    EXPECT_THAT(written("1/drawing.pdf"), StartsWith("%PDF-1."));
    EXPECT_THAT(written("1/fill_sheet.pdf"), StartsWith("%PDF-1."));
    // two calls within a second agree on today's date too: the fixed one must be there
    for (const char* name : {"1/drawing.pdf", "1/fill_sheet.pdf"})
        EXPECT_NE(written(name).find("20000101000000Z)"), std::string::npos) << name;
    if (files.step) {
        EXPECT_NE(written("1/partition.step").find("'2000-01-01T00:00:00'"), std::string::npos);
    }
    const std::string mark = "NOT VERIFIED: verdict undecided";
    for (const char* name : {"partition.stl", "flat_pattern.dxf", "fill_sheet.html", "spec.json"})
        EXPECT_THAT(written(std::string("1/") + name), HasSubstr(mark)) << name;
    if (files.step) {
        EXPECT_NE(written("1/partition.step").find(mark), std::string::npos);
    }
}

/// Required names, types and constants of a schema; enough of JSON Schema for what docs/schema uses.
void validate(const json& value, const json& schema, const std::string& where) {
    const auto is = [&value](const std::string& type) {
        return type == "object"    ? value.is_object()
               : type == "array"   ? value.is_array()
               : type == "string"  ? value.is_string()
               : type == "boolean" ? value.is_boolean()
               : type == "integer" ? value.is_number_integer()
               : type == "number"  ? value.is_number()
                                   : value.is_null();
    };
    if (schema.contains("type")) {
        bool any = false;
        for (const json& type : schema["type"].is_array() ? schema["type"] : json::array({schema["type"]}))
            any = any || is(type.get<std::string>());
        EXPECT_TRUE(any) << where << " is " << value.dump() << ", not " << schema["type"].dump();
    }
    if (schema.contains("const")) {
        EXPECT_EQ(value, schema["const"]) << where;
    }
    if (schema.contains("enum")) {
        EXPECT_THAT(schema["enum"], testing::Contains(value)) << where;
    }
    if (value.is_object()) {
        for (const json& name : schema.value("required", json::array()))
            EXPECT_TRUE(value.contains(name.get<std::string>())) << where << " lacks " << name;
        // named first: a range-for does not keep the temporary behind items() alive
        const json properties = schema.value("properties", json::object());
        for (const auto& [name, inner] : properties.items())
            if (value.contains(name)) validate(value[name], inner, where + "." + name);
        if (schema.value("additionalProperties", json(true)) == json(false)) {
            for (const auto& [name, ignored] : value.items())
                EXPECT_TRUE(schema["properties"].contains(name))
                    << where << " has " << name << ", which the schema does not know";
        }
    }
    if (value.is_array() && schema.contains("items"))
        for (const json& item : value) validate(item, schema["items"], where + "[]");
}

TEST(SpecJson, is_what_its_schema_says) {
    const json schema =
        json::parse(read_file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/spec.schema.json"));
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    const Study study = large();
    for (const auto& [s, f] : {std::pair{study, straight(study, 20)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}})
        validate(spec_json(s, f, hand_over(s, f), {"spec.json"}), schema, "spec");
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

#if GRADWRIGHT_TEST_STEP
TEST_F(SpecFolder, step_reads_back_with_the_closed_forms_volume_box_and_faces) {
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    const Study study = large();
    for (const auto& [s, f] : {std::pair{study, straight(study, 20)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}})
        for (const StepSchema schema : {StepSchema::ap214, StepSchema::ap242}) {
            const HandOver over = hand_over(s, f);
            const std::string path = folder_ + "/partition.step";
            write_step(over.plates, {over.id, "1.4301 0.5 mm", over.first_line, "owner", "creator"}, schema,
                       path);
            // a file of thousands of lines: found or not, never printed
            EXPECT_NE(
                read_file(path).find(schema == StepSchema::ap214 ? "'AUTOMOTIVE_DESIGN" : "'AP242_MANAGED"),
                std::string::npos);
            const auto solids = read_step(path);
            ASSERT_EQ(solids.size(), over.plates.size());
            for (std::size_t i = 0; i < solids.size(); ++i) {
                const Plate& plate = over.plates[i];
                EXPECT_TRUE(solids[i].valid);
                EXPECT_EQ(solids[i].name, over.id + " " + plate.name);
                EXPECT_EQ(solids[i].description, "1.4301 0.5 mm");
                EXPECT_NEAR(solids[i].volume, plate.volume() * 1e9, 1e-6 * plate.volume() * 1e9);
                EXPECT_EQ(solids[i].faces, plate.faces());
                const auto box = plate.box(1e-9);
                const double expected[] = {box[0].x, box[0].y, plate.z_low, box[1].x, box[1].y, plate.z_high};
                for (int k = 0; k < 6; ++k) EXPECT_NEAR(solids[i].box[k], expected[k] * 1e3, 1e-5) << k;
            }
        }
}
#endif

}  // namespace
}  // namespace gradwright
