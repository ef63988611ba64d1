// How long a time step may be: the stability edge of the production engine, found by bisection, and the
// saddle on which a late tangential velocity makes a grain stick.
//
// Explicit integration of a spring of angular frequency w is stable to w dt = 2 (leapfrog) and to less with
// damping, which is taken from a predicted velocity. What w a powder reaches depends on the overlap (S_n ~
// sqrt(delta)), the number of contacts and the rotations, so the edge is measured: a packing under load is
// given tiny random velocities; beyond the edge they grow until contacts open.
#pragma once
#include <string>
#include <vector>

#include "dem/contact_law.h"
#include "dem/material.h"
#include "dem/scene.h"

namespace gradwright {

/// What is loaded in the search for the edge.
enum class StabilityPacking {
    heap,  ///< grains in a box under a gravity that presses the lowest to the overlap asked for; with a
           ///< size ratio, large ones on a layer of small ones
    wedge  ///< one grain between two parallel plates, as between blade and rim
};

struct StabilitySetup {
    StabilityPacking packing = StabilityPacking::heap;
    double size_ratio = 1;          ///< largest over smallest radius [-], >= 1
    double overlap = kOverlapRule;  ///< largest overlap over the smaller radius [-], 0..0.3
    Interaction interaction;        ///< work_of_adhesion as the engine uses it: no scaling is applied
    bool free_dashpot = false;      ///< the deliberate fault of that name (contact_law.h)
    Precision precision = Precision::double_law;  ///< tiny motions: float would add its own
    std::uint64_t seed = 1;
};

struct StabilityEdge {
    double stable = 0, unstable = 0;  ///< dt over T_R of the smallest grain [-]: no growth; growth
    double overlap = 0;               ///< largest overlap over the smaller radius in the packing [-]
    long grains = 0;
    double edge() const { return 0.5 * (stable + unstable); }
};

/// Bisects between 0.05 and 6 Rayleigh times to 3 %.
StabilityEdge stability_edge(const StabilitySetup& setup);

/// One row of the table of edges: a law in words and what to load with it.
struct StabilityRow {
    std::string law;
    StabilitySetup setup;
};
/// Laws, damping, friction and rolling models one at a time, size ratios 1, 3 and 10, heaps at 0.1 and 3 %
/// overlap and wedges at 3, 10 and 20 %.
std::vector<StabilityRow> stability_table();

/// Edges in a dense heap of equal grains whose largest overlap is the 3 % that a run warns of [T_R of the
/// smallest grain], rounded down from the table in docs/hard-cases.md (rolling models of that table, the
/// lowest counts): e 0.5 and friction 0.64; e 0.05, where the normal dashpots alone reach their limit; e 1
/// with friction, where nothing damps the tangential spring. Beyond the first nothing is packed or spread.
inline constexpr double kStabilityEdge = 0.4, kDampedEdge = 0.3, kUndampedEdge = 0.1;
/// The edge that holds for an interaction: those three, linear in e between 0.05 and 0.5. Half of it is the
/// largest time step that `validate` passes without a warning.
double stability_edge_of(const Interaction& interaction);

/// "the time step is 6 Rayleigh times, 12 times the stability edge; lower
/// numerics.time_step.rayleigh_fraction".
std::string step_advice(double rayleigh_fraction, const Interaction& interaction);

/// Three grains (Vyas, Ottino, Lueptow, Umbanhowar, Comput. Phys. Commun. 310, 109524, 2025, arXiv
/// 2410.14798): a small one lies near the top of the saddle between two large fixed ones that touch, rolls
/// down and falls. Without slip phi'' = g sin(phi)/(rho (1 + 2/5 ((R + r)/rho)^2)), rho = sqrt((R + r)^2 -
/// R^2), phi from the vertical. The slip of the contact points must be computed from velocities and normals
/// of one instant: half-step velocities with whole-step normals leave omega r dphi/dt dt/2 of it, always
/// towards the neck, and the spring adds that up until friction alone carries the small grain: it runs round
/// below the large ones and does not fall.
struct SaddleSetup {
    double size_ratio = 20;          ///< R/r [-]; R = 5 mm
    double rayleigh_fraction = 0.2;  ///< dt over T_R of the small grain
    bool late_velocity = false;      ///< half-step velocities in the law, as many codes have it
    Precision precision = Precision::single_law;
};
struct SaddleResult {
    double expected_time = 0;       ///< from 1 to 30 degrees by the equation above [s]
    double time = 0;                ///< the same by the engine; infinity when it never came there [s]
    bool fell = false;              ///< it left the saddle within four times `expected_time`
    double farthest_angle_deg = 0;  ///< largest phi at which it still lay on the large ones
};
SaddleResult roll_off_saddle(const SaddleSetup& setup);

}  // namespace gradwright
