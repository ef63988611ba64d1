#include "optimise/nlopt_strategy.h"

namespace gradwright {

EvaluatorSearch search_with(SearchMethod method, const SearchTask& task) {
    BoundedSearch search;
    search.method = method;
    search.low = task.space.low();
    search.high = task.space.high();
    search.start = task.space.start();
    search.step = task.space.step();
    search.budget = task.budget;
    search.x_tolerance = 1e-4;
    search.seed = task.seed;
    search.stop = task.stop;

    EvaluatorSearch result;
    const BoundedSearchResult found = minimise(
        [&](const std::vector<double>& x) {
            const Evaluation evaluation = evaluate(task, x, result);
            return evaluation.health.ok() ? evaluation.objective : kNotEvaluable;
        },
        search);
    result.termination = found.termination;
    result.native = found.native;
    return result;
}

}  // namespace gradwright
