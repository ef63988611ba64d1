#include "dem/verification/line_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradwright {
namespace {

// One panel [px].
constexpr double kWidth = 400, kPlotHeight = 250, kLeft = 66, kRight = 14, kTop = 34, kBelow = 44,
                 kLegendLine = 17;
constexpr const char* kColours[] = {"#222222", "#0072B2", "#D55E00", "#009E73",
                                    "#E69F00", "#56B4E9", "#CC79A7"};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else
            out += c;
    }
    return out;
}

/// One axis: data to pixels, ticks.
struct Axis {
    bool log = false;
    double low = 0, high = 1, from = 0, to = 1;
    std::vector<double> ticks;

    double value(double v) const { return log ? std::log10(v) : v; }
    double at(double v) const { return from + (value(v) - low) / (high - low) * (to - from); }
    bool drawable(double v) const { return std::isfinite(v) && (!log || v > 0); }
};

Axis axis_of(bool log, double least, double most, double from, double to) {
    Axis a;
    a.log = log;
    a.from = from;
    a.to = to;
    if (log) {
        const double lo = std::log10(least), hi = std::log10(most);
        const double margin = 0.04 * std::max(hi - lo, 0.1);
        a.low = lo - margin;
        a.high = hi + margin;
        const int first = static_cast<int>(std::ceil(a.low)), last = static_cast<int>(std::floor(a.high));
        if (last - first >= 2) {
            const int step = (last - first) / 7 + 1;
            for (int k = first; k <= last; k += step) a.ticks.push_back(std::pow(10.0, k));
        } else {
            for (int k = first - 1; k <= last; ++k)
                for (const double m : {1.0, 2.0, 5.0})
                    if (const double v = m * std::pow(10.0, k);
                        std::log10(v) >= a.low && std::log10(v) <= a.high)
                        a.ticks.push_back(v);
        }
        return a;
    }
    double span = most - least;
    if (!(span > 0)) span = std::max(std::fabs(most), 1.0);
    a.low = least - 0.05 * span;
    a.high = most + 0.05 * span;
    const double raw = (a.high - a.low) / 6, decade = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10 * decade;
    for (const double m : {5.0, 2.0, 1.0})
        if (m * decade >= raw) step = m * decade;
    for (double v = std::ceil(a.low / step) * step; v <= a.high; v += step)
        a.ticks.push_back(std::fabs(v) < 1e-9 * step ? 0 : v);
    return a;
}

std::string tick_text(double v) {
    const double size = std::fabs(v);
    if (v == 0) return "0";
    if (size >= 1e-3 && size < 1e5) return fmt::format("{:.6g}", v);
    const int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    const double mantissa = v / std::pow(10.0, exponent);
    return fmt::format("{:.3g}e{}", mantissa, exponent);
}

std::string panel(const Chart& chart, double shift) {
    const double infinity = std::numeric_limits<double>::infinity();
    double x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity;
    for (const ChartSeries& s : chart.series)
        for (std::size_t k = 0; k < s.x.size(); ++k) {
            if (!std::isfinite(s.x[k]) || !std::isfinite(s.y[k])) continue;
            if ((chart.log_x && !(s.x[k] > 0)) || (chart.log_y && !(s.y[k] > 0))) continue;
            x0 = std::min(x0, s.x[k]);
            x1 = std::max(x1, s.x[k]);
            y0 = std::min(y0, s.y[k]);
            y1 = std::max(y1, s.y[k]);
        }
    if (!(x0 <= x1)) x0 = y0 = chart.log_x || chart.log_y ? 0.1 : 0, x1 = y1 = 1;
    if (chart.from_zero && !chart.log_y) y0 = std::min(y0, 0.0);
    const double left = shift + kLeft, right = shift + kWidth - kRight, top = kTop,
                 bottom = kTop + kPlotHeight;
    const Axis x = axis_of(chart.log_x, x0, x1, left, right), y = axis_of(chart.log_y, y0, y1, bottom, top);

    std::string out;
    auto add = [&](const std::string& line) { out += line + "\n"; };
    add(fmt::format(R"svg(<text x="{:.1f}" y="20" class="title">{}</text>)svg", left, escaped(chart.title)));
    for (const double v : x.ticks) {
        add(fmt::format(R"svg(<line x1="{0:.1f}" y1="{1:.1f}" x2="{0:.1f}" y2="{2:.1f}" class="grid"/>)svg",
                        x.at(v), top, bottom));
        add(fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)svg", x.at(v),
                        bottom + 16, tick_text(v)));
    }
    for (const double v : y.ticks) {
        add(fmt::format(R"svg(<line x1="{1:.1f}" y1="{0:.1f}" x2="{2:.1f}" y2="{0:.1f}" class="grid"/>)svg",
                        y.at(v), left, right));
        add(fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{}</text>)svg", left - 6,
                        y.at(v) + 4, tick_text(v)));
    }
    add(fmt::format(R"svg(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" class="frame"/>)svg",
                    left, top, right - left, bottom - top));
    add(fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)svg",
                    0.5 * (left + right), bottom + 35, escaped(chart.x_label)));
    add(fmt::format(
        R"svg(<text x="{0:.1f}" y="{1:.1f}" text-anchor="middle" transform="rotate(-90 {0:.1f} {1:.1f})">{2}</text>)svg",
        shift + 14, 0.5 * (top + bottom), escaped(chart.y_label)));

    double row = bottom + kBelow + 12;
    for (const ChartSeries& s : chart.series) {
        const char* colour = kColours[s.colour % 7];
        std::string path;
        bool drawing = false;
        for (std::size_t k = 0; k < s.x.size(); ++k) {
            if (!x.drawable(s.x[k]) || !y.drawable(s.y[k])) {
                drawing = false;
                continue;
            }
            const double px = x.at(s.x[k]), py = y.at(s.y[k]);
            if (s.look == ChartSeries::Look::points)
                add(fmt::format(
                    R"svg(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="none" stroke="{}" stroke-width="1.4"/>)svg",
                    px, py, colour));
            else
                path += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", px, py);
            drawing = true;
        }
        const char* dash = s.look == ChartSeries::Look::dashed ? R"( stroke-dasharray="5 3")" : "";
        if (!path.empty())
            add(fmt::format(R"svg(<path d="{}" fill="none" stroke="{}" stroke-width="1.6"{}/>)svg", path,
                            colour, dash));
        if (s.name.empty()) continue;
        if (s.look == ChartSeries::Look::points)
            add(fmt::format(
                R"svg(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="none" stroke="{}" stroke-width="1.4"/>)svg",
                left + 12, row - 4, colour));
        else
            add(fmt::format(
                R"svg(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}" stroke-width="1.6"{}/>)svg",
                left, row - 4, left + 24, row - 4, colour, dash));
        add(fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}">{}</text>)svg", left + 32, row, escaped(s.name)));
        row += kLegendLine;
    }
    for (const ChartNote& note : chart.notes)
        if (x.drawable(note.x) && y.drawable(note.y))
            add(fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" class="note">{}</text>)svg",
                            x.at(note.x) + (note.left ? -6 : 6), y.at(note.y) + 4 - note.shift,
                            note.left ? "end" : "start", escaped(note.text)));
    return out;
}

}  // namespace

std::string charts_svg(const std::vector<Chart>& charts) {
    std::size_t lines = 0;
    for (const Chart& chart : charts) {
        std::size_t named = 0;
        for (const ChartSeries& s : chart.series) named += !s.name.empty();
        lines = std::max(lines, named);
    }
    const double width = kWidth * static_cast<double>(charts.size()),
                 height = kTop + kPlotHeight + kBelow + kLegendLine * static_cast<double>(lines) + 4;
    std::string out = fmt::format(
        R"svg(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}" viewBox="0 0 {0:.0f} {1:.0f}">
<style>text {{ font: 12px sans-serif; fill: #222222; }} .title {{ font-weight: bold; }} .note {{ fill: #555555; }}
.grid {{ stroke: #dddddd; }} .frame {{ fill: none; stroke: #555555; }}</style>
<rect width="{0:.0f}" height="{1:.0f}" fill="white"/>
)svg",
        width, height);
    for (std::size_t k = 0; k < charts.size(); ++k) out += panel(charts[k], kWidth * static_cast<double>(k));
    return out + "</svg>\n";
}

}  // namespace gradwright
