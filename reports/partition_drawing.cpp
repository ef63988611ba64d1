#include "reports/partition_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/sheet_layout.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

// Sheet [mm]: frame, drawing field, table column, title block.
constexpr double kSheetWidth = 297, kSheetHeight = 210, kFrame = 8;
constexpr double kTitleHeight = 30, kTableWidth = 68;
constexpr double kRoomLeft = 30, kRoomBottom = 27, kRoomTop = 33, kRoomRight = 17;
constexpr double kTextStep = 4.0;  ///< smallest distance of two dimension texts

constexpr const char* kBlue = "#0072B2";  // Okabe-Ito: told apart with every kind of colour vision
constexpr const char* kOrange = "#E69F00";

constexpr const char* kDimensionLine =
    R"svg(<line x1="{:.3f}" y1="{:.3f}" x2="{:.3f}" y2="{:.3f}" class="dim" marker-start="url(#tip)" marker-end="url(#tip)"/>)svg";

class Sheet {
  public:
    Sheet(const Study& study, const StudyResult& result)
        : study_(study),
          result_(result),
          length_(study.scene.dispenser_length * 1e3),
          width_(study.dispenser_width * 1e3) {
        const double room_x = kSheetWidth - 2 * kFrame - kTableWidth - kRoomLeft - kRoomRight;
        const double room_y = kSheetHeight - 2 * kFrame - kTitleHeight - kRoomTop - kRoomBottom;
        scale_ = preferred_scale(std::min(room_x / length_, room_y / width_));
        left_ = kFrame + kRoomLeft + (room_x - length_ * scale_) / 2;
        bottom_ = kFrame + kRoomTop + room_y - (room_y - width_ * scale_) / 2;
        rows_ = partition_rows(study, result.design);
        // A smooth curve comes as many corners: the plan names and dimensions a dozen of them, the table
        // lists what it has room for, the file has all.
        const Family family = result.design.family;
        const bool smooth = family == Family::sigmoid || family == Family::spline;
        every_named_ = smooth ? 1 + rows_.size() / 12 : 1;
        every_listed_ = smooth ? 1 + rows_.size() / 36 : 1;
    }

    std::string svg() {
        head();
        chambers();
        ordinates();
        letters();
        partition();
        overall();
        arrow();
        table();
        title_block();
        out_ += "</svg>\n";
        return out_;
    }

  private:
    double sx(double x_mm) const { return left_ + x_mm * scale_; }
    double sy(double y_mm) const { return bottom_ - y_mm * scale_; }

    void add(const std::string& text) { out_ += text + "\n"; }
    void line(double x1, double y1, double x2, double y2, const char* style) {
        add(fmt::format(R"(<line x1="{:.3f}" y1="{:.3f}" x2="{:.3f}" y2="{:.3f}" class="{}"/>)", x1, y1, x2,
                        y2, style));
    }
    void text(double x, double y, const std::string& words, const char* style, const std::string& more = "") {
        add(fmt::format(R"(<text x="{:.3f}" y="{:.3f}" class="{}"{}>{}</text>)", x, y, style,
                        more.empty() ? "" : " " + more, escaped(words)));
    }

    void head() {
        add(R"(<?xml version="1.0" encoding="UTF-8"?>)");
        add(fmt::format(
            R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" viewBox="0 0 {0} {1}" role="img">)",
            kSheetWidth, kSheetHeight));
        add(fmt::format("<title>{}: dispenser partition, plan view</title>", escaped(study_.name)));
        add("<desc>Dimensions in mm from the dispenser's rear wall and its y = 0 side. A is the powder on "
            "the left of the partition "
            "seen from its first corner.</desc>");
        add(R"svg(<defs>
<style>
text{font-family:"Liberation Sans",Arial,Helvetica,sans-serif;fill:#111;font-size:3.1px}
.wall{fill:none;stroke:#111;stroke-width:.6}
.thin{stroke:#444;stroke-width:.18;fill:none}
.dim{stroke:#222;stroke-width:.2;fill:none}
.cut{stroke:#111;stroke-width:1;fill:none;stroke-linejoin:miter;stroke-linecap:butt}
.cross{stroke:#444;stroke-width:.18;stroke-dasharray:2 .8 .4 .8}
.frame{fill:none;stroke:#111;stroke-width:.5}
.num{font-size:2.9px}
.numr{font-size:2.9px;text-anchor:end}
.numm{font-size:2.9px;text-anchor:middle}
.head{font-weight:bold;font-size:2.7px;fill:#444}
.headr{font-weight:bold;font-size:2.7px;fill:#444;text-anchor:end}
.label{font-size:2.3px;fill:#555}
.labelr{font-size:2.3px;fill:#555;text-anchor:end}
.value{font-size:3.3px}
.name{font-size:5px;font-weight:bold}
.side,.powder{text-anchor:middle;paint-order:stroke;stroke:#fff;stroke-width:1px;stroke-opacity:.8;stroke-linejoin:round}
.side{font-size:9px;font-weight:bold}
.corner{font-size:2.9px;font-weight:bold;text-anchor:middle;paint-order:stroke;stroke:#fff;stroke-width:.9px;stroke-linejoin:round}
.way{font-size:3.2px;text-anchor:middle;fill:#111}
</style>
<marker id="tip" viewBox="0 0 10 10" refX="10" refY="5" markerWidth="2.6" markerHeight="2.6" markerUnits="userSpaceOnUse" orient="auto-start-reverse"><path d="M0 3.3 10 5 0 6.7z" fill="#222"/></marker>
</defs>)svg");
        add(fmt::format(R"(<rect width="{}" height="{}" fill="#fff"/>)", kSheetWidth, kSheetHeight));
        add(fmt::format(R"(<rect x="{0}" y="{0}" width="{1}" height="{2}" class="frame"/>)", kFrame,
                        kSheetWidth - 2 * kFrame, kSheetHeight - 2 * kFrame));
    }

    void chambers() {
        const auto outlines =
            chamber_outlines(result_.design.partition, study_.scene.dispenser_length, study_.dispenser_width);
        for (std::size_t side : {0u, 1u}) {
            if (outlines[side].empty()) continue;
            std::string points;
            for (const PlanPoint& p : outlines[side])
                points += fmt::format("{:.3f},{:.3f} ", sx(p.x * 1e3), sy(p.y * 1e3));
            add(fmt::format(R"(<polygon points="{}" fill="{}" fill-opacity=".16"/>)", points,
                            side == 0 ? kBlue : kOrange));
        }
        add(fmt::format(R"(<rect x="{:.3f}" y="{:.3f}" width="{:.3f}" height="{:.3f}" class="wall"/>)", sx(0),
                        sy(width_), length_ * scale_, width_ * scale_));
    }

    void letters() {
        for (const auto& [side, at] : chamber_letters(result_.design.partition, study_.scene.dispenser_length,
                                                      study_.dispenser_width)) {
            if (!std::isfinite(at.x)) continue;
            const double x = sx(at.x * 1e3), y = sy(at.y * 1e3);
            text(x, y + 1.6, side == 0 ? "A" : "B", "side",
                 fmt::format(R"(style="fill:{}")", side == 0 ? kBlue : "#9A6A00"));
            text(x, y + 6, chamber_name(study_, int(side)), "powder");
        }
    }

    void partition() {
        if (rows_.size() < 2) return;
        for (const int curve : {1, 2}) {
            std::string points;
            for (const PartitionRow& row : rows_)
                if (row.curve == curve) points += fmt::format("{:.3f},{:.3f} ", sx(row.x_mm), sy(row.y_mm));
            if (!points.empty()) add(fmt::format(R"(<polyline points="{}" class="cut"/>)", points));
        }
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (!shown(i, every_named_)) continue;
            const double x = sx(rows_[i].x_mm), y = sy(rows_[i].y_mm);
            add(fmt::format(
                R"(<circle cx="{:.3f}" cy="{:.3f}" r=".9" fill="#fff" stroke="#111" stroke-width=".35"/>)", x,
                y));
            // the name stands off the line, on the outer side of the corner, kept inside the walls
            const bool begins = i == 0 || rows_[i - 1].curve != rows_[i].curve,
                       ends = i + 1 == rows_.size() || rows_[i + 1].curve != rows_[i].curve;
            const PartitionRow &before = rows_[begins ? i : i - 1], &after = rows_[ends ? i : i + 1];
            const double tx = after.x_mm - before.x_mm, ty = -(after.y_mm - before.y_mm),
                         size = std::hypot(tx, ty);
            double nx = size > 0 ? ty / size : 0, ny = size > 0 ? -tx / size : -1;
            if (y + 4 * ny < sy(width_) + 2.5 || y + 4 * ny > sy(0) - 1.5 || x + 4 * nx < sx(0) + 2 ||
                x + 4 * nx > sx(length_) - 2) {
                nx = -nx;
                ny = -ny;
            }
            double px = x + 3.6 * nx, py = y + 3.6 * ny + 1;
            px = std::clamp(px, sx(0) + 3.2, sx(length_) - 3.2);
            py = std::clamp(py, sy(width_) + 3.4, sy(0) - 1.4);
            text(px, py, rows_[i].name(), "corner");
        }
    }

    /// Every n-th corner and the last.
    bool shown(std::size_t i, std::size_t every) const { return i % every == 0 || i + 1 == rows_.size(); }

    /// Ordinate dimensions (ISO 129-1 running dimensions from one origin): x below the dispenser, y on its
    /// left.
    void ordinates() {
        for (bool along_x : {true, false}) {
            std::vector<std::pair<double, double>> marks = {
                {0, 0}};  // ordinate, nearest corner's other coordinate
            for (std::size_t i = 0; i < rows_.size(); ++i)
                if (shown(i, every_named_))
                    marks.emplace_back(along_x ? rows_[i].x_mm : rows_[i].y_mm,
                                       along_x ? rows_[i].y_mm : rows_[i].x_mm);
            std::sort(marks.begin(), marks.end());
            std::vector<std::pair<double, double>> unique;
            for (const auto& mark : marks)
                if (unique.empty() || mark.first - unique.back().first > 5e-4) unique.push_back(mark);
            std::vector<double> wanted;
            for (const auto& mark : unique) wanted.push_back(along_x ? sx(mark.first) : -sy(mark.first));
            const std::vector<double> placed = spread_apart(wanted, kTextStep);
            for (std::size_t i = 0; i < unique.size(); ++i) {
                const double v = unique[i].first, other = unique[i].second;
                const std::string words = millimetres(v * 1e-3);
                if (along_x) {
                    const double x = sx(v), t = placed[i], wall = sy(0);
                    if (other > 0 && v > 0 && v < length_ - 1e-6) line(x, sy(other), x, wall, "cross");
                    add(fmt::format(R"(<path d="M{:.3f} {:.3f}V{:.3f}L{:.3f} {:.3f}V{:.3f}" class="dim"/>)",
                                    x, wall + 1.2, wall + 4, t, wall + 7, wall + 9));
                    text(t + 1.05, wall + 10, words, "numr",
                         fmt::format(R"svg(transform="rotate(-90 {:.3f} {:.3f})")svg", t + 1.05, wall + 10));
                } else {
                    const double y = sy(v), t = -placed[i], wall = sx(0);
                    if (other > 0 && v > 0 && v < width_ - 1e-6) line(wall, y, sx(other), y, "cross");
                    add(fmt::format(R"(<path d="M{:.3f} {:.3f}H{:.3f}L{:.3f} {:.3f}H{:.3f}" class="dim"/>)",
                                    wall - 1.2, y, wall - 4, wall - 7, t, wall - 9));
                    text(wall - 10, t + 1.05, words, "numr");
                }
            }
            if (along_x)
                text(sx(length_) + 3, sy(0) + 8, "x", "value", R"(font-style="italic")");
            else
                text(sx(0) - 16, sy(width_) - 4.5, "y", "value", R"(font-style="italic")");
        }
        // datum: both dimension chains start at this corner
        add(fmt::format(
            R"(<circle cx="{:.3f}" cy="{:.3f}" r="1.3" fill="#fff" stroke="#111" stroke-width=".3"/><circle cx="{:.3f}" cy="{:.3f}" r=".45" fill="#111"/>)",
            sx(0), sy(0), sx(0), sy(0)));
    }

    void overall() {
        const double above = sy(width_) - 7, right = sx(length_) + 8;
        for (double x : {sx(0), sx(length_)}) line(x, sy(width_) - 1.2, x, above - 1.5, "thin");
        add(fmt::format(kDimensionLine, sx(0), above, sx(length_), above));
        text((sx(0) + sx(length_)) / 2, above - 1, millimetres(length_ * 1e-3), "numm");
        for (double y : {sy(0), sy(width_)}) line(sx(length_) + 1.2, y, right + 1.5, y, "thin");
        add(fmt::format(kDimensionLine, right, sy(0), right, sy(width_)));
        const double y = (sy(0) + sy(width_)) / 2;
        text(right - 1, y, millimetres(width_ * 1e-3), "numm",
             fmt::format(R"svg(transform="rotate(-90 {:.3f} {:.3f})")svg", right - 1, y));
    }

    void arrow() {
        const double x = (sx(0) + sx(length_)) / 2, y = sy(width_) - 18.5;
        const double half = std::min(24.0, length_ * scale_ / 2);
        add(fmt::format(R"(<path d="M{:.3f} {:.3f}h{:.3f}v-1.3l5 2.2-5 2.2v-1.3h{:.3f}z" fill="#111"/>)",
                        x - half, y, 2 * half - 5, -(2 * half - 5)));
        text(x, y - 2.2, "spreading direction", "way");
        text(sx(0), sy(width_) - 13.5, "rear wall", "label");
        text(sx(length_), sy(width_) - 13.5, "platform side", "label", R"(text-anchor="end")");
    }

    void table() {
        const double x = kSheetWidth - kFrame - kTableWidth + 2, right = kSheetWidth - kFrame - 3;
        double y = kFrame + 9;
        text(x, y, "Corners of the partition", "value", R"(font-weight="bold")");
        y += 6;
        const double columns[] = {x + 20, x + 34, x + 49, right};
        text(x, y, "corner", "head");
        for (int c = 0; c < 4; ++c) text(columns[c], y + 3.4, c < 3 ? "mm" : "deg", "labelr");
        for (int c = 0; c < 4; ++c)
            text(columns[c], y, std::array{"x", "y", "length", "angle"}[static_cast<std::size_t>(c)],
                 "headr");
        y += 3.4;
        line(x, y + 1.4, right, y + 1.4, "thin");
        const double room = kSheetHeight - kFrame - kTitleHeight - 34 - y;
        const std::size_t listed = (rows_.size() + every_listed_ - 1) / every_listed_;
        const double step = std::min(5.0, rows_.empty() ? 5.0 : room / static_cast<double>(listed));
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (!shown(i, every_listed_)) continue;
            const PartitionRow& row = rows_[i];
            y += step;
            text(x, y, row.name(), "num", R"(font-weight="bold")");
            text(columns[0], y, millimetres(row.x_mm * 1e-3), "numr");
            text(columns[1], y, millimetres(row.y_mm * 1e-3), "numr");
            if (std::isfinite(row.length_mm)) {
                text(columns[2], y, millimetres(row.length_mm * 1e-3), "numr");
                text(columns[3], y, fmt::format("{:.2f}", row.angle_deg), "numr");
            }
        }
        line(x, y + 1.8, right, y + 1.8, "thin");
        if (rows_.size() < 2) text(x, y + 6, "no partition inside the dispenser", "num");
        y += 7;
        for (const char* words :
             {"Datum: rear wall (x = 0), side wall (y = 0).",
              "Length, angle: of the segment that starts here,",
              "angle from the spreading direction, + to +y.", "A: powder on the left, seen from P1 on."}) {
            text(x, y, words, "label");
            y += 3.6;
        }
        const PartitionCurve& partition = result_.design.partition;
        if (!partition.second.empty())
            text(x, y,
                 fmt::format("Two curves, P and Q: {} between them.", partition.a_between() ? "A" : "B"),
                 "label");
        else if (every_named_ > 1)
            text(x, y, "Smooth: corners within 0.002 of the curve.", "label");
        line(x - 4, kFrame, x - 4, kSheetHeight - kFrame - kTitleHeight, "thin");
    }

    void field(double x, double row, const char* label, const std::string& value, std::size_t letters) {
        const double y = kSheetHeight - kFrame - kTitleHeight + row;
        text(x, y, label, "label");
        std::string shown = value;
        if (shown.size() > letters) {  // cut on a UTF-8 boundary
            std::size_t cut = letters - 1;
            while (cut > 0 && (static_cast<unsigned char>(shown[cut]) & 0xC0) == 0x80) --cut;
            shown = shown.substr(0, cut) + "…";
        }
        text(x, y + 4.3, shown, "value");
    }

    void title_block() {
        const double top = kSheetHeight - kFrame - kTitleHeight, left = kFrame, right = kSheetWidth - kFrame;
        const double stop[] = {left + 92, left + 172, right - kTableWidth - 2};
        line(left, top, right, top, "wall");
        for (double x : stop) line(x, top, x, kSheetHeight - kFrame, "thin");
        for (double row : {10.0, 20.0}) line(stop[0], top + row, right, top + row, "thin");
        const Scene& scene = study_.scene;
        std::string name = study_.name;
        text(left + 4, top + 5, "study", "label");
        // long names shrink rather than run over the frame
        text(left + 4, top + 12, name, "name",
             name.size() > 30 ? R"(textLength="84" lengthAdjust="spacingAndGlyphs")" : "");
        text(left + 4, top + 18.5, "Dispenser partition, plan view", "value");
        text(left + 4, top + 25.5, fmt::format("made by gradwright, verdict: {}", to_string(result_.verdict)),
             "label");
        field(stop[0] + 3, 3.6, "machine", study_.machine_name, 44);
        field(stop[0] + 3, 13.6, "A (left of the partition)", chamber_name(study_, 0), 44);
        field(stop[0] + 3, 23.6, "B (right of the partition)", chamber_name(study_, 1), 44);
        field(stop[1] + 3, 3.6, "dosage", fmt::format("{:.3g}", result_.design.dosage_factor), 16);
        field(stop[1] + 3, 13.6, "fill A", fmt::format("{:.3g}", result_.design.fill_fraction[0]), 16);
        field(stop[1] + 3, 23.6, "fill B", fmt::format("{:.3g}", result_.design.fill_fraction[1]), 16);
        field(stop[2] + 4, 3.6, "scale (A4)", scale_text(scale_), 20);
        field(stop[2] + 38, 3.6, "dimensions", "mm", 20);
        field(stop[2] + 4, 13.6, "well length x width x depth",
              fmt::format("{:g} x {:g} x {:g}", length_, width_, scene.dispenser_depth * 1e3), 36);
        field(stop[2] + 4, 23.6, "plate thickness",
              scene.plate_thickness > 0
                  ? fmt::format("{:g}, centred on the line", scene.plate_thickness * 1e3)
                  : "ideal, the line is its middle",
              40);
    }

    const Study& study_;
    const StudyResult& result_;
    double length_, width_, scale_ = 1, left_ = 0, bottom_ = 0;  // [mm], drawn mm per mm, sheet mm
    std::vector<PartitionRow> rows_;
    std::size_t every_named_ = 1, every_listed_ = 1;
    std::string out_;
};

}  // namespace

std::string partition_svg(const Study& study, const StudyResult& result) {
    return Sheet(study, result).svg();
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
        }
    }
    return out;
}

std::array<std::vector<PlanPoint>, 2> chamber_outlines(const PartitionCurve& partition, double length,
                                                       double width) {
    const std::vector<PlanPoint> rectangle = {{0, 0}, {length, 0}, {length, width}, {0, width}};
    auto curve = partition.points.size() >= 2 ? partition.clipped(length, width) : std::vector<PlanPoint>{};
    auto second = partition.second_clipped(length, width);
    if (curve.size() < 2) std::swap(curve, second);  // the other curve alone divides the dispenser
    if (curve.size() < 2) {
        const bool all_a = partition.points.size() >= 2 && partition.on_side_a(length / 2, width / 2);
        return {all_a ? rectangle : std::vector<PlanPoint>{}, all_a ? std::vector<PlanPoint>{} : rectangle};
    }
    // Way round the rectangle, counter-clockwise from the corner (0, 0) [m].
    const double perimeter = 2 * (length + width);
    const auto way = [&](const PlanPoint& p) {
        const double gaps[] = {std::abs(p.y), std::abs(p.x - length), std::abs(p.y - width), std::abs(p.x)};
        switch (std::min_element(gaps, gaps + 4) - gaps) {
            case 0:
                return p.x;
            case 1:
                return length + p.y;
            case 2:
                return length + width + (length - p.x);
            default:
                return 2 * length + width + (width - p.y);
        }
    };
    const double corner_way[] = {0, length, length + width, 2 * length + width};
    // A lies on the left of the curve, so the curve followed by the walls counter-clockwise back to its start
    // bounds A.
    const auto walk = [&](std::vector<PlanPoint>& outline, const PlanPoint& target) {
        const double from = way(outline.back());
        double to = way(target);
        if (to <= from) to += perimeter;
        for (double turn : {0.0, perimeter})
            for (std::size_t c = 0; c < 4; ++c)
                if (corner_way[c] + turn > from + 1e-12 && corner_way[c] + turn < to - 1e-12)
                    outline.push_back(rectangle[c]);
    };
    const auto close = [&](std::vector<PlanPoint> outline) {
        const PlanPoint start = outline.front();
        walk(outline, start);
        return outline;
    };
    const std::vector<PlanPoint> back = {curve.rbegin(), curve.rend()};
    if (second.size() < 2) return {close(curve), close(back)};
    const std::vector<PlanPoint> second_back = {second.rbegin(), second.rend()};
    const bool a_inside = partition.a_between();
    // inner: along one curve, by the wall to the other, along it and back
    std::vector<PlanPoint> inner = a_inside ? curve : back;
    const std::vector<PlanPoint>& other = a_inside ? second : second_back;
    walk(inner, other.front());
    inner.insert(inner.end(), other.begin(), other.end());
    const PlanPoint start = inner.front();
    walk(inner, start);
    std::vector<PlanPoint> outer = close(a_inside ? back : curve);
    const std::vector<PlanPoint> beyond = close(a_inside ? second_back : second);
    outer.push_back(outer.front());
    outer.insert(outer.end(), beyond.begin(), beyond.end());
    outer.push_back(beyond.front());
    return a_inside ? std::array{inner, outer} : std::array{outer, inner};
}

std::array<PlanPoint, 2> chamber_centres(const PartitionCurve& partition, double length, double width) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::array<PlanPoint, 2> centres = {PlanPoint{kNone, kNone}, PlanPoint{kNone, kNone}};
    std::array<double, 2> clearance = {-1, -1};
    constexpr int kColumns = 80, kRows = 40;
    for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kColumns; ++i) {
            const PlanPoint p{(i + 0.5) * length / kColumns, (j + 0.5) * width / kRows};
            const double signed_distance =
                partition.points.size() >= 2 ? partition.signed_distance(p.x, p.y) : -length;
            const double room = std::min({std::abs(signed_distance), p.x, length - p.x, p.y, width - p.y});
            const std::size_t side = signed_distance > 0 ? 0 : 1;
            if (room > clearance[side]) {
                clearance[side] = room;
                centres[side] = p;
            }
        }
    return centres;
}

std::vector<ChamberLetter> chamber_letters(const PartitionCurve& partition, double length, double width) {
    const auto centres = chamber_centres(partition, length, width);
    std::vector<ChamberLetter> letters = {{0, centres[0]}, {1, centres[1]}};
    const std::size_t outer = partition.a_between() ? 1 : 0;
    if (partition.second.empty() || !std::isfinite(centres[outer].x)) return letters;
    // the outer powder has a letter beyond one curve; look beyond the other
    const auto beyond = [outer](const std::vector<PlanPoint>& curve, PlanPoint p) {
        return PartitionCurve{curve}.on_side_a(p.x, p.y) == (outer == 0);
    };
    const bool has_first = beyond(partition.points, centres[outer]);
    const PartitionCurve other{has_first ? partition.second : partition.points};
    const PlanPoint third = chamber_centres(other, length, width)[outer];
    if (std::isfinite(third.x)) letters.push_back({outer, third});
    return letters;
}

}  // namespace gradwright
