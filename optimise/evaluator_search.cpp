#include "optimise/evaluator_search.h"

#include <cmath>

namespace gradwright {

Evaluation evaluate(const SearchTask& task, const std::vector<double>& x, EvaluatorSearch& search) {
    Evaluation evaluation = task.evaluator.evaluate(task.space.design(x), task.seed);
    ++search.evaluations;
    if (task.seen) task.seen(evaluation);
    // what cannot be bent is no candidate, and costs the more the tighter it is
    const double unsound = task.space.unsound(x);
    evaluation.objective += unsound;
    const bool first = !search.best.health.ok();
    // a limit that is kept comes before a better gradation
    const bool kept = broken(limit_states(task.space.study(), evaluation)) == 0;
    const bool best_kept = !first && broken(limit_states(task.space.study(), search.best)) == 0;
    const bool better = kept != best_kept ? kept : evaluation.objective < search.best.objective;
    if (unsound == 0 && evaluation.health.ok() && (first || better)) search.best = evaluation;
    const double detour = task.space.detour(x);
    evaluation.objective += detour;
    if (!evaluation.residuals.empty()) evaluation.residuals.push_back(std::sqrt(unsound + detour));
    return evaluation;
}

}  // namespace gradwright
