#include "reports/fill_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/fill_sketch.h"
#include "reports/partition_drawing.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

constexpr CairoSheet::Colour kRed{0.75, 0, 0}, kGrey{0.35, 0.35, 0.35}, kShade{0.93, 0.94, 0.95};

std::string mm(double metres) {
    return millimetres(metres) + " mm";
}

/// Volumes of coupons are some mm3, of machines litres.
std::string volume_text(double cubic_metres) {
    return cubic_metres < 1e-6 ? fmt::format("{:.4g} mm³", cubic_metres * 1e9)
                               : fmt::format("{:.4g} cm³", cubic_metres * 1e6);
}

std::string title_of(const Study& study, const HandOver& over) {
    return fmt::format("Fill sheet {}: {}", over.id, study.name);
}

/// Tables and lists one below the other on as many pages as they need. Laid out on a recording first, so that
/// a block's height is known before it is drawn.
class Pages {
  public:
    Pages(const std::string& footer, DrawPage sketch) : footer_(footer), sketch_(std::move(sketch)) {}

    void add(const SheetBlock& block) { blocks_.push_back(block); }

    /// Draws page `wanted` (from 0) of the layout; returns the number of pages.
    int draw(CairoSheet& sheet, int wanted, const std::string& first_line, bool doubtful,
             const std::string& title, const std::string& subtitle) {
        page_ = 0;
        wanted_ = wanted;
        y_ = kTop;
        put(sheet, {kLeft, y_ + 4}, first_line,
            {.size = 4.2, .bold = true, .colour = doubtful ? kRed : CairoSheet::Colour{}});
        y_ += 10;
        put(sheet, {kLeft, y_ + 3}, title, {.size = 5.5, .bold = true});
        y_ += 7;
        put(sheet, {kLeft, y_ + 1}, subtitle, {.size = 3, .colour = kGrey});
        y_ += 7;
        if (shown()) sketch_(sheet);
        y_ += kSketch;
        for (const SheetBlock& block : blocks_) draw_block(sheet, block);
        foot(sheet);
        return page_ + 1;
    }

    static constexpr double kLeft = 18, kRight = 192, kTop = 14, kBottom = 280;
    static constexpr double kSketchTop = kTop + 20, kSketch = 52;  ///< below the head; its height

  private:
    bool shown() const { return page_ == wanted_; }
    void put(CairoSheet& sheet, SheetPoint at, const std::string& words, const CairoSheet::Look& look) {
        if (shown()) sheet.text(at, words, look);
    }
    void foot(CairoSheet& sheet) {
        put(sheet, {kLeft, 288}, footer_, {.size = 2.4, .colour = kGrey});
        put(sheet, {kRight, 288}, fmt::format("page {}", page_ + 1),
            {.size = 2.4, .anchor = CairoSheet::Anchor::end, .colour = kGrey});
    }
    /// Begins a new page when `height` does not fit.
    void need(CairoSheet& sheet, double height) {
        if (y_ + height <= kBottom) return;
        foot(sheet);
        ++page_;
        y_ = kTop + 4;
    }

    void draw_block(CairoSheet& sheet, const SheetBlock& block) {
        need(sheet, 26);
        put(sheet, {kLeft, y_ + 3}, block.heading, {.size = 3.8, .bold = true});
        y_ += 6;
        const CairoSheet::Look cell{.size = 2.9}, head{.size = 2.5, .bold = true, .colour = kGrey};
        if (block.numbered) {
            int number = 0;
            for (const auto& row : block.rows) {
                const auto lines = sheet.broken(kRight - kLeft - 7, row.front(), cell);
                need(sheet, 4.1 * static_cast<double>(lines.size()) + 1);
                put(sheet, {kLeft, y_ + 2.5}, fmt::format("{}.", ++number), cell);
                for (const std::string& line : lines) {
                    put(sheet, {kLeft + 7, y_ + 2.5}, line, cell);
                    y_ += 4.1;
                }
                y_ += 0.9;
            }
        } else if (!block.rows.empty()) {
            const std::vector<double> widths = columns(sheet, block, cell);
            draw_row(sheet, block.head, widths, head, false);
            bool shade = true;
            for (const auto& row : block.rows) {
                draw_row(sheet, row, widths, cell, shade);
                shade = !shade;
            }
        }
        if (!block.note.empty())
            for (const std::string& line : sheet.broken(kRight - kLeft, block.note, {.size = 2.6})) {
                need(sheet, 4);
                put(sheet, {kLeft, y_ + 3}, line, {.size = 2.6, .colour = kGrey});
                y_ += 3.7;
            }
        y_ += 5;
    }

    /// Widths in proportion to the longest words, at least what a head needs.
    std::vector<double> columns(CairoSheet& sheet, const SheetBlock& block,
                                const CairoSheet::Look& look) const {
        std::vector<double> widths(block.head.size(), 8);
        for (std::size_t c = 0; c < widths.size(); ++c) {
            widths[c] = std::max(widths[c], sheet.text_width(block.head[c], {.size = 2.5, .bold = true}) + 3);
            for (const auto& row : block.rows)
                widths[c] = std::max(widths[c], sheet.text_width(row[c], look) + 3);
        }
        const double room = kRight - kLeft;
        double sum = 0;
        for (const double w : widths) sum += w;
        if (sum <= room) {
            // columns to be filled in by hand share what is left, else the last one takes it
            std::vector<std::size_t> blank;
            for (std::size_t c = 0; c < widths.size(); ++c)
                if (std::all_of(block.rows.begin(), block.rows.end(),
                                [c](const auto& row) { return row[c].empty(); }))
                    blank.push_back(c);
            if (blank.empty()) blank.push_back(widths.size() - 1);
            for (const std::size_t c : blank) widths[c] += (room - sum) / static_cast<double>(blank.size());
            return widths;
        }
        // too wide: the narrow columns keep their width, the wide ones share what is left
        double fixed = 0, wide = 0;
        const double fair = room / static_cast<double>(widths.size());
        for (const double w : widths) (w <= fair ? fixed : wide) += w;
        for (double& w : widths)
            if (w > fair) w *= (room - fixed) / wide;
        return widths;
    }

    void draw_row(CairoSheet& sheet, const std::vector<std::string>& cells, const std::vector<double>& widths,
                  const CairoSheet::Look& look, bool shade) {
        std::vector<std::vector<std::string>> lines;
        std::size_t most = 1;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            lines.push_back(sheet.broken(widths[c] - 2, cells[c], look));
            most = std::max(most, lines.back().size());
        }
        const double step = 1.35 * look.size, height = step * static_cast<double>(most) + 1.4;
        need(sheet, height);
        if (shade && shown())
            sheet.fill({{kLeft, y_}, {kRight, y_}, {kRight, y_ + height}, {kLeft, y_ + height}}, kShade);
        double x = kLeft + 1;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            double y = y_ + look.size + 0.5;
            for (const std::string& line : lines[c]) {
                put(sheet, {x, y}, line, look);
                y += step;
            }
            x += widths[c];
        }
        y_ += height;
    }

    std::string footer_;
    DrawPage sketch_;
    std::vector<SheetBlock> blocks_;
    int page_ = 0, wanted_ = 0;
    double y_ = 0;
};

std::string subtitle_of(const Study& study) {
    return fmt::format("machine {}, dispenser {:g} x {:g} x {:g} mm", study.machine_name,
                       study.scene.dispenser_length * 1e3, study.dispenser_width * 1e3,
                       study.scene.dispenser_depth * 1e3);
}

}  // namespace

std::vector<SheetBlock> fill_blocks(const Study& study, const HandOver& over) {
    const FillPlan& plan = over.fill;
    std::vector<SheetBlock> blocks;
    SheetBlock chambers{"Chambers",
                        {"chamber", "powder", "volume beside the plate", "level", "bulk density",
                         "mass to fill in", "top-up"},
                        {},
                        "",
                        false};
    bool measured = true;
    for (const int i : {0, 1}) {
        const ChamberPlan& c = plan.chambers[static_cast<std::size_t>(i)];
        measured = measured && c.measured;
        chambers.rows.push_back(
            {i == 0 ? "A (left)" : "B (right)", c.powder,
             fmt::format("{} ({:.4g} mm² x {})", volume_text(c.volume), c.area * 1e6,
                         mm(plan.piston_start - c.level)),
             c.level > 0 ? mm(c.level) + " below the rim" : "to the rim",
             density_text(c.bulk_density) + (c.measured ? ", measured" : ", SIMULATED: MEASURE BEFORE USE"),
             mass_text(c.mass, c.mass_tolerance), "≈ " + mass_text(c.top_up)});
    }
    chambers.note = fmt::format(
        "Left and right as seen along the plate from its first end, where its letter stands (larger y is "
        "left of a plate that runs "
        "in the spreading "
        "direction). Volumes are less the plate of {:g} mm. The tolerance of a mass is {:.3g} % for the bulk "
        "density and what the "
        "end offsets' tolerance moves of the area.{}",
        study.build.thickness * 1e3, 100 * study.build.density_tolerance,
        measured ? ""
                 : " A bulk density that is not measured is the solid density times the packing of the bed "
                   "in the simulation.");
    blocks.push_back(chambers);
    blocks.push_back({"Loading, withdrawal, levelling", {}, {}, "", true});
    for (const std::string& step : over.steps) blocks.back().rows.push_back({step});
    blocks.back().note = over.slot.text;
    SheetBlock layers{"Layers", {"quantity", "value"}, {}, "", false};
    layers.rows = {
        {"dispenser floor while filling", mm(plan.piston_start) + " below the rim"},
        {plan.one_floor() ? "rise of the floor for each layer" : "rise of the pistons for each layer",
         plan.one_floor()
             ? fmt::format("{} (platform / dispenser area {:.4g})", mm(plan.rise), plan.area_ratio)
             : fmt::format("A {}, B {} (platform / dispenser area {:.4g})", mm(plan.chambers[0].rise),
                           mm(plan.chambers[1].rise), plan.area_ratio)},
        {"the fill lasts for",
         fmt::format("{} layers; then {} are left below the rim, no less than in the simulation", plan.layers,
                     mm(plan.left_over))},
        {"lifted for each layer", mass_text(plan.dosed)},
        {"into the overflow, each layer",
         plan.overflow ? mass_text(*plan.overflow) : "not known: no spread measured it"},
        {"into the overflow, the whole fill",
         plan.overflow ? mass_text(*plan.overflow * plan.layers) : "not known: no spread measured it"},
        {"of it A : B by mass", plan.overflow_a ? fmt::format("{:.0f} : {:.0f} %", 100 * *plan.overflow_a,
                                                              100 * (1 - *plan.overflow_a))
                                                : "not known: no confirming spread"}};
    layers.note =
        "The overflow is MIXED POWDER: collect it apart, label it, never return it to either chamber.";
    blocks.push_back(layers);
    blocks.push_back({"Acceptance", {"check", "limit", "when it fails"}, {}, "", false});
    for (const Acceptance& one : over.acceptance)
        blocks.back().rows.push_back({one.check, one.limit, one.if_failed});
    if (!over.warnings.empty()) {
        blocks.push_back({"Warnings", {}, {}, "", true});
        for (const std::string& warning : over.warnings) blocks.back().rows.push_back({warning});
    }
    blocks.push_back({"Record",
                      {"measured", "A", "B"},
                      {{"bulk density, g/cm³", "", ""},
                       {"mass filled in", "", ""},
                       {"mass topped up", "", ""},
                       {"lot", "", ""},
                       {"date, name", "", ""}},
                      "",
                      false});
    return blocks;
}

std::string fill_html(const Study& study, const HandOver& over) {
    std::string out = fmt::format(
        R"(<!doctype html>
<!-- {0} -->
<html lang="en"><head><meta charset="utf-8"><title>{1}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body{{font:15px/1.45 "Liberation Sans",Arial,Helvetica,sans-serif;color:#111;max-width:60em;margin:1.5em auto;padding:0 1em}}
.mark{{font-weight:bold;font-size:1.15em;padding:.4em .7em;border:2px solid currentColor}}
.doubt{{color:#b00000}}
table{{border-collapse:collapse;width:100%}}
th{{text-align:left;font-size:.85em;color:#555}}
td,th{{padding:.3em .5em;vertical-align:top;border-bottom:1px solid #ddd}}
.record td{{height:1.6em;border:1px solid #999}}
.note{{color:#555;font-size:.9em}}
h2{{font-size:1.1em;margin:1.4em 0 .3em}}
@media print{{body{{font-size:11px;margin:0}}h2{{break-after:avoid}}tr,li{{break-inside:avoid}}}}
</style></head><body>
<p class="mark{2}">{0}</p>
<h1>{1}</h1>
<p class="note">{3}</p>
)",
        escaped(over.first_line), escaped(title_of(study, over)), over.mark.empty() ? "" : " doubt",
        escaped(subtitle_of(study)));
    const std::string sketch = svg_of(120, Pages::kSketch + 6, [&](CairoSheet& sheet) {
        draw_fill_sketch(sheet, study, over, {2, 2, 118, Pages::kSketch + 4});
    });
    out += sketch.substr(sketch.find("<svg"));
    for (const SheetBlock& block : fill_blocks(study, over)) {
        out += fmt::format("<h2>{}</h2>\n", escaped(block.heading));
        if (block.numbered) {
            out += "<ol>\n";
            for (const auto& row : block.rows) out += fmt::format("<li>{}</li>\n", escaped(row.front()));
            out += "</ol>\n";
        } else {
            out += fmt::format("<table{}><tr>", block.heading == "Record" ? " class=\"record\"" : "");
            for (const std::string& word : block.head) out += fmt::format("<th>{}</th>", escaped(word));
            out += "</tr>\n";
            for (const auto& row : block.rows) {
                out += "<tr>";
                for (const std::string& word : row) out += fmt::format("<td>{}</td>", escaped(word));
                out += "</tr>\n";
            }
            out += "</table>\n";
        }
        if (!block.note.empty()) out += fmt::format("<p class=\"note\">{}</p>\n", escaped(block.note));
    }
    return out + "</body></html>\n";
}

std::string fill_pdf(const Study& study, const HandOver& over) {
    Pages pages(fmt::format("{}, {}", over.id, study.name), [&](CairoSheet& sheet) {
        draw_fill_sketch(
            sheet, study, over,
            {Pages::kLeft, Pages::kSketchTop, Pages::kRight, Pages::kSketchTop + Pages::kSketch});
    });
    for (const SheetBlock& block : fill_blocks(study, over)) pages.add(block);
    int count = 1;
    const auto draw = [&](CairoSheet& sheet, int page) {
        count = pages.draw(sheet, page, over.first_line, !over.mark.empty(), title_of(study, over),
                           subtitle_of(study));
    };
    // once for the count; the letters' widths, and so the breaks, are a surface's own
    pdf_of(kFillWidth, kFillHeight, {[&](CairoSheet& sheet) { draw(sheet, 0); }}, "");
    std::vector<DrawPage> drawn;
    for (int page = 0, all = count; page < all; ++page)
        drawn.push_back([&draw, page](CairoSheet& sheet) { draw(sheet, page); });
    return pdf_of(kFillWidth, kFillHeight, drawn, title_of(study, over));
}

}  // namespace gradwright
