// What tables of targets share: a piecewise linear function, and the cells of a CSV file. Private to
// targets/.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace gradwright::tables {

/// Of a bin or a zone: beyond it the other bins might as well not be there.
inline constexpr double kLargestWeight = 1e6;

/// Piecewise linear through (y, gi), constant beyond the ends.
inline double interpolate(const std::vector<double>& y, const std::vector<double>& gi, double at) {
    if (at <= y.front()) return gi.front();
    if (at >= y.back()) return gi.back();
    const std::size_t k = std::upper_bound(y.begin(), y.end(), at) - y.begin();
    return gi[k - 1] + (gi[k] - gi[k - 1]) * (at - y[k - 1]) / (y[k] - y[k - 1]);
}

/// Integral of the same from low to high: trapezia between the knots inside, exact.
inline double integrate(const std::vector<double>& y, const std::vector<double>& gi, double low,
                        double high) {
    double sum = 0, at = low, value = interpolate(y, gi, low);
    const auto advance = [&](double to) {
        const double next = interpolate(y, gi, to);
        sum += 0.5 * (value + next) * (to - at);
        at = to;
        value = next;
    };
    for (double knot : y) {
        if (knot > low && knot < high) advance(knot);
    }
    advance(high);
    return sum;
}

/// Without blanks and quotes at the ends.
inline std::string trimmed(const std::string& text) {
    const char* blank = " \t\r\n\"";
    const std::size_t begin = text.find_first_not_of(blank);
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

/// False when the text is not one finite number with a decimal point.
inline bool to_number(const std::string& text, double& value) {
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

/// Cells of a line, trimmed: separated by commas, else semicolons, else tabs.
inline std::vector<std::string> cells_of(const std::string& line) {
    const char separator =
        line.find(',') != std::string::npos ? ',' : (line.find(';') != std::string::npos ? ';' : '\t');
    std::vector<std::string> cells;
    std::istringstream split(line);
    for (std::string cell; std::getline(split, cell, separator);) cells.push_back(trimmed(cell));
    return cells;
}

/// SI of a column's unit by its name: 1 for "y" and "y_m", 1e-3 for "y_mm", 1e-6 for "y_um"; 0 when the name
/// is none of `coordinate`.
inline double unit_of_column(const std::string& name, const std::string& coordinate) {
    if (name == coordinate || name == coordinate + "_m") return 1;
    if (name == coordinate + "_mm") return 1e-3;
    return name == coordinate + "_um" ? 1e-6 : 0;
}

}  // namespace gradwright::tables
