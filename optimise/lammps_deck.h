// A stage (dem/stage.h) as a LAMMPS deck and data file. The deck is for people too: it says how it was made
// and how to run it by hand with another skin.
#pragma once
#include <string>
#include <vector>

#include "dem/stage.h"

namespace gradwright {

struct LammpsDeckOptions {
    int ranks = 1;
    /// Blade positions at which the grains are dumped on the way: rising, between kBladeStart and the
    /// platform's end [m].
    std::vector<double> shots;
    bool rigid_blade = false;  ///< as hard as the other walls: pinched grains are shot (see wall_softening)
};

// Names of the files in the deck's folder.
inline constexpr const char* kLammpsDeck = "in.spread";
inline constexpr const char* kLammpsBed = "bed.data";
inline constexpr const char* kLammpsFinal = "final.dump";
inline constexpr const char* kLammpsWay = "way.txt";  ///< of the blade, in all [m]
std::string lammps_shot_file(std::size_t shot);       ///< "shot-1.dump", ...

/// Why a deck of this scene cannot be written; empty when it can.
std::string lammps_obstacle(const Scene& scene);

/// The deck: machine, law, motion, end condition of `scene`, as run by process.cpp.
std::string lammps_deck(const Scene& scene, const Stage& stage, const LammpsDeckOptions& options);
/// The data file: fixed grains first (ids 1..F), then the bed's grains (F + 1 + bed index).
std::string lammps_bed(const Scene& scene, const Stage& stage);

/// Blade position -> time step of the deck, nearest whole step.
long lammps_step(const Scene& scene, double blade_x);
/// Steps until the blade reaches the platform's end: what `progress` is measured by.
long lammps_way_steps(const Scene& scene);

}  // namespace gradwright
