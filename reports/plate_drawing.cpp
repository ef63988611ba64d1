#include "reports/plate_drawing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optimise/build_section.h"
#include "optimise/plan_curve.h"
#include "reports/partition_drawing.h"
#include "reports/plate_views.h"
#include "reports/provenance.h"
#include "reports/sheet_layout.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

using Anchor = CairoSheet::Anchor;
using Wall = WallEnd::Wall;

constexpr double kDegree = std::numbers::pi / 180;
constexpr CairoSheet::Colour kA{0, 0.447, 0.698}, kB{0.604, 0.416, 0}, kTintA{0, 0.447, 0.698, 0.13},
    kTintB{0.902, 0.624, 0, 0.16}, kRed{0.75, 0, 0}, kGrey = kSheetGrey;

// Sheet [mm]: frame after ISO 5457, left column with the views, right column with tables and notes.
constexpr double kLeft = 20, kTop = 10, kRight = 410, kBottom = 287;
constexpr double kColumn = 236, kTitleTop = 229;
constexpr double kPlanBottom = 172;

class Drawing {
  public:
    Drawing(CairoSheet& sheet, const Study& study, const FinishedDesign& finished, const HandOver& over)
        : sheet_(sheet), study_(study), finished_(finished), over_(over) {}

    void draw() {
        sheet_.rectangle(kLeft, kTop, kRight - kLeft, kBottom - kTop, kThick);
        sheet_.text({kLeft + 4, kTop + 7}, over_.first_line,
                    {.size = 4, .bold = true, .colour = over_.mark.empty() ? CairoSheet::Colour{} : kRed});
        plan();
        sheet_.line({kLeft, kPlanBottom}, {kColumn, kPlanBottom}, kThin);
        const double top = kPlanBottom + 4, bottom = kBottom - 4, left = kLeft + 4, right = kColumn - 4;
        const double split = left + (right - left) / (1.0 + static_cast<double>(over_.flats.size()));
        draw_side_view(sheet_, study_, over_, {left, top, split, bottom});
        draw_flat_patterns(sheet_, study_, over_, {split + 2, top, right, bottom});
        tables();
        title_block();
    }

  private:
    double length() const { return study_.scene.dispenser_length * 1e3; }
    double width() const { return study_.dispenser_width * 1e3; }
    double sx(double x_mm) const { return origin_.x + x_mm * scale_; }
    double sy(double y_mm) const { return origin_.y - y_mm * scale_; }
    SheetPoint at(PlanPoint p) const { return {sx(p.x * 1e3), sy(p.y * 1e3)}; }

    // --- plan view
    void plan() {
        const double slot = 1.2 * study_.build.slot_depth * 1e3;
        // rows of dimensions on each side of the walls
        std::array<int, 5> ends{};
        for (const Plate& plate : over_.plates)
            for (const PlateEnd& end : plate.ends) ++ends[static_cast<std::size_t>(end.at.wall)];
        const auto rows = [&](Wall wall) { return 8.0 * ends[static_cast<std::size_t>(wall)]; };
        const double left = 10 + rows(Wall::rear), right = 26 + rows(Wall::platform);
        const double above = 22 + rows(Wall::side_high), below = 20 + rows(Wall::side_low);
        const double room_x = kColumn - kLeft - left - right,
                     room_y = kPlanBottom - kTop - 10 - above - below;
        scale_ = preferred_scale(std::min(room_x / (length() + 2 * slot), room_y / (width() + 2 * slot)));
        const double used_x = (length() + 2 * slot) * scale_, used_y = (width() + 2 * slot) * scale_;
        origin_ = {kLeft + left + (room_x - used_x) / 2 + slot * scale_,
                   kTop + 10 + above + (room_y - used_y) / 2 + used_y - slot * scale_};
        const double band = slot * scale_;
        const std::vector<SheetPoint> outer = {{sx(0) - band, sy(0) + band},
                                               {sx(length()) + band, sy(0) + band},
                                               {sx(length()) + band, sy(width()) - band},
                                               {sx(0) - band, sy(width()) - band}};
        sheet_.fill(outer, kWallGrey);
        sheet_.fill(rectangle(), {1, 1, 1});
        const auto outlines = chamber_outlines(finished_.design.partition, study_.scene.dispenser_length,
                                               study_.dispenser_width);
        for (const std::size_t side : {0u, 1u}) {
            std::vector<SheetPoint> points;
            for (const PlanPoint& p : outlines[side]) points.push_back(at(p));
            if (points.size() > 2) sheet_.fill(points, side == 0 ? kTintA : kTintB);
        }
        sheet_.polyline(rectangle(), kThick, true);
        slots();
        for (const Plate& plate : over_.plates) {
            std::vector<SheetPoint> strip, back;
            for (const Station& s : plate.stations(kChordError)) {
                strip.push_back(at(s[1]));
                back.push_back(at(s[0]));
            }
            strip.insert(strip.end(), back.rbegin(), back.rend());
            sheet_.fill(strip, kPlateGrey);
            sheet_.polyline(strip, kThin, true);
            std::vector<SheetPoint> middle;
            for (const PlanPoint& p : plate.corners) middle.push_back(at(p));
            sheet_.polyline(middle, {.width = 0.13, .colour = {1, 1, 1}, .dash = {4, 0.8, 0.6, 0.8}});
            name(plate);
        }
        for (const ChamberLetter& letter : chamber_letters(
                 finished_.design.partition, study_.scene.dispenser_length, study_.dispenser_width)) {
            if (!std::isfinite(letter.at.x)) continue;
            const SheetPoint p = at(letter.at);
            const auto colour = letter.side == 0 ? kA : kB;
            // a narrow chamber has room for its letter only
            const double room =
                std::abs(finished_.design.partition.signed_distance(letter.at.x, letter.at.y)) * 1e3 *
                    scale_ -
                0.5e3 * study_.build.thickness * scale_;
            const bool narrow = room < 8;
            sheet_.text(
                {p.x, p.y + (narrow ? 1.4 : 0)}, letter.side == 0 ? "A" : "B",
                {.size = narrow ? 4.0 : 8.0, .anchor = Anchor::middle, .bold = true, .colour = colour});
            if (!narrow)
                sheet_.text({p.x, p.y + 4}, chamber_name(study_, static_cast<int>(letter.side)),
                            {.size = 2.5, .anchor = Anchor::middle, .colour = colour});
        }
        end_dimensions(band);
        view_arrow(band, rows(Wall::side_low), rows(Wall::platform));
        const double y_arrow = sy(width()) - band - rows(Wall::side_high) - 8, x_middle = sx(length() / 2);
        sheet_.line({x_middle - 22, y_arrow}, {x_middle + 22, y_arrow}, {.width = 0.7});
        sheet_.tip({x_middle + 26, y_arrow}, 1, 0, 5);
        sheet_.text({x_middle, y_arrow - 1.6}, "spreading direction (x)",
                    {.size = 2.8, .anchor = Anchor::middle});
        sheet_.text({kLeft + 4, kTop + 14}, fmt::format("Plan view in the dispenser, {}", scale_text(scale_)),
                    {.size = 3, .bold = true});
        // on the walls where they are wide enough
        const double label = band > 4.5 ? 3.5 : -1;
        sheet_.text({sx(0) - band + 1.5, sy(width()) - band + label}, "rear wall",
                    {.size = 2.2, .colour = kGrey});
        sheet_.text({sx(length()) + band - 1.5, sy(width()) - band + label}, "platform side",
                    {.size = 2.2, .anchor = Anchor::end, .colour = kGrey});
    }

    std::vector<SheetPoint> rectangle() const {
        return {{sx(0), sy(0)}, {sx(length()), sy(0)}, {sx(length()), sy(width())}, {sx(0), sy(width())}};
    }

    /// The slots in the walls, as wide as the plate and its clearance, as deep as asked for.
    void slots() {
        const double half = 0.5 * study_.build.thickness + study_.build.slot_clearance;
        for (const Plate& plate : over_.plates)
            for (const std::size_t e : {0u, 1u}) {
                if (plate.ends[e].at.wall == Wall::none) continue;
                const std::size_t n = plate.corners.size();
                const PlanPoint tip = e == 0 ? plate.corners[0] : plate.corners[n - 1],
                                before = e == 0 ? plate.corners[1] : plate.corners[n - 2];
                const double size = std::hypot(tip.x - before.x, tip.y - before.y);
                const PlanPoint d{(tip.x - before.x) / size, (tip.y - before.y) / size};
                const double through = std::cos(plate.ends[e].slant),
                             reach = study_.build.slot_depth / std::max(0.1, through) + 0.2 * half;
                const PlanPoint beyond{tip.x + study_.build.slot_clearance * d.x,
                                       tip.y + study_.build.slot_clearance * d.y},
                    inside{tip.x - reach * d.x, tip.y - reach * d.y};
                const auto corner = [&](PlanPoint p, double side) {
                    return at({p.x - side * half * d.y, p.y + side * half * d.x});
                };
                sheet_.fill({corner(inside, 1), corner(beyond, 1), corner(beyond, -1), corner(inside, -1)},
                            {1, 1, 1});
            }
    }

    /// The plate's letter at its first end, a number at each bend that the table lists.
    void name(const Plate& plate) {
        const SheetPoint tip = at(plate.corners[0]), inner = at(plate.corners[1]);
        const double size = std::hypot(tip.x - inner.x, tip.y - inner.y);
        sheet_.text({tip.x + 4.2 * (tip.x - inner.x) / size, tip.y + 4.2 * (tip.y - inner.y) / size + 1.3},
                    plate.name, {.size = 3.6, .anchor = Anchor::middle, .bold = true});
        if (!plate.rounded) return;
        for (std::size_t k = 0; k < plate.turns.size(); ++k) {
            // outside the bend, where the strip bulges
            const SheetPoint a = at(plate.corners[k]), b = at(plate.corners[k + 1]),
                             c = at(plate.corners[k + 2]);
            const double ab = std::hypot(b.x - a.x, b.y - a.y), bc = std::hypot(c.x - b.x, c.y - b.y);
            const double ox = (b.x - a.x) / ab - (c.x - b.x) / bc, oy = (b.y - a.y) / ab - (c.y - b.y) / bc;
            const double o = std::hypot(ox, oy), off = 1.9 + 0.5e3 * plate.thickness * scale_;
            if (!(o > 0)) continue;
            sheet_.text({b.x + off * ox / o, b.y + off * oy / o + 0.9},
                        fmt::format("{}{}", plate.name, k + 1),
                        {.size = 2.2, .anchor = Anchor::middle, .bold = true});
        }
    }

    /// Each end from the datum corner, along its wall, one row an end; the dispenser's own size outside.
    void end_dimensions(double band) {
        std::array<std::vector<double>, 5> offsets;
        for (const Plate& plate : over_.plates)
            for (const PlateEnd& end : plate.ends)
                offsets[static_cast<std::size_t>(end.at.wall)].push_back(end.at.offset * 1e3);
        for (auto& list : offsets) std::sort(list.begin(), list.end());
        const auto words = [](double mm) { return fmt::format("{:.3f} {}", mm, tolerance_text(mm * 1e-3)); };
        for (const Wall wall : {Wall::rear, Wall::platform, Wall::side_low, Wall::side_high}) {
            double row = band + 6;
            for (const double offset : offsets[static_cast<std::size_t>(wall)]) {
                if (wall == Wall::rear || wall == Wall::platform) {
                    const double sign = wall == Wall::rear ? -1 : 1,
                                 from = sx(wall == Wall::rear ? 0 : length()), x = from + sign * row;
                    for (const double y : {0.0, offset})
                        sheet_.line({from, sy(y)}, {x + 1.5 * sign, sy(y)}, kFine);
                    sheet_.dimension({x, sy(0)}, {x, sy(offset)}, words(offset));
                } else {
                    const double sign = wall == Wall::side_low ? 1 : -1,
                                 from = sy(wall == Wall::side_low ? 0 : width()), y = from + sign * row;
                    for (const double x : {0.0, offset})
                        sheet_.line({sx(x), from}, {sx(x), y + 1.5 * sign}, kFine);
                    sheet_.dimension({sx(0), y}, {sx(offset), y}, words(offset));
                }
                row += 8;
            }
            if (wall == Wall::platform) {
                for (const double y : {0.0, width()})
                    sheet_.line({sx(length()), sy(y)}, {sx(length()) + row + 1.5, sy(y)}, kFine);
                sheet_.dimension({sx(length()) + row, sy(0)}, {sx(length()) + row, sy(width())},
                                 fmt::format("({:.3f})", width()));
            }
            if (wall == Wall::side_low) {
                for (const double x : {0.0, length()})
                    sheet_.line({sx(x), sy(0)}, {sx(x), sy(0) + row + 1.5}, kFine);
                sheet_.dimension({sx(0), sy(0) + row}, {sx(length()), sy(0) + row},
                                 fmt::format("({:.3f})", length()));
            }
        }
        sheet_.line({sx(0) - 2.5, sy(0)}, {sx(0) + 2.5, sy(0)}, kThick);
        sheet_.line({sx(0), sy(0) - 2.5}, {sx(0), sy(0) + 2.5}, kThick);
        sheet_.text({sx(0) + 1, sy(0) + 3.4}, "datum", {.size = 2.2});
    }

    /// Which way the side view looks.
    void view_arrow(double band, double rows_below, double rows_right) {
        const CairoSheet::Look letter{.size = 4, .anchor = Anchor::middle, .bold = true};
        if (seen_along_y(over_)) {
            const double x = sx(0.75 * length()), y = sy(0) + band + rows_below + 9;
            sheet_.line({x, y + 8}, {x, y + 2}, {.width = 0.5});
            sheet_.tip({x, y}, 0, -1, 3.5);
            sheet_.text({x + 3.5, y + 7}, "X", letter);
        } else {
            const double x = sx(length()) + band + rows_right + 9, y = sy(0.75 * width());
            sheet_.line({x + 8, y}, {x + 2, y}, {.width = 0.5});
            sheet_.tip({x, y}, -1, 0, 3.5);
            sheet_.text({x + 6, y - 1.5}, "X", letter);
        }
    }

    // --- right column
    void tables() {
        sheet_.line({kColumn, kTop}, {kColumn, kBottom}, kThin);
        double y = kTop + 8;
        const double x = kColumn + 4, right = kRight - 4;
        const CairoSheet::Look head{.size = 3, .bold = true}, cell{.size = 2.5};
        const auto row = [&](const std::vector<std::pair<double, std::string>>& cells,
                             const CairoSheet::Look& look) {
            for (std::size_t i = 0; i < cells.size(); ++i) {
                CairoSheet::Look own = look;
                own.anchor = i == 0 ? Anchor::start : Anchor::end;
                sheet_.text({x + cells[i].first, y}, cells[i].second, own);
            }
            y += 1.5 * look.size;
        };
        const CairoSheet::Look small{.size = 2.2, .colour = kGrey};
        sheet_.text({x, y}, "Ends, along the walls from the datum [mm]", head);
        y += 4.5;
        row({{0, "end"},
             {58, "wall"},
             {92, "offset"},
             {112, "tolerance"},
             {142, "slot along wall"},
             {166, "off normal"}},
            small);
        for (const Plate& plate : over_.plates)
            for (const std::size_t e : {0u, 1u}) {
                const PlateEnd& end = plate.ends[e];
                row({{0, plate.name + (e == 0 ? " first" : " last")},
                     {58, end.at.name()},
                     {92, std::isfinite(end.at.offset) ? millimetres(end.at.offset) : "-"},
                     {112, tolerance_text(end.at.offset)},
                     {142, millimetres(end.slot_along)},
                     {166, fmt::format("({:.1f} deg)", end.slant / kDegree)}},
                    cell);
            }
        y += 2;
        std::size_t corners = 0;
        for (const Plate& plate : over_.plates) corners += plate.turns.size();
        if (corners > 0) {
            sheet_.text({x, y},
                        study_.build.printed ? "Points of the middle line [mm]"
                                             : "Bends: corners of the middle line [mm]",
                        head);
            y += 4.5;
            row({{0, "corner"},
                 {40, "x"},
                 {62, "y"},
                 {92, "bend, deg"},
                 {112, "towards"},
                 {142, "at, laid flat"},
                 {166, "allowance"}},
                small);
            constexpr std::size_t kMost = 16;
            const std::size_t every = 1 + (corners - 1) / kMost;
            std::size_t count = 0;
            for (std::size_t p = 0; p < over_.plates.size(); ++p) {
                const Plate& plate = over_.plates[p];
                for (std::size_t k = 0; k < plate.turns.size(); ++k) {
                    if (count++ % every != 0) continue;
                    const FlatPattern& flat = over_.flats[p];
                    const bool bent = k < flat.bends.size();
                    row({{0, fmt::format("{}{}", plate.name, k + 1)},
                         {40, millimetres(plate.corners[k + 1].x)},
                         {62, millimetres(plate.corners[k + 1].y)},
                         {92, fmt::format("{:.2f}", std::abs(plate.turns[k]) / kDegree)},
                         {112, plate.turns[k] > 0 ? "A" : "B"},
                         {142, bent ? millimetres(flat.bends[k].at) : "-"},
                         {166, bent ? fmt::format("{:.4f}", flat.bends[k].allowance * 1e3) : "-"}},
                        cell);
                }
            }
            if (every > 1)
                row({{0, fmt::format("each {}. of {} points; spec.json and partition.step have all", every,
                                     corners)}},
                    small);
            y += 2;
        }
        sheet_.text({x, y}, "Notes", head);
        y += 4.5;
        int number = 0;
        const auto note = [&](const std::string& words, const CairoSheet::Colour& colour = {}) {
            const CairoSheet::Look look{.size = 2.45, .colour = colour};
            const auto lines = sheet_.broken(right - x - 6, words, look);
            if (y + 3.3 * static_cast<double>(lines.size()) > kTitleTop - 2) {
                ++unwritten_;
                return;
            }
            sheet_.text({x, y}, fmt::format("{}", ++number), look);
            y = sheet_.paragraph({x + 6, y}, right - x - 6, words, look) + 0.7;
        };
        const PartitionBuild& build = study_.build;
        const double finest = finest_d10(study_);
        for (const PlateCheck& check : over_.checks)
            if (!check.passed) note("CANNOT BE BUILT AS DRAWN: " + check.text, kRed);
        note(
            "Temporary plate: the dispenser is filled with it in place, then it is drawn out upwards. "
            "Position by the end "
            "offsets, not by angle; angles in brackets are for information.");
        const double slot = 1e3 * (build.thickness + 2 * build.slot_clearance);
        if (build.tabs) {
            note(fmt::format(
                "Notches in the rim of the dispenser's walls for the tabs: {:.3f} +0.1/0 deep below "
                "the rim, {:.3f} +0.1/0 into the wall, width {:.4g} +{:.4g}/0; bottoms level.",
                1e3 * build.tab_depth, 1e3 * build.slot_depth, slot, 1e3 * build.slot_clearance));
            note(fmt::format(
                "The plate hangs by its tabs. Its ends below them are fitted to this dispenser: gap "
                "to the walls {:.4g} um, nowhere {:.4g} um or more (finest D10). Lower edge straight "
                "within {:.4g} um; the floor is brought up to it.",
                build.end_clearance * 1e6, finest * 1e6, build.clearance * 1e6));
        } else {
            note(
                fmt::format("Slots in the dispenser's walls, square to the rim, over its full depth: width "
                            "{:.4g} +{:.4g}/0, depth {:.3f} +0.1/0.",
                            slot, 1e3 * build.slot_clearance, 1e3 * build.slot_depth));
            note(fmt::format(
                "The plate stands on the dispenser floor, so its height's tolerance goes into the "
                "grip. Lower edge straight and square to the plate: gap to the floor {:.4g} um, "
                "nowhere {:.4g} um or more (finest D10).",
                build.clearance * 1e6, finest * 1e6));
        }
        note(fmt::format("Deburr all edges, burr at most {:.4g} um, edges not rounded; free of grease.",
                         finest * 1e6));
        if (over_.make == "bent sheet")
            note(
                fmt::format("Inside bend radius {:.3f}. Bend allowance q (r + k t), q in rad, k = {:.4f}{}.",
                            build.bend_radius * 1e3, build.k_factor,
                            std::abs(build.k_factor - din_k_factor(build.bend_radius, build.thickness)) < 1e-9
                                ? " (DIN 6935)"
                                : ""));
        if (build.printed)
            note(
                "Printed standing, shape from partition.step or partition.stl; no support on the faces. "
                "Slide it "
                "through its slots by hand before use: it must fall by its own weight.");
        for (std::size_t i = 0; i < over_.marks.size(); ++i) {
            const auto& sides = over_.marks[i];
            note(fmt::format(
                "{} {} above the rim, {}letters {:.2g} mm high; on side B: {}; on side A: {}. As in "
                "partition.step; side B also in flat_pattern.dxf.",
                build.engraving > 0 ? "Engrave" : "Mark the surface of", over_.plates[i].name,
                build.engraving > 0 ? fmt::format("{:.3g} mm deep, ", build.engraving * 1e3) : "",
                1e3 * std::min(sides[0].letter, sides[1].letter), fmt::join(sides[1].lines, " / "),
                fmt::join(sides[0].lines, " / ")));
        }
        note(over_.slot.text);
        // what concerns powder stands on the fill sheet
        for (const std::string& warning : plate_warnings(study_, over_.plates)) note(warning);
        if (unwritten_ > 0)
            sheet_.text({right, kTitleTop - 1.5}, fmt::format("{} more in spec.json", unwritten_),
                        {.size = 2.2, .anchor = Anchor::end});
    }

    void field(double x, double y, double width, const std::string& label, const std::string& value,
               double size = 2.8, const CairoSheet::Colour& colour = {}) {
        sheet_.text({x + 1.2, y + 2.6}, label, {.size = 1.9, .colour = kGrey});
        CairoSheet::Look look{.size = size, .colour = colour};
        const double needed = sheet_.text_width(value, look);
        if (needed > width - 2.4)
            look.size *= (width - 2.4) / needed;  // shrinks rather than runs over the frame
        sheet_.text({x + 1.2, y + 6.4}, value, look);
    }

    /// ISO 7200: owner, number, title, kind, creator, approval, date, sheet; and what a workshop asks for.
    void title_block() {
        const double left = kColumn, top = kTitleTop, right = kRight;
        sheet_.line({left, top}, {right, top}, kThick);
        const auto rows = {8.0, 16.0, 24.0, 32.0, 40.0, 49.0};
        for (const double r : rows) sheet_.line({left, top + r}, {right, top + r}, kFine);
        const PartitionBuild& build = study_.build;
        const double third = (right - left) / 3;
        const auto divide = [&](double from, double to, std::initializer_list<double> at) {
            for (const double x : at) sheet_.line({left + x, top + from}, {left + x, top + to}, kFine);
        };
        divide(0, 24, {third, 2 * third});
        field(left, top, third, "material", build.material);
        field(left + third, top, third, "thickness, make",
              fmt::format("{:g}, {}", build.thickness * 1e3, over_.make));
        field(left + 2 * third, top, third, "general tolerances", "ISO 2768-1 m");
        field(left, top + 8, third, "dimensions, scales",
              fmt::format("mm; {} or as stated (A3)", scale_text(scale_)));
        field(left + third, top + 8, third, "machine", study_.machine_name);
        field(left + 2 * third, top + 8, third, "dispenser length x width x depth",
              fmt::format("{:g} x {:g} x {:g}", length(), width(), study_.scene.dispenser_depth * 1e3));
        field(left, top + 16, third, "creator", build.creator);
        field(left + third, top + 16, third, "approved by", build.approved);
        field(left + 2 * third, top + 16, third, "date of issue", build.date);
        divide(24, 32, {2 * third});
        field(left, top + 24, 2 * third, "legal owner", build.owner);
        field(left + 2 * third, top + 24, third, "document type", "component drawing");
        divide(32, 40, {2 * third});
        field(left, top + 32, 2 * third, "title", fmt::format("Dispenser partition, {}", study_.name), 3.4);
        field(left + 2 * third, top + 32, third, "identification number", over_.id, 3.6);
        field(left, top + 40, right - left, "document status", over_.first_line, 3.4,
              over_.mark.empty() ? CairoSheet::Colour{} : kRed);
        divide(49, kBottom - top, {third, 2 * third, 2 * third + 30});
        field(left, top + 49.5, third, "made by",
              fmt::format("gradwright {}", provenance_json()["version"].get<std::string>()));
        sheet_.text({left + third + 1.2, top + 52.1}, "first-angle projection",
                    {.size = 1.9, .colour = kGrey});
        sheet_.text({left + third + 1.2, top + 56}, "X: by arrow", {.size = 1.9, .colour = kGrey});
        // a truncated cone from the side and from its small end
        const double cx = left + third + 28, cy = top + 53.5;
        sheet_.polyline({{cx, cy - 1.5}, {cx + 7, cy - 2.6}, {cx + 7, cy + 2.6}, {cx, cy + 1.5}}, kThin,
                        true);
        for (const double r : {1.5, 2.6}) {
            std::vector<SheetPoint> circle;
            for (int i = 0; i < 32; ++i)
                circle.push_back(
                    {cx + 14 + r * std::cos(i * kDegree * 11.25), cy + r * std::sin(i * kDegree * 11.25)});
            sheet_.polyline(circle, kThin, true);
        }
        field(left + 2 * third, top + 49.5, 30, "language", "en");
        field(left + 2 * third + 30, top + 49.5, third - 30, "sheet", "1 / 1");
    }

    CairoSheet& sheet_;
    const Study& study_;
    const FinishedDesign& finished_;
    const HandOver& over_;
    double scale_ = 1;
    SheetPoint origin_;
    int unwritten_ = 0;
};

}  // namespace

DrawPage plate_drawing(const Study& study, const FinishedDesign& finished, const HandOver& over) {
    return [&](CairoSheet& sheet) { Drawing(sheet, study, finished, over).draw(); };
}

}  // namespace gradwright
