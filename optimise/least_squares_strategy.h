// Levenberg-Marquardt (Ceres) on Evaluation::residuals of any evaluator, with derivatives of our own.
//
// A spread is noisy in its design: one grain more on A's side moves a bin by a step. Ceres' own numeric
// differences step by about 1e-6 and would differentiate that noise. Ours step by a stated share of each
// variable's range:
//   dr/dx_i = (r(x + h_i) - r(x - h_i)) / 2 h_i        h_i = difference_step (high_i - low_i)
// and every evaluation has the same seed (common random numbers), so that what all designs share of a bed's
// chance cancels in the difference. Where x +- h_i would leave the box, or gave no numbers, the other side is
// taken with r(x); where neither is there the variable rests for this iteration.
//
// The cost is 2 n + 1 evaluations an iteration for n free variables. Where the budget left does not pay for
// central differences and a step to use them, one-sided ones are taken (n evaluations, error of first order
// in h); where it does not pay for these either, the search ends: a derivative that no step can follow is not
// bought.
//
// The residuals are misfit and drift, always as squares: price of waste and missing coverage, which are in
// the objective, steer the choice of the best but not the steps. With free motion variables and a dear waste
// take bobyqa.
#pragma once
#include "optimise/evaluator_search.h"

namespace gradwright {

struct LeastSquaresOptions {
    /// Of a variable's range, 0.03 to 0.10: below it the step drowns in the noise of single grains, above it
    /// the curve's bend. Outside: std::invalid_argument.
    double difference_step = 0.05;
    int iterations = 50;
};

/// `best` by Evaluation::objective of all that was evaluated, differences included. Throws what the evaluator
/// throws.
EvaluatorSearch least_squares_with(const LeastSquaresOptions& options, const SearchTask& task);

}  // namespace gradwright
