// The settled bed: packed by DEM in the raised dispenser, kept by value so that a cached bed and a fresh one
// give the same bits.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "dem/engine.h"
#include "dem/scene.h"
#include "dem/spread.h"

namespace gradwright {

/// Grains of a settled, not yet levelled bed. Floor's mean plane at z = -floor_depth(), so z = 0 is already
/// the blade's plane.
struct Bed {
    std::vector<double> x, y, z, radius;  ///< [m]
    std::vector<std::uint8_t> material;   ///< 0 = A, 1 = B
    BedFacts facts;
};

/// Index of the wall material in EngineOptions::materials (0 = A, 1 = B).
inline constexpr int kWallMaterial = 2;

/// Engine options of a scene: materials, law, time step, sides.
EngineOptions engine_options(const Scene& scene, int threads);
/// T_R of the scene's smallest grain times rayleigh_fraction [s].
double scene_time_step(const Scene& scene);

/// Rough fixed surface: a triangular lattice of spheres of diameter `roughness`, heights jittered by a tenth
/// of it, over [x0, x1] x [0, width], mean surface plane at `plane` (a close lattice of half spheres has it
/// 0.395 r below their tops).
std::vector<GrainSpec> rough_surface(double x0, double x1, double width, double plane, double roughness,
                                     std::uint64_t seed);

/// End walls x = 0 and x = L_d of the dispenser, full height: for beds that stand, not for spreading.
void add_end_walls(Engine& engine, const Scene& scene);

/// The bed's grains; `labelled`: each with its own material, else all with powder A's.
void add_bed(Engine& engine, const Bed& bed, bool labelled);

/// Side walls y = 0, W of a scene as bodies (none when periodic).
std::vector<Body> side_walls(const Scene& scene);
void add_side_walls(Engine& engine, const Scene& scene);

/// Solid volume of spheres between two heights [m3], exact.
double solid_between(const std::vector<double>& z, const std::vector<double>& radius, double low,
                     double high);

/// Pack and settle (physics.md 1.1, 1.2): pour, settle, with labels and the plate when asked for. `health`
/// says why when it fails.
Bed pack_bed(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
             RunHealth& health);

/// pack_bed behind a cache: key = scene bytes + partition + seed + engine format number. A damaged file is
/// made anew.
Bed cached_bed(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
               RunHealth& health);

}  // namespace gradwright
