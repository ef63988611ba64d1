#include "reports/report_data.h"

#include <algorithm>
#include <cmath>

#include "reports/grain_picture.h"
#include "reports/json_support.h"
#include "reports/map_file.h"
#include "reports/partition_drawing.h"
#include "reports/reduction_cost.h"
#include "reports/result_json.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

using nlohmann::json;

/// Solid volume by origin_x (rows) and deposit_x (columns) over all map layers, as shares of the whole; W
/// over the footprint.
json origin_json(const Study& study, const StudyResult& result) {
    if (result.map_layers.empty()) return nullptr;
    std::size_t grains = 0;
    for (const Layer& layer : result.map_layers) grains += layer.size();
    // some eight grains a cell, if they lay evenly: finer cells would show grains, not the flow
    const std::size_t cells =
        std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(grains) / 8)), 8, 48);
    const double length = study.scene.dispenser_length, platform = study.scene.platform_length;
    const double low = study.footprint.x_low + result.design.footprint_offset,
                 high = study.footprint.x_high + result.design.footprint_offset;
    std::vector<double> density(cells * cells, 0.0), cumulative(cells + 1, 0.0);
    double total = 0;
    for (const Layer& layer : result.map_layers)
        for (std::size_t i = 0; i < layer.size(); ++i) {
            const auto cell = [&](double value, double range) {
                return std::min(cells - 1, static_cast<std::size_t>(std::max(0.0, value / range) * cells));
            };
            const std::size_t from = cell(layer.origin_x[i], length), to = cell(layer.deposit_x[i], platform);
            density[from * cells + to] += layer.volume[i];
            total += layer.volume[i];
            if (layer.deposit_x[i] >= low && layer.deposit_x[i] < high)
                cumulative[from + 1] += layer.volume[i];
        }
    if (!(total > 0)) return nullptr;
    for (std::size_t i = 1; i <= cells; ++i) cumulative[i] += cumulative[i - 1];
    const double laid = cumulative[cells];
    for (double& value : cumulative) value = laid > 0 ? value / laid : std::nan("");
    // five digits are finer than the grain statistics and keep the page small
    for (double& value : density) value = std::round(value / total * 1e7) / 1e7;
    return {{"cells", cells},
            {"dispenser_length_m", length},
            {"platform_length_m", platform},
            {"share", numbers(density)},
            {"cumulative", numbers(cumulative)},
            {"layers", result.map_layers.size()}};
}

json plan_json(const Study& study, const StudyResult& result) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const auto outlines = chamber_outlines(result.design.partition, length, width);
    const auto centres = chamber_centres(result.design.partition, length, width);
    const auto letters = chamber_letters(result.design.partition, length, width);
    auto outer = json::array();  // the chamber beyond the second curve, with the letter of its powder
    for (std::size_t i = 2; i < letters.size(); ++i)
        outer.push_back({{"side", letters[i].side == 0 ? "a" : "b"},
                         {"at", {number(letters[i].at.x), number(letters[i].at.y)}}});
    std::vector<PlanPoint> curve, straight;
    if (result.design.partition.points.size() >= 2) curve = result.design.partition.clipped(length, width);
    if (result.straight && result.straight->design.partition.points.size() >= 2)
        straight = result.straight->design.partition.clipped(length, width);
    const Scene scene = scene_of(study, result.design, false, result.seed);
    const double shift = result.design.footprint_offset;
    return {{"dispenser_length_m", length},
            {"width_m", width},
            {"land_m", number(scene.land)},
            {"platform_length_m", number(scene.platform_length)},
            {"second_land_m", number(scene.second_land)},
            {"gap_m", number(scene.gap)},
            {"bed_depth_m", number(scene.floor_depth())},
            {"dose_height_m", number(scene.dose_height)},
            {"blade_thickness_m", number(scene.blade_thickness)},
            {"periodic", scene.sides == Sides::periodic},
            {"footprint",
             {number(study.footprint.x_low + shift), number(study.footprint.x_high + shift),
              number(study.footprint.y_low), number(study.footprint.y_high)}},
            {"outline_a", plan_points(outlines[0])},
            {"outline_b", plan_points(outlines[1])},
            {"centre_a", {number(centres[0].x), number(centres[0].y)}},
            {"centre_b", {number(centres[1].x), number(centres[1].y)}},
            {"curve", plan_points(curve)},
            {"curve2", plan_points(result.design.partition.second_clipped(length, width))},
            {"more_centres", outer},
            {"straight", plan_points(straight)}};
}

json map_json(const StudyResult& result) {
    std::vector<const GradationMap*> maps;
    for (const Evaluation& evaluation : result.confirmations) maps.push_back(&evaluation.map);
    const bool confirmed = !maps.empty();
    if (!confirmed) maps.push_back(&result.predicted.map);
    const GradationMap map = mean_map(maps);
    if (map.gi.empty()) return nullptr;
    std::vector<double> gi(map.gi);
    for (double& value : gi) value = std::round(value * 1e4) / 1e4;
    return {{"x_m", numbers(map.x_m)},
            {"y_m", numbers(map.y_m)},
            {"gi", numbers(gi)},
            {"mass_kg", numbers(map.mass_kg)},
            {"of", confirmed ? "confirmed" : "predicted"}};
}

json speed_json(const StudyResult& result) {
    auto rows = json::array();
    for (const Evaluation& evaluation : result.confirmations)
        rows.push_back({{"seed", evaluation.seed},
                        {"grains", evaluation.grains},
                        {"steps", evaluation.steps},
                        {"grain_steps", number(evaluation.grain_steps)},
                        {"seconds", number(evaluation.seconds)},
                        {"seconds_cold", number(evaluation.seconds_cold)}});
    return rows;
}

json build_json(const Study& study, const StudyResult& result) {
    auto rows = json::array();
    for (const PartitionRow& row : partition_rows(study, result.design))
        rows.push_back({{"number", row.number},
                        {"name", row.name()},
                        {"x_mm", number(row.x_mm)},
                        {"y_mm", number(row.y_mm)},
                        {"length_mm", number(row.length_mm)},
                        {"angle_deg", number(row.angle_deg)}});
    return rows;
}

/// A word for a POSIX shell: as it is when harmless, else in single quotes.
std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
        return std::isalnum(c) ||
               std::string_view("._-/+=:,@%").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (plain) return word;
    std::string out = "'";
    for (char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

/// One line that makes the result again. The seed stands at its end, wherever it was given.
std::string command_of(const Study& study, const StudyResult& result,
                       const std::vector<std::string>& called_with) {
    std::string command = "gradwright design " + quoted(study.file);
    for (std::size_t k = 0; k < called_with.size(); ++k) {
        if (called_with[k] == "--set" && k + 1 < called_with.size() &&
            called_with[k + 1].starts_with("run.seed=")) {
            ++k;
            continue;
        }
        command += " " + quoted(called_with[k]);
    }
    return command + " --seed " + std::to_string(result.seed) + " --out OUT";
}

constexpr std::size_t kPictureGrains = 60000;  // five pictures of 8 bytes a grain: 3.2 MB of base64

}  // namespace

std::vector<std::size_t> shown_instants(std::size_t count, std::size_t most) {
    std::vector<std::size_t> out;
    const std::size_t shown = std::min(count, most);
    for (std::size_t k = 0; k < shown; ++k) out.push_back(shown == 1 ? 0 : k * (count - 1) / (shown - 1));
    return out;
}

json report_data(const Study& study, const StudyResult& result, const std::vector<std::string>& files,
                 const std::vector<std::string>& called_with) {
    const Wording words = wording(study, result);
    const Scene scene = scene_of(study, result.design, false, result.seed);
    json pictures = json::array();
    const std::vector<std::size_t> shown = shown_instants(result.snapshots.size());
    for (const std::size_t k : shown)
        pictures.push_back(grain_picture(result.snapshots[k], scene, kPictureGrains, kPictureGrains));
    return {{"format", "gradwright-report-1"},
            {"result", to_json(study, result, files)},
            {"words",
             {{"state", words.state},
              {"headline", words.headline},
              {"verdict", words.verdict},
              {"misfit", words.misfit},
              {"drift", words.drift},
              {"sure", words.sure},
              {"build", words.build},
              {"fill", words.fill},
              {"dose", words.dose},
              {"losses", words.losses}}},
            {"materials",
             {{"A", study.scene.powder[0].material.name}, {"B", study.scene.powder[1].material.name}}},
            {"chambers", {{"A", chamber_name(study, 0)}, {"B", chamber_name(study, 1)}}},
            {"bin_width_m", number(study.bins.width)},
            {"build", build_json(study, result)},
            {"plan", plan_json(study, result)},
            {"map", map_json(result)},
            {"origin", origin_json(study, result)},
            {"pictures", pictures},
            {"speed", speed_json(result)},
            {"reduction_cost", reduction_cost(study)},
            {"command", command_of(study, result, called_with)},
            {"study_text", study.text}};
}

}  // namespace gradwright
