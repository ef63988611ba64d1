// Which of several layers is judged, and what each of them is told to be.
#include "optimise/laid_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "optimise/dem_evaluator.h"
#include "optimise/map_evaluator.h"
#include "optimise/study_file.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;
using testing::Contains;
using testing::HasSubstr;

Study several(int layers, int judged) {
    Study study = coupon();
    study.scene.sides = Sides::periodic;
    study.scene.layers = layers;
    study.judged_layer = judged;
    return study;
}

/// A heap that is laid from further back with every layer, and a little less of it.
SpreadFunction layered_engine() {
    return [](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        SpreadResult result;
        Calls calls;
        for (int k = 0; k < scene.layers; ++k) {
            Heap heap;
            heap.centre = 0.5 + 0.08 * k;
            heap.capture = 0.6 - 0.1 * k;
            Scene own = scene;
            own.seed = scene.seed + 1000 * std::uint64_t(k);
            SpreadResult one = spread(heap, calls, own, partition);
            if (k + 1 < scene.layers)
                result.earlier.push_back(one.layer);
            else
                one.earlier = std::move(result.earlier), one.passes = std::move(result.passes),
                result = std::move(one);
            if (scene.layers > 1) result.passes.push_back({1e-12 * (k + 1), 0});
        }
        return result;
    };
}

struct Told {
    Evaluation evaluation;
    SpreadResult spread;
};
Told spread_once(const Study& study) {
    RunOptions options;
    options.spread = layered_engine();
    SpreadRunner runner(options);
    DemEvaluator evaluator(study, runner, nullptr);
    Told told;
    told.evaluation = evaluator.evaluate(start_design(study), 5);
    told.spread = evaluator.last();
    return told;
}

TEST(JudgedLayer, is_the_last_one_where_nothing_else_is_asked_for) {
    const Told told = spread_once(several(3, kLastLayer));
    const Evaluation& e = told.evaluation;
    ASSERT_TRUE(e.health.ok()) << e.health.reason;
    ASSERT_EQ(e.layers.size(), 3u);
    EXPECT_EQ(e.profile.gi, e.layers[2].profile.gi);
    EXPECT_EQ(e.drift.difference, e.layers[2].drift.difference);
    EXPECT_EQ(e.misfit.value, e.layers[2].misfit.value);
    EXPECT_EQ(e.map.gi, e.layers[2].map.gi);
    EXPECT_NE(e.profile.gi, e.layers[0].profile.gi);
    EXPECT_NEAR(e.capture_fraction, 0.4, 1e-12);
}

TEST(JudgedLayer, by_number_is_that_one_with_its_own_fractions) {
    for (const int number : {1, 2, 3}) {
        const Told told = spread_once(several(3, number));
        const Evaluation& e = told.evaluation;
        const LaidLayer& own = e.layers.at(static_cast<std::size_t>(number) - 1);
        EXPECT_EQ(e.profile.gi, own.profile.gi);
        EXPECT_EQ(e.misfit.value, own.misfit.value);
        EXPECT_EQ(e.drift_misfit.value, own.drift_misfit.value);
        EXPECT_NEAR(e.capture_fraction, 0.6 - 0.1 * (number - 1), 1e-12);
        EXPECT_NEAR(e.waste_fraction, 1 - e.capture_fraction, 1e-12);
        EXPECT_EQ(own.number, number);
        EXPECT_EQ(own.raised_solid_volume, 1e-12 * number);
    }
}

TEST(JudgedLayer, all_are_their_grains_in_one_profile) {
    Study study = several(3, kAllLayers);
    study.scene.sides = Sides::frictional;  // bins of their own grains: GI of a bin = A's volume over all
    const Told told = spread_once(study);
    const Evaluation& e = told.evaluation;
    std::size_t defined = 0;
    for (std::size_t b = 0; b < e.profile.gi.size(); ++b) {
        double a = 0, all = 0;
        for (const LaidLayer& layer : e.layers) {
            if (!(layer.profile.volume[b] > 0)) continue;
            a += layer.profile.gi[b] * layer.profile.volume[b];
            all += layer.profile.volume[b];
        }
        if (!(all > 0)) continue;
        ++defined;
        EXPECT_NEAR(e.profile.gi[b], a / all, 1e-12);
    }
    EXPECT_GT(defined, 4u);
    double laid = 0, dosed = 0;
    for (const LaidLayer& layer : e.layers) {
        laid += layer.laid_solid_volume;
        dosed += layer.dosed_solid_volume;
    }
    EXPECT_NEAR(e.capture_fraction, laid / dosed, 1e-12);
    const Scene& s = study.scene;
    EXPECT_NEAR(e.packing_fraction, laid / (3 * s.gap * s.platform_length * s.width), 1e-12);
    // one dose for what one layer holds on average
    const Scene spread = scene_of(study, start_design(study), false, 5);
    EXPECT_NEAR(e.supply_ratio, spread.dose_height * 0.55 * s.dispenser_length * s.width / (laid / 3), 1e-9);
}

TEST(JudgedLayer, of_one_layer_is_that_layer_and_nothing_is_told_beside_it) {
    const Told told = spread_once(several(1, kLastLayer));
    EXPECT_TRUE(told.evaluation.layers.empty());
    for (const int judged : {kAllLayers, 1}) {
        const Told same = spread_once(several(1, judged));
        EXPECT_EQ(same.evaluation.profile.gi, told.evaluation.profile.gi);
        EXPECT_EQ(same.evaluation.supply_ratio, told.evaluation.supply_ratio);
    }
}

TEST(JudgedLayer, is_what_the_map_is_made_of) {
    RunOptions options;
    options.spread = layered_engine();
    std::vector<std::vector<double>> gi;
    for (const int judged : {1, 2, kLastLayer}) {
        const Study study = several(2, judged);
        SpreadRunner runner(options);
        MapEvaluator maps(study, runner, nullptr);
        const Design design = start_design(study);
        const Evaluation e = maps.quoted(design);
        ASSERT_TRUE(e.health.ok());
        ASSERT_EQ(e.layers.size(), 2u);
        EXPECT_EQ(e.profile.gi, e.layers.at(judged == 1 ? 0 : 1).profile.gi);
        EXPECT_NEAR(e.capture_fraction, judged == 1 ? 0.6 : 0.5, 1e-12);
        EXPECT_TRUE(maps.quick(design).layers.empty());
        EXPECT_NEAR(maps.quick(design).misfit.value, e.misfit.value, 1e-12);  // summed in another order
        gi.push_back(e.profile.gi);
    }
    EXPECT_NE(gi[0], gi[1]);
    EXPECT_EQ(gi[1], gi[2]);
}

TEST(ChamberFillOfLayers, levels_act_in_the_first_and_in_all_together_by_their_doses) {
    Study study = several(4, 1);
    Design design = start_design(study);
    design.fill_fraction = {1, 0.95};
    const double h = scene_of(study, design, false, 0).dose_height, c = 0.05 * study.scene.dispenser_depth;
    EXPECT_DOUBLE_EQ(chamber_fill(study, design).dose[0], h);
    EXPECT_DOUBLE_EQ(chamber_fill(study, design).dose[1], h - c);
    study.judged_layer = 3;
    EXPECT_TRUE(chamber_fill(study, design).level());
    study.judged_layer = kLastLayer;
    EXPECT_TRUE(chamber_fill(study, design).level());
    EXPECT_FALSE(chamber_fill_of_layer(study, design, 1).level());
    study.judged_layer = kAllLayers;
    EXPECT_NEAR(chamber_fill(study, design).dose[0], 4 * h, 1e-15);
    EXPECT_NEAR(chamber_fill(study, design).dose[1], 4 * h - c, 1e-15);
    study.scene.layers = 1;
    EXPECT_DOUBLE_EQ(chamber_fill(study, design).dose[1], h - c);
}

const std::string kHead =
    "[machine]\nuse = \"coupon-rig\"\n[powder.A]\nmaterial = \"SS17-4PH\"\n[powder.B]\nmaterial = "
    "\"IN718\"\n";
const std::string kTarget =
    "[target]\nshape = \"linear\"\nfrom = { y = \"0.4 mm\", gi = 0.0 }\nto = { y = \"1.2 mm\", gi = 1.0 }\n";

Study parsed(const std::string& process, const std::string& target = "", const std::string& rest = "") {
    return parse_study(kHead + "[process]\n" + process + kTarget + target + rest, "layers.toml");
}

TEST(LayersInAStudy, are_one_over_fused_metal_by_default_and_what_is_written_otherwise) {
    const Study plain = parsed("");
    EXPECT_EQ(plain.scene.layers, 1);
    EXPECT_EQ(judged_number(plain), 1);
    const Study three = parsed("layers = 3\n");
    EXPECT_EQ(three.scene.layers, 3);
    EXPECT_EQ(judged_number(three), 3);
    EXPECT_EQ(judged_number(parsed("layers = 3\n", "layer = 2\n")), 2);
    EXPECT_EQ(judged_number(parsed("layers = 3\n", "layer = \"all\"\n")), 0);
    EXPECT_EQ(judged_number(parsed("", "layer = \"all\"\n")), 1);
    const Study powder = parsed("substrate = \"powder\"\n");
    EXPECT_EQ(powder.scene.substrate, Substrate::powder);
    EXPECT_EQ(powder.scene.gap, powder.scene.layer_thickness);
    EXPECT_EQ(powder.scene.substrate_share_a, 1);
    EXPECT_EQ(parsed("substrate = \"powder\"\nsubstrate_share_a = 0.25\n").scene.substrate_share_a, 0.25);
}

TEST(LayersInAStudy, warn_of_unusual_pairs) {
    EXPECT_THAT(parsed("substrate = \"powder\"\ngap = \"steady\"\n").warnings,
                Contains(HasSubstr("belongs to a fused substrate")));
    EXPECT_THAT(parsed("substrate = \"powder\"\ngap = \"90 um\"\nlayers = 2\n").warnings,
                Contains(HasSubstr("sinks by one layer thickness (40 um)")));
    EXPECT_THAT(parsed("substrate_share_a = 0.5\n").warnings, Contains(HasSubstr("has no effect")));
    const std::string fills = "[design_space]\nfill_fraction = { A = 1.0, B = 0.99 }\n";
    EXPECT_THAT(parsed("layers = 2\n", "", fills).warnings, Contains(HasSubstr("judges layer 2")));
    EXPECT_THAT(parsed("layers = 2\n", "layer = 1\n", fills).warnings,
                testing::Not(Contains(HasSubstr("first layer only"))));
    EXPECT_THAT(parsed("layers = 2\n", "footprint = { x = [\"1.6 mm\", \"3.2 mm\"] }\n").warnings,
                Contains(HasSubstr("the powder beside the part stays")));
}

TEST(LayersInAStudy, that_cannot_be_are_refused_together_with_their_mend) {
    const auto problems = [](const std::string& process, const std::string& target) {
        try {
            parsed(process, target);
        } catch (const InputError& error) {
            return report_of(error);
        }
        return std::string();
    };
    const std::string both =
        problems("layers = 0\nsubstrate_share_a = 2\nsubstrate = \"powder\"\n", "layer = \"first\"\n");
    EXPECT_THAT(both, HasSubstr("3 problems"));
    EXPECT_THAT(both, HasSubstr("process.layers = 0"));
    EXPECT_THAT(both, HasSubstr("process.substrate_share_a = 2"));
    EXPECT_THAT(both, HasSubstr("target.layer"));
    EXPECT_THAT(problems("layers = 2\n", "layer = 3\n"), HasSubstr("is not among the 2"));
    EXPECT_THAT(problems("layers = 2\n", "layer = 3\n"), HasSubstr("a number from 1 to 2"));
    EXPECT_EQ(problems("layers = 2\n", "layer = 2\n"), "");
}

}  // namespace
}  // namespace gradwright
