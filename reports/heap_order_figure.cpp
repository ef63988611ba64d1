#include "reports/heap_order_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/svg_figure.h"

namespace gradwright {

std::string heap_order_svg(const ScaledHeap& heap) {
    constexpr double width = 860, height = 380, left = 70, top = 50, right = 24, bottom = 60;
    SvgFigure figure(width, height, "How the heap forgets the order of the dispenser");
    double reach = 0.1;
    for (const HeapOrder& strip : heap.strips) reach = std::max(reach, 1.3 * std::fabs(strip.profile));
    const double last = 1.06 * heap.turnovers;
    Axes axes(figure, left, top, width - left - right, height - top - bottom, {0, last}, {-reach, reach});
    if (heap.law.fitted) {
        std::vector<double> n, law, low, high;
        for (int k = 1; k <= 300; ++k) {
            const double at = last * k / 300, envelope = heap.law.envelope(at);
            if (envelope > reach) continue;
            n.push_back(at);
            law.push_back(heap.law.at(at));
            low.push_back(-envelope);
            high.push_back(envelope);
        }
        axes.band(n, low, high, "#5b6b7b", 0.18);
        axes.curve(n, law, {.colour = "#5b6b7b", .width = 2});
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
        figure.text(axes.px(strip.turnovers) + 9, axes.py(strip.profile) + 4,
                    fmt::format("{:.3g} mm x {:.2g}", 1e3 * strip.dispenser_length, strip.dosage_factor),
                    {.size = 11});
    }
    axes.dots(x, y, 5, "#111");
    axes.frame("turnovers of the heap, N = sqrt(dispenser length / dose)", "order left in the layer (GI)",
               true);
    return figure.document();
}

}  // namespace gradwright
