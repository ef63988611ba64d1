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
    Bed bed;                         ///< levelled: z = 0 is the blade's plane
    Bed substrate;                   ///< settled powder over the platform, in the scene's frame (substrate.h)
    bool labelled = false;           ///< grains carry their own powder; else all are powder A
    double dosed_solid_volume = 0;   ///< solid above z = 0 [m3]
    std::vector<GrainSpec> fixed;    ///< rough dispenser floor, then rough fused substrate or powder's floor
    std::size_t platform_floor = 0;  ///< index in `fixed` of the first that is the platform's
    std::vector<Body> bodies;        ///< walls, lands, blade
    int blade = -1;                  ///< index of the blade in `bodies`
    int plate = -1;                  ///< of the bare plate, -1 without one

    /// Mobile grains: the bed's, then the substrate's.
    std::size_t grains() const { return bed.x.size() + substrate.x.size(); }
    double radius(std::size_t grain) const {
        return grain < bed.x.size() ? bed.radius[grain] : substrate.radius[grain - bed.x.size()];
    }
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

/// How far below z = 0 the lowest floor ever lies: the dispenser's in the first pass, the platform's in the
/// last [m].
double deepest_floor(const Scene& scene);

/// Mean kinetic energy times grains below which a spread has come to rest: 1e-3 m g d per grain [J].
double quiet_energy(const Scene& scene, std::size_t grains);

/// F_po/(m g) of the median grain of powder A between its equals; `work_of_adhesion` scaled [J/m2].
double bond_number(const Scene& scene, double work_of_adhesion);

/// A mobile grain at the end of a pass. y unwrapped when periodic [m].
struct GrainPlace {
    std::size_t bed_index = 0;  ///< into Stage::bed, and behind its end into Stage::substrate
    double x = 0, y = 0, z = 0;
};

/// Where a grain stands when a pass begins: only what stands ahead of the platform can be laid in the pass.
enum class Stand : std::uint8_t { gone, ahead, on_platform };

/// What a pass begins with.
struct Pass {
    int number = 1;                  ///< from 1
    double floor_rise = 0;           ///< of the dispenser's floor since the first pass [m]
    double gap = 0;                  ///< from the plane under this layer to the blade's edge [m]
    double dosed_solid_volume = 0;   ///< Layer::dosed_solid_volume
    double raised_solid_volume = 0;  ///< PassFacts::raised_solid_volume
    std::vector<Stand> stand;        ///< by GrainPlace::bed_index
};
Pass first_pass(const Scene& scene, const Stage& stage);

/// The laid layer (physics.md 5): grains laid in this pass whose centre is over the platform and below z = 0,
/// each with its origin in the dispenser before the first pass; the substrate and earlier layers never count.
/// `places`: the grains still there, ascending bed_index; what is missing has gone over the end, and what
/// stood ahead of the platform counts as overflow. Warns in `health` of a moving bed floor (last pass) and of
/// a heap that ran dry; sets "starved" when nothing was laid.
Layer measure_layer(const Scene& scene, const Stage& stage, const Pass& pass,
                    std::span<const GrainPlace> places, RunHealth& health);
/// Of the only pass.
Layer measure_layer(const Scene& scene, const Stage& stage, std::span<const GrainPlace> places,
                    RunHealth& health);
/// Solid of the substrate and of earlier layers that the pass took over the platform's end [m3].
double carried_off_solid(const Scene& scene, const Stage& stage, const Pass& pass,
                         std::span<const GrainPlace> places);

/// Solid of this pass over the platform that stands above the blade's edge [m3].
double proud_solid(const Scene& scene, const Stage& stage, const Pass& pass,
                   std::span<const GrainPlace> places);

/// Spreads a stage, all its passes: from the levelled bed to the last layer. Grains past the second land's
/// end leave the run.
SpreadResult spread_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options);

}  // namespace gradwright
