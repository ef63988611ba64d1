// The process as named functions: pack -> label -> level -> dose -> spread -> Layer. One call does all of it.
#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dem/energy_ledger.h"
#include "dem/layer.h"
#include "dem/scene.h"

namespace gradwright {

struct Progress {
    std::string stage;    ///< "pack", "settle", "spread", "spread layer 2 of 3"
    double fraction = 0;  ///< 0..1 of that stage
};

struct SpreadOptions {
    int threads = 0;  ///< 0 = OpenMP's default
    /// Of the machine, that this spread has while others run beside it: its seconds count so much.
    double machine_share = 1;
    std::string cache_folder;  ///< settled beds; empty = no cache
    int snapshots = 0;  ///< instants of the last pass kept between first and last; 0 = none but those two
    std::function<void(const Progress&)> progress;
    bool energy_account = false;              ///< fill SpreadResult::energy: no sleep, several times slower
    const std::atomic<bool>* stop = nullptr;  ///< set by a signal: the run ends with status "interrupted"
};

struct BedFacts {
    double packing_fraction = 0, mean_coordination = 0, max_overlap_ratio = 0;
    double speed_number = 0;          ///< max speed / sqrt(g D50)
    double carried_weight_ratio = 0;  ///< floor and wall forces over weight; accepted within 1 %
    long steps = 0;
    bool from_cache = false;
    double seconds = 0, seconds_cold = 0;
    std::vector<double> made_d10_d50_d90;  ///< [m]
};

/// What only passes over powder, or several of them, have to tell.
struct PassFacts {
    double raised_solid_volume = 0;       ///< above z = 0 ahead of the platform when the pass began [m3]
    double carried_off_solid_volume = 0;  ///< of substrate and earlier layers, taken over the end [m3]
    /// Of grains over the platform whose centre stands above the blade's edge: not laid, but the next pass
    /// over a fused substrate begins without them [m3].
    double proud_solid_volume = 0;
};

struct SpreadResult {
    RunHealth health;
    Layer layer;                    ///< the last one laid
    std::vector<Layer> earlier;     ///< those laid before it, the first first; empty with one layer
    std::vector<PassFacts> passes;  ///< one a layer; empty for one layer on fused metal or a plate
    BedFacts bed;
    std::vector<Snapshot> snapshots;  ///< first = levelled and raised bed, last = the end
    long grains = 0;                  ///< mobile grains in the spread, a powder substrate's too
    long fixed_grains = 0;
    long pinched_grains = 0;  ///< pressed into the yielding blade by more than 5 % of their radius, mostly at
                              ///< the dispenser's rim
    long steps = 0;
    double grain_steps = 0;      ///< awake grain-steps: forces evaluated
    double all_grain_steps = 0;  ///< steps x mobile grains, sleeping ones included
    double time_step = 0;        ///< [s]
    double bond_number = 0;      ///< F_po/(m g) of the median grain, as computed
    /// Wall times share of the machine; cold adds the stored cost of what came from a cache [s].
    double seconds = 0, seconds_cold = 0;
    std::string state_hash;  ///< of positions and velocities at the end, of every pass
    EnergyLedger energy;     ///< of the spread, from the blade's start; with `energy_account`
};

/// One spread. `partition`: null = no labels (all grains have powder A's material and sizes: an origin-map
/// run); else chamber A is filled with powder A on the curve's left and B on its right, each with its own
/// material. Physical failure is a status in `health`, not an exception; the curve and scene must have been
/// validated.
SpreadResult run_spread(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options);

/// What `check` tells before anything runs.
struct SceneCost {
    double grains = 0, fixed_grains = 0, steps = 0, grain_steps = 0, memory_bytes = 0;
};
SceneCost estimate_cost(const Scene& scene);
double rayleigh_time_step(double radius, double density, double shear_modulus, double poissons_ratio);

/// Problems that make a scene impossible or doubtful; empty when sound.
struct SceneProblem {
    bool fatal = false;
    std::string text;  ///< says the numbers, the rule and the knob
};
std::vector<SceneProblem> validate(const Scene& scene);

}  // namespace gradwright
