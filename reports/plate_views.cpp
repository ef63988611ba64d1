#include "reports/plate_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimise/plan_curve.h"
#include "reports/sheet_layout.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

using Anchor = CairoSheet::Anchor;
using Wall = WallEnd::Wall;

constexpr CairoSheet::Look kSmall{.size = 2.2};

std::string toleranced(double metres) {
    return fmt::format("{} {}", millimetres(metres), tolerance_text(metres));
}

/// A plate as the side view shows it: across = along the dispenser or its width [m].
struct Silhouette {
    double low, high;              ///< of the whole plate
    double below_low, below_high;  ///< of what stands below the tabs
    std::vector<double> corners;   ///< bends between its ends
};

Silhouette silhouette(const Plate& plate, bool along_y) {
    const auto across = [along_y](PlanPoint p) { return along_y ? p.x : p.y; };
    const auto box = plate.box(kChordError);
    Silhouette s{across(box[0]), across(box[1]), across(box[0]), across(box[1]), {}};
    for (std::size_t k = 1; plate.rounded && k + 1 < plate.corners.size(); ++k)
        s.corners.push_back(across(plate.corners[k]));
    if (!plate.tabs()) return s;
    // the corners of the end below a tab
    const std::vector<Station> stations = plate.stations(kChordError);
    s.below_low = s.high;
    s.below_high = s.low;
    for (std::size_t i = 0; i < stations.size(); ++i)
        for (const PlanPoint& p : stations[i]) {
            double x = across(p);
            for (const std::size_t e : {0u, 1u}) {
                const std::size_t n = plate.corners.size();
                if (i != (e == 0 ? 0 : stations.size() - 1)) continue;
                const PlanPoint tip = plate.corners[e == 0 ? 0 : n - 1],
                                inner = plate.corners[e == 0 ? 1 : n - 2];
                const double size = std::hypot(inner.x - tip.x, inner.y - tip.y);
                x += plate.ends[e].cut * (across(inner) - across(tip)) / size;
            }
            s.below_low = std::min(s.below_low, x);
            s.below_high = std::max(s.below_high, x);
        }
    return s;
}

}  // namespace

bool seen_along_y(const HandOver& over) {
    for (const Plate& plate : over.plates)
        for (const PlateEnd& end : plate.ends)
            if (end.at.wall == Wall::rear || end.at.wall == Wall::platform) return true;
    return false;
}

void draw_side_view(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box) {
    const PartitionBuild& build = study.build;
    const bool along_y = seen_along_y(over);
    const double well = (along_y ? study.scene.dispenser_length : study.dispenser_width) * 1e3,
                 depth = study.scene.dispenser_depth * 1e3, grip = build.grip * 1e3,
                 reach = build.slot_depth * 1e3, wall = 1.6 * reach, floor = 0.6 * wall;
    const double room_x = box.right - box.left - 42, room_y = box.bottom - box.top - 30;
    const double scale =
        preferred_scale(std::min(room_x / (well + 2 * wall), room_y / (depth + grip + floor)));
    const double x0 = box.left + 18 + (room_x - well * scale) / 2,
                 y0 = box.bottom - 14 - (floor + depth) * scale -
                      (room_y - (depth + grip + floor) * scale) / 2;
    const auto at = [&](double across, double z) { return SheetPoint{x0 + across * scale, y0 - z * scale}; };
    const auto block = [&](double a, double b, double low, double high) {
        return std::vector<SheetPoint>{at(a, low), at(b, low), at(b, high), at(a, high)};
    };
    sheet.text({box.left, box.top + 2},
               fmt::format("Side view X, {}, {}", along_y ? "from the side y = 0" : "from the platform side",
                           scale_text(scale)),
               {.size = 3, .bold = true});
    sheet.fill(block(-wall, 0, -depth - floor, 0), kWallGrey);
    sheet.fill(block(well, well + wall, -depth - floor, 0), kWallGrey);
    sheet.fill(block(0, well, -depth - floor, -depth), {0.75, 0.75, 0.75});
    for (const Plate& plate : over.plates) {
        const Silhouette s = silhouette(plate, along_y);
        const double low = plate.z_low * 1e3, seat = plate.z_seat * 1e3, high = plate.z_high * 1e3;
        std::vector<SheetPoint> outline = {at(s.below_low * 1e3, low), at(s.below_high * 1e3, low)};
        if (plate.tabs()) {
            outline.push_back(at(s.below_high * 1e3, seat));
            outline.push_back(at(s.high * 1e3, seat));
        }
        outline.push_back(at(s.high * 1e3, high));
        outline.push_back(at(s.low * 1e3, high));
        if (plate.tabs()) {
            outline.push_back(at(s.low * 1e3, seat));
            outline.push_back(at(s.below_low * 1e3, seat));
        }
        sheet.fill(outline, {kPlateGrey.red, kPlateGrey.green, kPlateGrey.blue, 0.35});
        sheet.polyline(outline, kThick, true);
        for (const double corner : s.corners)
            sheet.line(at(corner * 1e3, low), at(corner * 1e3, high), kFine);
        // bottoms of slots and notches are hidden in the walls
        const double bottom = plate.tabs() ? -build.tab_depth * 1e3 : -depth;
        for (const PlateEnd& end : plate.ends) {
            const bool first = end.at.wall == (along_y ? Wall::rear : Wall::side_low),
                       last = end.at.wall == (along_y ? Wall::platform : Wall::side_high);
            if (!first && !last) continue;
            const double x = first ? -reach : well + reach;
            sheet.line(at(x, 0), at(x, bottom), kDashed);
            if (plate.tabs()) sheet.line(at(x, bottom), at(first ? 0 : well, bottom), kDashed);
        }
    }
    sheet.polyline({at(-wall, 0), at(0, 0), at(0, -depth), at(well, -depth), at(well, 0), at(well + wall, 0)},
                   kThick);
    sheet.line(at(0, 0), at(well, 0), kCentre);
    const SheetPoint rim = at(well + wall, 0);
    sheet.text({rim.x + 1.5, rim.y - 0.8}, "rim", kSmall);
    // heights: the well's on the left, the plate's on the right
    const double left = at(-wall, 0).x - 6, right = at(well + wall, 0).x + 8;
    for (const double z : {0.0, -depth})
        sheet.line(at(z == 0 ? -wall : 0, z), {left - 1.5, at(0, z).y}, kFine);
    sheet.dimension({left, at(0, -depth).y}, {left, at(0, 0).y}, fmt::format("({:.3f})", depth));
    for (const double z : {grip, 0.0})
        sheet.line(at(well + (z > 0 ? 0 : wall), z), {right + 1.5, at(0, z).y}, kFine);
    sheet.dimension({right, at(0, 0).y}, {right, at(0, grip).y}, toleranced(build.grip));
    if (build.tabs) {
        const double column = at(well, 0).x - 5, z = -build.tab_depth * 1e3;
        sheet.line(at(well, z), {column - 1.5, at(0, z).y}, kFine);
        sheet.dimension({column, at(0, z).y}, {column, at(0, 0).y}, millimetres(build.tab_depth));
    }
    const SheetPoint middle = at(0.5 * well, grip);
    sheet.line({middle.x, middle.y - 2}, {middle.x, middle.y - 6}, {.width = 0.7});
    sheet.tip({middle.x, middle.y - 9}, 0, -1, 4);
    sheet.text({middle.x - 3, middle.y - 4}, "drawn out upwards after filling",
               {.size = 2.2, .anchor = Anchor::end});
    sheet.text({at(0.5 * well, -depth - floor).x, at(0, -depth - floor).y + 4},
               fmt::format("gap to the floor {:.4g} um", build.clearance * 1e6),
               {.size = 2.2, .anchor = Anchor::middle});
}

void draw_flat_patterns(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box) {
    const double count = static_cast<double>(over.flats.size());
    double longest = 0, highest = 0;
    for (const FlatPattern& flat : over.flats) {
        longest = std::max(longest, flat.length * 1e3);
        highest = std::max(highest, flat.height * 1e3);
    }
    const double room_x = (box.right - box.left) / count - 34, room_y = box.bottom - box.top - 36;
    const double scale = preferred_scale(std::min(room_x / longest, room_y / highest));
    sheet.text({box.left, box.top + 2},
               fmt::format("{} seen from side B, {}", study.build.printed ? "Wall unrolled," : "Flat pattern",
                           scale_text(scale)),
               {.size = 3, .bold = true});
    for (std::size_t i = 0; i < over.flats.size(); ++i) {
        const FlatPattern& flat = over.flats[i];
        const double l = flat.length * 1e3 * scale, h = flat.height * 1e3 * scale, r = flat.rim * 1e3 * scale;
        const double x = box.left + (box.right - box.left) / count * static_cast<double>(i) + 18 +
                         (room_x - l) / 2,
                     y = box.bottom - 18 - (room_y - h) / 2;
        const auto at = [&](double u, double v) {
            return SheetPoint{x + u * 1e3 * scale, y - v * 1e3 * scale};
        };
        std::vector<SheetPoint> outline;
        for (const PlanPoint& p : flat.outline()) outline.push_back(at(p.x, p.y));
        sheet.polyline(outline, kThick, true);
        sheet.line({x - 3, y - r}, {x + l + 3, y - r}, kCentre);
        sheet.text({x + l + 4, y - r + 0.8}, "rim", kSmall);
        std::vector<double> wanted;
        for (const FlatBend& bend : flat.bends) wanted.push_back(x + bend.at * 1e3 * scale);
        const std::vector<double> placed = spread_apart(wanted, 3.4);
        for (std::size_t b = 0; b < wanted.size(); ++b) {
            sheet.line({wanted[b], y + 1}, {wanted[b], y - h - 1}, kDashed);
            sheet.polyline({{wanted[b], y - h - 1}, {placed[b], y - h - 3}}, kFine);
            sheet.text({placed[b] + 0.9, y - h - 3.6}, millimetres(flat.bends[b].at),
                       {.size = 2.4, .turn_deg = 90});
        }
        for (const FlatMark& mark : flat.marks)
            sheet.fill(
                {at(mark.u0, mark.v0), at(mark.u1, mark.v0), at(mark.u1, mark.v1), at(mark.u0, mark.v1)},
                {0.1, 0.1, 0.1});
        const double low_left = flat.cut[0], low_right = flat.length - flat.cut[1];
        double row = y + 7;
        if (flat.seat > 0) {
            for (const double u : {low_left, low_right}) sheet.line(at(u, 0), {at(u, 0).x, row + 1.5}, kFine);
            sheet.dimension({at(low_left, 0).x, row}, {at(low_right, 0).x, row},
                            fmt::format("{} fitted", millimetres(low_right - low_left)));
            row += 7;
            const double column = x + l + 12;
            for (const double v : {0.0, flat.seat})
                sheet.line(at(v > 0 ? flat.length : low_right, v), {column + 1.5, at(0, v).y}, kFine);
            sheet.dimension({column, at(0, 0).y}, {column, at(0, flat.seat).y}, toleranced(flat.seat));
        }
        for (const double u : {0.0, flat.length})
            sheet.line(at(u, flat.seat), {at(u, 0).x, row + 1.5}, kFine);
        sheet.dimension({x, row}, {x + l, row}, toleranced(flat.length));
        for (const double v : {0.0, flat.height})
            sheet.line(at(v > 0 ? 0 : low_left, v), {x - 11.5, at(0, v).y}, kFine);
        sheet.dimension({x - 10, y}, {x - 10, y - h}, toleranced(flat.height));
        sheet.text({x + l + 4, y - r - 9}, flat.name, {.size = 4, .bold = true});
        sheet.text({x + l + 4, y - r - 5}, fmt::format("t = {:g}", study.build.thickness * 1e3),
                   {.size = 2.4});
    }
}

}  // namespace gradwright
