// The contact law of two engines, contact by contact: pairs and wall contacts whose grains LAMMPS is told to
// hold at given positions, velocities and spins, and the same contacts through contact_law.h. Nothing moves
// but what is moved on purpose, so the forces are functions of what is written in the deck, and differences
// are differences of the law or of its conversion (lammps_law.h), not of an integrator.
//
// Stages: held still in motion (springs empty: elastic and damping force at once) -> some hundred steps at
// constant relative velocity (springs grow, some slip) -> motion taken away (what is left is elastic). Ours
// runs with SlidingConvention::lammps, the law in double precision; walls as plain Hertz walls with |F_n| as
// the cap.
#pragma once
#include <string>
#include <vector>

#include "dem/scene.h"
#include "optimise/lammps_run.h"

namespace gradwright {

/// What was compared, over all contacts of a kind.
struct TwoBodyCase {
    std::string name;      ///< "pair, elastic normal force"
    int contacts = 0;      ///< compared
    double error = 0;      ///< largest relative difference; scale in `scale`
    std::string scale;     ///< what it is relative to
    bool decisive = true;  ///< counts for TwoBodyResult::max_relative_error: pair forces before sliding
};

struct TwoBodyResult {
    std::vector<TwoBodyCase> cases;
    double max_relative_error = 0;  ///< over decisive cases
    /// Stretched bonds (delta < 0) compared, and how many of them LAMMPS still had after a neighbour rebuild.
    int bonds_stretched = 0, bonds_kept = 0;
    /// Bonds stretched further than LAMMPS lets them (kLammpsTearOff) but not yet torn by ours, and how many
    /// of them LAMMPS held nevertheless.
    int bonds_beyond = 0, bonds_held_beyond = 0;
    std::string version;
    double seconds = 0;
    bool interrupted = false;  ///< stopped before LAMMPS had answered: no cases
};

/// LAMMPS lets go of a bond where the pull is largest (s^3 = 3/4), which is where it breaks under a dead
/// load; between grains that are drawn apart it lives on to s_c^3 = 1/4. Share of that tear-off overlap: (s -
/// s^4) at the one over (s - s^4) at the other.
inline constexpr double kLammpsTearOff = 0.48075;

/// Tolerance of every case: both compute in double precision.
inline constexpr double kTwoBodyTolerance = 1e-9;

/// Compares the law of `scene` (materials, walls, softening, interaction) between the engines. Deck, data and
/// dumps go to `folder`. `ours`: another scene for our side alone, to see that a difference is seen; null:
/// the same. Throws LammpsError.
TwoBodyResult compare_two_body(const Scene& scene, const std::string& folder, const Scene* ours = nullptr,
                               const std::atomic<bool>* stop = nullptr);

}  // namespace gradwright
