// Scene: everything one spread needs, as plain SI numbers. Constant while a run lives; hashable.
// Frame (physics.md 1): x = spreading direction, y = across (graded), z = up; z = 0 is the blade edge = rim =
// lands.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dem/material.h"
#include "dem/partition.h"
#include "dem/size_distribution.h"

namespace gradwright {

/// What the first layer is laid on. Later layers lie on fused metal again, else on the powder before them.
enum class Substrate { fused, plate, powder };
enum class Sides { periodic, frictional, frictionless };
enum class Precision {
    single_law,
    double_law
};  ///< number type of the contact law; integration is always double

struct Powder {
    Material material;
    SizeDistribution size;
};

struct Scene {
    // machine
    double dispenser_length = 3.2e-3;  ///< L_d [m]
    double width = 1.6e-3;             ///< W modelled (strip or full) [m]
    double bed_depth = 120e-6;         ///< powder modelled below z = 0 after raising [m]
    double dispenser_depth = 1e-3;     ///< real depth of the well [m] (only reported against bed_depth)
    double land = 3.2e-3;              ///< between dispenser and platform [m]
    double platform_length = 3.2e-3;   ///< L_b [m]
    double second_land = 2e-3;         ///< behind the platform, then the overflow [m]
    double blade_tip_radius = 0;       ///< [m]
    double blade_thickness = 1e-3;     ///< [m]
    double blade_speed = 0.1;          ///< [m/s]
    // process
    double dose_height = 120e-6;  ///< h, rise of the dispenser floor [m]
    std::array<double, 2> headspace = {
        0, 0};                       ///< c of chamber A, B below the rim before raising [m], 0 <= c < h
    double gap = 143e-6;             ///< substrate mean plane to blade edge [m]
    double layer_thickness = 40e-6;  ///< [m]
    Substrate substrate = Substrate::fused;
    /// Substrate::powder: share of powder A, by solid volume, in the settled powder under the first layer.
    double substrate_share_a = 1;
    int layers = 1;            ///< doses and passes, one after the other (next_pass.h), >= 1
    double roughness = 40e-6;  ///< diameter of the fixed grains of a fused substrate and of the bed floor [m]
    Sides sides = Sides::periodic;
    /// Share of powder A, by solid volume, in what is filled into chamber A and B: {1, 0} = pure powders.
    std::array<double, 2> share_a = {1, 0};
    double plate_thickness = 0;  ///< t of the temporary partition [m]; 0 = ideal
    bool allow_starved = false;  ///< a layer that ends short of the platform's end is a result, not a failure
    // powders; index 0 = A, 1 = B
    std::array<Powder, 2> powder;
    Material wall;
    Interaction interaction;
    bool adhesive_walls =
        true;  ///< false: land, blade and sides are plain Hertz walls, as in engines without JKR walls
    // numerics
    double softening = 1e-4;  ///< s: E' = s E
    AdhesionScaling adhesion_scaling = AdhesionScaling::cohesion_number;
    double rayleigh_fraction = 0.2;  ///< dt / T_R of the smallest grain
    double gravity = 9.81;           ///< [m/s2]
    bool sleep = true;               ///< grains at rest in a quiet neighbourhood are not computed
    bool early_stop = false;  ///< the blade stops at the platform's end instead of carrying the heap off it
    Precision precision = Precision::single_law;
    std::uint64_t seed = 1;

    /// Depth of the dispenser's floor below z = 0 in the first pass [m]: in the last one, after layers - 1
    /// further doses, it is bed_depth.
    double floor_depth() const { return bed_depth + (layers - 1) * dose_height; }
    /// Powder under a layer on Substrate::powder, as deep as the dispenser's [m]; 0 without it.
    double substrate_depth() const { return substrate == Substrate::powder ? bed_depth : 0; }
    /// How far the platform sinks between two passes [m]. Fused metal shrinks by what the platform sinks, so
    /// that its surface stays where it is.
    double sink() const { return substrate == Substrate::fused ? 0 : layer_thickness; }

    /// Every field as "key = value" lines with full precision: what the caches hash.
    std::string canonical_text() const;
};

/// The scene with grains `factor` times as large: fewer by factor^3, and a time step longer by factor.
/// Grains, gap, layer, dose, headspace, roughness, blade tip and bed depth grow, lengths in plan stay,
/// density stays, the work of adhesion grows by `factor`, which keeps the speed at which grains stick
/// (physics.md 4). For the gradation only, never for packing: what a gap holds depends on grains per gap,
/// which is kept, but also on how far powder flies, which is not. factor > 0; 1 changes nothing.
Scene coarse_grained(Scene scene, double factor);

/// FNV-1a 64-bit hash of a text, as 16 hex digits.
std::string text_hash(const std::string& text);

}  // namespace gradwright
