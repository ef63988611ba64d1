#include "optimise/partition_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optimise/partition_family.h"
#include "optimise/scene_file.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string mm(double si) {
    return format_quantity(si, "length");
}

/// Keys that not every family has; the first family is the one that a refusal names.
const std::vector<std::pair<std::string, std::vector<Family>>> kFamilyKeys = {
    {"knots", {Family::polyline, Family::spline, Family::two_curves}},
    {"monotone", {Family::polyline}},
    {"points", {Family::polyline, Family::spline, Family::two_curves}},
    {"start", {Family::polyline, Family::spline}},
    {"minimum_segment", {Family::polyline, Family::spline, Family::two_curves}},
    {"points2", {Family::two_curves}},
    {"clearance", {Family::two_curves}},
    {"angle", {Family::straight}},
    {"offset", {Family::straight}},
    {"centre", {Family::sigmoid}},
    {"height", {Family::sigmoid}},
    {"place", {Family::sigmoid}},
    {"width_10_90", {Family::sigmoid}},
    {"minimum_bend_radius", {Family::sigmoid, Family::spline}}};

void read_straight(TomlReader& reader, Section& section, Study& study) {
    DesignSpace& design = study.design_space;
    const double width = study.dispenser_width;
    Variable angle = design.angle_deg, offset = design.offset;
    offset.low = -0.5 * width;
    offset.high = 0.5 * width;
    design.angle_deg =
        section.variable("angle", "partition.angle", "angle", angle, "free: bounds of the family",
                         Range::between(-90 * kDegree, 90 * kDegree), kDegree);
    design.offset = section.variable("offset", "partition.offset", "length", offset,
                                     "free: half the width to each side", Range::between(-10, 10));
    design.partition_free = design.angle_deg.free || design.offset.free;
    if (reader.sound({"design_space.partition.offset", "machine.dispenser.width"}) &&
        (std::abs(design.offset.low) > width || std::abs(design.offset.high) > width))
        reader.conflict({"design_space.partition.offset"},
                        fmt::format("must stay within one width ({}) of the centre", mm(width)),
                        "lower the offset");
}

/// Least bend of the plate's middle. Sheet practice (DIN 6935; annealed stainless steel) bends to an inner
/// radius of one thickness, which is one and a half in the middle; a partition whose thickness is left at 0
/// is taken to be a foil of 0.2 mm.
void read_bend_radius(Section& section, Study& study) {
    const double thickness = study.scene.plate_thickness;
    constexpr double kFoil = 0.2e-3, kMiddle = 1.5;
    study.design_space.minimum_bend_radius = section.quantity(
        "minimum_bend_radius", "length",
        {kMiddle * (thickness > 0 ? thickness : kFoil),
         thickness > 0 ? "1.5 plate thicknesses: inner radius of one thickness, DIN 6935"
                       : "1.5 thicknesses of a 0.2 mm foil: inner radius of one thickness, DIN 6935"},
        Range::between(0, 10));
}

void refuse_tight_bend(TomlReader& reader, const std::vector<std::string>& keys, double radius,
                       const DesignSpace& design, const std::string& mend) {
    if (!(radius < design.minimum_bend_radius)) return;
    reader.conflict(keys,
                    fmt::format("bends with a radius of {}, tighter than minimum_bend_radius = {}",
                                mm(radius), mm(design.minimum_bend_radius)),
                    mend);
}

void read_sigmoid(TomlReader& reader, Section& section, Study& study) {
    DesignSpace& design = study.design_space;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const auto read = [&](Variable& variable, const char* key, double low, double high, const char* note,
                          const Range& range) {
        Variable fallback = variable;
        fallback.low = low;
        fallback.high = high;
        fallback.value = 0.5 * (low + high);
        Variable read = section.variable(key, variable.name, "length", fallback, note, range);
        // the family's own bounds: it knows them better once the curve's direction stands
        if (!section.has(key)) read.low = read.high = 0;
        variable = read;
    };
    read(design.centre, "centre", -0.5 * width, 1.5 * width, "free: half a width beyond each side",
         Range::between(-10, 10));
    read(design.height, "height", -2 * width, 2 * width, "free: twice the width, rising or falling",
         Range::between(-10, 10));
    read(design.place, "place", 0, length, "free: anywhere along the dispenser", Range::between(-10, 10));
    read(design.width_10_90, "width_10_90", 0.02 * length, 4 * length,
         "free: from 0.02 of the dispenser's length to 4, where the curve is straight",
         Range::above_to(0, 100));
    read_bend_radius(section, study);
    design.partition_free =
        design.centre.free || design.height.free || design.place.free || design.width_10_90.free;
    const std::string at = "design_space.partition.";
    if (design.partition_free || !reader.sound({"design_space.partition", "machine.dispenser"})) return;
    const PartitionFamily family(design, length, width, {true, true});
    const std::vector<double>& p = family.low();
    refuse_tight_bend(reader, {at + "width_10_90", at + "height"}, family.least_bend_radius(p), design,
                      "widen width_10_90, lower the height, or lower minimum_bend_radius");
    if (family.curve(p).clipped(length, width).empty())
        reader.conflict({at + "centre"}, "the partition never crosses the dispenser",
                        fmt::format("the dispenser is 0 to {} in x and 0 to {} in y", mm(length), mm(width)));
}

void check_curve(TomlReader& reader, const std::string& key, const std::vector<PlanPoint>& points,
                 const Study& study) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    if (points.empty()) return;
    if (PartitionCurve{points}.self_intersects())
        reader.conflict({key}, "the partition crosses itself", "order the points along the curve");
    else if (PartitionCurve{points}.clipped(length, width).empty())
        reader.conflict({key}, "the partition never crosses the dispenser",
                        fmt::format("the dispenser is 0 to {} in x and 0 to {} in y", mm(length), mm(width)));
}

/// A spline is a function of x that never turns back: so must its knots be.
void check_spline(TomlReader& reader, const std::string& key, const DesignSpace& design) {
    const std::vector<PlanPoint>& points = design.given_points;
    bool rises = true, falls = true, up = true, down = true;
    for (std::size_t k = 1; k < points.size(); ++k) {
        rises = rises && points[k].x > points[k - 1].x;
        falls = falls && points[k].x < points[k - 1].x;
        up = up && points[k].y >= points[k - 1].y;
        down = down && points[k].y <= points[k - 1].y;
    }
    if (!rises && !falls)
        reader.conflict({key}, "x must rise or fall from point to point", "order the points along x");
    else if (!up && !down)
        reader.conflict({key}, "y must not turn back: the spline is monotone",
                        "leave the point out that turns back, or choose family = \"polyline\"");
    else if (!design.partition_free)
        refuse_tight_bend(reader, {key}, spline_radius(points), design,
                          "draw the points further apart, or lower minimum_bend_radius");
}

/// `knots` and what hangs on it, for every family with knots.
void read_knots(TomlReader& reader, Section& section, Study& study) {
    DesignSpace& design = study.design_space;
    const double length = study.scene.dispenser_length;
    const bool pair = design.family == Family::two_curves;
    design.knots = static_cast<int>(section.integer(
        "knots", pair ? 2 : 5,
        pair ? "our default: two straight partitions" : "our default: 4-5 knots reproduce a ramp", 2, 50));
    if (design.family == Family::polyline)
        design.monotone = section.boolean("monotone", true, "y never turns back along x");
    design.minimum_segment = section.quantity(
        "minimum_segment", "length", {design.minimum_segment, "our default: what a workshop can bend"},
        Range::above_to(0, 10));
    const std::vector<PlanPoint> fixed = section.points("points", 2);
    const std::vector<PlanPoint> start = pair ? std::vector<PlanPoint>{} : section.points("start", 2);
    if (!pair && section.has("points") && section.has("start"))
        reader.conflict({"design_space.partition.start"}, "stands beside points, which fix the partition",
                        "keep points (fixed) or start (free)");
    design.given_points = fixed.empty() ? start : fixed;
    design.partition_free = fixed.empty();
    const std::string points_key =
        fixed.empty() ? "design_space.partition.start" : "design_space.partition.points";
    check_curve(reader, points_key, design.given_points, study);
    if (!design.given_points.empty() && !section.has("knots"))
        design.knots = static_cast<int>(design.given_points.size());
    if (design.family == Family::spline) {
        read_bend_radius(section, study);
        if (!design.given_points.empty() && reader.sound({points_key}))
            check_spline(reader, points_key, design);
    }
    if (design.partition_free &&
        reader.sound({"design_space.partition.knots", "design_space.partition.minimum_segment",
                      "machine.dispenser"}) &&
        (design.knots - 1) * design.minimum_segment >= length)
        reader.conflict({"design_space.partition.minimum_segment", "design_space.partition.knots"},
                        fmt::format("{} knots at least {} apart do not fit into a dispenser {} long",
                                    design.knots, mm(design.minimum_segment), mm(length)),
                        "use fewer knots or shorter segments");
}

void read_pair(TomlReader& reader, Section& section, Study& study) {
    DesignSpace& design = study.design_space;
    const std::string first = "design_space.partition.points", second = "design_space.partition.points2";
    design.clearance = section.quantity(
        "clearance", "length",
        {3 * largest_grain(study.scene), "3 of the largest grains: a narrower chamber does not fill"},
        Range::above_to(0, 10));
    design.given_second = section.points("points2", 2);
    if (section.has("points") != section.has("points2")) {
        reader.conflict({first, second}, "fixes one of two curves",
                        "give both, points and points2, or neither to have both searched");
        design.given_second.clear();
        return;
    }
    check_curve(reader, second, design.given_second, study);
    if (!design.given_second.empty() && reader.sound({first, second}) &&
        PartitionCurve{design.given_points, design.given_second}.pair_disagrees())
        reader.conflict(
            {second}, "meets the first curve, or calls A what the first calls B",
            "A is on the left of both: between two curves it is above the one that runs in +x and "
            "below the one that runs in -x");
    if (reader.sound({"design_space.partition.clearance", "machine.dispenser.width"}) &&
        design.clearance >= study.dispenser_width)
        reader.conflict({"design_space.partition.clearance"},
                        fmt::format("leaves no room in a dispenser {} wide", mm(study.dispenser_width)),
                        "lower the clearance");
}

}  // namespace

void read_partition(TomlReader& reader, Section& space, Study& study) {
    Section section = space.sub("partition");
    DesignSpace& design = study.design_space;
    const std::string name =
        section.choice("family", {"polyline", "straight", "sigmoid", "spline", "two_curves"}, "polyline",
                       "our default: a straight one reproduces a ramp to 0.04-0.05 only");
    design.family = family_of(name).value_or(Family::polyline);
    for (const auto& [key, families] : kFamilyKeys) {
        if (std::find(families.begin(), families.end(), design.family) != families.end()) continue;
        section.refuse(key, fmt::format("has no place in family = \"{}\"", to_string(design.family)),
                       fmt::format("leave it out, or choose family = \"{}\"", to_string(families.front())));
    }
    switch (design.family) {
        case Family::straight:
            read_straight(reader, section, study);
            break;
        case Family::sigmoid:
            read_sigmoid(reader, section, study);
            break;
        case Family::polyline:
        case Family::spline:
            read_knots(reader, section, study);
            break;
        case Family::two_curves:
            read_knots(reader, section, study);
            read_pair(reader, section, study);
            break;
    }
    section.finish();
}

}  // namespace gradwright
