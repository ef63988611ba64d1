// Both engines step by step on the same bed, every grain awake: what one core does in one second.
#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "dem/spread.h"

namespace gradwright {

struct EngineSpeedOptions {
    std::string folder;  ///< decks, data and logs, one sub-folder per state
    std::string cache_folder;
    int threads = 1, ranks = 1;
    long steps = 1000;  ///< timed, after a tenth as many that are not
    /// LAMMPS runs once with each; its best counts [m].
    std::vector<double> skins = {1e-6, 2e-6, 4e-6, 8e-6, 12e-6};
    const std::atomic<bool>* stop = nullptr;
    std::function<void(const std::string& stage, double fraction)> progress;
};

struct EngineSpeedCase {
    std::string name;                    ///< settled | flowing
    long grains = 0;                     ///< mobile, all of them awake in both
    double ours = 0;                     ///< grain-steps/s
    double lammps = 0;                   ///< the same at its best skin
    double best_skin = 0;                ///< [m]
    std::vector<double> lammps_by_skin;  ///< grain-steps/s, in the order of `skins`
    double ratio = 0;                    ///< ours / lammps
};

struct EngineSpeed {
    RunHealth health;
    std::string version;  ///< of LAMMPS
    std::vector<EngineSpeedCase> cases;
};

/// The scene's bed, levelled and raised between its walls, the blade standing where it starts. settled: at
/// rest under its weight; flowing: the same bed under ten times its weight at 60 degrees across the periodic
/// width, from the instant when it slides at the blade's speed (positions and velocities go over to LAMMPS,
/// histories of contacts do not). Law and time step of `scene`, which lammps_obstacle must pass; sides
/// periodic. Only the steps are timed: no files, no set-up, no packing. Throws LammpsError.
EngineSpeed run_engine_speed(const Scene& scene, const EngineSpeedOptions& options);

}  // namespace gradwright
