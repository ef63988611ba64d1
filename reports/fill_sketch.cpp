#include "reports/fill_sketch.h"

#include <algorithm>
#include <cmath>

#include "optimise/plan_curve.h"
#include "reports/partition_drawing.h"

namespace gradwright {
namespace {

using Anchor = CairoSheet::Anchor;

constexpr CairoSheet::Colour kA{0, 0.447, 0.698}, kB{0.604, 0.416, 0}, kTintA{0.87, 0.93, 0.96},
    kTintB{0.98, 0.93, 0.85};

}  // namespace

void draw_fill_sketch(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    // slots in thick walls: a plate may stand out further than the dispenser is wide
    double low = 0, high = width, left = 0, right = length;
    for (const Plate& plate : over.plates)
        for (const PlanPoint& p : plate.corners) {
            low = std::min(low, p.y - plate.thickness);
            high = std::max(high, p.y + plate.thickness);
            left = std::min(left, p.x);
            right = std::max(right, p.x);
        }
    const double label = low < 0 ? 6 : 0;  // [mm] a plate's letter below the picture
    const double scale = std::min((box.right - box.left - 44) / (right - left),
                                  (box.bottom - box.top - 12 - label) / (high - low));
    const double x0 = 0.5 * (box.left + box.right - (left + right) * scale),
                 y0 = box.bottom - 1 - label + low * scale;
    const auto at = [&](PlanPoint p) { return SheetPoint{x0 + p.x * scale, y0 - p.y * scale}; };
    const auto outlines = chamber_outlines(over.partition, length, width);
    for (const std::size_t side : {0u, 1u}) {
        std::vector<SheetPoint> points;
        for (const PlanPoint& p : outlines[side]) points.push_back(at(p));
        if (points.size() > 2) sheet.fill(points, side == 0 ? kTintA : kTintB);
    }
    sheet.polyline({at({0, 0}), at({length, 0}), at({length, width}), at({0, width})}, kThick, true);
    for (const Plate& plate : over.plates) {
        std::vector<SheetPoint> line;
        for (const PlanPoint& p : plate.corners) line.push_back(at(p));
        // no thinner than the eye sees
        sheet.polyline(line, {.width = std::max(0.6, plate.thickness * scale), .colour = kPlateGrey});
        const double size = std::hypot(line[0].x - line[1].x, line[0].y - line[1].y);
        sheet.text({line[0].x + 3.5 * (line[0].x - line[1].x) / size,
                    line[0].y + 3.5 * (line[0].y - line[1].y) / size + 1},
                   plate.name, {.size = 3, .anchor = Anchor::middle, .bold = true});
    }
    for (const ChamberLetter& letter : chamber_letters(over.partition, length, width)) {
        if (!std::isfinite(letter.at.x)) continue;
        const SheetPoint p = at(letter.at);
        const auto colour = letter.side == 0 ? kA : kB;
        const ChamberPlan& chamber = over.fill.chambers[letter.side];
        const double room = std::abs(over.partition.signed_distance(letter.at.x, letter.at.y)) * scale;
        sheet.text({p.x, p.y + (room < 8 ? 1.4 : 0)}, letter.side == 0 ? "A" : "B",
                   {.size = room < 8 ? 4.0 : 6.5, .anchor = Anchor::middle, .bold = true, .colour = colour});
        if (room >= 8)
            sheet.text({p.x, p.y + 3.6}, chamber.powder,
                       {.size = 2.4, .anchor = Anchor::middle, .colour = colour});
    }
    const SheetPoint from = at({0.2 * length, width}), to = at({0.8 * length, width});
    const double above = from.y - (high - width) * scale;
    sheet.line({from.x, above - 3}, {to.x, above - 3}, {.width = 0.6});
    sheet.tip({to.x + 3, above - 3}, 1, 0, 4);
    sheet.text({0.5 * (from.x + to.x), above - 4.5}, "spreading direction",
               {.size = 2.5, .anchor = Anchor::middle});
    sheet.text({at({0, 0}).x - 2, y0 - 1}, "rear",
               {.size = 2.5, .anchor = Anchor::end, .colour = kSheetGrey});
    sheet.text({at({length, 0}).x + 2, y0 - 1}, "platform", {.size = 2.5, .colour = kSheetGrey});
}

}  // namespace gradwright
