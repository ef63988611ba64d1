// The engine's own speed: settled and flowing beds of the default study's physics, by stage.
#pragma once
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "dem/scene.h"

namespace gradwright {

struct BenchOptions {
    std::vector<double> grains = {20000};  ///< wanted sizes, mobile grains
    std::vector<int> threads = {1};
    std::vector<std::string> states = {"settled"};  ///< settled | flowing | spread
    long steps = 2000;                              ///< timed steps a case
    /// Beds of more grains are copies of a smaller one side by side: it is periodic across, so they meet
    /// without a seam, and a million grains need not be settled. Not for "spread".
    double largest_packed = 40000;
    Scene scene;               ///< physics: powders, law, time step; lengths are chosen from the size
    std::string cache_folder;  ///< settled beds
    std::function<void(const std::string& stage, double fraction)> progress;
};

struct BenchCase {
    std::string name;  ///< of the state
    long grains = 0;
    int threads = 1;
    double grain_steps_per_second = 0;  ///< grains whose forces were evaluated
    double awake_share = 1;             ///< grain-steps / (steps x mobile grains); 1 but for "spread"
    double seconds = 0;
    std::map<std::string, double> stages;  ///< seconds: law, grains, near_list, candidates
    double bytes_per_grain = 0;
    double contacts_per_grain = 0;
    double steps_per_near_list = 0, steps_per_candidate_list = 0;  ///< infinite: none was made
    int steps_at_once = 1;            ///< that a bed beyond the cache goes through together
    double near_pairs_per_grain = 0;  ///< pairs that the law sees, touching or not
    /// A cache line from one thread's core to another's and back, at the time of this case [s]; NaN for one
    /// thread. What two threads gain on a small heap depends on it.
    double core_round_trip = std::numeric_limits<double>::quiet_NaN();
    std::string state_hash;
};

struct BenchResult {
    int cores = 0;
    std::string isa;  ///< instruction set the program was compiled for
    std::vector<BenchCase> cases;
};

BenchResult run_bench(const BenchOptions& options);

/// Instruction set this program was compiled for: "AVX-512", "AVX2", ...
std::string compiled_isa();

}  // namespace gradwright
