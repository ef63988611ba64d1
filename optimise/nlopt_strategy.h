// NLopt over any evaluator: partition parameters and free motion variables in one box (bounded_search.h says
// which method is for what).
#pragma once
#include "optimise/bounded_search.h"
#include "optimise/evaluator_search.h"

namespace gradwright {

/// Minimises Evaluation::objective. Evaluations without numbers count as kNotEvaluable.
EvaluatorSearch search_with(SearchMethod method, const SearchTask& task);

}  // namespace gradwright
