#include "optimise/strategy_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "optimise/confirmation.h"
#include "optimise/dem_evaluator.h"

namespace gradwright {
namespace {

void refuse(const ComparisonOptions& options, int budget) {
    const std::vector<std::string>& names = strategy_names();
    if (options.strategies.empty()) throw std::invalid_argument("compare: no strategy is named");
    for (auto name = options.strategies.begin(); name != options.strategies.end(); ++name) {
        if (std::find(names.begin(), names.end(), *name) == names.end())
            throw std::invalid_argument("compare: there is no strategy '" + *name + "'");
        if (std::find(options.strategies.begin(), name, *name) != name)
            throw std::invalid_argument("compare: strategy '" + *name + "' is named twice");
    }
    if (budget < 2 || budget > kMostCompared)
        throw std::invalid_argument(
            fmt::format("compare: a budget of {} spreads lies outside 2 to {}: one "
                        "to search with, one to confirm",
                        budget, kMostCompared));
    if (options.confirmations < 1 || options.evaluations < 1)
        throw std::invalid_argument("compare: at least one confirmation and one evaluation");
    if (options.fidelity == Fidelity::lammps)
        throw std::invalid_argument("compare: fidelity lammps is a witness, not a search");
}

void judge_best(const Study& study, const RunOptions& options, const std::vector<std::uint64_t>& seeds,
                ComparedStrategy& row) {
    SpreadRunner runner(options);
    Journal journal(options.journal_folder);
    DemEvaluator full(study, runner, &journal);
    ConfirmedDesign best;
    for (const std::uint64_t seed : seeds) {
        const Evaluation evaluation = full.evaluate(row.design, seed);
        if (!evaluation.health.ok()) {
            row.reason = fmt::format("{}: {}", evaluation.health.status, evaluation.health.reason);
            continue;
        }
        // Held against no prediction: equality with one is the strategy's own concern.
        if (best.confirmations.empty()) best = unconfirmed(evaluation);
        best.confirmations.push_back(evaluation);
    }
    row.confirmations = int(best.confirmations.size());
    if (row.confirmations == 0) return;
    // A row that rests on fewer beds than the others says so in `confirmations`, not in `reason`.
    row.reason.clear();
    summarise(study, best);
    row.confirmed = best.mean;
    row.misfit = best.misfit;
    row.drift_misfit = best.drift_misfit;
    row.verdict = best.verdict;
}

}  // namespace

StrategyComparison compare_strategies(const Study& given, const ComparisonOptions& options) {
    Study study = given;
    if (options.budget > 0) study.max_spreads = options.budget;
    refuse(options, study.max_spreads);
    StrategyComparison comparison;
    comparison.fidelity = options.fidelity;
    comparison.budget = study.max_spreads;
    comparison.evaluations = options.fidelity == Fidelity::full ? study.max_spreads - 1 : options.evaluations;
    comparison.confirmations = options.confirmations;
    for (int i = 0; i < options.confirmations; ++i)
        comparison.seeds.push_back(confirmation_seed(study.seed, kMostCompared + i));
    for (const std::string& name : options.strategies) {
        comparison.strategies.emplace_back();
        comparison.strategies.back().name = name;
    }
    const auto stopped = [&] { return options.run.stop && options.run.stop->load(); };
    for (ComparedStrategy& row : comparison.strategies) {
        if (stopped()) break;
        RunOptions run = options.run;
        if (run.progress)
            run.progress = [&options, &row](const std::string& stage, double fraction) {
                options.run.progress(row.name + ": " + stage, fraction);
            };
        if (!options.folder.empty()) run.journal_folder = options.folder + "/" + row.name + "/journal";
        const StudyResult result =
            run_strategy(study, {row.name, options.fidelity, comparison.evaluations}, run);
        row.termination = result.termination;
        for (const auto& [option, used] : result.given_used)
            if (option == "search") row.native = used;
        row.spreads_map = result.spreads_map;
        row.spreads_full = result.spreads_full;
        row.seconds = result.seconds;
        row.seconds_cold = result.seconds_cold;
        row.design = result.design;
        row.own_verdict = result.verdict;
        if (options.after_strategy) options.after_strategy(row.name, result);
        if (stopped()) {
            row.reason = "interrupted";
            break;
        }
        if (row.design.partition.points.empty()) {
            row.reason = result.message;
            continue;
        }
        if (!options.folder.empty()) run.journal_folder = options.folder + "/" + row.name + "/judgement";
        judge_best(study, run, comparison.seeds, row);
    }
    if (stopped()) comparison.status = "interrupted";
    return comparison;
}

}  // namespace gradwright
