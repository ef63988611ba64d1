// `compare STUDY`: several strategies on one study, each within the same budget, each one's best design then
// judged by the same number of labelled full-width spreads on the same beds, which none of them has seen.
//
// What is equal: spreads in all (a strategy's own confirmations are among them: they belong to its way to a
// design), bed of every search (the study's first map seed), beds of the judgement. What is not: where the
// fidelity is map or kinematic an evaluation costs no spread, and `evaluations` bounds the search instead.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "optimise/strategies.h"

namespace gradwright {

struct ComparisonOptions {
    std::vector<std::string> strategies;  ///< names of strategy_names(), each once
    int budget = 0;  ///< spreads that each may spend in all, >= 2 and <= kMostCompared; 0 = study.max_spreads
    Fidelity fidelity = Fidelity::full;  ///< of the strategies that have a choice: kinematic, map or full
    int evaluations = 60;                ///< of those, where the fidelity is not full
    int confirmations = 2;               ///< spreads that judge each strategy's best design, >= 1
    RunOptions run;
    /// Each strategy's journal is in this folder's subfolder of its name; empty = none.
    std::string folder;
    /// Told after each strategy with all that `design` would have reported.
    std::function<void(const std::string& name, const StudyResult& result)> after_strategy;
};
/// Beds of the judgement have seed numbers from here on: beyond any that a strategy could have used.
inline constexpr int kMostCompared = 1000;

struct ComparedStrategy {
    std::string name;
    std::string termination = "not_run";  ///< of the strategy, as StudyResult
    std::string native;                   ///< its method's own word; empty for map
    std::string reason;                   ///< why there is no confirmed misfit; empty: there is one
    int spreads_map = 0, spreads_full = 0;
    double seconds = 0, seconds_cold = 0;  ///< of the strategy without the judgement [s]
    Design design;
    Verdict own_verdict = Verdict::undecided;  ///< by its own confirmations
    // by the judgement
    int confirmations = 0;  ///< spreads with numbers
    GradationProfile confirmed;
    Misfit misfit, drift_misfit;
    Verdict verdict = Verdict::undecided;
};

struct StrategyComparison {
    std::string status = "ok";  ///< ok | interrupted
    Fidelity fidelity = Fidelity::full;
    int budget = 0, evaluations = 0, confirmations = 0;
    std::vector<std::uint64_t> seeds;  ///< beds of the judgement
    std::vector<ComparedStrategy> strategies;
};

/// Throws std::invalid_argument for options outside their ranges.
StrategyComparison compare_strategies(const Study& study, const ComparisonOptions& options);

}  // namespace gradwright
