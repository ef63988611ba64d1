// `design` as one call: strategy(study) -> StudyResult.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "optimise/study_result.h"

namespace gradwright {

/// One spread: what `run_spread` (dem/spread.h) is. A test puts a heap with a known transport kernel here.
using SpreadFunction = std::function<SpreadResult(const Scene&, const PartitionCurve*, const SpreadOptions&)>;

struct RunOptions {
    int threads = 0;
    std::string cache_folder;    ///< empty = no cache
    std::string journal_folder;  ///< one fsynced file per finished evaluation; empty = none
    std::string spread_folder;   ///< every finished spread, kept whole for a resumed run; empty = none
    bool resume = false;         ///< what stands in the two folders is this very run's beginning
    int snapshots = 3;           ///< instants kept of a labelled spread, between its first and its last
    std::function<void(const std::string& stage, double fraction)> progress;
    const std::atomic<bool>* stop = nullptr;
    SpreadFunction spread;      ///< empty = run_spread
    std::string lammps_folder;  ///< fidelity lammps: deck, data and log stay here; empty = a temporary folder
};

/// Packing seeds derived from study.seed by SplitMix64 (see design_run.cpp). Map seeds are even, confirmation
/// seeds odd, so that a confirmation can never meet a bed that the map was made from. Below 2^53: exact in
/// every JSON reader.
std::uint64_t map_seed(std::uint64_t study_seed, int index);
std::uint64_t confirmation_seed(std::uint64_t study_seed, int index);

/// The design a study starts from: fixed values, else `start`, else mid-range; the partition from
/// given_points, else straight at the start angle, else the kinematic closed form.
Design start_design(const Study& study);

/// One design at one fidelity: the `evaluate` verb. `seed` is the packing seed of the first spread; a map
/// pools study.map_spreads. `spread`, when given, takes the spread itself with its options.snapshots instants
/// (fidelity full only; else untouched).
Evaluation evaluate_once(const Study& study, const Design& design, Fidelity fidelity, std::uint64_t seed,
                         const RunOptions& options, SpreadResult* spread = nullptr);

/// The default; strategies.h has the others.
StudyResult run_map_strategy(const Study& study, const RunOptions& options);

}  // namespace gradwright
