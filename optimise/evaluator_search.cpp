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
    if (!evaluation.residuals.empty()) evaluation.residuals.push_back(std::sqrt(unsound));
    const bool first = !search.best.health.ok();
    if (unsound == 0 && evaluation.health.ok() && (first || evaluation.objective < search.best.objective))
        search.best = evaluation;
    return evaluation;
}

}  // namespace gradwright
