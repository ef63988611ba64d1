#include "targets/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "targets/field_support.h"
#include "targets/table_support.h"

namespace gradwright {
namespace {

using namespace tables;

/// s of the logistic 1/(1 + exp(-(y - centre)/s)): it passes 0.1 and 0.9 at centre -+ s ln 9.
double logistic_scale(double width_10_90) {
    return width_10_90 / (2 * std::log(9.0));
}

/// ln(1 + exp(t)) without overflow.
double softplus(double t) {
    return t > 0 ? t + std::log1p(std::exp(-t)) : std::log1p(std::exp(t));
}

/// "GI 0.1 up to y = 0.4 mm, 0.5 from 0.7 to 0.9 mm, 0.9 from 1.2 mm on" of the knots of plateaus.
std::string levels_text(const std::vector<double>& y, const std::vector<double>& gi) {
    std::string text;
    for (std::size_t k = 0, end = 0; k < y.size(); k = end + 1) {
        for (end = k; end + 1 < y.size() && gi[end + 1] == gi[k];) ++end;
        if (k == 0)
            text += fmt::format("GI {:g} up to y = {:g} mm", gi[k], y[end] * 1e3);
        else if (end + 1 == y.size())
            text += fmt::format(", {:g} from {:g} mm on", gi[k], y[k] * 1e3);
        else if (k == end)
            text += fmt::format(", {:g} at {:g} mm", gi[k], y[k] * 1e3);
        else
            text += fmt::format(", {:g} from {:g} to {:g} mm", gi[k], y[k] * 1e3, y[end] * 1e3);
    }
    return text + ", straight between";
}

}  // namespace

double Target::operator()(double y) const {
    switch (shape) {
        case TargetShape::linear:
            return y1 > y0 ? interpolate({y0, y1}, {gi0, gi1}, y) : interpolate({y1, y0}, {gi1, gi0}, y);
        case TargetShape::step:
            return y < y0 ? gi0 : gi1;
        case TargetShape::sigmoid:
            return gi0 + (gi1 - gi0) / (1 + std::exp(-(y - centre) / logistic_scale(width_10_90)));
        case TargetShape::table:
        case TargetShape::plateaus:
        case TargetShape::aba:
        case TargetShape::field:
            return interpolate(table_y, table_gi, y);
    }
    return gi0;
}

double Target::bin_mean(double y_low, double y_high) const {
    const double width = y_high - y_low;
    if (!(width > 0)) return (*this)(y_low);
    switch (shape) {
        case TargetShape::linear: {
            const bool rises = y1 > y0;
            return integrate({rises ? y0 : y1, rises ? y1 : y0}, {rises ? gi0 : gi1, rises ? gi1 : gi0},
                             y_low, y_high) /
                   width;
        }
        case TargetShape::step: {
            const double above = std::clamp(y_high - y0, 0.0, width) / width;
            return gi0 * (1 - above) + gi1 * above;
        }
        case TargetShape::sigmoid: {
            const double s = logistic_scale(width_10_90);
            return gi0 + (gi1 - gi0) * s / width *
                             (softplus((y_high - centre) / s) - softplus((y_low - centre) / s));
        }
        case TargetShape::table:
        case TargetShape::plateaus:
        case TargetShape::aba:
        case TargetShape::field:
            return integrate(table_y, table_gi, y_low, y_high) / width;
    }
    return gi0;
}

double Target::weight(double y) const {
    for (auto zone = zones.rbegin(); zone != zones.rend(); ++zone) {
        if (y >= zone->y_low && y < zone->y_high) return zone->weight;
    }
    return 1;
}

std::pair<double, double> Target::gi_range() const {
    if (shape == TargetShape::linear || shape == TargetShape::step || shape == TargetShape::sigmoid)
        return {std::min(gi0, gi1), std::max(gi0, gi1)};
    const std::vector<double>& all = is_field() ? field_gi : table_gi;
    if (all.empty()) return {0, 0};
    const auto [low, high] = std::minmax_element(all.begin(), all.end());
    return {*low, *high};
}

std::string Target::describe() const {
    std::string text;
    switch (shape) {
        case TargetShape::linear:
            text =
                fmt::format("linear ramp, GI {:g} at y = {:g} mm to GI {:g} at y = {:g} mm, constant beyond",
                            gi0, y0 * 1e3, gi1, y1 * 1e3);
            break;
        case TargetShape::step:
            text = fmt::format("step from GI {:g} to GI {:g} at y = {:g} mm", gi0, gi1, y0 * 1e3);
            break;
        case TargetShape::sigmoid:
            text = fmt::format("logistic from GI {:g} to GI {:g}, centre y = {:g} mm, 10-90 % width {:g} mm",
                               gi0, gi1, centre * 1e3, width_10_90 * 1e3);
            break;
        case TargetShape::table:
            text = fmt::format("table of {} points{}", table_y.size(),
                               table_file.empty() ? std::string() : fmt::format(" from {}", table_file));
            if (!table_y.empty()) {
                text += fmt::format(", y = {:g} to {:g} mm, GI {:g} to {:g}", table_y.front() * 1e3,
                                    table_y.back() * 1e3, table_gi.front(), table_gi.back());
            }
            break;
        case TargetShape::plateaus:
            text = "plateaus: " + levels_text(table_y, table_gi);
            break;
        case TargetShape::aba:
            text = (table_gi.size() > 1 && table_gi[0] < table_gi[1] ? "B-A-B: " : "A-B-A: ") +
                   levels_text(table_y, table_gi);
            break;
        case TargetShape::field:
            text = field_text(*this);
            break;
    }
    for (const TargetZone& zone : zones) {
        const bool below = std::isinf(zone.y_low), beyond = std::isinf(zone.y_high);
        if (below && beyond)
            text += "; everywhere";
        else if (below)
            text += fmt::format("; below {:g} mm", zone.y_high * 1e3);
        else if (beyond)
            text += fmt::format("; from {:g} mm on", zone.y_low * 1e3);
        else
            text += fmt::format("; {:g} to {:g} mm", zone.y_low * 1e3, zone.y_high * 1e3);
        if (std::isfinite(zone.x_low) || std::isfinite(zone.x_high))
            text += fmt::format(" where x = {:g} to {:g} mm", zone.x_low * 1e3, zone.x_high * 1e3);
        text += zone.weight == 0 ? std::string(" don't care") : fmt::format(" weight {:g}", zone.weight);
    }
    return text;
}

Target linear_target(double y0, double gi0, double y1, double gi1) {
    Target target;
    target.shape = TargetShape::linear;
    target.y0 = y0;
    target.gi0 = gi0;
    target.y1 = y1;
    target.gi1 = gi1;
    return target;
}

Target sigmoid_target(double centre, double width_10_90, double gi_low, double gi_high) {
    Target target;
    target.shape = TargetShape::sigmoid;
    target.centre = centre;
    target.width_10_90 = width_10_90;
    target.gi0 = gi_low;
    target.gi1 = gi_high;
    return target;
}

Target step_target(double y, double gi_low, double gi_high) {
    Target target;
    target.shape = TargetShape::step;
    target.y0 = y;
    target.gi0 = gi_low;
    target.gi1 = gi_high;
    return target;
}

Target plateaus_target(const std::vector<Plateau>& levels) {
    Target target;
    target.shape = TargetShape::plateaus;
    const auto knot = [&](double y, double gi) {
        target.table_y.push_back(y);
        target.table_gi.push_back(gi);
    };
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const bool first = k == 0, last = k + 1 == levels.size();
        if (!first) knot(levels[k].from, levels[k].gi);
        // a level of no length is one knot, a peak
        if (!last && (first || levels[k].to != levels[k].from)) knot(levels[k].to, levels[k].gi);
    }
    return target;
}

Target aba_target(double gi_outer, double gi_inner, double in_from, double in_to, double out_from,
                  double out_to) {
    Target target = plateaus_target(
        {{gi_outer, in_from, in_from}, {gi_inner, in_to, out_from}, {gi_outer, out_to, out_to}});
    target.shape = TargetShape::aba;
    return target;
}

Target table_target(const std::string& csv_file) {
    std::ifstream in(csv_file);
    if (!in)
        throw std::runtime_error(
            fmt::format("{}: cannot be opened: give the path of a CSV file y, gi", csv_file));
    Target target;
    target.shape = TargetShape::table;
    target.table_file = csv_file;
    double unit = 1;  // metres
    int y_column = 0, gi_column = 1, weight_column = -1;
    std::vector<double> weights;
    std::string line, wrong;
    bool first = true;
    for (int number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xef\xbb\xbf"))
            line.erase(0, 3);  // byte order mark of spreadsheets
        if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
        const std::vector<std::string> cells = cells_of(line);
        const auto fault = [&](const std::string& rule) {
            wrong += fmt::format("{}{}:{}: {}", wrong.empty() ? "" : "\n", csv_file, number, rule);
        };
        double y = 0, gi = 0;
        const bool was_first = std::exchange(first, false);
        if (was_first && !cells.empty() && !to_number(cells[0], y)) {
            int found_y = -1, found_gi = -1;
            for (int c = 0; c < static_cast<int>(cells.size()); ++c) {
                const std::string& name = cells[c];
                if (name == "gi") found_gi = c;
                if (name == "weight") weight_column = c;
                if (const double si = unit_of_column(name, "y"); si > 0) {
                    found_y = c;
                    unit = si;
                }
            }
            if (found_y < 0 || found_gi < 0) {
                fault(
                    fmt::format("header '{}' must name the columns y_m, y_mm or y_um, and gi; weight is free",
                                trimmed(line)));
                break;  // without the columns every line below would be a fault of its own
            }
            y_column = found_y;
            gi_column = found_gi;
            continue;
        }
        // Without a header the first line says whether there is a third column.
        if (was_first && cells.size() > 2) weight_column = 2;
        const int needed = std::max({y_column, gi_column, weight_column}) + 1;
        if (static_cast<int>(cells.size()) < needed) {
            fault(fmt::format("'{}' has {} column(s), {} are needed: y, gi{}", trimmed(line), cells.size(),
                              needed, weight_column >= 0 ? ", weight" : ""));
            continue;
        }
        if (!to_number(cells[y_column], y) || !to_number(cells[gi_column], gi)) {
            fault(fmt::format("'{}': y and gi must be finite numbers with a decimal point", trimmed(line)));
            continue;
        }
        double weight = 1;
        if (weight_column >= 0) {
            if (!to_number(cells[weight_column], weight) || weight < 0 || weight > kLargestWeight)
                fault(fmt::format("weight = '{}' must be a number in 0 .. {:g}, 0 for don't care",
                                  cells[weight_column], kLargestWeight));
            weights.push_back(weight);
        }
        if (gi < 0 || gi > 1) fault(fmt::format("gi = {:g} must lie in 0 .. 1", gi));
        if (!target.table_y.empty() && y * unit <= target.table_y.back()) {
            fault(fmt::format("y = {:g} must be greater than the y of the line before: sort the table by y",
                              y));
        }
        target.table_y.push_back(y * unit);
        target.table_gi.push_back(gi);
    }
    if (wrong.empty() && target.table_y.size() < 2) {
        wrong = fmt::format("{}: {} data line(s), at least 2 are needed", csv_file, target.table_y.size());
    }
    if (wrong.empty() && !weights.empty() && *std::max_element(weights.begin(), weights.end()) == 0)
        wrong = fmt::format("{}: every weight is 0: give at least one line a weight above 0", csv_file);
    if (!wrong.empty()) throw std::runtime_error(wrong);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const double low = k == 0 ? -kFar : target.table_y[k];
        const double high = k + 1 == weights.size() ? kFar : target.table_y[k + 1];
        if (!target.zones.empty() && target.zones.back().weight == weights[k])
            target.zones.back().y_high = high;
        else
            target.zones.push_back({low, high, weights[k]});
    }
    return target;
}

std::vector<std::string> problems(const Target& target) {
    std::vector<std::string> found;
    const auto gi_in_range = [&](const char* name, double gi) {
        if (!(gi >= 0 && gi <= 1)) found.push_back(fmt::format("{} = {:g} must lie in 0 .. 1", name, gi));
    };
    const char* shape = target.shape == TargetShape::table      ? "table"
                        : target.shape == TargetShape::plateaus ? "plateaus"
                                                                : "A-B-A";
    switch (target.shape) {
        case TargetShape::linear:
            gi_in_range("from.gi", target.gi0);
            gi_in_range("to.gi", target.gi1);
            if (!std::isfinite(target.y0) || !std::isfinite(target.y1) || target.y0 == target.y1) {
                found.push_back(fmt::format(
                    "from.y = {:g} mm and to.y = {:g} mm must differ: for a jump use shape = \"step\"",
                    target.y0 * 1e3, target.y1 * 1e3));
            }
            break;
        case TargetShape::step:
            gi_in_range("gi_low", target.gi0);
            gi_in_range("gi_high", target.gi1);
            if (!std::isfinite(target.y0)) found.push_back("y of the step must be a finite length");
            break;
        case TargetShape::sigmoid:
            gi_in_range("gi_low", target.gi0);
            gi_in_range("gi_high", target.gi1);
            if (!std::isfinite(target.centre)) found.push_back("centre must be a finite length");
            if (!(target.width_10_90 > 0) || !std::isfinite(target.width_10_90)) {
                found.push_back(
                    fmt::format("width_10_90 = {:g} mm must be > 0: for a jump use shape = \"step\"",
                                target.width_10_90 * 1e3));
            }
            break;
        case TargetShape::table:
        case TargetShape::plateaus:
        case TargetShape::aba:
            if (target.table_y.size() != target.table_gi.size()) {
                found.push_back(fmt::format("{} has {} y and {} gi: one gi per y", shape,
                                            target.table_y.size(), target.table_gi.size()));
            }
            if (target.table_y.size() < 2) {
                found.push_back(
                    fmt::format("{} has {} point(s), at least 2 are needed", shape, target.table_y.size()));
            }
            for (std::size_t k = 0; k < target.table_gi.size(); ++k) {
                gi_in_range(fmt::format("{} gi, point {},", shape, k + 1).c_str(), target.table_gi[k]);
            }
            for (std::size_t k = 0; k < target.table_y.size(); ++k) {
                if (!std::isfinite(target.table_y[k]) ||
                    (k > 0 && !(target.table_y[k] > target.table_y[k - 1]))) {
                    found.push_back(fmt::format(
                        "{} y, point {}, = {:g} mm must be finite and greater than the one before", shape,
                        k + 1, target.table_y[k] * 1e3));
                }
            }
            break;
        case TargetShape::field:
            for (const std::string& rule : field_problems(target)) found.push_back(rule);
            break;
    }
    for (std::size_t k = 0; k < target.zones.size(); ++k) {
        const TargetZone& zone = target.zones[k];
        if (!(zone.y_high > zone.y_low)) {
            found.push_back(
                fmt::format("zone {}: its end y = {:g} mm must be greater than its start y = {:g} mm", k + 1,
                            zone.y_high * 1e3, zone.y_low * 1e3));
        }
        if (!(zone.x_high > zone.x_low)) {
            found.push_back(
                fmt::format("zone {}: its end x = {:g} mm must be greater than its start x = {:g} mm", k + 1,
                            zone.x_high * 1e3, zone.x_low * 1e3));
        }
        if (!(zone.weight >= 0) || !std::isfinite(zone.weight)) {
            found.push_back(
                fmt::format("zone {}: weight = {:g} must be >= 0 (0 = don't care)", k + 1, zone.weight));
        }
    }
    return found;
}

}  // namespace gradwright
