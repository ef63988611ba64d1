#include "reports/partition_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/json_support.h"
#include "reports/plate.h"
#include "reports/result_json.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

using nlohmann::json;

/// Wall on which an end of the partition lies and the way along that wall from the datum corner. `before`:
/// the corner before the end.
json end_offset(const PartitionRow& row, const PartitionRow& before, double length_mm, double width_mm) {
    const WallEnd end =
        wall_end({row.x_mm, row.y_mm}, {row.x_mm - before.x_mm, row.y_mm - before.y_mm}, length_mm, width_mm);
    return {{"wall", end.name()}, {"offset_m", number(end.offset * 1e-3)}, {"offset_mm", number(end.offset)}};
}

json powder_json(const Powder& powder) {
    return {{"material", powder.material.name},
            {"density_kg_m3", number(powder.material.density)},
            {"d10_m", number(powder.size.d10)},
            {"d50_m", number(powder.size.d50)},
            {"d90_m", number(powder.size.d90)},
            {"cut_m", {number(powder.size.cut_low), number(powder.size.cut_high)}}};
}

}  // namespace

json partition_json(const Study& study, const StudyResult& result) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const auto rows = partition_rows(study, result.design);
    json corners = json::array();
    std::array<json, 2> points_m = {json::array(), json::array()}, points_mm = points_m;
    for (const PartitionRow& row : rows) {
        const std::size_t curve = static_cast<std::size_t>(row.curve) - 1;
        corners.push_back({{"name", row.name()},
                           {"x_mm", number(row.x_mm)},
                           {"y_mm", number(row.y_mm)},
                           {"segment_length_mm", number(row.length_mm)},
                           {"segment_angle_deg", number(row.angle_deg)}});
        points_m[curve].push_back({number(row.x_mm * 1e-3), number(row.y_mm * 1e-3)});
        points_mm[curve].push_back({number(row.x_mm), number(row.y_mm)});
    }
    const bool pair = !result.design.partition.second.empty();
    const char* const curves =
        pair ? "of each directed curve, P1, P2, ... and Q1, Q2, ..." : "of the directed curve P1, P2, ...";
    const auto ends = [&](std::size_t curve) {
        if (points_m[curve].size() < 2) return json(nullptr);
        std::vector<PartitionRow> own;
        for (const PartitionRow& row : rows)
            if (row.curve == int(curve) + 1) own.push_back(row);
        const double length_mm = length * 1e3, width_mm = width * 1e3;
        return json({{"first", end_offset(own[0], own[1], length_mm, width_mm)},
                     {"last", end_offset(own.back(), own[own.size() - 2], length_mm, width_mm)}});
    };
    const bool inside = rows.size() >= 2;
    const double area_a = inside ? result.design.partition.area_a(length, width) : std::nan("");
    const Scene scene = scene_of(study, result.design, false, result.seed);
    json object = {
        {"format", "gradwright-partition-1"},
        {"study", study.name},
        {"machine", study.machine_name},
        {"verdict", to_string(result.verdict)},
        {"frame", "x = spreading direction from the dispenser's rear wall, y = across from its y = 0 side"},
        {"dispenser",
         {{"length_m", number(length)},
          {"width_m", number(width)},
          {"depth_m", number(study.scene.dispenser_depth)},
          {"length_mm", number(length * 1e3)},
          {"width_mm", number(width * 1e3)},
          {"depth_mm", number(study.scene.dispenser_depth * 1e3)}}},
        {"points_m", points_m[0]},
        {"points_mm", points_mm[0]},
        {"corners", corners},
        {"ends", ends(0)},
        {"sides",
         {{"A",
           {{"where", fmt::format("left {}", curves)},
            {"area_m2", number(area_a)},
            {"powder", powder_json(scene.powder[0])},
            {"share_of_powder_a", number(scene.share_a[0])}}},
          {"B",
           {{"where", fmt::format("right {}{}", pair ? "of either " : "", curves)},
            {"area_m2", number(length * width - area_a)},
            {"powder", powder_json(scene.powder[1])},
            {"share_of_powder_a", number(scene.share_a[1])}}}}},
        {"plate_thickness_m", number(scene.plate_thickness)},
        {"dose_height_m", number(scene.dose_height)},
        {"headspace_m", {{"A", number(scene.headspace[0])}, {"B", number(scene.headspace[1])}}},
    };
    if (pair) {
        object["points2_m"] = points_m[1];
        object["points2_mm"] = points_mm[1];
        object["ends2"] = ends(1);
    }
    object.update(design_json(
        study, result.design));  // partition{family, parameters, ...}, fill_fraction, dosage_factor, land_m
    return object;
}

}  // namespace gradwright
