// What this machine and these powders can lay: the narrowest and the widest linear ramp, how far it can be
// moved along y, the steepest sigmoid, and what stops each.
//
// Every answer comes from one origin map (map_evaluator.h): for each target asked, the best partition of the
// study's own family is fitted on it (ceres_fit.h). A target is *reachable* when the verdict on the map's
// numbers is `met` for the profile and for the x drift: upper 95 % bounds and noise floors within the
// tolerances, exactly as `design` judges its confirmations. The map is a prediction: what labelled spreads
// add to it is not in here, and partitions are chosen on the map they are judged by, so limits are a little
// bold.
//
// Each limit is searched on a grid first and then bisected between the last reachable and the first
// unreachable value. Nothing makes reachability monotone (bins, knots and noise are discrete): the whole scan
// is kept (its fits start from fewer places than the own target's), the longest reachable stretch of the grid
// counts, and `gaps` tells when there are others. Dosage factor, land and footprint stay at the study's
// start: each of their values would need a map of its own.
#pragma once
#include <string>
#include <vector>

#include "optimise/design_run.h"

namespace gradwright {

/// What stops a target.
enum class ReachLimit {
    none,       ///< nothing: it is reachable
    profile,    ///< GI(y): transport and partition family lay it no closer
    x_drift,    ///< the profile wanders along x
    noise,      ///< the map is too noisy to tell
    bin_width,  ///< finer than one bin: not judged
    margins,    ///< wider than, or moved out of, the bins that count
};
const char* to_string(ReachLimit limit);  ///< "profile", ...
/// What it means and which knob to turn, a sentence without its full stop.
const char* meaning(ReachLimit limit);

/// One target asked of the map, with the best partition found for it.
struct ReachPoint {
    double value = 0;  ///< of the scan's variable [m]
    bool on_grid = true;
    Target target;
    Design design;
    Misfit misfit, drift;
    bool reachable = false;
    ReachLimit limit = ReachLimit::profile;
};

struct ReachScan {
    std::string variable;            ///< "full width of a linear ramp"
    double ramp_width = 0;           ///< shift only: of the ramp that is moved [m]
    double resolution = 0;           ///< a limit lies within this beyond the number given [m]
    std::vector<ReachPoint> points;  ///< by value: grid and bisection
    /// Ends of the longest reachable stretch [m], NaN when nothing is reachable. What stops it beyond them.
    double low, high;
    ReachLimit low_limit = ReachLimit::profile, high_limit = ReachLimit::profile;
    bool gaps = false;  ///< something else than the stretch was reachable too
};

struct Reach {
    std::string status = "ok";  ///< or "interrupted", or the status of the map spread that failed
    std::string reason;
    ReachPoint own;  ///< the study's own target; `value` has no meaning
    /// Bins that count when no zone weighs: from, to [m] and how many.
    double window_low = 0, window_high = 0;
    int bins = 0;
    double gi_low = 0,
           gi_high = 1;  ///< ends of every ramp and sigmoid: the target's own, 0 and 1 if it is flat
    bool rises = true;   ///< along y, as the target does
    ReachScan ramp, shift, sigmoid;
    std::vector<std::string> remarks;
    int map_spreads = 0;
    double capture_fraction = 0, coverage = 0;
    double seconds = 0, seconds_cold = 0;
};

struct ReachOptions {
    int grid = 7;           ///< points of each scan before bisection, >= 3
    double resolution = 0;  ///< of the limits [m]; 0 = a quarter of a bin: finer is not seen by the bins
    RunOptions run;
};

/// `study` must leave its partition free and its target must have a counting bin. A map that cannot be spread
/// is a status, not an exception.
Reach run_reach(const Study& study, const ReachOptions& options);

}  // namespace gradwright
