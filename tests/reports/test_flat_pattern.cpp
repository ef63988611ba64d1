// Flat patterns against closed forms, and read back from their DXF.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "reports/dxf_file.h"
#include "tests/reports/spec_fixture.h"

namespace gradwright {
namespace {

using namespace fixture;
using testing::StartsWith;

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
    const std::string text = dxf_text(flats, {"NOT VERIFIED: for a test \u00b1", {"note"}});
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
        if (code == 10 && kind == "VERTEX" && layer == "CUT") outline.push_back({std::stod(value), 0});
        if (code == 20 && kind == "VERTEX" && layer == "CUT") outline.back()[1] = std::stod(value);
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

}  // namespace
}  // namespace gradwright
