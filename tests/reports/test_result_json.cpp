// The JSON that scripts rely on: names, nulls, units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "reports/heap_order_figure.h"
#include "reports/result_json.h"
#include "tests/reports/fixture.h"

namespace gradwright {
namespace {

using nlohmann::json;

/// Walks "a.b.c"; fails the test when a name is missing.
const json& at(const json& object, const std::string& path) {
    const json* here = &object;
    std::size_t start = 0;
    while (start <= path.size()) {
        const std::size_t dot = std::min(path.find('.', start), path.size());
        const std::string name = path.substr(start, dot - start);
        EXPECT_TRUE(here->is_object() && here->contains(name)) << path;
        if (!here->is_object() || !here->contains(name)) return *here;
        here = &here->at(name);
        start = dot + 1;
    }
    return *here;
}

void expect_no_undefined_number(const json& node, const std::string& path) {
    if (node.is_number_float()) {
        EXPECT_TRUE(std::isfinite(node.get<double>())) << path;
    }
    if (node.is_structured())
        for (auto it = node.begin(); it != node.end(); ++it)
            expect_no_undefined_number(*it, path + "/" + (node.is_object() ? it.key() : std::string("item")));
}

/// Names that `schema` requires, at every depth its `properties` describe.
void expect_required(const json& schema, const json& object, const std::string& path) {
    for (const json& name : schema.value("required", json::array()))
        EXPECT_TRUE(object.contains(name.get<std::string>())) << path << "/" << name;
    const json properties = schema.value("properties", json::object());
    for (auto it = properties.begin(); it != properties.end(); ++it)
        if (object.contains(it.key()) && object.at(it.key()).is_object())
            expect_required(*it, object.at(it.key()), path + "/" + it.key());
}

json schema(const std::string& name) {
    std::ifstream file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/" + name);
    EXPECT_TRUE(file.good()) << name;
    return json::parse(file);
}

/// A field of 2 columns over the fixture's bins: cell value = column + bin / 100, so that a place tells
/// itself.
StudyResult with_field(Study& study) {
    study.target.shape = TargetShape::field;
    study.target.field_x = {1.6e-3, 3.2e-3};
    study.target.table_y = {0, 1.6e-3};
    study.target.field_gi = {0, 0.2, 0.8, 1};
    study.target.table_gi = {0.1, 0.9};
    study.columns = 2;
    StudyResult result = fixture::result(study);
    const std::size_t bins = static_cast<std::size_t>(study.bins.count);
    GradationField field;
    field.x_m = {2.0e-3, 2.8e-3};
    for (std::size_t b = 0; b < bins; ++b) field.y_m.push_back(study.bins.centre(static_cast<int>(b)));
    for (std::size_t cell = 0; cell < 2 * bins; ++cell) {
        field.cells.y_m.push_back(field.y_m[cell % bins]);
        field.cells.gi.push_back(0.5 * static_cast<double>(cell / bins) +
                                 static_cast<double>(cell % bins) / 100);
        field.cells.standard_error.push_back(0.01);
    }
    result.predicted.field = result.confirmed_field = field;
    result.field_target = field.cells.gi;
    result.field_weight.assign(2 * bins, 1);
    result.field_weight[bins + 3] = 0;
    return result;
}

TEST(ResultJson, a_field_stands_row_by_row_with_what_is_left_out_kept_apart) {
    Study study = fixture::study();
    const StudyResult result = with_field(study);
    const json object = to_json(study, result, {});
    expect_required(schema("design.schema.json"), object, "");
    const json& field = at(object, "field");
    expect_required(schema("design.schema.json")["properties"]["field"], field, "field");
    ASSERT_EQ(field["confirmed"].size(), 8u);
    ASSERT_EQ(field["confirmed"][0].size(), 2u);
    EXPECT_DOUBLE_EQ(field["confirmed"][5][0], 0.05);
    EXPECT_DOUBLE_EQ(field["predicted"][5][1], 0.55);
    EXPECT_TRUE(field["target"][3][1].is_null());
    EXPECT_TRUE(field["confirmed"][3][1].is_null());
    EXPECT_DOUBLE_EQ(field["left_out"]["confirmed"][3][1], 0.53);
    EXPECT_TRUE(field["left_out"]["confirmed"][3][0].is_null());
    // 15 cells count: Sidak over them
    std::vector<double> errors(15, 0.01);
    EXPECT_NEAR(field["band_high"][5][0].get<double>(), 0.05 + 0.01 * simultaneous_factor(errors), 1e-12);
    EXPECT_EQ(object["x_drift"]["profile"]["target"].size(), 8u);
    EXPECT_EQ(field["of"], "confirmed");
    // a target of y alone has none
    const Study plain = fixture::study();
    EXPECT_FALSE(to_json(plain, fixture::result(plain), {}).contains("field"));
    EXPECT_FALSE(to_json(plain, fixture::result(plain), {}).contains("constraints"));
}

TEST(ResultJson, constraints_stand_with_their_slack_and_open_ends_are_null) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    const double open = std::numeric_limits<double>::infinity();
    result.constraints = {{"fall", "length", 0.3e-3, 0.1e-3, open, 0.2e-3, 1.6e-3, false},
                          {"objective.max_waste", "", 0.4, -open, 0.35, -0.05, 1, true}};
    const json list = at(to_json(study, result, {}), "constraints");
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0]["unit"], "m");
    EXPECT_EQ(list[0]["kind"], "linear");
    EXPECT_EQ(list[0]["kept"], true);
    EXPECT_TRUE(list[0]["at_most"].is_null());
    EXPECT_EQ(list[1]["kind"], "limit");
    EXPECT_EQ(list[1]["kept"], false);
    EXPECT_DOUBLE_EQ(list[1]["slack"], -0.05);
}

TEST(ResultJson, unequal_fills_state_what_the_level_chambers_lay) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    EXPECT_TRUE(to_json(study, result, {}).at("profile").at("levelled").is_null());
    result.design.fill_fraction = {1.0, 0.96};  // a dose of 120 um against 80 um
    const json object = to_json(study, result, {});
    const json& levelled = object.at("profile").at("levelled");
    ASSERT_EQ(levelled.size(), result.confirmed.gi.size());
    for (std::size_t b = 0; b < levelled.size(); ++b) {
        const double gi = result.confirmed.gi[b], share = 80 * gi / (80 * gi + 120 * (1 - gi));
        if (!std::isfinite(gi)) {  // an empty bin
            EXPECT_TRUE(levelled[b].is_null()) << b;
            continue;
        }
        EXPECT_NEAR(levelled[b].get<double>(), share, 1e-9) << b;
    }
    EXPECT_THAT(object.at("warnings").dump(), testing::HasSubstr("filled unequally"));
}

TEST(ResultJson, an_extrapolated_design_says_what_it_rests_on) {
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    EXPECT_TRUE(to_json(study, result, {}).at("extrapolated").is_null());
    result.confirmations.clear();
    result.confirmed = {};
    result.predicted.one_error = true;
    result.waste_a_share = std::nan("");
    ScaledHeap heap;
    for (const double length : {3.2e-3, 6.4e-3}) {
        HeapOrder strip;
        strip.dispenser_length = length;
        strip.dosage_factor = 3;
        strip.turnovers = std::sqrt(length / 120e-6);
        strip.profile = -0.2;
        heap.strips.push_back(strip);
    }
    heap.turnovers = 28.9;
    heap.longest = 6.4e-3;
    heap.profile_error = 0.06;
    heap.rests_on = {"dispenser length"};
    result.extrapolated = heap;
    const json object = to_json(study, result, {});
    expect_required(schema("design.schema.json"), object, "");
    expect_no_undefined_number(object, "");
    EXPECT_EQ(at(object, "extrapolated.strips").size(), 2u);
    EXPECT_EQ(at(object, "extrapolated.profile_error"), 0.06);
    EXPECT_TRUE(at(object, "extrapolated.law.amplitude").is_null());  // not fitted
    EXPECT_EQ(at(object, "predicted.extrapolated"), true);
    EXPECT_TRUE(at(object, "waste_a_share").is_null());
    EXPECT_THAT(at(object, "verdict_text").get<std::string>(), testing::StartsWith("Extrapolated"));
    // the picture, with and without a law
    EXPECT_THAT(heap_order_svg(heap), testing::HasSubstr("6.4 mm x 3"));
    heap.law.fitted = true;
    heap.law.amplitude = 0.5;
    heap.law.memory = heap.law.turn = 10;
    EXPECT_THAT(heap_order_svg(heap),
                testing::AllOf(testing::HasSubstr("not used"), testing::Not(testing::HasSubstr("nan"))));
}

TEST(ResultJson, design_has_every_promised_name) {
    const Study study = fixture::study();
    const json object = to_json(study, fixture::result(study), {"result.json"});
    for (const char* path : {"termination",
                             "verdict",
                             "target_met",
                             "misfit.norm",
                             "misfit.value",
                             "misfit.debiased",
                             "misfit.interval",
                             "misfit.noise_floor",
                             "misfit.tolerance",
                             "x_drift.value",
                             "x_drift.noise_floor",
                             "x_drift.tolerance",
                             "capture_fraction",
                             "supply_ratio",
                             "design.partition.family",
                             "design.partition.parameters",
                             "design.partition.points_m",
                             "design.fill_fraction.A",
                             "design.fill_fraction.B",
                             "design.dosage_factor",
                             "profile.y_m",
                             "profile.target",
                             "profile.predicted",
                             "profile.confirmed",
                             "profile.band_low",
                             "profile.band_high",
                             "coverage",
                             "waste_fraction",
                             "spreads.map",
                             "spreads.full",
                             "seconds",
                             "seconds_cold",
                             "seed",
                             "files"})
        at(object, path);
    expect_required(schema("design.schema.json"), object, "");
}

TEST(ResultJson, evaluate_has_every_promised_name) {
    const Study study = fixture::study();
    const json object = evaluation_json(study, fixture::result(study).confirmations[0], {});
    for (const char* path : {"profile.y_m",
                             "profile.gi",
                             "profile.band_low",
                             "profile.band_high",
                             "map.x_m",
                             "map.y_m",
                             "map.gi",
                             "map.mass_kg",
                             "x_drift",
                             "capture_fraction",
                             "supply_ratio",
                             "coverage",
                             "waste_fraction",
                             "packing_fraction",
                             "grains",
                             "steps",
                             "grain_steps",
                             "seconds",
                             "seconds_cold",
                             "fidelity",
                             "status",
                             "state_hash",
                             "files"})
        at(object, path);
    expect_required(schema("evaluate.schema.json"), object, "");
    EXPECT_EQ(object["map"]["gi"].size(), object["map"]["y_m"].size());
    EXPECT_EQ(object["map"]["gi"][0].size(), object["map"]["x_m"].size());
    EXPECT_TRUE(object["map"]["gi"][0][3].is_null());
}

TEST(ResultJson, each_of_several_layers_has_its_entry_and_the_judged_one_is_marked) {
    Study study = fixture::study();
    Evaluation one = fixture::result(study).confirmations[0];
    json object = evaluation_json(study, one, {});
    ASSERT_EQ(object["layers"].size(), 1u) << "a single layer is listed too";
    EXPECT_EQ(object["judged_layer"], 1);
    EXPECT_EQ(object["layers"][0]["gi"], object["profile"]["gi"]);
    EXPECT_EQ(object["layers"][0]["capture_fraction"], one.capture_fraction);
    EXPECT_TRUE(object["layers"][0]["dosed_solid_m3"].is_null());

    study.scene.layers = 2;
    for (const int number : {1, 2}) {
        LaidLayer layer;
        layer.number = number;
        layer.profile = one.profile;
        for (double& gi : layer.profile.gi) gi *= 0.5 * number;
        layer.drift = one.drift;
        layer.dosed_solid_volume = 1e-11;
        layer.laid_solid_volume = 4e-12 * number;
        layer.capture_fraction = 0.4 * number;
        one.layers.push_back(layer);
    }
    object = evaluation_json(study, one, {});
    EXPECT_EQ(object["judged_layer"], 2);
    ASSERT_EQ(object["layers"].size(), 2u);
    EXPECT_FALSE(object["layers"][0]["judged"]);
    EXPECT_TRUE(object["layers"][1]["judged"]);
    EXPECT_EQ(object["layers"][0]["capture_fraction"], 0.4);
    expect_required(schema("evaluate.schema.json"), object, "");

    StudyResult result = fixture::result(study);
    result.confirmations = {one, one};
    for (LaidLayer& layer : result.confirmations[1].layers) layer.capture_fraction += 0.1;
    const json design = to_json(study, result);
    ASSERT_EQ(design["layers"].size(), 2u);
    EXPECT_NEAR(design["layers"][0]["capture_fraction"].get<double>(), 0.45, 1e-12);
    EXPECT_NEAR(design["layers"][1]["gi"][2].get<double>(), one.layers[1].profile.gi[2], 1e-12);
    study.judged_layer = kAllLayers;
    EXPECT_EQ(to_json(study, result)["judged_layer"], "all");
    result.confirmations[0].health.status = "jammed";
    EXPECT_TRUE(evaluation_json(study, result.confirmations[0], {})["layers"].empty());
}

TEST(ResultJson, undefined_bins_are_null_in_target_and_confirmed_alike) {
    const Study study = fixture::study();
    const json profile = to_json(study, fixture::result(study))["profile"];
    for (std::size_t b = 0; b < profile["target"].size(); ++b)
        EXPECT_EQ(profile["target"][b].is_null(), profile["confirmed"][b].is_null()) << b;
    EXPECT_TRUE(profile["confirmed"][7].is_null());
    EXPECT_FALSE(profile["confirmed"][6].is_null());
}

TEST(ResultJson, no_number_is_undefined_whatever_the_result_holds) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();
    const Study study = fixture::study();
    StudyResult result = fixture::result(study);
    result.capture_fraction = nan;
    result.misfit.value = infinite;
    result.confirmations[0].coverage = nan;
    result.stage_seconds["lost"] = nan;
    result.design.parameters.emplace_back("lost", nan);
    result.history[0].design.partition.points[0].x = nan;
    const json object = to_json(study, result);
    expect_no_undefined_number(object, "");
    EXPECT_TRUE(object["capture_fraction"].is_null());
    EXPECT_TRUE(object["misfit"]["value"].is_null());
    expect_no_undefined_number(evaluation_json(study, result.confirmations[0]), "");
}

TEST(ResultJson, an_undefined_error_gives_a_null_band_not_a_clamped_one) {
    const Study study = fixture::study();
    Evaluation evaluation = fixture::result(study).confirmations[0];
    evaluation.profile.standard_error[2] = std::nan("");
    const json profile = evaluation_json(study, evaluation)["profile"];
    EXPECT_TRUE(profile["band_low"][2].is_null());
    EXPECT_TRUE(profile["band_high"][2].is_null());
}

TEST(ResultJson, a_search_without_numbers_does_not_look_perfect) {
    const Study study = fixture::study();
    StudyResult result;
    result.termination = "failed";
    result.message = "jammed";
    const json object = to_json(study, result);
    EXPECT_FALSE(object["target_met"].get<bool>());
    EXPECT_TRUE(object["misfit"]["value"].is_null());
    EXPECT_TRUE(object["x_drift"]["value"].is_null());
    EXPECT_TRUE(object["capture_fraction"].is_null());
    Evaluation broken;
    broken.health.status = "jammed";
    EXPECT_TRUE(evaluation_json(study, broken)["misfit"]["value"].is_null());
    EXPECT_TRUE(evaluation_json(study, broken)["x_drift"]["value"].is_null());
}

TEST(ResultJson, lengths_are_in_metres) {
    const Study study = fixture::study();
    const StudyResult result = fixture::result(study);
    const json object = to_json(study, result);
    EXPECT_DOUBLE_EQ(object["design"]["partition"]["points_m"][4][0].get<double>(),
                     result.design.partition.points[4].x);
    EXPECT_DOUBLE_EQ(object["profile"]["y_m"][0].get<double>(), study.bins.centre(0));
}

TEST(ResultJson, bands_of_one_spread_know_how_few_blocks_are_behind_them) {
    const Study study = fixture::study();
    Evaluation evaluation = fixture::result(study).confirmations.front();
    const auto width = [&](double degrees) {
        evaluation.profile.degrees = degrees;
        const json profile = evaluation_json(study, evaluation)["profile"];
        const std::size_t b = profile["gi"].size() / 2;
        return profile["band_high"][b].get<double>() - profile["band_low"][b].get<double>();
    };
    EXPECT_GT(width(3), 1.2 * width(0));
}

}  // namespace
}  // namespace gradwright
