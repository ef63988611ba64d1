#include "optimise/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "optimise/motion.h"
#include "optimise/partition_family.h"
#include "optimise/study.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr const char* kPartition = "partition.";
constexpr double kAim = 1e-10;  // how far inside the bounds a point is aimed at, in scales

/// SI of a named number of a design; none when its family has no such number.
std::optional<double> value_of(const Study& study, const Design& design, const std::string& name) {
    const MotionValues motion = motion_values(study, design);
    for (std::size_t i = 0; i < kMotionCount; ++i)
        if (name == kMotionVariables[i].name) return motion[i];
    if (!name.starts_with(kPartition)) return {};
    const std::string number = name.substr(std::string(kPartition).size());
    for (const auto& [key, value] : design.parameters) {
        if (key == number + "_m") return value;
        if (key == number + "_deg") return value * kDegree;
    }
    return {};
}

/// SI of one unit of the sum: a dispenser's width of length, a radian, one.
double scale_of(const Study& study, const LinearConstraint& constraint) {
    double largest = 0;
    for (const auto& [name, factor] : constraint.terms) largest = std::max(largest, std::abs(factor));
    return (constraint.dimension == "length" ? study.dispenser_width : 1) * std::max(largest, 1e-12);
}

double slack_of(double value, double low, double high) {
    return std::min(value - low, high - value);
}

/// How far values lie outside of what is aimed at, summed.
double outside(const std::vector<double>& values, const std::vector<std::pair<double, double>>& bounds) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        sum += std::max(0.0, -slack_of(values[i], bounds[i].first, bounds[i].second));
    return sum;
}

struct HalfSpace {
    std::vector<double> normal;
    double least = 0;  ///< normal . x >= least
    double square = 0;
    double memory = 0;  ///< Dykstra's: what the last sweep has moved x along the normal
};

/// Projection of `x` on the intersection of half spaces and box.
std::vector<double> project(std::vector<HalfSpace> spaces, std::span<const double> low,
                            std::span<const double> high, std::vector<double> x) {
    const std::size_t n = x.size();
    std::vector<double> memory(n, 0.0);
    constexpr int kSweeps = 4000;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        double moved = 0;
        for (HalfSpace& space : spaces) {
            if (!(space.square > 0)) continue;
            double at = 0;
            for (std::size_t i = 0; i < n; ++i) at += space.normal[i] * x[i];
            at -= space.memory * space.square;
            const double step = std::max(0.0, (space.least - at) / space.square);
            const double change = step - space.memory;
            for (std::size_t i = 0; i < n; ++i) x[i] += change * space.normal[i];
            moved = std::max(moved, std::abs(change) * std::sqrt(space.square));
            space.memory = step;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double free = x[i] - memory[i];
            const double inside = std::clamp(free, low[i], high[i]);
            moved = std::max(moved, std::abs(inside - x[i]));
            memory[i] = inside - free;
            x[i] = inside;
        }
        if (moved < 1e-13) break;
    }
    return x;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> constraint_variables(const Study& study) {
    const PartitionFamily family(study.design_space, study.scene.dispenser_length, study.dispenser_width,
                                 {true, true});
    std::vector<std::pair<std::string, std::string>> variables;
    for (const std::string& name : family.number_names())
        variables.emplace_back(kPartition + name, name == "angle" ? "angle" : "length");
    for (const MotionVariable& motion : kMotionVariables)
        variables.emplace_back(motion.name, motion.dimension);
    return variables;
}

std::vector<ConstraintState> constraint_states(const Study& study, const Design& design) {
    std::vector<ConstraintState> states;
    for (const LinearConstraint& constraint : study.constraints) {
        ConstraintState state;
        bool known = true;
        for (const auto& [name, factor] : constraint.terms) {
            const std::optional<double> value = value_of(study, design, name);
            known = known && value;
            if (value) state.value += factor * *value;
        }
        if (!known) continue;
        state.name = constraint.name;
        state.dimension = constraint.dimension;
        state.low = constraint.low;
        state.high = constraint.high;
        state.slack = slack_of(state.value, state.low, state.high);
        state.scale = scale_of(study, constraint);
        states.push_back(state);
    }
    return states;
}

std::vector<ConstraintState> limit_states(const Study& study, double waste_fraction, double supply_ratio) {
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    std::vector<ConstraintState> states;
    const auto add = [&](const char* name, double value, double low, double high) {
        states.push_back({name, "", value, low, high, slack_of(value, low, high), 1, true});
        // a number that was not measured keeps no limit
        if (std::isnan(value)) states.back().slack = -kOpen;
    };
    if (study.objective.max_waste < kOpen)
        add("objective.max_waste", waste_fraction, -kOpen, study.objective.max_waste);
    if (study.objective.min_supply_ratio > 0)
        add("objective.min_supply_ratio", supply_ratio, study.objective.min_supply_ratio, kOpen);
    return states;
}

double broken(const std::vector<ConstraintState>& states) {
    double sum = 0;
    for (const ConstraintState& state : states)
        if (!state.kept()) sum += -state.slack / state.scale;
    return sum;
}

const ConstraintState* binding(const std::vector<ConstraintState>& states) {
    const auto least = std::min_element(states.begin(), states.end(), [](const auto& a, const auto& b) {
        return a.slack / a.scale < b.slack / b.scale;
    });
    return least == states.end() ? nullptr : &*least;
}

std::string describe(const ConstraintState& state) {
    const auto text = [&](double si) { return format_quantity(si, state.dimension); };
    std::string bounds;
    if (std::isfinite(state.low)) bounds = fmt::format("at least {}", text(state.low));
    if (std::isfinite(state.high))
        bounds += fmt::format("{}at most {}", bounds.empty() ? "" : ", ", text(state.high));
    const std::string stands = state.kept()
                                   ? fmt::format("has a slack of {}", text(std::max(0.0, state.slack)))
                                   : fmt::format("is broken by {}", text(-state.slack));
    return fmt::format("'{}' {} ({}; {})", state.name, stands, text(state.value), bounds);
}

std::vector<ConstraintRow> constraint_rows(const Study& study, const PartitionFamily& family) {
    const std::vector<std::string> names = family.number_names();
    std::vector<ConstraintRow> rows;
    for (const LinearConstraint& constraint : study.constraints) {
        const double scale = scale_of(study, constraint);
        ConstraintRow row;
        row.low = constraint.low / scale;
        row.high = constraint.high / scale;
        bool known = true;
        for (const auto& [name, factor] : constraint.terms) {
            const auto motion = std::find_if(kMotionVariables.begin(), kMotionVariables.end(),
                                             [&, &term = name](const auto& m) { return m.name == term; });
            if (motion != kMotionVariables.end()) {
                row.motion[std::size_t(motion - kMotionVariables.begin())] += factor / scale;
                continue;
            }
            const auto at = std::find_if(names.begin(), names.end(),
                                         [&, &term = name](const auto& n) { return kPartition + n == term; });
            known = known && at != names.end();
            if (at != names.end())
                row.partition.emplace_back(static_cast<int>(at - names.begin()), factor / scale);
        }
        if (known) rows.push_back(row);
    }
    return rows;
}

std::vector<double> nearest_kept(const ConstraintValues& values,
                                 const std::vector<std::pair<double, double>>& bounds,
                                 std::span<const double> low, std::span<const double> high,
                                 std::vector<double> x) {
    if (bounds.empty()) return x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::clamp(x[i], low[i], high[i]);
    std::vector<std::pair<double, double>> aimed = bounds;
    for (auto& [least, most] : aimed) {
        const double margin = std::min(kAim, 0.25 * (most - least));
        least += margin;
        most -= margin;
    }
    std::vector<double> here = values(x), best = x;
    double least = outside(here, bounds);
    if (least == 0) return x;
    const std::vector<double> start = x;
    constexpr int kModels = 30;
    for (int model = 0; model < kModels && least > 0; ++model) {
        std::vector<HalfSpace> spaces;
        std::vector<std::vector<double>> slope(bounds.size(), std::vector<double>(x.size(), 0.0));
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double h = 1e-6 * std::max(1e-3, high[i] - low[i]);
            if (!(high[i] > low[i])) continue;
            std::vector<double> point = x;
            point[i] = x[i] + h <= high[i] ? x[i] + h : x[i] - h;
            const std::vector<double> there = values(point);
            for (std::size_t r = 0; r < bounds.size(); ++r)
                slope[r][i] = (there[r] - here[r]) / (point[i] - x[i]);
        }
        for (std::size_t r = 0; r < bounds.size(); ++r) {
            double at = 0;
            HalfSpace space;
            for (std::size_t i = 0; i < x.size(); ++i) {
                at += slope[r][i] * x[i];
                space.square += slope[r][i] * slope[r][i];
            }
            // value(y) = here + slope (y - x)
            if (std::isfinite(aimed[r].first)) {
                space.normal = slope[r];
                space.least = aimed[r].first - here[r] + at;
                spaces.push_back(space);
            }
            if (std::isfinite(aimed[r].second)) {
                space.normal = slope[r];
                for (double& number : space.normal) number = -number;
                space.least = here[r] - aimed[r].second - at;
                spaces.push_back(space);
            }
        }
        x = project(spaces, low, high, start);
        here = values(x);
        const double off = outside(here, bounds);
        if (model > 3 && off > (1 - 1e-6) * least) break;  // there is no such point, or none nearer
        if (off < least) {
            least = off;
            best = x;
        }
    }
    return best;
}

double detour(std::span<const double> x, std::span<const double> kept) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - kept[i]) * (x[i] - kept[i]);
    return sum;
}

std::vector<double> nearest_kept(const std::vector<ConstraintRow>& rows, const PartitionFamily& family,
                                 const MotionValues& motion, std::vector<double> p) {
    if (rows.empty()) return p;
    std::vector<std::pair<double, double>> bounds;
    for (const ConstraintRow& row : rows) bounds.emplace_back(row.low, row.high);
    return nearest_kept(
        [&](const std::vector<double>& point) {
            std::vector<double> numbers, values;
            family.numbers_of(point.data(), numbers);
            for (const ConstraintRow& row : rows) values.push_back(row_value(row, numbers, motion));
            return values;
        },
        bounds, family.low(), family.high(), std::move(p));
}

}  // namespace gradwright
