// What a study will cost before anything runs: estimates for `check`, kept apart from printing so that tests
// can call them.
#pragma once
#include <string>
#include <vector>

#include "optimise/study.h"

namespace gradwright::cli {

/// Grain-steps per second and core assumed when no other figure is given [1/s]: half of what a core with
/// AVX-512 does on a heap before the blade in the default study's physics (docs/speed-against-error.md).
/// `gradwright bench` measures the machine at hand.
inline constexpr double kAssumedSpeed = 20e6;
/// Packing of a settled bed assumed before one has been packed [-]: loose random packing of frictional
/// grains.
inline constexpr double kAssumedBedPacking = 0.55;

/// One kind of spread of a study.
struct SpreadEstimate {
    std::string name;  ///< "map strip" | "full width"
    SceneCost cost;
    double seconds = 0;  ///< on `threads` cores at the assumed speed, no sleeping grains, nothing cached [s]
    int at_most = 0;     ///< spreads of this kind within the study's budget
    std::vector<SceneProblem> problems;
};

struct StudyEstimate {
    std::vector<SpreadEstimate> spreads;
    double supply_ratio = 0;          ///< with the assumed bed packing [-]
    double seconds_at_most = 0;       ///< every spread of the budget [s]
    double memory_bytes = 0;          ///< of the largest spread
    double dose_height = 0, gap = 0;  ///< [m]
    double packed_depth = 0;          ///< of the bed below the rim in the first pass [m]
    int partition_variables = 0, motion_variables = 0;
};

StudyEstimate estimate(const Study& study, int threads);

/// Warnings of the study and of its scenes, each once.
std::vector<std::string> all_warnings(const Study& study, const StudyEstimate& estimate);

/// Throws InputError with everything that forbids a spread: fatal scene problems, a dose that starves the
/// layer.
void refuse_impossible(const Study& study, const StudyEstimate& estimate);

}  // namespace gradwright::cli
