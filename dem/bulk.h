// Bulk properties a powder engineer asks for, from the same packing and the same engine as a spread: packing,
// static angle of repose, and what limits them in adhesive powder. Measured only: nothing of it feeds the
// spread.
#pragma once
#include <vector>

#include "dem/scene.h"
#include "dem/spread.h"

namespace gradwright {

/// A bed behind a gate: length x width in plan, `height` deep, on a rough floor of fixed grains.
struct ReposeSetup {
    double length = 1.0e-3;  ///< along the flow [m]
    double width = 0.26e-3;  ///< periodic [m]
    double height = 0.4e-3;  ///< of the bed before the gate opens [m]
    double longest = 0.25;   ///< flow is watched for so long at most [s]
};

struct ReposeResult {
    RunHealth health;
    BedFacts bed;
    long grains = 0, left = 0;  ///< mobile grains before and after
    double bond_number = 0;     ///< F_po/(m g) of the median grain, as computed
    double angle_deg = 0;       ///< slope of the surface that stays; NaN when too little is left for a fit
    double fit_error_deg = 0;   ///< standard error of the fit's slope [deg]
    double left_fraction = 0;   ///< solid left behind the gate's line / solid before [-]
    double gate_height = 0;     ///< height of the powder that stands at the gate's line [m]
    double back_height = 0;     ///< and at the back wall [m]
    double flow_time = 0;       ///< until the mean kinetic energy was below 1e-4 m g d [s]
    bool at_rest = false;       ///< false: still creeping at `longest`
    double seconds = 0;
    std::vector<double> x, surface;  ///< of the slope: bin centres [m], height [m]
};

/// Static angle of repose by draining: the bed packs against a gate, the gate vanishes, what crosses its line
/// falls off the edge; the slope that stays is fitted by a line below nine tenths of its height and up to 2
/// D50 from the edge. The powder, law and numerics are the scene's; its machine is not used. Adhesive powder
/// stands upright to a height that grows with its Bond number (then nothing is left to fit and the angle is
/// NaN), so the angle depends on `height`: both are results.
ReposeResult drain(const Scene& scene, const ReposeSetup& setup, const SpreadOptions& options);

inline constexpr double kCoverageCell = 0.2e-3;  ///< side of the cells of coverage [m]

/// Layer quality along the platform: share of square cells of a fifth of a millimetre whose solid depth
/// exceeds half the mean of all cells, in `parts` equal parts along x (physics.md 5, coverage); NaN in a part
/// without a cell, so no more parts than cells.
std::vector<double> coverage_along(const Layer& layer, int parts);

}  // namespace gradwright
