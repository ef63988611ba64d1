#include "reports/heap_order_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/svg_figure.h"

namespace gradwright {

std::string heap_order_svg(const ScaledHeap& heap) {
    constexpr double width = 860, height = 380, left = 70, top = 50, right = 24, bottom = 60;
    SvgFigure figure(width, height, "Order of the dispenser left in the layer, strip by strip");
    double reach = 0.1;
    for (const HeapOrder& strip : heap.strips) reach = std::max(reach, 1.3 * std::fabs(strip.profile));
    const double last = 1.06 * heap.turnovers;
    Axes axes(figure, left, top, width - left - right, height - top - bottom, {0, last}, {-reach, reach});
    if (heap.law.fitted) {
        std::vector<double> n, law;
        for (int k = 1; k <= 300; ++k) {
            n.push_back(last * k / 300);
            law.push_back(heap.law.at(n.back()));
            if (std::fabs(law.back()) > reach)
                law.back() = std::numeric_limits<double>::quiet_NaN();  // a gap
        }
        axes.curve(n, law, {.colour = "#5b6b7b", .width = 1.5, .dash = "4 4"});
        figure.text(
            axes.px(heap.turnovers) - 8, height - bottom - 14,
            fmt::format("dashed: a law of turnovers, off by {:.3f}, not used", heap.law.collapse_error),
            {.anchor = "end", .size = 12, .colour = "#5b6b7b"});
    }
    const std::vector<double> whole = {0, last}, zero = {0, 0};
    axes.curve(whole, zero, {.colour = "#888", .width = 1});
    const std::vector<double> machine = {heap.turnovers, heap.turnovers}, full = {-reach, reach};
    axes.curve(machine, full, {.colour = "#0a7d4f", .width = 2, .dash = "5 4"});
    figure.text(axes.px(heap.turnovers) - 8, top + 18, "the machine", {.anchor = "end", .colour = "#0a7d4f"});
    std::vector<double> x, y;
    for (const HeapOrder& strip : heap.strips) {
        x.push_back(strip.turnovers);
        y.push_back(strip.profile);
        // neighbours stand close: to the left above and to the right below in turn
        const bool left_above = x.size() % 2 == 1;
        figure.text(axes.px(strip.turnovers) + (left_above ? -7 : 7),
                    axes.py(strip.profile) + (left_above ? -8 : 17),
                    fmt::format("{:.3g} mm x {:.2g}", 1e3 * strip.dispenser_length, strip.dosage_factor),
                    {.anchor = left_above ? "end" : "start", .size = 11});
    }
    axes.dots(x, y, 5, "#111");
    axes.frame("turnovers of the heap, N = sqrt(dispenser length / dose)", "order left in the layer (GI)",
               true);
    return figure.document();
}

}  // namespace gradwright
