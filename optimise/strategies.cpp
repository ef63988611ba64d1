#include "optimise/strategies.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "optimise/kinematic_evaluator.h"
#include "optimise/least_squares_strategy.h"
#include "optimise/motion.h"
#include "optimise/multi_fidelity_search.h"
#include "optimise/nlopt_strategy.h"
#include "optimise/strategy_support.h"

namespace gradwright {
namespace {

/// The map without the trimmings that a search does not look at; the strips of a new motion point are spread
/// on the way. `journal` may be null.
class QuickMap : public Evaluator {
  public:
    QuickMap(MapEvaluator& map, Journal* journal) : map_(map), journal_(journal) {}
    Evaluation evaluate(const Design& design, std::uint64_t) override {
        const Evaluation evaluation = map_.quick(design);
        if (journal_ && evaluation.health.status != "interrupted") journal_->append(evaluation);
        return evaluation;
    }
    Fidelity fidelity() const override { return Fidelity::map; }

  private:
    MapEvaluator& map_;
    Journal* journal_;
};

/// The box, starting from the closed form: with a map at hand from its own distribution of origins, else from
/// a fully mixed dispenser.
SearchSpace space_of(StrategyRun& run, const Design& start, bool on_map, Moves moves) {
    run.enter("start");
    const Study& study = run.study;
    const double length = study.scene.dispenser_length;
    std::function<double(double)> quantile = [length](double share) { return share * length; };
    if (on_map) {
        const OriginMap& map = run.map.map_of(start);
        run.result.map_layers = map.layers;
        run.result.beds = map.beds;
        const Footprint footprint = footprint_of(study, start);
        bool grains = false;
        for (const Layer& layer : map.layers) grains = grains || layer.size() > 0;
        if (map.health.ok() && grains)
            quantile = [&map, footprint](double share) {
                return origin_x_quantile(map.layers, footprint.x_low, footprint.x_high, share);
            };
    }
    const bool above = stands_above(study, study.design_space);
    const PartitionFamily family(study.design_space, length, study.dispenser_width, {above, !above});
    return {study, family, start, closed_form_start(study, family, quantile), moves};
}

/// What every search here ends with: its best confirmed on seeds that it never saw, as far as the budget of
/// spreads goes; `once` even where the search has spent it.
StudyResult confirm_best(StrategyRun& run, const EvaluatorSearch& found, bool once) {
    std::vector<ConfirmedDesign> rounds = {unconfirmed(found.best)};
    run.enter("confirm");
    if (once && !run.runner.stopped()) run.confirm(rounds.back());
    run.confirm_until_decided(rounds.back());
    KinematicEvaluator bounded(run.study, found.best.capture_fraction > 0
                                              ? std::optional(found.best.capture_fraction)
                                              : std::nullopt);
    run.result.kinematic = bounded.evaluate(found.best.design, 0);
    run.limit = fmt::format(
        "The search over '{}' ended '{}' at misfit {:.3f} and x drift {:.3f} after {} evaluations ({}).",
        to_string(found.best.fidelity), found.termination, found.best.misfit.value,
        found.best.drift_misfit.value, found.evaluations, found.native);
    return run.finish(rounds);
}

StudyResult nothing_found(StrategyRun& run) {
    return run.fail("No evaluation gave numbers; the last: " + (run.result.history.empty()
                                                                    ? "stopped before the first evaluation"
                                                                    : run.result.history.back().note));
}

using Search = std::function<EvaluatorSearch(const SearchTask&)>;

/// One search over one evaluator, then the confirmation.
StudyResult run_evaluator_strategy(const Study& study, const StrategyChoice& choice,
                                   const RunOptions& options, const Search& search) {
    StrategyRun run(study, options);
    const Design start = start_design(run.study);
    const bool on_map = choice.fidelity == Fidelity::map;
    const SearchSpace space = space_of(run, start, on_map, Moves::everything);

    KinematicEvaluator kinematic(run.study);
    QuickMap map(run.map, &run.journal);
    Evaluator& evaluator = choice.fidelity == Fidelity::kinematic ? static_cast<Evaluator&>(kinematic)
                           : on_map                               ? static_cast<Evaluator&>(map)
                                                                  : static_cast<Evaluator&>(run.full);
    run.enter("search");
    const SearchTask task{evaluator,
                          space,
                          map_seed(study.seed, 0),
                          choice.budget,
                          [&run] { return run.runner.stopped(); },
                          [&](const Evaluation& evaluation) {
                              run.record(choice.name, evaluation, to_string(choice.fidelity));
                              if (choice.fidelity == Fidelity::kinematic) run.journal.append(evaluation);
                          }};
    EvaluatorSearch found;
    if (space.free_count() > 0) {
        found = search(task);
    } else {
        evaluate(task, space.start(), found);
        found.termination = "converged";
        found.native = "no variable is free";
    }
    run.result.given_used.emplace_back("budget", fmt::format("{} -> {}", choice.budget, found.evaluations));
    run.result.given_used.emplace_back("search", fmt::format("{}, {}", found.termination, found.native));
    if (!found.best.health.ok()) return nothing_found(run);
    if (on_map) {
        found.best = run.map.evaluate(found.best.design, 0);
        run.result.map_layers = run.map.map_of(found.best.design).layers;
    }
    return confirm_best(run, found, true);
}

/// Of the spreads that the map has left, a third is kept for the confirmation, at least one.
StudyResult run_mf_strategy(const Study& study, const RunOptions& options) {
    StrategyRun run(study, options);
    const Design start = start_design(run.study);
    const SearchSpace space = space_of(run, start, true, Moves::labels);
    const OriginMap& origins = run.map.map_of(start);
    run.warn(origins.health.warnings);
    if (!origins.health.ok()) {
        run.record("map", run.map.evaluate(start, 0), "no origin map");
        return run.fail(
            fmt::format("The map spread ended '{}': {}", origins.health.status, origins.health.reason));
    }
    if (const std::string names = free_motion(run.study.design_space, true); !names.empty())
        run.result.warnings.push_back("mf moves the partition and the footprint only: " + names +
                                      " stay at their start");
    run.record("start", run.map.quick(space.design(space.start())), "start design on the map");

    run.enter("search");
    QuickMap map(run.map, nullptr);
    const int left = run.spreads_left();
    const int budget = space.free_count() > 0 ? std::max(0, left - std::max(1, left / 3)) : 0;
    const SearchTask task{run.full,
                          space,
                          map_seed(study.seed, 0),
                          budget,
                          [&run] { return run.runner.stopped(); },
                          [&](const Evaluation& evaluation) { run.record("mf", evaluation, "full"); }};
    MultiFidelitySearch found;
    if (space.free_count() > 0)
        found = multi_fidelity_search({}, run.study, task, map);
    else
        found.model_optimum = space.start();
    run.result.given_used.emplace_back("budget", fmt::format("{} -> {}", budget, found.evaluations));
    run.result.given_used.emplace_back("search", fmt::format("{}, {}", found.termination, found.native));
    if (found.termination == "failed") return nothing_found(run);
    // Where no full spread could be paid, the map's own optimum is what there is to confirm.
    if (!found.best.health.ok()) found.best = run.map.evaluate(space.design(found.model_optimum), 0);
    return confirm_best(run, found, false);
}

}  // namespace

const std::vector<std::string>& strategy_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all = {"map", "mf"};
        for (const SearchMethod method : kSearchMethods) all.push_back(to_string(method));
        all.push_back("ceres");
        return all;
    }();
    return names;
}

bool searches_one_fidelity(const std::string& strategy) {
    return strategy != "map" && strategy != "mf";
}

StudyResult run_strategy(const Study& study, const StrategyChoice& choice, const RunOptions& options) {
    if (choice.name == "map") return run_map_strategy(study, options);
    if (choice.name == "mf") return run_mf_strategy(study, options);
    if (choice.fidelity == Fidelity::lammps)
        throw std::invalid_argument("strategy: fidelity lammps is a witness, not a search");
    if (choice.name == "ceres")
        return run_evaluator_strategy(study, choice, options,
                                      [](const SearchTask& task) { return least_squares_with({}, task); });
    const std::optional<SearchMethod> method = search_method(choice.name);
    if (!method) throw std::invalid_argument("strategy: there is no '" + choice.name + "'");
    return run_evaluator_strategy(study, choice, options,
                                  [&](const SearchTask& task) { return search_with(*method, task); });
}

}  // namespace gradwright
