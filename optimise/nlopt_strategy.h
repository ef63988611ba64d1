// NLopt BOBYQA over any evaluator: partition parameters and free motion variables in one box.
#pragma once
#include "optimise/design_run.h"
#include "optimise/partition_family.h"

namespace gradwright {

struct EvaluatorSearch {
    Evaluation best;  ///< of all that was evaluated; health "not_run" when nothing gave numbers
    int evaluations = 0;
    std::string termination, native;  ///< as BoundedSearchResult
};

/// Minimises Evaluation::objective from `start` (its motion variables) and `p` (the family's parameters).
/// Every evaluation has the same seed, so that designs are compared on the same bed. `seen` is called after
/// each. Evaluations without numbers count as kNotEvaluable.
EvaluatorSearch search_with(Evaluator& evaluator, const Study& study, const PartitionFamily& family,
                            const Design& start, const std::vector<double>& p, std::uint64_t seed, int budget,
                            const std::function<bool()>& stop,
                            const std::function<void(const Evaluation&)>& seen);

}  // namespace gradwright
