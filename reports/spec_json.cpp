#include "reports/spec_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reports/json_support.h"
#include "reports/provenance.h"
#include "reports/step_file.h"

namespace gradwright {
namespace {

using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180;

json optional_number(const std::optional<double>& value) {
    return value ? number(*value) : json(nullptr);
}

json plate_json(const Plate& plate, const FlatPattern& flat, const std::array<MarkText, 2>& marks) {
    const auto box = plate.box(1e-9);
    json ends = json::array(), bends = json::array();
    for (const PlateEnd& end : plate.ends)
        ends.push_back({{"wall", end.at.name()},
                        {"offset_m", number(end.at.offset)},
                        {"tolerance_m", number(linear_tolerance(end.at.offset))},
                        {"slot_along_wall_m", number(end.slot_along)},
                        {"cut_below_tab_m", number(end.cut)},
                        {"off_normal_deg", number(end.slant / kDegree)}});
    for (const FlatBend& bend : flat.bends)
        bends.push_back({{"at_m", number(bend.at)},
                         {"turn_deg", number(bend.turn / kDegree)},
                         {"towards", bend.turn > 0 ? "A" : "B"},
                         {"allowance_m", number(bend.allowance)}});
    return {
        {"name", plate.name},
        {"thickness_m", number(plate.thickness)},
        {"height_m", number(plate.height())},
        {"z_m", {number(plate.z_low), number(plate.z_high)}},
        {"middle_line_m", plan_points(plate.corners)},
        {"middle_length_m", number(plate.middle_length())},
        {"volume_m3", number(plate.volume())},
        {"faces", plate.faces()},
        {"box_m",
         {{number(box[0].x), number(box[0].y), number(plate.z_low)},
          {number(box[1].x), number(box[1].y), number(plate.z_high)}}},
        {"ends", ends},
        {"engraved",
         {{"depth_m", number(plate.mark_depth)},
          {"letter_height_m", {{"A", number(marks[0].letter)}, {"B", number(marks[1].letter)}}},
          {"side_a", marks[0].lines},
          {"side_b", marks[1].lines},
          {"marks", plate.marks.size()}}},
        {"flat", {{"length_m", number(flat.length)}, {"height_m", number(flat.height)}, {"bends", bends}}}};
}

json chamber_json(const ChamberPlan& chamber) {
    return {{"powder", chamber.powder},
            {"area_m2", number(chamber.area)},
            {"area_without_plate_m2", number(chamber.ideal_area)},
            {"level_below_rim_m", number(chamber.level)},
            {"rise_per_layer_m", number(chamber.rise)},
            {"volume_m3", number(chamber.volume)},
            {"bulk_density_kg_m3", number(chamber.bulk_density)},
            {"bulk_density_measured", chamber.measured},
            {"mass_kg", number(chamber.mass)},
            {"mass_tolerance_kg", number(chamber.mass_tolerance)},
            {"top_up_kg", number(chamber.top_up)}};
}

}  // namespace

json spec_json(const Study& study, const FinishedDesign& finished, const HandOver& over,
               const std::vector<std::string>& files) {
    json plates = json::array(), checks = json::array(), acceptance = json::array();
    for (std::size_t i = 0; i < over.plates.size(); ++i)
        plates.push_back(plate_json(over.plates[i], over.flats[i], over.marks[i]));
    for (const PlateCheck& check : over.checks)
        checks.push_back({{"id", check.id},
                          {"passed", check.passed},
                          {"value", number(check.value)},
                          {"limit", number(check.limit)},
                          {"unit", check.unit},
                          {"text", check.text}});
    for (const Acceptance& one : over.acceptance)
        acceptance.push_back({{"check", one.check}, {"limit", one.limit}, {"if_failed", one.if_failed}});
    const PartitionBuild& build = study.build;
    const FillPlan& fill = over.fill;
    const json provenance = provenance_json();
    const bool solid = std::find(files.begin(), files.end(), "partition.step") != files.end();
    json missing = json::array();
    if (!solid)
        missing.push_back({{"file", "partition.step"},
                           {"reason", step_available() ? "the plate is no valid solid"
                                                       : "built without OpenCASCADE (GRADWRIGHT_STEP=OFF): "
                                                         "partition.stl has the shape, without exact arcs"}});
    return {{"format", "gradwright-spec-1"},
            {"first_line", over.first_line},
            {"verified", over.mark.empty()},
            {"buildable", over.buildable()},
            {"id", over.id},
            {"study", study.name},
            {"machine", study.machine_name},
            {"verdict", finished.verdict},
            {"termination", finished.termination},
            {"extrapolated", finished.extrapolated},
            {"frame",
             "x = spreading direction from the dispenser's rear wall, y = across from its y = 0 side, z = up "
             "from the rim"},
            {"dispenser",
             {{"length_m", number(study.scene.dispenser_length)},
              {"width_m", number(study.dispenser_width)},
              {"depth_m", number(study.scene.dispenser_depth)}}},
            {"make",
             {{"kind", over.make},
              {"material", build.material},
              {"thickness_m", number(build.thickness)},
              {"grip_m", number(build.grip)},
              {"bend_radius_m", number(build.bend_radius)},
              {"k_factor", number(build.k_factor)},
              {"clearance_m", number(build.clearance)},
              {"hold", build.tabs ? "tabs" : "slots"},
              {"slot_depth_m", number(build.slot_depth)},
              {"tab_depth_m", build.tabs ? number(build.tab_depth) : json(nullptr)},
              {"end_clearance_m", build.tabs ? number(build.end_clearance) : json(nullptr)},
              {"slot_width_m", number(build.thickness + 2 * build.slot_clearance)},
              {"general_tolerances", "ISO 2768-1 m"}}},
            {"plates", plates},
            {"checks", checks},
            {"slot",
             {{"simulated", over.slot.simulated},
              {"volume_m3", number(over.slot.volume)},
              {"share", number(over.slot.share)},
              {"trough_depth_m", number(over.slot.depth)},
              {"trough_width_m", number(over.slot.width)},
              {"text", over.slot.text}}},
            {"fill",
             {{"A", chamber_json(fill.chambers[0])},
              {"B", chamber_json(fill.chambers[1])},
              {"piston_start_m", number(fill.piston_start)},
              {"rise_per_layer_m", number(fill.rise)},
              {"area_ratio", number(fill.area_ratio)},
              {"layers", fill.layers},
              {"left_over_m", number(fill.left_over)},
              {"dosed_per_layer_kg", number(fill.dosed)},
              {"overflow_per_layer_kg", optional_number(fill.overflow)},
              {"overflow_mass_share_a", optional_number(fill.overflow_a)}}},
            {"steps", over.steps},
            {"acceptance", acceptance},
            {"warnings", over.warnings},
            {"provenance",
             {{"program", provenance["program"]},
              {"version", provenance["version"]},
              {"source", provenance["source"]}}},
            {"files", files},
            {"missing", missing}};
}

}  // namespace gradwright
