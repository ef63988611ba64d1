#include "reports/spread_drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/result_json.h"
#include "reports/svg_figure.h"

namespace gradwright {
namespace {

std::vector<double> in_mm(std::vector<double> metres) {
    for (double& value : metres) value *= 1e3;
    return metres;
}

/// Swatch and words of a legend entry.
void legend_line(SvgFigure& figure, double x, double y, const SvgFigure::Pen& pen, const std::string& words) {
    figure.line(x, y - 4, x + 26, y - 4, pen);
    figure.text(x + 32, y, words, {.size = 12});
}

void legend_swatch(SvgFigure& figure, double x, double y, const std::string& colour,
                   const std::string& words) {
    figure.rect(x, y - 11, 13, 13, colour);
    figure.text(x + 19, y, words, {.size = 12});
}

/// The grains that are seen from above, lowest first: in each cell of 1.5 mean radii only the highest centre
/// counts. `shift`: subtracted from x [m].
void draw_from_above(SvgFigure& figure, const Axes& axes, const Snapshot& shot,
                     std::vector<std::size_t> grains, double shift, double period, double scale) {
    double mean = 0;
    for (const std::size_t n : grains) mean += shot.radius[n] / static_cast<double>(grains.size());
    std::sort(grains.begin(), grains.end(),
              [&](std::size_t a, std::size_t b) { return shot.z[a] > shot.z[b]; });
    std::set<std::pair<long, long>> taken;
    std::vector<std::size_t> seen;
    const auto y_of = [&](std::size_t n) {
        return period > 0 ? shot.y[n] - period * std::floor(shot.y[n] / period) : double(shot.y[n]);
    };
    for (const std::size_t n : grains)
        if (taken.insert({std::lround(shot.x[n] / (1.5 * mean)), std::lround(y_of(n) / (1.5 * mean))}).second)
            seen.push_back(n);
    for (auto n = seen.rbegin(); n != seen.rend(); ++n)
        figure.grain(axes.px((shot.x[*n] - shift) * 1e3), axes.py(y_of(*n) * 1e3),
                     shot.radius[*n] * 1e3 * scale, shot.is_a[*n] != 0);
}

}  // namespace

std::string gi_map_svg(const Study& study, const GradationMap& map) {
    const double cell = map.x_m.size() > 1 ? map.x_m[1] - map.x_m[0] : 2 * map.x_m[0];
    const double length = cell * static_cast<double>(map.x_m.size()),
                 width = cell * static_cast<double>(map.y_m.size());
    const double scale = std::min(720 / length, 420 / width), left = 70, top = 44;
    SvgFigure figure(left + scale * length + 100, top + scale * width + 52,
                     fmt::format("Gradation index over the platform, {:.0f} um cells", cell * 1e6));
    Axes axes(figure, left, top, scale * length, scale * width, {0, length * 1e3}, {0, width * 1e3});
    for (std::size_t row = 0; row < map.y_m.size(); ++row)
        for (std::size_t column = 0; column < map.x_m.size(); ++column)
            figure.rect(axes.px((map.x_m[column] - cell / 2) * 1e3), axes.py((map.y_m[row] + cell / 2) * 1e3),
                        scale * cell + 0.4, scale * cell + 0.4,
                        gi_colour(map.gi[row * map.x_m.size() + column]));
    axes.frame("x, spreading direction, from the platform's near edge (mm)", "y (mm)");
    const std::string names = fmt::format("GI: 0 {}, 1 {}", study.scene.powder[1].material.name,
                                          study.scene.powder[0].material.name);
    figure.colour_bar(left + scale * length + 18, top, scale * width, true, 0, 1, gi_colour, names);
    return figure.document();
}

std::string beds_svg(const Study& study, const Evaluation& evaluation, const SpreadResult& spread) {
    const Scene& scene = study.scene;
    const double platform = scene.dispenser_length + evaluation.design.land;
    const double longest = std::max(scene.dispenser_length, scene.platform_length),
                 width = study.dispenser_width;
    const double scale = std::min(0.72 / longest, 0.36 / width), left = 70;  // [px/mm], lengths in m
    const double height = scale * width * 1e3, first = 74, second = first + height + 78;
    SvgFigure figure(left + scale * longest * 1e3 + 40, second + height + 52,
                     "Powder from above, before and after spreading");
    legend_swatch(figure, left, 48, kColourA, "A, " + scene.powder[0].material.name);
    legend_swatch(figure, left + 150, 48, kColourB, "B, " + scene.powder[1].material.name);
    for (const bool after : {false, true}) {
        const Snapshot& shot = after ? spread.snapshots.back() : spread.snapshots.front();
        const double from = after ? platform : 0,
                     length = after ? scene.platform_length : scene.dispenser_length;
        std::vector<std::size_t> grains;
        for (std::size_t n = 0; n < shot.x.size(); ++n)
            if (shot.x[n] >= from && shot.x[n] < from + length && (!after || shot.z[n] < 0))
                grains.push_back(n);
        Axes axes(figure, left, after ? second : first, scale * length * 1e3, height, {0, length * 1e3},
                  {0, width * 1e3});
        draw_from_above(figure, axes, shot, grains, from, scene.sides == Sides::periodic ? width : 0, scale);
        axes.frame(after ? "platform: x from its near edge (mm)"
                         : "dispenser, levelled and raised: x from its rear wall (mm)",
                   "y (mm)");
    }
    return figure.document();
}

std::string gi_line_svg(const Study& study, const Evaluation& evaluation, const SpreadFigures& figures) {
    const double left = 66, top = 44, width = 620, height = 340;
    SvgFigure figure(left + width + 30, top + height + 126, "Gradation index across the layer");
    const double y_end = study.dispenser_width * 1e3;
    Axes axes(figure, left, top, width, height, {0, y_end}, {-0.05, 1.05});
    axes.frame("y (mm)", "GI by volume", true);
    const GradationProfile& bins = evaluation.profile;
    const Band band = simultaneous_band(bins.gi, bins.standard_error, bins.degrees);
    std::vector<double> step_y, step_low, step_high, step_gi;
    const double half_bin = study.bins.width / 2;
    for (std::size_t b = 0; b < bins.gi.size(); ++b)
        for (const double side : {-1.0, 1.0}) {
            step_y.push_back((bins.y_m[b] + side * half_bin) * 1e3);
            step_gi.push_back(bins.gi[b]);
            step_low.push_back(band.low[b]);
            step_high.push_back(band.high[b]);
        }
    axes.band(step_y, step_low, step_high, kColourA, 0.15);
    axes.curve(step_y, step_gi, {.colour = kColourA, .width = 1.4});
    const std::vector<double> y = in_mm(figures.fine.y_m);
    std::vector<double> low, high;
    for (std::size_t b = 0; b < y.size(); ++b) {
        low.push_back(figures.fine.gi[b] - figures.fine.standard_error[b]);
        high.push_back(figures.fine.gi[b] + figures.fine.standard_error[b]);
    }
    axes.bars(y, low, high, {.colour = "#444", .width = 1});
    axes.dots(y, figures.fine.gi, 3.2, "#444");
    const bool rises = figures.unmixed_slope > 0;
    const std::vector<double> unmixed_y = {0, figures.y_low * 1e3, figures.y_high * 1e3, y_end};
    const std::vector<double> unmixed =
        rises ? std::vector<double>{0, 0, 1, 1} : std::vector<double>{1, 1, 0, 0};
    const bool sloped = std::isfinite(figures.unmixed_slope);
    if (sloped) axes.curve(unmixed_y, unmixed, {.colour = "#777", .width = 1.4, .dash = "6 4"});
    double at = top + height + 60;
    if (!figures.fits.empty()) {
        const LinearFit& line = figures.fits.front().line;
        const std::vector<double> ends = {figures.y_low, figures.y_high};
        const std::vector<double> values = {line.intercept + line.slope * ends[0],
                                            line.intercept + line.slope * ends[1]};
        axes.curve(in_mm(ends), values, {.colour = "#d55e00", .width = 2.4});
        legend_line(figure, left, at, {.colour = "#d55e00", .width = 2.4},
                    fmt::format("straight line over the partition's extent: {:.2f} per mm, R\u00b2 = {:.3f}",
                                line.slope * 1e-3, line.r_squared));
        at += 19;
    }
    if (sloped)
        legend_line(figure, left, at, {.colour = "#777", .width = 1.4, .dash = "6 4"},
                    fmt::format("the partition, mixed along x and not at all across: {:.2f} per mm",
                                figures.unmixed_slope * 1e-3));
    legend_line(figure, left, at + 19, {.colour = kColourA, .width = 1.4},
                fmt::format("bins of {:.0f} um, simultaneous 95 % band", study.bins.width * 1e6));
    figure.discs(std::vector<double>{left + 13}, std::vector<double>{at + 34}, std::vector<double>{3.2},
                 "#444");
    const double fine = figures.fine.y_m.size() > 1 ? figures.fine.y_m[1] - figures.fine.y_m[0] : 0;
    figure.text(left + 32, at + 38, fmt::format("bins of {:.0f} um, one standard error", fine * 1e6),
                {.size = 12});
    return figure.document();
}

std::string heap_velocity_svg(const SpreadFigures& figures) {
    const HeapField& field = figures.field;
    const double x_end = field.cell * field.columns * 1e3, z_low = field.z_low * 1e3,
                 z_high = (field.z_low + field.cell * field.rows) * 1e3;
    const double blade = 0.06 * x_end;  // how much of the blade is drawn [mm]
    const double scale = std::min(640 / (x_end + blade), 300 / (z_high - z_low));
    const double left = 70, width = scale * (x_end + blade), height = scale * (z_high - z_low);
    const double top = 60, second = top + height + 88;
    SvgFigure figure(
        left + width + 100, second + height + 96,
        fmt::format("Powder ahead of the blade, mean of {} instants over the platform", field.instants));
    const double speed = figures.blade_speed;
    double rise = 0;
    for (const double vz : field.vz)
        if (std::isfinite(vz)) rise = std::max(rise, std::abs(vz));
    for (const bool seen_from_blade : {false, true}) {
        const double panel = seen_from_blade ? second : top;
        Axes axes(figure, left, panel, width, height, {-blade, x_end}, {z_low, z_high});
        const double side = scale * field.cell * 1e3;
        for (int k = 0; k < field.rows; ++k)
            for (int i = 0; i < field.columns; ++i) {
                const std::size_t at = field.at(i, k);
                if (std::isnan(field.vx[at])) continue;
                const double share = seen_from_blade ? 0.5 + 0.5 * field.vz[at] / rise
                                                     : std::hypot(field.vx[at], field.vz[at]) / speed;
                figure.rect(axes.px(i * field.cell * 1e3), axes.py(z_low + (k + 1) * field.cell * 1e3),
                            side + 0.4, side + 0.4,
                            seen_from_blade ? sign_colour(share) : sequence_colour(share));
            }
        // an arrow every other cell where cells are small; the blade's own speed is 1.5 spacings long
        const int every = side < 18 ? 2 : 1;
        const double arrow = 1.5 * every * side / speed;
        for (int k = 0; k < field.rows; k += every)
            for (int i = 0; i < field.columns; i += every) {
                const std::size_t at = field.at(i, k);
                if (std::isnan(field.vx[at])) continue;
                const double vx = field.vx[at] - (seen_from_blade ? speed : 0);
                figure.arrow(axes.px(field.x(i) * 1e3), axes.py(field.z(k) * 1e3), arrow * vx,
                             -arrow * field.vz[at],
                             {.colour = seen_from_blade ? "#111" : "#fff", .width = 1.3});
            }
        const double edge = axes.py(0), roof = axes.py(z_high);
        figure.rect(axes.px(-blade), roof, axes.px(0) - axes.px(-blade), edge - roof, "#8a8a8a");
        figure.line(axes.px(0), roof, axes.px(0), edge, {.colour = "#333", .width = 2});
        figure.text(axes.px(-blade / 2) + 4, (edge + roof) / 2, "blade",
                    {.anchor = "middle", .size = 12, .colour = "#fff", .turn_deg = -90});
        axes.frame("x ahead of the blade (mm)", "z (mm)");
        figure.text(left, panel - 8,
                    seen_from_blade ? "Seen from the blade: colour = rise (blue) and fall (red)"
                                    : "As it stands: colour = speed / blade speed",
                    {.size = 13});
        if (seen_from_blade)
            figure.colour_bar(left + width + 18, panel, height, true, -rise * 1e3, rise * 1e3, sign_colour,
                              "rise (mm/s)");
        else
            figure.colour_bar(left + width + 18, panel, height, true, 0, 1, sequence_colour,
                              "speed / blade speed");
    }
    const HeapRotation& turn = figures.rotation;
    if (turn.area > 0) {
        figure.text(
            left, second + height + 64,
            fmt::format(
                "Circulation {:.3g} mm\u00b2/s over {:.3f} mm\u00b2; mean vorticity {:.0f} \u00b1 {:.0f} 1/s "
                "between instants",
                turn.circulation * 1e6, turn.area * 1e6, turn.vorticity, turn.deviation),
            {.size = 12});
        figure.text(left, second + height + 82,
                    fmt::format("({}): one turn of the mean rotation in {:.2f} mm of the blade's way.",
                                turn.vorticity < 0 ? "clockwise, rolls forward" : "anticlockwise",
                                turn.turn_length(speed) * 1e3),
                    {.size = 12});
    }
    return figure.document();
}

std::string heap_mixing_svg(const Study& study, const Evaluation& evaluation, const SpreadResult& spread,
                            const SpreadFigures& figures) {
    const HeapMixingOptions& options = figures.mixing_options;
    double x_end = 0;
    for (const std::size_t k : figures.shown) {
        const Snapshot& shot = spread.snapshots[k];
        std::vector<double> ahead;
        for (const std::size_t n : heap_grains(shot, options.least_speed))
            ahead.push_back(shot.x[n] - shot.blade_x);
        if (ahead.empty()) continue;
        // 99 %: a grain that rolls far ahead must not shrink the picture
        const auto rank =
            ahead.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(ahead.size() - 1));
        std::nth_element(ahead.begin(), rank, ahead.end());
        x_end = std::max(x_end, *rank);
    }
    x_end = std::max(x_end * 1.05, 0.2e-3) * 1e3;
    const double y_end = options.width * 1e3, gap = 26, left = 70, top = 74;
    const double count = static_cast<double>(std::max<std::size_t>(1, figures.shown.size()));
    const double scale = std::min((860 - gap * (count - 1)) / (count * x_end), 330 / y_end);
    const double width = scale * x_end, height = scale * y_end, full = 860;
    const double charts = top + height + 88, chart = 230;
    SvgFigure figure(left + full + 40, charts + chart + 92,
                     "Mixing in the powder that moves ahead of the blade");
    const double platform = study.scene.dispenser_length + evaluation.design.land;
    legend_swatch(figure, left, 48, kColourA, "A, " + study.scene.powder[0].material.name);
    legend_swatch(figure, left + 150, 48, kColourB, "B, " + study.scene.powder[1].material.name);
    for (std::size_t p = 0; p < figures.shown.size(); ++p) {
        const Snapshot& shot = spread.snapshots[figures.shown[p]];
        const double at = left + static_cast<double>(p) * (width + gap);
        Axes axes(figure, at, top, width, height, {0, x_end}, {0, y_end});
        std::vector<std::size_t> inside = heap_grains(shot, options.least_speed);
        std::erase_if(inside, [&](std::size_t n) { return (shot.x[n] - shot.blade_x) * 1e3 > x_end; });
        draw_from_above(figure, axes, shot, inside, shot.blade_x, options.periodic ? options.width : 0,
                        scale);
        axes.frame("ahead of the blade (mm)", p == 0 ? "y (mm)" : "");
        const double from_edge = (shot.blade_x - platform) * 1e3;
        figure.text(at + width / 2, top - 7,
                    shot.blade_x < study.scene.dispenser_length
                        ? fmt::format("blade {:.1f} mm into dispenser", shot.blade_x * 1e3)
                    : from_edge < 0 ? fmt::format("blade on the land, {:.1f} mm to go", -from_edge)
                                    : fmt::format("blade {:.1f} mm into platform", from_edge),
                    {.anchor = "middle", .size = 12});
    }
    // mixing over the way
    const double half = (full - 90) / 2;
    std::vector<double> way, lacey, slices;
    for (const HeapMixing& row : figures.mixing) {
        way.push_back(row.blade_x * 1e3);
        lacey.push_back(row.lacey);
        slices.push_back(row.lacey_in_slices);
    }
    const double end = (platform + study.scene.platform_length) * 1e3;
    double roof = 1.05;
    for (const double value : slices)
        if (std::isfinite(value)) roof = std::max(roof, value * 1.03);
    Axes over(figure, left, charts, half, chart, {0, end}, {0, roof});
    for (const double mark : {study.scene.dispenser_length, platform})
        figure.line(over.px(mark * 1e3), charts, over.px(mark * 1e3), charts + chart,
                    {.colour = "#999", .width = 1, .dash = "3 3"});
    over.frame("blade (mm from the dispenser's rear wall)", "Lacey index", true);
    over.curve(way, slices, {.colour = "#117733", .width = 2});
    over.curve(way, lacey, {.colour = "#882255", .width = 2});
    legend_line(figure, left, charts + chart + 62, {.colour = "#117733", .width = 2},
                "within slices of equal y: mixing along x and z");
    legend_line(figure, left, charts + chart + 81, {.colour = "#882255", .width = 2},
                "over all cells: A and B across the whole heap");
    // GI across the heap
    const double right = left + half + 90;
    Axes across(figure, right, charts, half, chart, {0, y_end}, {-0.03, 1.03});
    across.frame("y (mm)", "GI of the heap", true);
    static constexpr const char* kShades[] = {"#bbbbbb", "#88aacc", "#4477aa", "#223355"};
    for (std::size_t p = 0; p < figures.shown_mixing.size(); ++p) {
        const HeapMixing& row = figures.shown_mixing[p];
        across.curve(in_mm(row.y_m), row.slice_gi, {.colour = kShades[p % 4], .width = 2.2});
        legend_line(figure, right + (p % 2 ? half / 2 : 0), charts + chart + 62 + (p / 2 ? 19 : 0),
                    {.colour = kShades[p % 4], .width = 2.2},
                    fmt::format("blade at {:.2f} mm", row.blade_x * 1e3));
    }
    return figure.document();
}

std::string composition_svg(const SpreadFigures& figures) {
    const Composition& powder = *figures.powder;
    const double left = 66, top = 44, width = 620, height = 340;
    SvgFigure figure(left + width + 30, top + height + 104,
                     "Composition across the layer, from nominal alloys");
    const std::vector<double> y = in_mm(powder.y_m);
    const double step = y.size() > 1 ? y[1] - y[0] : 1;
    double highest = 0;
    for (const char* element : {"Fe", "Ni"})
        for (const double value : powder.wt(element).high)
            if (std::isfinite(value)) highest = std::max(highest, value);
    Axes axes(figure, left, top, width, height, {0, y.back() + step / 2},
              {0, std::max(10.0, 1.06 * highest)});
    axes.frame("y (mm)", "wt%", true);
    double at = left;
    for (const auto& [element, colour] : {std::pair{"Fe", "#882255"}, std::pair{"Ni", "#117733"}}) {
        const BandedProfile& wt = powder.wt(element);
        axes.band(y, wt.low, wt.high, colour, 0.18);
        axes.curve(y, wt.value, {.colour = colour, .width = 2});
        legend_line(figure, at, top + height + 60, {.colour = colour, .width = 2},
                    fmt::format("{} of the powder as laid, 95 % band", element));
        if (figures.melted) {
            axes.curve(y, figures.melted->wt(element).value, {.colour = colour, .width = 2, .dash = "5 4"});
            legend_line(figure, at, top + height + 79, {.colour = colour, .width = 2, .dash = "5 4"},
                        fmt::format("{} after melting", element));
        }
        at += width / 2;
    }
    return figure.document();
}

}  // namespace gradwright
