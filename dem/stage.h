// The stage of one spread: the levelled and raised bed, the fixed rough grains and the bodies of the machine.
// That, and the measurement of the layer from where the grains end, is what any engine needs to spread a
// scene: ours (process.cpp) and an outside one (optimise/lammps_spread.cpp) read the same stage and hand back
// the same kind of places.
#pragma once
#include <span>
#include <vector>

#include "dem/bed.h"
#include "dem/layer.h"

namespace gradwright {

/// Front face of the blade before it moves: clear of the powder [m].
inline constexpr double kBladeStart = -20e-6;
inline constexpr double kFar = 1.0;  ///< depth of the solid bodies: beyond any scene [m]

struct Stage {
    Bed bed;                        ///< levelled: z = 0 is the blade's plane
    bool labelled = false;          ///< grains carry their own powder; else all are powder A
    double dosed_solid_volume = 0;  ///< solid above z = 0 [m3]
    std::vector<GrainSpec> fixed;   ///< rough dispenser floor, rough fused substrate
    std::vector<Body> bodies;       ///< walls, lands, blade
    int blade = -1;                 ///< index of the blade in `bodies`
};

/// Pack (or take from the cache), level, dose, build the machine (physics.md 1.1-1.4). `health` is "ok", or
/// says why there is no stage.
Stage set_stage(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
                RunHealth& health);

/// Where the platform begins and ends [m].
inline double platform_start(const Scene& scene) {
    return scene.dispenser_length + scene.land;
}
inline double platform_end(const Scene& scene) {
    return platform_start(scene) + scene.platform_length;
}

/// Mean kinetic energy times grains below which a spread has come to rest: 1e-3 m g d per grain [J].
double quiet_energy(const Scene& scene, std::size_t grains);

/// F_po/(m g) of the median grain of powder A between its equals; `work_of_adhesion` scaled [J/m2].
double bond_number(const Scene& scene, double work_of_adhesion);

/// A mobile grain at the end of a spread. y unwrapped when periodic [m].
struct GrainPlace {
    std::size_t bed_index = 0;  ///< into Stage::bed
    double x = 0, y = 0, z = 0;
};

/// The laid layer (physics.md 5): mobile grains whose centre is over the platform and below z = 0, each with
/// its origin. `places`: the grains still there, ascending bed_index; what is missing has gone over the end
/// and counts as overflow. Warns in `health` of a moving bed floor and of a heap that ran dry; sets "starved"
/// when nothing was laid.
Layer measure_layer(const Scene& scene, const Stage& stage, std::span<const GrainPlace> places,
                    RunHealth& health);

/// Spreads a stage: from the levelled bed to the layer. Grains past the second land's end leave the run.
SpreadResult spread_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options);

}  // namespace gradwright
