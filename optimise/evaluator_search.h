// A search over one evaluator, whatever its fidelity: what it is given, what comes out, and the account that
// every method keeps in the same way.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "optimise/evaluation.h"
#include "optimise/search_space.h"

namespace gradwright {

struct SearchTask {
    Evaluator& evaluator;
    const SearchSpace& space;
    std::uint64_t seed = 0;  ///< the same for every evaluation, so that designs are compared on the same bed
    int budget = 60;         ///< evaluations
    std::function<bool()> stop = {};                   ///< looked at before every evaluation; may be empty
    std::function<void(const Evaluation&)> seen = {};  ///< told of every evaluation; may be empty
};

struct EvaluatorSearch {
    Evaluation best;  ///< of all that was evaluated; health "not_run" when nothing gave numbers
    int evaluations = 0;
    std::string termination = "not_run";  ///< converged | budget | interrupted | failed
    std::string native;                   ///< the method's own word for it
};

/// Evaluates x, tells `seen`, keeps the best sound one by objective. What comes back has the price of an
/// unsound design in its objective and, as a last residual, the root of it.
Evaluation evaluate(const SearchTask& task, const std::vector<double>& x, EvaluatorSearch& search);

}  // namespace gradwright
