// The outcome of `design`: what the reports, the JSON and the tests read.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "optimise/evaluation.h"
#include "optimise/heap_order.h"
#include "optimise/powder_gate.h"

namespace gradwright {

struct HistoryEntry {
    int iteration = 0;
    std::string stage;  ///< "start", "map", "confirm", "correct", or the strategy's name
    Fidelity fidelity = Fidelity::map;
    double objective = 0, misfit = 0, drift = 0;
    int spreads = 0;     ///< spent so far
    double seconds = 0;  ///< since the start
    Design design;
    std::string note;
};

struct StudyResult {
    std::string termination = "not_run";  ///< converged | budget | failed | interrupted
    std::string message;
    Verdict verdict = Verdict::undecided;
    Misfit misfit, drift_misfit;  ///< of the mean confirmed profile
    Design design;
    Evaluation predicted;                   ///< on the map, hard labels
    std::vector<Evaluation> confirmations;  ///< labelled full-width spreads on unseen packing seeds
    GradationProfile confirmed;             ///< mean of the confirmations, with band
    XDrift confirmed_drift;
    /// A target over x and y: mean field of the confirmations, and what was asked of its cells; else empty.
    GradationField confirmed_field;
    std::vector<double> field_target, field_weight;
    std::vector<double> target, weight, band_low,
        band_high;                       ///< per bin; simultaneous 95 % band of the confirmed profile
    std::optional<Evaluation> straight;  ///< the best straight partition on the same map: stated comparison
    std::optional<Evaluation> kinematic;
    std::optional<PowderGate> powder_gate;   ///< unlike powders only
    std::optional<ScaledHeap> extrapolated;  ///< studies with [scale_up]: what the numbers rest on
    /// Every [[constraint]] and limit, as the design found stands to it; a broken one is never "met".
    std::vector<ConstraintState> constraints;
    double capture_fraction = 0, supply_ratio = 0, coverage = 0, waste_fraction = 0, packing_fraction = 0,
           waste_a_share = 0;
    int spreads_map = 0, spreads_full = 0;
    std::vector<HistoryEntry> history;
    std::map<std::string, double> stage_seconds;
    double seconds = 0, seconds_cold = 0;
    std::uint64_t seed = 1;
    std::vector<std::pair<std::string, std::string>> given_used;  ///< option, "given -> used"
    std::vector<std::string> warnings;
    std::string unwritten;  ///< why the journal could not be kept, and the search was ended; empty: it was
    /// Confirmations of designs that were given up afterwards.
    std::vector<Evaluation> superseded;
    // raw material for pictures
    std::vector<Layer> map_layers;
    std::vector<Snapshot> snapshots;  ///< of the first confirmation of `design`
    std::vector<BedFacts> beds;
    std::string host_isa;
    int host_cores = 0, threads = 0;
};

}  // namespace gradwright
