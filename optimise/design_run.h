// `design` as one call: strategy(study) -> StudyResult.
#pragma once
#include <functional>
#include <string>

#include "optimise/study_result.h"

namespace gradwright {

struct RunOptions {
    int threads = 0;
    std::string cache_folder;    ///< empty = no cache
    std::string journal_folder;  ///< one fsynced file per finished evaluation; empty = none
    int snapshots = 2;
    std::function<void(const std::string& stage, double fraction)> progress;
    const std::atomic<bool>* stop = nullptr;
};

StudyResult run_map_strategy(const Study& study, const RunOptions& options);
StudyResult run_bobyqa_strategy(const Study& study, Fidelity fidelity, int budget, const RunOptions& options);

}  // namespace gradwright
