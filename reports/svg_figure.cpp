#include "reports/svg_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reports/partition_drawing.h"

namespace gradwright {
namespace {

struct Colour {
    double red, green, blue;
};

template <std::size_t N>
std::string between(const std::array<Colour, N>& stops, double share) {
    if (std::isnan(share)) return "#e3e3e3";
    const double place = std::clamp(share, 0.0, 1.0) * (N - 1);
    const std::size_t k = std::min<std::size_t>(static_cast<std::size_t>(place), N - 2);
    const double f = place - static_cast<double>(k);
    const auto mix = [&](double a, double b) { return static_cast<int>(std::lround(a + f * (b - a))); };
    return fmt::format("#{:02x}{:02x}{:02x}", mix(stops[k].red, stops[k + 1].red),
                       mix(stops[k].green, stops[k + 1].green), mix(stops[k].blue, stops[k + 1].blue));
}

std::string style(const SvgFigure::Pen& pen) {
    return fmt::format(R"(stroke="{}" stroke-width="{:g}"{})", pen.colour, pen.width,
                       pen.dash.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", pen.dash));
}

/// As many decimals as the step of the ticks needs.
std::string tick_text(double value, double step) {
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
    // a step of 2.5 needs one decimal more than its magnitude says
    const double scaled = step * std::pow(10, decimals);
    const bool more = std::abs(scaled - std::round(scaled)) > 1e-6;
    return fmt::format("{:.{}f}", std::abs(value) < 1e-9 * step ? 0.0 : value, decimals + (more ? 1 : 0));
}

}  // namespace

SvgFigure::SvgFigure(double width, double height, const std::string& title)
    : width_(width), height_(height), title_(title) {
    text(width / 2, 22, title, {.anchor = "middle", .size = 15, .bold = true});
}

void SvgFigure::rect(double x, double y, double width, double height, const std::string& fill) {
    body_ += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
                         x, y, width, height, fill);
}

void SvgFigure::line(double x1, double y1, double x2, double y2, const Pen& pen) {
    body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n", x1, y1, x2,
                         y2, style(pen));
}

void SvgFigure::path(const std::string& data, const Pen& pen, const std::string& fill, double opacity) {
    body_ += fmt::format("<path d=\"{}\" {} fill=\"{}\"{} stroke-linejoin=\"round\"/>\n", data, style(pen),
                         fill, opacity < 1 ? fmt::format(" fill-opacity=\"{:g}\"", opacity) : "");
}

void SvgFigure::grain(double x, double y, double radius, bool is_a) {
    // by class: thousands of grains stay at some 45 bytes each
    body_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n",
                         is_a ? "a" : "b", x, y, radius);
}

void SvgFigure::discs(std::span<const double> x, std::span<const double> y, std::span<const double> radius,
                      const std::string& fill) {
    std::string data;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double r = radius[i];
        data += fmt::format("M{:.1f} {:.1f}a{:.1f} {:.1f} 0 1 0 {:.1f} 0a{:.1f} {:.1f} 0 1 0 {:.1f} 0",
                            x[i] - r, y[i], r, r, 2 * r, r, r, -2 * r);
    }
    if (!data.empty())
        body_ +=
            fmt::format("<path d=\"{}\" fill=\"{}\" stroke=\"#fff\" stroke-width=\".3\"/>\n", data, fill);
}

void SvgFigure::arrow(double x, double y, double dx, double dy, const Pen& pen) {
    const double length = std::hypot(dx, dy);
    if (!(length > 0.8)) {  // too short for a head: a dot says "at rest"
        body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"/>\n", x, y,
                             pen.width, pen.colour);
        return;
    }
    const double ux = dx / length, uy = dy / length, head = std::min(6.0, 0.55 * length), half = 0.42 * head;
    const double tx = x + dx, ty = y + dy, bx = tx - head * ux, by = ty - head * uy;
    body_ += fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" {} fill=\"none\"/>\n"
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}z\" fill=\"{}\"/>\n",
        x, y, bx, by, style(pen), tx, ty, bx - half * uy, by + half * ux, bx + half * uy, by - half * ux,
        pen.colour);
}

void SvgFigure::text(double x, double y, const std::string& words, const Words& look) {
    body_ += fmt::format(
        "<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\" font-size=\"{:g}\" fill=\"{}\"{}{}>{}</text>\n",
        x, y, look.anchor, look.size, look.colour, look.bold ? " font-weight=\"bold\"" : "",
        look.turn_deg != 0 ? fmt::format(" transform=\"rotate({:g} {:.2f} {:.2f})\"", look.turn_deg, x, y)
                           : "",
        escaped(words));
}

void SvgFigure::colour_bar(double x, double y, double length, bool vertical, double low, double high,
                           std::string (*colour)(double), const std::string& label) {
    constexpr int kSteps = 64;
    constexpr double kThick = 12;
    for (int i = 0; i < kSteps; ++i) {
        const double share = (i + 0.5) / kSteps, step = length / kSteps;
        // a hair of overlap, or seams show
        if (vertical)
            rect(x, y + length - (i + 1) * step, kThick, step + 0.5, colour(share));
        else
            rect(x + i * step, y, step + 0.5, kThick, colour(share));
    }
    const std::vector<double> marks = ticks(low, high, 5);
    const double step = marks.size() > 1 ? marks[1] - marks[0] : high - low;
    for (const double mark : marks) {
        const double at = (mark - low) / (high - low) * length;
        if (vertical) {
            line(x + kThick, y + length - at, x + kThick + 4, y + length - at, {.width = 0.8});
            text(x + kThick + 7, y + length - at + 4, tick_text(mark, step), {.size = 11});
        } else {
            line(x + at, y + kThick, x + at, y + kThick + 4, {.width = 0.8});
            text(x + at, y + kThick + 15, tick_text(mark, step), {.anchor = "middle", .size = 11});
        }
    }
    if (vertical)
        text(x + kThick + 42, y + length / 2, label, {.anchor = "middle", .size = 12, .turn_deg = -90});
    else
        text(x + length / 2, y - 5, label, {.anchor = "middle", .size = 12});
}

std::string SvgFigure::document() const {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} "
        "{1:g}\" "
        "role=\"img\" font-family=\"Liberation Sans,Arial,Helvetica,sans-serif\">\n<title>{2}</title>\n"
        "<style>.a{{fill:{4}}}.b{{fill:{5}}}.a,.b{{stroke:#fff;stroke-width:.3}}</style>\n"
        "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#fff\"/>\n{3}</svg>\n",
        width_, height_, escaped(title_), body_, kColourA, kColourB);
}

Axes::Axes(SvgFigure& figure, double left, double top, double width, double height, Range x, Range y)
    : figure_(figure), left_(left), top_(top), width_(width), height_(height), x_(x), y_(y) {}

void Axes::frame(const std::string& x_label, const std::string& y_label, bool grid) {
    const SvgFigure::Pen thin{.colour = "#222", .width = 0.9}, faint{.colour = "#ddd", .width = 0.7};
    const auto marks = [](const Range& range, double length, double room) {
        return ticks(range.low, range.high, std::clamp(static_cast<int>(length / room), 2, 8));
    };
    const std::vector<double> along = marks(x_, width_, 60), up = marks(y_, height_, 34);
    const auto step = [](const std::vector<double>& values, const Range& range) {
        return values.size() > 1 ? values[1] - values[0] : range.high - range.low;
    };
    for (const double x : along) {
        if (grid) figure_.line(px(x), top_, px(x), top_ + height_, faint);
        figure_.line(px(x), top_ + height_, px(x), top_ + height_ + 4, thin);
        figure_.text(px(x), top_ + height_ + 17, tick_text(x, step(along, x_)),
                     {.anchor = "middle", .size = 12});
    }
    for (const double y : up) {
        if (grid) figure_.line(left_, py(y), left_ + width_, py(y), faint);
        figure_.line(left_ - 4, py(y), left_, py(y), thin);
        figure_.text(left_ - 7, py(y) + 4, tick_text(y, step(up, y_)), {.anchor = "end", .size = 12});
    }
    figure_.path(fmt::format("M{:.2f} {:.2f}h{:.2f}v{:.2f}h{:.2f}z", left_, top_, width_, height_, -width_),
                 thin);
    figure_.text(left_ + width_ / 2, top_ + height_ + 36, x_label, {.anchor = "middle"});
    if (!y_label.empty())
        figure_.text(left_ - 44, top_ + height_ / 2, y_label, {.anchor = "middle", .turn_deg = -90});
}

void Axes::curve(std::span<const double> x, std::span<const double> y, const SvgFigure::Pen& pen) {
    std::string data;
    bool drawing = false;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (std::isnan(y[i])) {
            drawing = false;
            continue;
        }
        data += fmt::format("{}{:.2f} {:.2f}", drawing ? "L" : "M", px(x[i]), py(y[i]));
        drawing = true;
    }
    if (!data.empty()) figure_.path(data, pen);
}

void Axes::band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                const std::string& fill, double opacity) {
    for (std::size_t from = 0; from < x.size();) {
        std::size_t to = from;
        while (to < x.size() && !std::isnan(low[to]) && !std::isnan(high[to])) ++to;
        if (to - from >= 2) {
            std::string data;
            for (std::size_t i = from; i < to; ++i)
                data += fmt::format("{}{:.2f} {:.2f}", i == from ? "M" : "L", px(x[i]), py(high[i]));
            for (std::size_t i = to; i-- > from;) data += fmt::format("L{:.2f} {:.2f}", px(x[i]), py(low[i]));
            figure_.path(data + "z", {.colour = "none", .width = 0}, fill, opacity);
        }
        from = to + 1;
    }
}

void Axes::dots(std::span<const double> x, std::span<const double> y, double radius,
                const std::string& fill) {
    std::vector<double> at_x, at_y, size;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (std::isnan(y[i])) continue;
        at_x.push_back(px(x[i]));
        at_y.push_back(py(y[i]));
        size.push_back(radius);
    }
    figure_.discs(at_x, at_y, size, fill);
}

void Axes::bars(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                const SvgFigure::Pen& pen) {
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!std::isnan(low[i]) && !std::isnan(high[i]))
            figure_.line(px(x[i]), py(low[i]), px(x[i]), py(high[i]), pen);
}

std::vector<double> ticks(double low, double high, int most) {
    const double rough = (high - low) / std::max(1, most);
    const double magnitude = std::pow(10, std::floor(std::log10(rough)));
    double step = 10 * magnitude;
    for (const double nice : {1.0, 2.0, 2.5, 5.0})
        if (nice * magnitude >= rough * (1 - 1e-9)) {
            step = nice * magnitude;
            break;
        }
    std::vector<double> marks;
    for (long k = static_cast<long>(std::ceil(low / step - 1e-6)); k * step <= high + 1e-6 * step; ++k)
        marks.push_back(static_cast<double>(k) * step);
    return marks;
}

std::string gi_colour(double gi) {
    static constexpr std::array<Colour, 3> kStops = {{{230, 159, 0}, {246, 241, 228}, {0, 114, 178}}};
    return between(kStops, gi);
}

std::string sequence_colour(double share) {
    // viridis (S. van der Walt, N. Smith, 2015) at nine equal steps
    static constexpr std::array<Colour, 9> kStops = {{{68, 1, 84},
                                                      {71, 44, 122},
                                                      {59, 81, 139},
                                                      {44, 113, 142},
                                                      {33, 144, 141},
                                                      {39, 173, 129},
                                                      {92, 200, 99},
                                                      {170, 220, 50},
                                                      {253, 231, 37}}};
    return between(kStops, share);
}

std::string sign_colour(double share) {
    // RdBu of ColorBrewer (C. Brewer), five steps
    static constexpr std::array<Colour, 5> kStops = {
        {{202, 0, 32}, {244, 165, 130}, {247, 247, 247}, {146, 197, 222}, {5, 113, 176}}};
    return between(kStops, share);
}

}  // namespace gradwright
