// The solids: the STL read back as a closed mesh, the STEP by OpenCASCADE.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <sstream>

#include "reports/safe_write.h"
#include "reports/step_file.h"
#include "reports/stl_file.h"
#include "tests/reports/spec_fixture.h"
#if GRADWRIGHT_TEST_STEP
#include "tests/reports/step_reader.h"
#endif

namespace gradwright {
namespace {

using namespace fixture;

TEST(Stl, is_closed_and_holds_the_plate) {
    for (const auto& [s, f] : every_kind()) {
        const auto plates = hand_over(s, f).plates;
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

/// Points of the letters as someone in front of the plate sees them: from the mesh, where its floors lie.
TEST(Stl, what_is_engraved_reads_from_the_side_that_it_names) {
    const Study study = large();
    const HandOver over =
        hand_over(study, straight(study, 0));  // along x at y = 30 mm; A beyond, B before it
    const Plate& plate = over.plates[0];
    const auto mesh = plate_mesh(plate, 1e-6);
    for (const std::size_t side : {0u, 1u}) {
        const double out = side == 0 ? 1 : -1,  // way to the reader, along y
            floor = 30 + out * (0.5 * plate.thickness - study.build.engraving) * 1e3;
        const auto carved = [&](double x, double z) {
            for (const auto& [a, b, c] : mesh) {
                if (std::abs(a[1] - floor) + std::abs(b[1] - floor) + std::abs(c[1] - floor) > 1e-9) continue;
                const auto turn = [&](const MeshPoint& p, const MeshPoint& q) {
                    return (q[0] - p[0]) * (z - p[2]) - (q[2] - p[2]) * (x - p[0]);
                };
                const double u = turn(a, b), v = turn(b, c), w = turn(c, a);
                if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) return true;
            }
            return false;
        };
        const MarkText& text = over.marks[0][side];
        EXPECT_EQ(text.lines[1], side == 0 ? "SIDE A" : "SIDE B");
        EXPECT_EQ(text.lines[0], over.id + " P");
        // the reader's right is +x on side B, -x on side A: the spreading direction
        EXPECT_EQ(text.lines[2], side == 0 ? "<---" : "--->");
        const double point = text.letter * 1e3 / 7;
        EXPECT_NEAR(text.letter, 3.5e-3, 1e-12);
        int wrong = 0, points = 0;
        for (std::size_t l = 0; l < text.lines.size(); ++l)
            for (std::size_t c = 0; c < text.lines[l].size(); ++c) {
                const auto letter = letter_points(text.lines[l][c]);
                const double indent =
                    static_cast<double>((text.lines[0].size() - text.lines[l].size()) * 6 / 2);
                for (std::size_t r = 0; r < letter.size(); ++r)
                    for (std::size_t k = 0; k < letter[r].size(); ++k) {
                        const double across = indent + 6.0 * static_cast<double>(c) + static_cast<double>(k) +
                                              0.53 -
                                              0.5 * (6.0 * static_cast<double>(text.lines[0].size()) - 1);
                        const double x = 50 - out * across * point;
                        const double z =
                            plate.z_high * 1e3 * 0.95 -
                            (10.0 * static_cast<double>(l) + static_cast<double>(r) + 0.48) * point;
                        wrong += carved(x, z) != (letter[r][k] == '#');
                        ++points;
                    }
            }
        EXPECT_GT(points, 600);
        EXPECT_EQ(wrong, 0) << "side " << side;
    }
}

TEST(Marks, touch_nowhere_and_stay_above_the_rim_within_their_faces) {
    for (const auto& [s, f] : every_kind())
        for (const Plate& plate : hand_over(s, f).plates) {
            ASSERT_GT(plate.marks.size(), 100u);
            double engraved = 0;
            for (std::size_t i = 0; i < plate.marks.size(); ++i) {
                const Mark& a = plate.marks[i];
                const PlatePiece& piece = plate.pieces[a.piece];
                EXPECT_EQ(piece.turn, 0);
                EXPECT_GT(a.from, 0);
                EXPECT_LT(a.to, std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y));
                EXPECT_GT(a.low, 0);
                EXPECT_LT(a.high, plate.z_high);
                engraved += (a.to - a.from) * (a.high - a.low) * s.build.engraving;
                for (std::size_t k = i + 1; k < plate.marks.size(); ++k) {
                    const Mark& b = plate.marks[k];
                    EXPECT_FALSE(a.side == b.side && a.piece == b.piece && a.from <= b.to && b.from <= a.to &&
                                 a.low <= b.high && b.low <= a.high);
                }
            }
            Plate plain = plate;
            plain.marks.clear();
            EXPECT_NEAR(plate.volume(), plain.volume() - engraved, 1e-15);
            EXPECT_EQ(plate.faces(), plain.faces() + 5 * static_cast<int>(plate.marks.size()));
        }
}

#if GRADWRIGHT_TEST_STEP
TEST(Step, reads_back_with_the_closed_forms_volume_box_and_faces) {
    const std::vector<Built> kinds = every_kind();
    for (std::size_t kind = 0; kind < kinds.size(); ++kind)
        for (const StepSchema schema : {StepSchema::ap214, StepSchema::ap242}) {
            // engraved: straight, bent and printed, with tabs; a thousand faces each cost seconds
            const bool marked = kind == 1 || kind == 5 || kind == 9;
            if (schema == StepSchema::ap242 && marked) continue;
            const auto& [s, f] = kinds[kind];
            HandOver over = hand_over(s, f);
            if (!marked) over.plates = plates_of(s, f.design);
            const std::string path = testing::TempDir() + "gradwright_partition.step";
            write_step(over.plates, {over.id, "1.4301 0.5 mm", over.first_line, "owner", "creator"}, schema,
                       path);
            // a file of thousands of lines: found or not, never printed
            EXPECT_NE(
                read_file(path).find(schema == StepSchema::ap214 ? "'AUTOMOTIVE_DESIGN" : "'AP242_MANAGED"),
                std::string::npos);
            const auto solids = read_step(path);
            std::remove(path.c_str());
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

/// What is left of the well around the plates, cut by OpenCASCADE from the file that was written.
TEST(Step, chambers_measured_on_the_solid_are_the_closed_forms) {
    for (const auto& [s, f] : every_kind()) {
        const HandOver over = hand_over(s, f);
        const std::string path = testing::TempDir() + "gradwright_chambers.step";
        // not engraved: that is above the rim
        write_step(plates_of(s, f.design), {over.id, "", "", "", ""}, StepSchema::ap214, path);
        const double length = s.scene.dispenser_length, width = s.dispenser_width,
                     depth = s.scene.dispenser_depth;
        const auto area = chamber_areas(s, f.design, over.plates);
        const std::array<double, 2> volume = {over.fill.chambers[0].volume, over.fill.chambers[1].volume};
        if (s.build.tabs) {  // gaps join the chambers: their sum, and the powder under the plate
            double foot = length * width - area[0] - area[1], total = 0;
            for (const Plate& plate : over.plates)
                for (const PlateEnd& end : plate.ends) foot -= plate.thickness * end.gap;
            for (const WellPart& part : read_well(path, {0, 0, -depth}, {length, width, 0}))
                total += part.volume;
            EXPECT_NEAR(total, volume[0] + volume[1] + foot * s.build.clearance, 1e-8 * total);
        } else {
            std::array<double, 2> found{};
            for (const WellPart& part :
                 read_well(path, {0, 0, -depth + s.build.clearance}, {length, width, 0}))
                found[f.design.partition.on_side_a(part.centre.x, part.centre.y) ? 0 : 1] += part.volume;
            for (const std::size_t k : {0u, 1u}) {
                EXPECT_NEAR(found[k], area[k] * (depth - s.build.clearance), 1e-8 * found[k]) << k;
                EXPECT_NEAR(volume[k], area[k] * depth, 1e-15);
            }
        }
        std::remove(path.c_str());
    }
}
#endif

}  // namespace
}  // namespace gradwright
