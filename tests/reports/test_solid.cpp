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

#if GRADWRIGHT_TEST_STEP
TEST(Step, reads_back_with_the_closed_forms_volume_box_and_faces) {
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    const Study study = large();
    for (const auto& [s, f] : {std::pair{study, straight(study, 20)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}})
        for (const StepSchema schema : {StepSchema::ap214, StepSchema::ap242}) {
            const HandOver over = hand_over(s, f);
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
#endif

}  // namespace
}  // namespace gradwright
