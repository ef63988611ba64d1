#include "optimise/multi_fidelity_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimise/bounded_search.h"

namespace gradwright {
namespace {

/// full - map at one design, and what then still differs in the objective (coverage, waste).
struct Discrepancy {
    std::vector<double> profile, drift;  ///< per bin or cell, and per bin; empty = none
    double rest = 0;
};

std::vector<double> difference(const std::vector<double>& full, const std::vector<double>& map) {
    std::vector<double> result(full.size(), 0.0);
    for (std::size_t b = 0; b < std::min(full.size(), map.size()); ++b)
        if (std::isfinite(full[b]) && std::isfinite(map[b])) result[b] = full[b] - map[b];
    return result;
}

class CorrectedMap {
  public:
    CorrectedMap(const Study& study, const SearchTask& task, Evaluator& map)
        : study_(study), task_(task), map_(map) {}

    double operator()(const std::vector<double>& x) const {
        Evaluation evaluation = map_.evaluate(task_.space.design(x), 0);
        return value(evaluation, discrepancy_) + task_.space.unsound(x) + task_.space.detour(x);
    }
    void correct_at(const std::vector<double>& x, const Evaluation& full) {
        const Evaluation map = map_.evaluate(task_.space.design(x), 0);
        discrepancy_ = {};
        if (!map.health.ok()) return;
        discrepancy_.profile = difference(full.judged().gi, map.judged().gi);
        discrepancy_.drift = difference(full.drift.difference, map.drift.difference);
        discrepancy_.rest =
            full.objective - task_.space.unsound(x) - task_.space.detour(x) - value(map, discrepancy_);
    }

  private:
    double value(Evaluation map, const Discrepancy& discrepancy) const {
        if (!map.health.ok()) return kNotEvaluable;
        for (std::size_t b = 0; b < discrepancy.profile.size() && b < map.judged().gi.size(); ++b)
            map.judged().gi[b] += discrepancy.profile[b];
        for (std::size_t b = 0; b < discrepancy.drift.size() && b < map.drift.difference.size(); ++b)
            map.drift.difference[b] += discrepancy.drift[b];
        judge(study_, map);
        return map.health.ok() ? map.objective + discrepancy.rest : kNotEvaluable;
    }

    const Study& study_;
    const SearchTask& task_;
    Evaluator& map_;
    Discrepancy discrepancy_;
};

/// Best of the model within `radius` of `centre`.
BoundedSearchResult best_of(const CorrectedMap& model, const SearchTask& task,
                            const std::vector<double>& centre, double radius, int evaluations) {
    const SearchSpace& space = task.space;
    BoundedSearch search;
    for (std::size_t i = 0; i < space.size(); ++i) {
        const double room = radius * (space.high()[i] - space.low()[i]);
        search.low.push_back(std::max(space.low()[i], centre[i] - room));
        search.high.push_back(std::min(space.high()[i], centre[i] + room));
    }
    search.start = centre;
    search.step = space.step();
    search.budget = evaluations;
    search.x_tolerance = 1e-4;
    search.stop = task.stop;
    return minimise([&](const std::vector<double>& x) { return model(x); }, search);
}

/// Largest move of a variable, as a share of its range.
double step_length(const SearchSpace& space, const std::vector<double>& from, const std::vector<double>& to) {
    double length = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (space.high()[i] > space.low()[i])
            length = std::max(length, std::fabs(to[i] - from[i]) / (space.high()[i] - space.low()[i]));
    return length;
}

}  // namespace

MultiFidelitySearch multi_fidelity_search(const MultiFidelityOptions& options, const Study& study,
                                          const SearchTask& task, Evaluator& map) {
    MultiFidelitySearch search;
    const auto ended = [&](const std::string& termination, const std::string& why) {
        search.termination = termination;
        search.native = fmt::format("trust region {:.3g}, {} steps accepted, {} rejected: {}", search.radius,
                                    search.accepted, search.rejected, why);
        return search;
    };
    const auto stopped = [&] { return task.stop && task.stop(); };
    CorrectedMap model(study, task, map);
    search.radius = options.radius;

    // The whole box: nothing is known yet that would bind the first step.
    std::vector<double> x = best_of(model, task, task.space.start(), 1, options.model_evaluations).best;
    search.model_optimum = x;
    if (stopped()) return ended("interrupted", "stopped");
    if (task.budget < 1) return ended("budget", "no full spread to spend");
    Evaluation at_x = evaluate(task, x, search);
    if (!at_x.health.ok())
        return stopped() ? ended("interrupted", "stopped")
                         : ended("failed", "the first spread gave no numbers");
    model.correct_at(x, at_x);
    while (true) {
        if (search.radius < options.smallest_radius) return ended("converged", "radius below its resolution");
        if (search.evaluations >= task.budget) return ended("budget", "full spreads spent");
        if (stopped()) return ended("interrupted", "stopped");
        const BoundedSearchResult trial = best_of(model, task, x, search.radius, options.model_evaluations);
        if (stopped()) return ended("interrupted", "stopped");
        const double predicted = at_x.objective - trial.value;
        if (!(predicted > options.least_reduction))
            return ended("converged", "the corrected map knows nothing better");
        const Evaluation at_trial = evaluate(task, trial.best, search);
        if (stopped() && !at_trial.health.ok()) return ended("interrupted", "stopped");
        const double actual = at_trial.health.ok() ? at_x.objective - at_trial.objective : -kNotEvaluable;
        const double step = step_length(task.space, x, trial.best);
        if (actual < 0.25 * predicted)
            search.radius = 0.5 * step;
        else if (actual > 0.75 * predicted && step > 0.9 * search.radius)
            search.radius = std::min(1.0, 2 * search.radius);
        if (actual > 0) {
            ++search.accepted;
            x = trial.best;
            at_x = at_trial;
            model.correct_at(x, at_x);
        } else {
            ++search.rejected;
        }
    }
}

}  // namespace gradwright
