// A gradation over x and y: bilinear on a rectangular grid. Whoever asks for one y is answered with the mean
// over a range of x, which of a bilinear function is piecewise linear in y again: the mean commutes with the
// interpolation, so a field's profile is a table and is integrated as one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include "targets/field_support.h"
#include "targets/table_support.h"

namespace gradwright {
namespace {

using namespace tables;

/// One line of the file.
struct FieldPoint {
    double x = 0, y = 0, gi = 0, weight = 1;
    int line = 0;
};

/// Columns by number; -1 = none.
struct Columns {
    int x = 0, y = 1, gi = 2, weight = -1;
    double x_unit = 1, y_unit = 1;
    int needed() const { return std::max({x, y, gi, weight}) + 1; }
};

/// False when the header does not name what is needed.
bool name_columns(const std::vector<std::string>& cells, Columns& columns) {
    columns = {-1, -1, -1, -1, 1, 1};
    for (int c = 0; c < static_cast<int>(cells.size()); ++c) {
        if (cells[c] == "gi") columns.gi = c;
        if (cells[c] == "weight") columns.weight = c;
        if (const double si = unit_of_column(cells[c], "x"); si > 0) {
            columns.x = c;
            columns.x_unit = si;
        }
        if (const double si = unit_of_column(cells[c], "y"); si > 0) {
            columns.y = c;
            columns.y_unit = si;
        }
    }
    return columns.x >= 0 && columns.y >= 0 && columns.gi >= 0;
}

/// The different numbers in rising order; what differs by less than a part in 1e9 of the whole is one.
std::vector<double> grid_lines(std::vector<double> numbers) {
    std::sort(numbers.begin(), numbers.end());
    const double near = 1e-9 * std::max(std::abs(numbers.front()), std::abs(numbers.back()));
    numbers.erase(
        std::unique(numbers.begin(), numbers.end(), [near](double a, double b) { return b - a <= near; }),
        numbers.end());
    return numbers;
}

std::size_t nearest(const std::vector<double>& lines, double at) {
    const auto above = std::lower_bound(lines.begin(), lines.end(), at);
    if (above == lines.end()) return lines.size() - 1;
    if (above == lines.begin() || *above - at <= at - *(above - 1)) return above - lines.begin();
    return above - lines.begin() - 1;
}

/// Index of the grid line at or below; the first also before.
std::size_t line_below(const std::vector<double>& lines, double at) {
    const auto above = std::upper_bound(lines.begin(), lines.end(), at);
    return above == lines.begin() ? 0 : above - lines.begin() - 1;
}

/// Ends of the pieces that `edges` cut [low, high) into.
std::vector<double> cuts(double low, double high, const std::vector<double>& edges) {
    std::vector<double> at = {low, high};
    for (const double edge : edges)
        if (edge > low && edge < high) at.push_back(edge);
    std::sort(at.begin(), at.end());
    return at;
}

}  // namespace

double Target::at(double x, double y) const {
    if (!is_field()) return (*this)(y);
    std::vector<double> of_row;
    const auto columns = static_cast<std::ptrdiff_t>(field_x.size());
    for (std::size_t row = 0; row < table_y.size(); ++row) {
        const auto begin = field_gi.begin() + static_cast<std::ptrdiff_t>(row) * columns;
        of_row.push_back(interpolate(field_x, {begin, begin + columns}, x));
    }
    return interpolate(table_y, of_row, y);
}

Target Target::over_x(double x_low, double x_high) const {
    Target mean = *this;
    if (!is_field()) return mean;
    const auto columns = static_cast<std::ptrdiff_t>(field_x.size());
    for (std::size_t row = 0; row < table_y.size(); ++row) {
        const auto begin = field_gi.begin() + static_cast<std::ptrdiff_t>(row) * columns;
        const std::vector<double> gi(begin, begin + columns);
        mean.table_gi[row] = x_high > x_low ? integrate(field_x, gi, x_low, x_high) / (x_high - x_low)
                                            : interpolate(field_x, gi, x_low);
    }
    return mean;
}

double Target::weight(double x, double y) const {
    for (auto zone = zones.rbegin(); zone != zones.rend(); ++zone)
        if (x >= zone->x_low && x < zone->x_high && y >= zone->y_low && y < zone->y_high) return zone->weight;
    if (field_weight.empty()) return 1;
    return field_weight[line_below(table_y, y) * field_x.size() + line_below(field_x, x)];
}

Target::Weight Target::weight_over(double x_low, double x_high, double y_low, double y_high) const {
    std::vector<double> x_edges, y_edges;
    if (!field_weight.empty()) {
        x_edges = field_x;
        y_edges = table_y;
    }
    for (const TargetZone& zone : zones) {
        x_edges.insert(x_edges.end(), {zone.x_low, zone.x_high});
        y_edges.insert(y_edges.end(), {zone.y_low, zone.y_high});
    }
    const std::vector<double> xs = cuts(x_low, x_high, x_edges), ys = cuts(y_low, y_high, y_edges);
    Weight result{0, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i + 1 < xs.size(); ++i)
        for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
            const double w = weight(0.5 * (xs[i] + xs[i + 1]), 0.5 * (ys[j] + ys[j + 1]));
            result.mean += w * (xs[i + 1] - xs[i]) * (ys[j + 1] - ys[j]);
            result.least = std::min(result.least, w);
        }
    result.mean /= (x_high - x_low) * (y_high - y_low);
    return result;
}

std::string field_text(const Target& field) {
    if (field.field_x.empty() || field.table_y.empty()) return "field without points";
    const auto [low, high] = field.gi_range();
    return fmt::format(
        "field of {} x {} points{}, x = {:g} to {:g} mm, y = {:g} to {:g} mm, GI {:g} to {:g}{}",
        field.field_x.size(), field.table_y.size(),
        field.table_file.empty() ? std::string() : fmt::format(" from {}", field.table_file),
        field.field_x.front() * 1e3, field.field_x.back() * 1e3, field.table_y.front() * 1e3,
        field.table_y.back() * 1e3, low, high, field.field_weight.empty() ? "" : ", with weights of its own");
}

std::vector<std::string> field_problems(const Target& field) {
    std::vector<std::string> found;
    const std::size_t points = field.field_x.size() * field.table_y.size();
    if (field.field_x.size() < 2 || field.table_y.size() < 2)
        found.push_back(fmt::format("field has {} x and {} y, at least 2 of each are needed",
                                    field.field_x.size(), field.table_y.size()));
    if (field.field_gi.size() != points || field.table_gi.size() != field.table_y.size() ||
        (!field.field_weight.empty() && field.field_weight.size() != points))
        found.push_back("field must have one gi, and one weight or none, for every x and y of its grid");
    for (const std::vector<double>* lines : {&field.field_x, &field.table_y})
        for (std::size_t k = 0; k < lines->size(); ++k)
            if (!std::isfinite((*lines)[k]) || (k > 0 && !((*lines)[k] > (*lines)[k - 1])))
                found.push_back(
                    fmt::format("field {}, line {}, = {:g} mm must be finite and greater than the "
                                "one before",
                                lines == &field.field_x ? "x" : "y", k + 1, (*lines)[k] * 1e3));
    for (const double gi : field.field_gi)
        if (!(gi >= 0 && gi <= 1)) found.push_back(fmt::format("field gi = {:g} must lie in 0 .. 1", gi));
    for (const double weight : field.field_weight)
        if (!(weight >= 0) || !std::isfinite(weight))
            found.push_back(fmt::format("field weight = {:g} must be >= 0 (0 = don't care)", weight));
    return found;
}

Target field_target(const std::string& csv_file) {
    std::ifstream in(csv_file);
    if (!in)
        throw std::runtime_error(
            fmt::format("{}: cannot be opened: give the path of a CSV file x, y, gi", csv_file));
    Target target;
    target.shape = TargetShape::field;
    target.table_file = csv_file;
    Columns columns;
    std::vector<FieldPoint> points;
    std::string line, wrong;
    const auto fault = [&](int number, const std::string& rule) {
        wrong += fmt::format("{}{}:{}: {}", wrong.empty() ? "" : "\n", csv_file, number, rule);
    };
    bool first = true;
    for (int number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xef\xbb\xbf"))
            line.erase(0, 3);  // byte order mark of spreadsheets
        const std::string text = trimmed(line);
        if (text.empty() || text.front() == '#') continue;
        const std::vector<std::string> cells = cells_of(line);
        FieldPoint point;
        point.line = number;
        const bool was_first = std::exchange(first, false);
        if (was_first && !cells.empty() && !to_number(cells[0], point.x)) {
            if (name_columns(cells, columns)) continue;
            fault(number,
                  fmt::format("header '{}' must name the columns x_m, x_mm or x_um, y_m, y_mm or y_um, "
                              "and gi; weight is free",
                              text));
            break;  // without the columns every line below would be a fault of its own
        }
        // Without a header the first line says whether there is a fourth column.
        if (was_first && cells.size() > 3) columns.weight = 3;
        if (static_cast<int>(cells.size()) < columns.needed()) {
            fault(number, fmt::format("'{}' has {} column(s), {} are needed: x, y, gi{}", text, cells.size(),
                                      columns.needed(), columns.weight >= 0 ? ", weight" : ""));
            continue;
        }
        if (!to_number(cells[columns.x], point.x) || !to_number(cells[columns.y], point.y) ||
            !to_number(cells[columns.gi], point.gi)) {
            fault(number, fmt::format("'{}': x, y and gi must be finite numbers with a decimal point", text));
            continue;
        }
        if (columns.weight >= 0 && (!to_number(cells[columns.weight], point.weight) || point.weight < 0 ||
                                    point.weight > kLargestWeight))
            fault(number, fmt::format("weight = '{}' must be a number in 0 .. {:g}, 0 for don't care",
                                      cells[columns.weight], kLargestWeight));
        if (point.gi < 0 || point.gi > 1)
            fault(number, fmt::format("gi = {:g} must lie in 0 .. 1", point.gi));
        point.x *= columns.x_unit;
        point.y *= columns.y_unit;
        points.push_back(point);
    }
    if (!wrong.empty()) throw std::runtime_error(wrong);
    if (points.empty()) throw std::runtime_error(fmt::format("{}: no data line", csv_file));

    std::vector<double> xs, ys;
    for (const FieldPoint& point : points) {
        xs.push_back(point.x);
        ys.push_back(point.y);
    }
    target.field_x = grid_lines(xs);
    target.table_y = grid_lines(ys);
    const std::size_t width = target.field_x.size(), all = width * target.table_y.size();
    if (width < 2 || target.table_y.size() < 2)
        throw std::runtime_error(fmt::format("{}: {} x and {} y, at least 2 of each are needed", csv_file,
                                             width, target.table_y.size()));
    target.field_gi.assign(all, std::numeric_limits<double>::quiet_NaN());
    std::vector<double> weights(all, 1);
    std::vector<int> line_of(all, 0);
    for (const FieldPoint& point : points) {
        const std::size_t at = nearest(target.table_y, point.y) * width + nearest(target.field_x, point.x);
        if (line_of[at] > 0)
            fault(point.line, fmt::format("x = {:g} mm, y = {:g} mm stands in line {} already", point.x * 1e3,
                                          point.y * 1e3, line_of[at]));
        line_of[at] = point.line;
        target.field_gi[at] = point.gi;
        weights[at] = point.weight;
    }
    constexpr int kNamed = 5;  // a sheared table would name nearly all of them
    const auto missing = std::count(line_of.begin(), line_of.end(), 0);
    int named = 0;
    for (std::size_t at = 0; at < all && named < kNamed; ++at)
        if (line_of[at] == 0) {
            ++named;
            wrong += fmt::format(
                "{}{}: no line has x = {:g} mm, y = {:g} mm: the points must fill a "
                "rectangular grid",
                wrong.empty() ? "" : "\n", csv_file, target.field_x[at % width] * 1e3,
                target.table_y[at / width] * 1e3);
        }
    if (missing > kNamed)
        wrong += fmt::format("\n{}: {} more points are missing", csv_file, missing - kNamed);
    if (wrong.empty() && *std::max_element(weights.begin(), weights.end()) == 0)
        wrong = fmt::format("{}: every weight is 0: give at least one line a weight above 0", csv_file);
    if (!wrong.empty()) throw std::runtime_error(wrong);
    if (columns.weight >= 0) target.field_weight = weights;
    target.table_gi.assign(target.table_y.size(), 0.0);
    return target.over_x(target.field_x.front(), target.field_x.back());
}

}  // namespace gradwright
