// The JSON that scripts rely on: names, nulls, units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

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
