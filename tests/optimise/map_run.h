#pragma once
#include "tests/optimise/synthetic_heap.h"

namespace gradwright::testing_heap {

/// The map strategy on a heap, and what it asked of it.
struct Outcome {
    StudyResult result;
    std::shared_ptr<Calls> calls = std::make_shared<Calls>();
};
inline Outcome run(const Study& study, const Heap& heap, RunOptions options = {}) {
    Outcome outcome;
    options.spread = engine(heap, outcome.calls);
    outcome.result = run_map_strategy(study, options);
    return outcome;
}

}  // namespace gradwright::testing_heap
