#include "optimise/motion_search.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "optimise/bounded_search.h"
#include "optimise/chamber_fill.h"
#include "optimise/joined.h"
#include "optimise/motion.h"

namespace gradwright {
namespace {

constexpr double kSame = 0.04;  // of the ranges: a map cannot tell nearer motions apart
constexpr double kInfinity = std::numeric_limits<double>::infinity();

FitOptions quick_fit(std::uint64_t seed) {
    FitOptions options;
    options.kernels = {50e-6};
    options.iterations = 20;
    options.finalists = 1;
    options.perturbed_starts = 1;
    options.polish_evaluations = 100;
    options.seed = seed;
    return options;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

/// Radical inverse of `index` in base `base`: coordinate of Halton's low-discrepancy set, in (0, 1).
double radical_inverse(int index, int base) {
    double value = 0, digit = 1.0 / base;
    for (; index > 0; index /= base, digit /= base) value += (index % base) * digit;
    return value;
}
constexpr std::array kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};

double of_range(double low, double high, double share) {
    return low + share * (high - low);
}

}  // namespace

std::vector<double> interpolation_shares(const std::vector<std::vector<double>>& points,
                                         const std::vector<double>& at) {
    const std::size_t n = points.size(), d = at.size();
    std::vector<double> shares(n, 0.0);
    const auto nearer = [&](std::size_t a, std::size_t b) {
        return distance(points[a], at) < distance(points[b], at);
    };
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t(0));
    const std::size_t nearest = *std::min_element(order.begin(), order.end(), nearer);
    double least = kInfinity;
    // every choice of d + 1 of the points: a motion search has a dozen of them in two or three directions
    std::vector<bool> chosen(n, false);
    if (n > d) std::fill(chosen.begin(), chosen.begin() + std::ptrdiff_t(d + 1), true);
    if (distance(points[nearest], at) > 1e-9 && n > d) do {
            Eigen::MatrixXd corners(d + 1, d + 1);
            Eigen::VectorXd wanted(d + 1);
            std::vector<std::size_t> members;
            for (std::size_t k = 0; k < n; ++k)
                if (chosen[k]) members.push_back(k);
            for (std::size_t c = 0; c <= d; ++c) {
                for (std::size_t i = 0; i < d; ++i) corners(i, c) = points[members[c]][i];
                corners(d, c) = 1;
            }
            for (std::size_t i = 0; i < d; ++i) wanted(i) = at[i];
            wanted(d) = 1;
            const auto solver = corners.fullPivLu();
            if (!solver.isInvertible()) continue;
            const Eigen::VectorXd part = solver.solve(wanted);
            if (part.minCoeff() < -1e-9) continue;  // outside this simplex
            double size = 0;  // the lifted paraboloid over the point: least on Delaunay's simplex
            for (std::size_t c = 0; c <= d; ++c)
                size += part(c) * std::pow(distance(points[members[c]], at), 2);
            if (size >= least) continue;
            least = size;
            std::fill(shares.begin(), shares.end(), 0.0);
            for (std::size_t c = 0; c <= d; ++c) shares[members[c]] = std::max(0.0, part(c));
        } while (std::prev_permutation(chosen.begin(), chosen.end()));
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    if (!(sum > 0)) {
        shares[nearest] = 1;
        return shares;
    }
    for (double& share : shares) share /= sum;
    return shares;
}

double turnovers_to_part(const Study& study, const Design& design) {
    const Scene scene = scene_of(study, design, false, study.seed);
    const Footprint footprint = footprint_of(study, design);
    const double dose = scene.dose_height - 0.5 * (scene.headspace[0] + scene.headspace[1]);
    return (scene.land + 0.5 * (footprint.x_low + footprint.x_high)) /
           std::sqrt(dose * scene.dispenser_length);
}

MotionSearch::MotionSearch(StrategyRun& run, const Design& start)
    : run_(run), study_(run.study), start_(start) {
    const DesignSpace& space = study_.design_space;
    for (const MotionVariable& motion : kMotionVariables) {
        Variable variable = motion.in(space);
        const std::string name = motion.name;
        if (name.rfind("dose.", 0) == 0 || name.rfind("fill_fraction.", 0) == 0) continue;  // below
        if (!motion.spreads) {
            // kept whole on the platform: a cut footprint would be a smaller part, not a better place
            variable.low = std::max(variable.low, -study_.footprint.x_low);
            variable.high = std::min(variable.high, study_.scene.platform_length - study_.footprint.x_high);
        }
        if (!variable.free || !(variable.high > variable.low)) continue;
        (motion.spreads ? spreads_ : labels_)
            .push_back({name, variable.low, variable.high,
                        std::clamp(variable.value, variable.low, variable.high),
                        [&motion](Design& design, double value) { motion.of(design) = value; }});
    }
    only_motion_ = study_;
    std::erase_if(only_motion_.constraints, [](const LinearConstraint& constraint) {
        return std::any_of(constraint.terms.begin(), constraint.terms.end(),
                           [](const auto& term) { return term.first.starts_with("partition."); });
    });
    add_chambers("dose", &Design::dose, space.dose, !space.dosage_factor.free);
    add_chambers("fill_fraction", &Design::fill_fraction, space.fill_fraction, true);
}

void MotionSearch::add_chambers(const char* name, std::array<double, 2> Design::*values,
                                const std::array<Variable, 2>& variables, bool mean_too) {
    const auto& [a, b] = variables;
    if (!a.free && !b.free) return;
    if (a.free != b.free) {
        const Variable& one = a.free ? a : b;
        const std::size_t chamber = a.free ? 0 : 1;
        spreads_.push_back(
            {one.name, one.low, one.high, one.value,
             [values, chamber](Design& design, double value) { (design.*values)[chamber] = value; }});
        return;
    }
    const double mean = 0.5 * (a.value + b.value), tilt = 0.5 * (a.value - b.value);
    // set in this order: the mean first, then the tilt around it, both inside the chambers' own bounds
    if (mean_too)
        spreads_.push_back({fmt::format("mean {}", name), 0.5 * (a.low + b.low), 0.5 * (a.high + b.high),
                            mean, [values](Design& design, double value) {
                                (design.*values) = {value, value};
                            }});
    const double least = 0.5 * (a.low - b.high), most = 0.5 * (a.high - b.low);
    labels_.push_back({fmt::format("tilt of {}", name), least, most, tilt,
                       [values, variables, mean, mean_too](Design& design, double value) {
                           auto& pair = design.*values;
                           const double middle = mean_too ? 0.5 * (pair[0] + pair[1]) : mean;
                           const auto& [first, second] = variables;
                           // the tilt that both chambers allow: else the mean would move with it
                           const double low = std::max(first.low - middle, middle - second.high),
                                        high = std::min(first.high - middle, middle - second.low);
                           const double allowed = low <= high ? std::clamp(value, low, high) : 0;
                           pair = {middle + allowed, middle - allowed};
                       }});
}

Design MotionSearch::design_at(const std::vector<double>& spreads, const std::vector<double>& labels) const {
    Design design = start_;
    for (std::size_t i = 0; i < spreads_.size(); ++i)
        spreads_[i].set(design, of_range(spreads_[i].low, spreads_[i].high, spreads[i]));
    for (std::size_t i = 0; i < labels_.size(); ++i)
        labels_[i].set(design, of_range(labels_[i].low, labels_[i].high, labels[i]));
    return design;
}

std::vector<std::vector<double>> MotionSearch::first_points(std::size_t count) const {
    const std::size_t d = spreads_.size();
    std::vector<double> start;
    for (const Direction& direction : spreads_)
        start.push_back((direction.start - direction.low) / (direction.high - direction.low));
    std::vector<std::vector<double>> points = {start}, corners;
    std::vector<double> labels, turned = start;
    for (const Direction& label : labels_)
        labels.push_back((label.start - label.low) / (label.high - label.low));
    const auto off = [&](const std::vector<double>& at) {  // with a little of what is nearest to the start
        return std::fabs(turnovers_to_part(study_, design_at(at, labels)) / kBestTurnovers - 1) +
               0.05 * distance(at, start);
    };
    constexpr int kSamples = 200;
    for (int i = 1; i <= kSamples; ++i) {
        std::vector<double> at;
        for (std::size_t k = 0; k < d; ++k) at.push_back(radical_inverse(i, kPrimes.at(k)));
        if (off(at) < off(turned)) turned = at;
    }
    if (count > 1 && distance(turned, start) >= kSame) points.push_back(turned);
    for (unsigned corner = 0; corner < (1u << d); ++corner) {
        std::vector<double> point;
        for (std::size_t i = 0; i < d; ++i) point.push_back(corner >> i & 1 ? 1 : 0);
        corners.push_back(point);
    }
    while (points.size() < count) {
        const auto room = [&](const std::vector<double>& corner) {
            double least = kInfinity;
            for (const auto& point : points) least = std::min(least, distance(point, corner));
            return least;
        };
        const auto furthest = std::max_element(
            corners.begin(), corners.end(), [&](const auto& a, const auto& b) { return room(a) < room(b); });
        if (room(*furthest) < kSame) break;
        points.push_back(*furthest);
    }
    return points;
}

Evaluation MotionSearch::nested(const Design& motion, OriginMap& map) {
    Design design = motion;
    if (map.health.ok() && study_.design_space.partition_free) {
        const FitProblem problem(study_, motion, map.layers, map.share);
        const FitResult fit =
            fit_partition(study_, study_.design_space, motion, problem, quick_fit(study_.seed));
        if (fit.ok) design = fit.design;
    }
    Evaluation evaluation = run_.map.quick(design, map);
    evaluation.objective =
        std::hypot(evaluation.objective, step_doubt(study_, design, evaluation.profile, evaluation.weight));
    evaluation.objective += kBrokenPrice * broken(constraint_states(study_, design));
    return evaluation;
}

void MotionSearch::keep(std::vector<double>& spreads, std::vector<double>& labels, bool labels_only) const {
    if (only_motion_.constraints.empty()) return;
    const std::size_t d = spreads.size();
    std::vector<double> x = spreads, low(d + labels.size(), 0), high(d + labels.size(), 1);
    x.insert(x.end(), labels.begin(), labels.end());
    if (labels_only)
        for (std::size_t i = 0; i < d; ++i) low[i] = high[i] = x[i];
    const auto split = [&](const std::vector<double>& point) {
        return design_at(std::vector(point.begin(), point.begin() + std::ptrdiff_t(d)),
                         std::vector(point.begin() + std::ptrdiff_t(d), point.end()));
    };
    std::vector<std::pair<double, double>> bounds;
    for (const ConstraintState& state : constraint_states(only_motion_, split(x)))
        bounds.emplace_back(state.low / state.scale, state.high / state.scale);
    x = nearest_kept(
        [&](const std::vector<double>& point) {
            std::vector<double> values;
            for (const ConstraintState& state : constraint_states(only_motion_, split(point)))
                values.push_back(state.value / state.scale);
            return values;
        },
        bounds, low, high, x);
    spreads.assign(x.begin(), x.begin() + std::ptrdiff_t(d));
    labels.assign(x.begin() + std::ptrdiff_t(d), x.end());
}

std::vector<double> MotionSearch::least(std::size_t n,
                                        const std::function<double(const std::vector<double>&)>& objective,
                                        const std::vector<double>& start, double& value) const {
    value = kInfinity;
    std::vector<double> best = start;
    const auto look = [&](const std::vector<double>& x) {
        const double found = objective(x);
        if (found < value) {
            value = found;
            best = x;
        }
        return found;
    };
    look(start);
    if (n == 0) return best;
    constexpr int kLattice = 9, kEach = 14;
    if (n == 1)
        for (int i = 0; i < kLattice; ++i) look({double(i) / (kLattice - 1)});
    else
        for (int i = 1; i <= kEach * int(n); ++i) {
            std::vector<double> x;
            for (std::size_t k = 0; k < n; ++k) x.push_back(radical_inverse(i, kPrimes.at(k)));
            look(x);
        }
    BoundedSearch search;
    search.method = SearchMethod::sbplx;
    search.low.assign(n, 0);
    search.high.assign(n, 1);
    search.start = best;
    search.step.assign(n, n == 1 ? 1.0 / (kLattice - 1) : 0.1);
    search.x_tolerance = 0.25 * kSame;
    search.budget = 9 * int(n);
    search.stop = [this] { return run_.runner.stopped(); };
    minimise(look, search);
    return best;
}

std::string MotionSearch::describe(const Design& motion) const {
    std::string text;
    Design copy = motion;
    for (const MotionVariable& variable : kMotionVariables) {
        if (!variable.in(study_.design_space).free) continue;
        const bool length = std::string_view(variable.unit).front() == 'm';
        text += fmt::format("{}{} {:.4g}{}", text.empty() ? "" : ", ", variable.name,
                            variable.of(copy) * (length ? 1e3 : 1),
                            length ? fmt::format(" m{}", variable.unit) : "");
    }
    return text;
}

bool MotionSearch::spread(const std::vector<double>& wanted, double promised) {
    std::vector<double> at = wanted, labels;
    for (const Direction& direction : labels_)
        labels.push_back((direction.start - direction.low) / (direction.high - direction.low));
    keep(at, labels, false);
    OriginMap& map = run_.map.map_of(design_at(at, labels));
    if (!map.health.ok()) {
        run_.record("motion", run_.map.quick(design_at(at, labels), map), describe(design_at(at, labels)));
        return false;
    }
    double value = 0;
    labels = least(
        labels_.size(),
        [&](const std::vector<double>& x) {
            std::vector<double> same = at, kept = x;
            keep(same, kept, true);
            return nested(design_at(at, kept), map).objective + detour(x, kept);
        },
        labels, value);
    keep(at, labels, true);
    const Design motion = design_at(at, labels);
    const Evaluation found = nested(motion, map);
    run_.record(
        "motion", found,
        describe(motion) + (std::isfinite(promised)
                                ? fmt::format("; objective between the maps {:.3f}, on its own {:.3f}",
                                              promised, found.objective)
                                : fmt::format("; objective {:.3f}", found.objective)));
    // moved onto one that is there already, it says nothing new
    if (std::none_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& node) { return distance(node.at, at) < 1e-9; }))
        nodes_.push_back({at, motion, found.objective});
    return true;
}

Design MotionSearch::best() {
    if (spreads_.empty() && labels_.empty()) return start_;
    const int reserve = std::min(kReserve, std::max(1, study_.max_spreads - study_.map_spreads));
    const std::size_t d = spreads_.size(), corners = (std::size_t(1) << std::min<std::size_t>(d, 8)) + 1;
    std::size_t points = std::size_t(std::max(1, (study_.max_spreads - reserve) / study_.map_spreads));
    if (d == 0) points = 1;
    if (d > 0 && points == 1) {
        std::vector<std::string> names;
        for (const Direction& direction : spreads_) names.push_back(direction.name);
        run_.result.warnings.push_back(
            fmt::format("{} at the start's value: run.max_spreads leaves no spread to search for another",
                        joined(names)));
    }
    // a check or two is worth more than the last corners
    const std::size_t first = points <= d + 2 ? std::min(points, corners) : std::min(points - 1, corners);
    const auto may_spread = [&] {
        return !run_.runner.stopped() &&
               run_.spreads_left() - study_.map_spreads >= (nodes_.empty() ? 0 : reserve);
    };
    for (const auto& at : first_points(first))
        if (may_spread() && !spread(at, kInfinity) && nodes_.empty()) return start_;
    if (nodes_.empty()) return start_;
    const auto best_node = [&] {
        return std::min_element(nodes_.begin(), nodes_.end(),
                                [](const Node& a, const Node& b) { return a.objective < b.objective; });
    };
    std::string end = "budget";
    while (d > 0 && nodes_.size() < points && may_spread()) {
        std::vector<std::vector<double>> known;
        std::vector<Design> motions;
        for (const Node& node : nodes_) {
            known.push_back(node.at);
            motions.push_back(node.motion);
        }
        const std::size_t n = d + labels_.size();
        const auto split = [&](const std::vector<double>& x) {
            return std::pair(std::vector(x.begin(), x.begin() + std::ptrdiff_t(d)),
                             std::vector(x.begin() + std::ptrdiff_t(d), x.end()));
        };
        const auto objective = [&](const std::vector<double>& x) {
            if (run_.runner.stopped()) return kNotEvaluable;
            auto [at, labels] = split(x);
            keep(at, labels, false);
            OriginMap map = run_.map.between(motions, interpolation_shares(known, at));
            std::vector<double> kept = at;
            kept.insert(kept.end(), labels.begin(), labels.end());
            return nested(design_at(at, labels), map).objective + detour(x, kept);
        };
        std::vector<double> from = best_node()->at;
        for (const Direction& label : labels_)
            from.push_back((label.start - label.low) / (label.high - label.low));
        double promised = 0;
        auto [at, labels] = split(least(n, objective, from, promised));
        keep(at, labels, false);
        const bool known_already =
            std::any_of(known.begin(), known.end(),
                        [&, &here = at](const auto& point) { return distance(point, here) < kSame; });
        if (known_already || promised >= best_node()->objective) {
            end = "nothing better between the maps";
            break;
        }
        const std::size_t before = nodes_.size();
        // a constraint may move the motion onto one that is there: asking again would not end
        if (!spread(at, promised) || nodes_.size() == before) break;
    }
    run_.result.given_used.emplace_back("motion search",
                                        fmt::format("{} motions spread, {}", nodes_.size(), end));
    return best_node()->motion;
}

}  // namespace gradwright
