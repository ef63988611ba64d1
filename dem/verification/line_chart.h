// Plain line charts as SVG text, panels side by side: for pages that are looked at in a browser or on paper.
// No fonts but the reader's sans-serif, no scripts; the same data give the same bytes.
#pragma once
#include <string>
#include <vector>

namespace gradwright {

struct ChartSeries {
    enum class Look { line, dashed, points };
    std::string name;  ///< in the legend; empty = not listed
    Look look = Look::line;
    int colour = 0;  ///< 0..6: black, blue, vermilion, green, orange, sky blue, purple (Okabe & Ito)
    std::vector<double> x, y;  ///< same length; points that are not finite break the line
};

/// A word at a point of the plot.
struct ChartNote {
    std::string text;
    double x = 0, y = 0;
    bool left = false;  ///< the text ends at the point instead of beginning there
    double shift = 0;   ///< upwards [px]
};

struct Chart {
    std::string title, x_label, y_label;
    bool log_x = false, log_y = false;
    std::vector<ChartSeries> series;
    std::vector<ChartNote> notes;
    bool from_zero = false;  ///< the y axis reaches down to 0 at least
};

/// One SVG with the charts in a row, all with a legend as deep as the longest.
std::string charts_svg(const std::vector<Chart>& charts);

}  // namespace gradwright
