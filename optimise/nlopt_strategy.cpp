#include "optimise/nlopt_strategy.h"

#include <fmt/format.h>

#include "optimise/bounded_search.h"
#include "optimise/kinematic_evaluator.h"
#include "optimise/strategy_support.h"

namespace gradwright {
namespace {

/// The map without the trimmings that a search does not look at; the strips of a new motion point are spread
/// on the way.
class QuickMap : public Evaluator {
  public:
    QuickMap(MapEvaluator& map, Journal& journal) : map_(map), journal_(journal) {}
    Evaluation evaluate(const Design& design, std::uint64_t) override {
        const Evaluation evaluation = map_.quick(design);
        if (evaluation.health.status != "interrupted") journal_.append(evaluation);
        return evaluation;
    }
    Fidelity fidelity() const override { return Fidelity::map; }

  private:
    MapEvaluator& map_;
    Journal& journal_;
};

}  // namespace

EvaluatorSearch search_with(Evaluator& evaluator, const Study& study, const PartitionFamily& family,
                            const Design& start, const std::vector<double>& p, std::uint64_t seed, int budget,
                            const std::function<bool()>& stop,
                            const std::function<void(const Evaluation&)>& seen) {
    const DesignSpace& space = study.design_space;
    const Variable* motion[3] = {&space.dosage_factor, &space.land, &space.footprint_offset};
    BoundedSearch search;
    search.low = family.low();
    search.high = family.high();
    search.start = p;
    if (!space.partition_free) search.low = search.high = p;
    search.step.assign(p.size(), 0.1);
    for (const Variable* variable : motion) {
        const double room = variable->free ? variable->high - variable->low : 0;
        search.low.push_back(0);
        search.high.push_back(room > 0 ? 1 : 0);
        search.start.push_back(room > 0 ? (variable->value - variable->low) / room : 0);
        search.step.push_back(0.2);
    }
    search.budget = budget;
    search.x_tolerance = 1e-4;
    search.stop = stop;

    EvaluatorSearch result;
    const auto objective = [&](const std::vector<double>& x) {
        Design design = start;
        if (space.partition_free) {
            design.family = family.family();
            design.partition = family.curve(std::span(x).first(p.size()));
            design.parameters = family.named(std::span(x).first(p.size()));
        }
        double* numbers[3] = {&design.dosage_factor, &design.land, &design.footprint_offset};
        for (int i = 0; i < 3; ++i)
            if (search.high[p.size() + i] > 0)
                *numbers[i] = motion[i]->low + x[p.size() + i] * (motion[i]->high - motion[i]->low);
        const Evaluation evaluation = evaluator.evaluate(design, seed);
        if (seen) seen(evaluation);
        if (!evaluation.health.ok()) return kNotEvaluable;
        if (!result.best.health.ok() || evaluation.objective < result.best.objective)
            result.best = evaluation;
        return evaluation.objective;
    };
    const BoundedSearchResult found = minimise(objective, search);
    result.evaluations = found.evaluations;
    result.termination = found.termination;
    result.native = found.native;
    return result;
}

StudyResult run_bobyqa_strategy(const Study& study, Fidelity fidelity, int budget,
                                const RunOptions& options) {
    StrategyRun run(study, options);
    const double length = study.scene.dispenser_length;
    const Design start = start_design(run.study);

    // The start in closed form; with a map at hand its own distribution of origins, else a fully mixed
    // dispenser.
    run.enter("start");
    std::function<double(double)> quantile = [length](double share) { return share * length; };
    if (fidelity == Fidelity::map) {
        const OriginMap& map = run.map.map_of(start);
        run.result.map_layers = map.layers;
        run.result.beds = map.beds;
        const Footprint footprint = footprint_of(run.study, start);
        bool grains = false;
        for (const Layer& layer : map.layers) grains = grains || layer.size() > 0;
        if (map.health.ok() && grains)
            quantile = [&map, footprint](double share) {
                return origin_x_quantile(map.layers, footprint.x_low, footprint.x_high, share);
            };
    }
    const bool angle_fixed =
        study.design_space.family == Family::straight && !study.design_space.angle_deg.free;
    const bool above = angle_fixed || target_rises(run.study);
    const PartitionFamily family(study.design_space, length, study.dispenser_width, {above, !above});
    const std::vector<double> p =
        family.fit_samples(closed_form_curve(run.study, family.orientation(), quantile));

    KinematicEvaluator kinematic(run.study);
    QuickMap map(run.map, run.journal);
    Evaluator& evaluator = fidelity == Fidelity::kinematic ? static_cast<Evaluator&>(kinematic)
                           : fidelity == Fidelity::map     ? static_cast<Evaluator&>(map)
                                                           : static_cast<Evaluator&>(run.full);
    run.enter("search");
    const auto stop = [&run] { return run.runner.stopped(); };
    const auto seen = [&](const Evaluation& evaluation) {
        run.record("bobyqa", evaluation, to_string(fidelity));
        if (fidelity == Fidelity::kinematic) run.journal.append(evaluation);
    };
    EvaluatorSearch found =
        search_with(evaluator, run.study, family, start, p, map_seed(study.seed, 0), budget, stop, seen);
    run.result.given_used.emplace_back("budget", fmt::format("{} -> {}", budget, found.evaluations));
    run.result.given_used.emplace_back("search", found.native);
    if (!found.best.health.ok()) {
        const std::string last = run.result.history.empty() ? "stopped before the first evaluation"
                                                            : run.result.history.back().note;
        return run.fail("No evaluation gave numbers; the last: " + last);
    }
    if (fidelity == Fidelity::map) {
        found.best = run.map.evaluate(found.best.design, 0);
        run.result.map_layers = run.map.map_of(found.best.design).layers;
    }

    // The search has seen its seeds: only unseen ones confirm. At least one, even where the search has spent
    // the budget.
    std::vector<ConfirmedDesign> rounds = {unconfirmed(found.best)};
    run.enter("confirm");
    if (!run.runner.stopped()) run.confirm(rounds.back());
    run.confirm_until_decided(rounds.back());
    KinematicEvaluator bounded(run.study, found.best.capture_fraction > 0
                                              ? std::optional(found.best.capture_fraction)
                                              : std::nullopt);
    run.result.kinematic = bounded.evaluate(found.best.design, 0);
    run.limit = fmt::format(
        "The search over '{}' ended at misfit {:.3f} and x drift {:.3f} after {} evaluations ({}).",
        to_string(fidelity), found.best.misfit.value, found.best.drift_misfit.value, found.evaluations,
        found.native);
    return run.finish(rounds);
}

}  // namespace gradwright
