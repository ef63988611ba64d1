// Multi-fidelity search: the origin map, which costs milliseconds, corrected by few spreads with both
// powders, within a trust region (approximation and model management: Alexandrov, Dennis, Lewis, Torczon,
// Structural Optimization 15 (1998) 16).
//
//   F(x)   objective of a full spread, every one on the same bed (common random numbers)
//   m_k(x) objective of map(x) + (full(x_k) - map(x_k)), profile and drift bin by bin, so that m_k(x_k) =
//   F(x_k) x_0    the map's own optimum, uncorrected trial  argmin m_k over the box of half width Delta_k
//   around x_k, in shares of each variable's range rho    (F(x_k) - F(trial)) / (m_k(x_k) - m_k(trial)),
//   actual over predicted reduction
// The trial becomes x_{k+1} when F went down; Delta grows twofold when rho > 0.75 and the step used its room,
// and becomes half of the step taken when rho < 0.25.
//
// How it differs from the strategy `map`: `map` takes its spreads on beds that the search never saw, asks a
// chi-squared test whether they contradict the map at all, and then aims at a target shifted by the smoothed
// difference, however far that leads. Here every full spread is a measurement of the function to be
// minimised: nothing is accepted that a spread has not shown to be better, and no step is longer than the map
// has proved good for. That is the right tool where map and spread differ by more than a shift (unlike
// powders); for like powders it needs more spreads than `map`, and it fits the one bed's chance, which the
// confirmation on unseen beds then tells.
//
// The correction is additive and of order zero: values agree at x_k, slopes need not. So it can come to rest
// beside the optimum of F, where the map's slope is worth nothing; Delta below its resolution then ends it.
#pragma once
#include "optimise/evaluator_search.h"

namespace gradwright {

struct MultiFidelityOptions {
    double radius = 0.15;           ///< Delta_0 [share of the range], > 0
    double smallest_radius = 0.01;  ///< below it the search has converged: 32 um in y on the coupon, a grain
    double least_reduction = 1e-3;  ///< predicted by less: converged [GI units]; far below any noise floor
    int model_evaluations = 300;    ///< of the map, for each trial
};

struct MultiFidelitySearch : EvaluatorSearch {
    int accepted = 0, rejected = 0;
    double radius = 0;                  ///< at the end
    std::vector<double> model_optimum;  ///< x_0, also where no full spread could be paid
};

/// `task`: the full spreads and their budget. `map`: the same study's cheap model; its evaluations are
/// neither counted nor told. Ends "converged" by Delta or predicted reduction, "failed" when the first spread
/// gave no numbers.
MultiFidelitySearch multi_fidelity_search(const MultiFidelityOptions& options, const Study& study,
                                          const SearchTask& task, Evaluator& map);

}  // namespace gradwright
