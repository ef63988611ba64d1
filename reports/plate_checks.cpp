#include "reports/plate_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "optimise/build_section.h"
#include "optimise/tolerance_budget.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSagitta = 2e-6;     // [m], as the plan curves (kChordError)
constexpr double kSteepestSlot = 70;  // [deg]: a slot of three plates, a feather edge in the wall
constexpr double kRepose = 30;        // [deg]
constexpr double kCoarse = 0.25;      // thickness of a plate over its shortest segment
constexpr double kOnWall = 1e-9;      // [m]
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

std::vector<PlanPoint> outline_of(const Plate& plate) {
    const std::vector<Station> stations = plate.stations(kSagitta);
    std::vector<PlanPoint> outline;
    for (const Station& s : stations) outline.push_back(s[1]);
    for (auto s = stations.rbegin(); s != stations.rend(); ++s) outline.push_back((*s)[0]);
    return outline;
}

double cross(PlanPoint o, PlanPoint a, PlanPoint b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}
bool meet(PlanPoint a, PlanPoint b, PlanPoint c, PlanPoint d) {
    return (cross(a, b, c) > 0) != (cross(a, b, d) > 0) && (cross(c, d, a) > 0) != (cross(c, d, b) > 0);
}
double distance(PlanPoint p, PlanPoint a, PlanPoint b) {
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const double t = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0;
    return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// A closed outline that meets itself somewhere other than at neighbouring sides.
bool meets_itself(const std::vector<PlanPoint>& outline) {
    const std::size_t n = outline.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 2; j < n; ++j) {
            if (i == 0 && j == n - 1) continue;
            if (meet(outline[i], outline[i + 1], outline[j], outline[(j + 1) % n])) return true;
        }
    return false;
}

/// Least distance of two outlines [m]; 0 where they meet.
double gap_between(const std::vector<PlanPoint>& a, const std::vector<PlanPoint>& b) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            const PlanPoint a0 = a[i], a1 = a[(i + 1) % a.size()], b0 = b[j], b1 = b[(j + 1) % b.size()];
            if (meet(a0, a1, b0, b1)) return 0;
            least = std::min({least, distance(a0, b0, b1), distance(b0, a0, a1)});
        }
    return least;
}

/// Every segment of a plate's face runs the way of its middle line: a fold that is tighter than the plate is
/// thick turns a piece of the inner face round.
bool faces_run_forward(const Plate& plate) {
    if (plate.rounded) return true;
    const std::vector<Station> stations = plate.stations(kSagitta);
    for (std::size_t i = 0; i + 1 < stations.size(); ++i)
        for (const int side : {0, 1}) {
            const PlanPoint a = stations[i][side], b = stations[i + 1][side];
            const PlanPoint c = plate.corners[i], d = plate.corners[i + 1];
            if ((b.x - a.x) * (d.x - c.x) + (b.y - a.y) * (d.y - c.y) <= 0) return false;
        }
    return true;
}

std::string mm(double metres) {
    return millimetres(metres) + " mm";
}
/// Gaps finer than the micrometre that `mm` shows.
std::string fine(double metres) {
    return fmt::format("{:.4g} mm", metres * 1e3);
}

}  // namespace

double linear_tolerance(double length) {
    return general_tolerance(ToleranceClass::m, length);
}

std::vector<PlateCheck> plate_checks(const Study& study, const std::vector<Plate>& plates) {
    const PartitionBuild& build = study.build;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    std::vector<PlateCheck> checks;
    const auto add = [&](const char* id, bool passed, double value, double limit, const char* unit,
                         std::string text) {
        checks.push_back({id, passed, value, limit, unit, std::move(text)});
    };
    double left = std::numeric_limits<double>::infinity();
    bool bent = false;
    for (const Plate& plate : plates) {
        bent = bent || (!build.printed && !plate.turns.empty());
        for (std::size_t k = 0; k + 1 < plate.corners.size(); ++k)
            left = std::min(left, plate.straight_left(k));
    }
    if (bent) {
        add("bends", left > 0, left, 0, "m",
            left > 0
                ? fmt::format("between two bends at least {} stay straight", mm(left))
                : fmt::format("two bends overlap by {}: the segment is shorter than the inside bend radius "
                              "of {} allows; a smaller radius, a thinner sheet or make = \"printed\" helps",
                              mm(-left), mm(build.bend_radius)));
        const double ratio = build.bend_radius / build.thickness;
        add("bend_radius", ratio >= 1 - 1e-9, ratio, 1, "-",
            fmt::format(
                "inside bend radius of {:.3g} thicknesses; annealed stainless sheet wants at least one",
                ratio));
    }
    bool whole = true;
    double apart = kUndefined, room = std::numeric_limits<double>::infinity(), slant = 0, corner = room;
    std::vector<std::vector<PlanPoint>> outlines;
    for (const Plate& plate : plates) {
        outlines.push_back(outline_of(plate));
        whole = whole && faces_run_forward(plate) && !meets_itself(outlines.back());
        const std::vector<Station> stations = plate.stations(kSagitta);
        for (std::size_t i = 1; i + 1 < stations.size(); ++i)
            for (const PlanPoint& p : stations[i])
                room = std::min({room, p.x, length - p.x, p.y, width - p.y});
        for (const PlateEnd& end : plate.ends) {
            if (end.at.wall == WallEnd::Wall::none) continue;
            slant = std::max(slant, end.slant / kDegree);
            const bool across = end.at.wall == WallEnd::Wall::rear || end.at.wall == WallEnd::Wall::platform;
            const double wall = across ? width : length;
            corner = std::min(
                {corner, end.at.offset - 0.5 * end.slot_along, wall - end.at.offset - 0.5 * end.slot_along});
        }
    }
    add("outline", whole, kUndefined, kUndefined, "-",
        whole ? "the plate's outline nowhere meets itself"
              : "folds overlap: the outline meets itself; it can be neither bent nor printed like this");
    if (plates.size() > 1) {
        for (std::size_t i = 0; i < outlines.size(); ++i)
            for (std::size_t j = i + 1; j < outlines.size(); ++j) {
                const double gap = gap_between(outlines[i], outlines[j]);
                apart = std::isnan(apart) ? gap : std::min(apart, gap);
            }
        const double least = std::max(study.scene.powder[0].size.d90, study.scene.powder[1].size.d90) * 3;
        add("plates_apart", apart >= least, apart, least, "m",
            fmt::format("{} between the plates; powder needs three grains of D90, {}, to be filled in",
                        mm(apart), mm(least)));
    }
    if (std::isfinite(room))
        add("in_the_well", room >= 0, room, 0, "m",
            room >= 0 ? fmt::format("between its ends the plate stays {} off the walls", mm(room))
                      : fmt::format("a corner of the plate reaches {} into a wall", mm(-room)));
    const char* const slots = build.tabs ? "notches" : "slots";
    if (build.tabs) {
        double straight = std::numeric_limits<double>::infinity();
        for (const Plate& plate : plates)
            for (const std::size_t e : {0u, 1u}) {
                const PlatePiece& piece = e == 0 ? plate.pieces.front() : plate.pieces.back();
                straight =
                    std::min(straight, std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y) -
                                           plate.ends[e].cut);
            }
        add("tabs", straight > 0, straight, 0, "m",
            straight > 0 ? fmt::format("beside its tabs the plate runs straight for {}", mm(straight))
                         : "a tab reaches into a bend: the plate must run straight where it meets the wall");
        add("end_gap", build.end_clearance < finest_d10(study), build.end_clearance, finest_d10(study), "m",
            fmt::format("{} between the plate's ends and the walls, the finest D10 is {}",
                        fine(build.end_clearance), fine(finest_d10(study))));
    }
    add("slot_angle", slant <= kSteepestSlot, slant, kSteepestSlot, "deg",
        fmt::format("the plate meets the walls at most {:.1f} deg off their normal; beyond {:g} deg a {} is "
                    "three plates wide and leaves a feather edge",
                    slant, kSteepestSlot, build.tabs ? "notch" : "slot"));
    add("slot_corner", corner >= 0, corner, 0, "m",
        corner >= 0 ? fmt::format("the {} stay {} off the dispenser's corners", slots, mm(corner))
                    : fmt::format("the {} run {} over a corner of the dispenser", slots, mm(-corner)));
    const double slot = build.thickness + 2 * build.slot_clearance, finest = finest_d10(study);
    add("slot_width", slot >= build.least_slot_width, slot, build.least_slot_width, "m",
        fmt::format("{} {} wide, the workshop cuts {}", slots, fine(slot), fine(build.least_slot_width)));
    if (build.wall_thickness > 0)
        add("wall_thickness", build.slot_depth < build.wall_thickness, build.slot_depth, build.wall_thickness,
            "m",
            fmt::format("{} {} deep in walls of {}", slots, mm(build.slot_depth), mm(build.wall_thickness)));
    add("clearance", build.clearance < finest, build.clearance, finest, "m",
        fmt::format("{} under the plate, the finest D10 is {}", fine(build.clearance), fine(finest)));
    // what stands in the well is the same at every height, and only tabs reach over it: nothing is undercut
    const bool free = whole && !(room < 0);
    const double travel = plates.empty() ? kUndefined : plates.front().height();
    const bool high = !(build.headroom > 0) || travel <= build.headroom;
    add("withdrawal", free && high, travel, build.headroom > 0 ? build.headroom : kUndefined, "m",
        !free  ? "a plate that cannot be made or put in cannot be drawn out"
        : high ? fmt::format("the plate is the same at every height{}, so it draws out straight upwards; it "
                             "stands clear {} above the rim, {}",
                             build.tabs ? " below its tabs" : "", mm(travel),
                             build.headroom > 0 ? fmt::format("and {} are free", mm(build.headroom))
                                                : "which must be free (partition_build.headroom not given)")
               : fmt::format("the plate is {} high, only {} are free above the rim: less grip, or take the "
                             "dispenser out of the machine to fill it",
                             mm(travel), mm(build.headroom)));
    return checks;
}

SlotEffect slot_effect(const Study& study, const Design& design, const std::vector<Plate>& plates) {
    SlotEffect effect;
    const Scene& scene = study.scene;
    const double thickness = study.build.thickness, depth = scene.dispenser_depth;
    const auto net = chamber_areas(study, design, plates);
    const double plan = scene.dispenser_length * study.dispenser_width;
    effect.volume = (plan - net[0] - net[1]) * depth;
    effect.share = (plan - net[0] - net[1]) / plan;
    effect.depth = std::sqrt(thickness * depth * std::tan(kRepose * kDegree));
    effect.width = 2 * effect.depth / std::tan(kRepose * kDegree);
    effect.simulated =
        std::abs(scene.plate_thickness - thickness) < kOnWall && scene.bed_depth >= depth * (1 - 1e-9);
    const std::string trough = fmt::format(
        "the slot takes {:.1f} % of the dispenser; at {:g} deg of repose it collapses into a trough "
        "about {} deep and {} wide, which is topped up and levelled",
        100 * effect.share, kRepose, mm(effect.depth), mm(effect.width));
    effect.text =
        effect.simulated
            ? fmt::format("Simulated: the bed was packed with this plate at full depth. {}", trough)
            : fmt::format(
                  "NOT SIMULATED: the spreads knew {} ({}); {}. Simulate it with "
                  "process.plate_thickness = \"{}\" and numerics.bed_depth = \"{}\"",
                  scene.plate_thickness > 0 ? fmt::format("a plate of {} in a bed {} deep",
                                                          mm(scene.plate_thickness), mm(scene.bed_depth))
                                            : "an ideally thin partition",
                  scene.bed_depth < depth ? "bed shallower than the dispenser" : "full depth", trough,
                  mm(thickness), mm(depth));
    return effect;
}

std::vector<std::string> plate_warnings(const Study& study, const std::vector<Plate>& plates) {
    const PartitionBuild& build = study.build;
    std::vector<std::string> warnings;
    double shortest = std::numeric_limits<double>::infinity(), rounding = 0, tolerance = 0;
    for (const Plate& plate : plates) {
        for (std::size_t k = 0; k + 1 < plate.corners.size(); ++k)
            shortest = std::min(shortest, std::hypot(plate.corners[k + 1].x - plate.corners[k].x,
                                                     plate.corners[k + 1].y - plate.corners[k].y));
        if (plate.rounded)
            for (const double turn : plate.turns)
                rounding = std::max(
                    rounding, (plate.bend_radius + 0.5 * plate.thickness) * (1 / std::cos(0.5 * turn) - 1));
        for (const PlateEnd& end : plate.ends)
            if (end.at.wall != WallEnd::Wall::none)
                tolerance = std::max(tolerance, linear_tolerance(end.at.offset));
    }
    if (!build.printed && build.thickness > kCoarse * shortest)
        warnings.push_back(
            fmt::format("a sheet of {} is coarse here: the shortest segment is {}, {:.1f} thicknesses",
                        mm(build.thickness), mm(shortest), shortest / build.thickness));
    if (const double share = tolerance / study.dispenser_width; share > 0.02)
        warnings.push_back(
            fmt::format("the general tolerance of an end offset, \u00b1{} mm, is {:.0f} % of the dispenser's "
                        "width: agree a tighter one with the workshop, and look what it does with "
                        "'gradwright evaluate --design'",
                        tolerance * 1e3, 100 * share));
    if (rounding > 0.5 * build.thickness)
        warnings.push_back(fmt::format("bends round the corners off by up to {}", mm(rounding)));
    if (build.thickness < 0.3e-3 && !build.printed)
        warnings.push_back(
            fmt::format("a sheet of {} bends in the hand: stiffen its grip", mm(build.thickness)));
    if (build.thickness > 1e-3)
        warnings.push_back(
            fmt::format("a plate of {} leaves a wide slot: below 1 mm is usual", mm(build.thickness)));
    if (build.printed && build.thickness < 0.4e-3)
        warnings.push_back(fmt::format("a printed wall of {} is thinner than one bead of a 0.4 mm nozzle",
                                       mm(build.thickness)));
    const double simulated = study.scene.plate_thickness;
    if (simulated > 0 && std::abs(simulated - build.thickness) > kOnWall)
        warnings.push_back(fmt::format("the spreads knew a plate of {}, this one is {} thick", mm(simulated),
                                       mm(build.thickness)));
    return warnings;
}

}  // namespace gradwright
