// One finished evaluation of one design at one fidelity, and the interface behind which every fidelity
// stands.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dem/gradation.h"
#include "dem/homogeneous_estimator.h"
#include "optimise/study.h"

namespace gradwright {

enum class Fidelity { kinematic, map, full, lammps };
const char* to_string(Fidelity fidelity);

/// One of several layers that one run laid, or the only one on powder.
struct LaidLayer {
    int number = 1;  ///< from 1
    GradationProfile profile;
    XDrift drift;
    Misfit misfit, drift_misfit;
    GradationMap map;                                            ///< full only
    double gap = 0;                                              ///< [m]
    double dosed_solid_volume = 0, raised_solid_volume = 0;      ///< Layer, PassFacts [m3]
    double laid_solid_volume = 0, carried_off_solid_volume = 0;  ///< [m3]
    double capture_fraction = 0, coverage = 0, waste_fraction = 0, packing_fraction = 0;
};

struct Evaluation {
    Design design;
    Fidelity fidelity = Fidelity::full;
    RunHealth health;  ///< status "ok" or why there are no numbers
    std::uint64_t seed = 0;
    GradationProfile profile;
    XDrift drift;
    GradationMap map;  ///< full only; map: relabelled
    /// Plain bins of the same grains, a map's strips tiled over the width; empty where the profile is plain
    /// bins itself.
    GradationProfile plain_check;
    XDrift plain_check_drift;            ///< and their drift
    bool one_error = false;              ///< one error moves all bins: an extrapolation (heap_order.h)
    bool every_grain = false;            ///< full only: every grain told of every y (dem_evaluator.h)
    std::vector<double> target, weight;  ///< per bin; of a field its means along x
    // a target over x and y only, else empty: what is judged then, cell by cell as in GradationField
    GradationField field;
    std::vector<double> field_target, field_weight;
    Misfit misfit;        ///< of the profile; of the field where one is asked for
    Misfit drift_misfit;  ///< of what the target does not ask to change along x (drift_targets)
    double capture_fraction = 0, supply_ratio = 0, coverage = 0, waste_fraction = 0, packing_fraction = 0;
    double waste_a_share = 0;  ///< A's share of the overflow [-]
    double objective = 0;      ///< what a search minimises
    /// map only: where each sixth of the platform was laid from, mean and local standard deviation of
    /// origin_x by volume, as shares of the dispenser's length; NaN where nothing lies. The heap's turnover,
    /// in numbers.
    std::vector<double> origin_mean, origin_deviation;
    double kinematic_error_bound = 0;  ///< 1 - f where f is known, else 1
    long grains = 0, steps = 0;
    double grain_steps = 0, seconds = 0, seconds_cold = 0;
    /// Each layer of several, the numbers above being the judged one's (target.layer); empty for one on fused
    /// metal or a plate.
    std::vector<LaidLayer> layers;
    int spreads = 0;  ///< DEM spreads whose result this used for the first time
    std::string state_hash;
    std::vector<double>
        residuals;  ///< sqrt(w) (gi - g) per counting bin, then sqrt(x_drift_weight) drift per bin

    /// What the verdict is about: the profile's bins, or the field's cells.
    const GradationProfile& judged() const { return field_target.empty() ? profile : field.cells; }
    GradationProfile& judged() { return field_target.empty() ? profile : field.cells; }
    const std::vector<double>& judged_weight() const { return field_target.empty() ? weight : field_weight; }
};

/// Design -> Evaluation. "Not evaluable" is a status in `health`.
class Evaluator {
  public:
    virtual ~Evaluator() = default;
    virtual Evaluation evaluate(const Design& design, std::uint64_t seed) = 0;
    virtual Fidelity fidelity() const = 0;
};

/// The design's footprint: the study's, shifted by footprint_offset and kept on the platform; y range cut to
/// the width [m].
Footprint footprint_of(const Study& study, const Design& design);
/// Weight per bin: mean of the target's zones over the bin; 0 outside the footprint and within 2 D90 of a
/// side (wall or periodic seam).
std::vector<double> bin_weights(const Study& study);
/// Target per bin: mean of g over the bin [-]; of a field over the footprint's x too.
std::vector<double> bin_targets(const Study& study);

/// A field's cells: study.columns equal parts of the footprint along x, the bins of each along y, in the
/// order of GradationField. The field belongs to the part and is shifted with the footprint, so the cells'
/// targets are the same for every design. Both empty for a target of y alone.
std::vector<double> field_targets(const Study& study);
std::vector<double> field_weights(const Study& study);
/// What the target itself asks to change along x, per bin: its mean over the last third of the footprint
/// minus that over the first [-]. The layer's drift is held against it; 0 for a target of y alone.
std::vector<double> drift_targets(const Study& study);
/// 1 for a bin whose drift is judged: one of weight > 0; of a field one that has no don't-care part in the
/// first and the last third.
std::vector<double> drift_weights(const Study& study);

/// The grains of one bed share more than its blocks can tell: how this bed as a whole happened to turn over.
/// Widens standard errors of profile and drift that were taken from blocks of single beds by the square root
/// of `variance_ratio`: variance between sixteen beds of the coupon over the variance the blocks gave, for
/// maps of strips and for plain bins (docs/origin-map.md, "One bed's noise").
struct BedAllowance {
    double profile, drift;  ///< what all grains of a bed share cancels in part in a difference along x
};
constexpr BedAllowance kBedsOverBlocksMap{3.5, 1.3}, kBedsOverBlocksMirrored{2.5, 2.1},
    kBedsOverBlocksPlain{2.3, 1.25};
inline BedAllowance beds_over_blocks(const PooledGrains& grains) {
    return grains.mirrored ? kBedsOverBlocksMirrored : kBedsOverBlocksMap;
}
/// A field's cell has the blocks' variance of n columns over the whole's and shares with its row what the bed
/// has in common: 1 + (profile - 1)/n of its blocks' variance.
void allow_for_beds(Evaluation& evaluation, BedAllowance variance_ratio);

/// From run results to numbers, shared by every evaluator: fills target, weight, misfits, objective and
/// residuals. A field is judged by its cells where the text says bins, its drift less what the target asks
/// for. objective = sqrt(m^2 + x_drift_weight d^2) + waste_weight x waste_fraction + max(0,
/// min_coverage - coverage) [GI units], m = raw misfit in the study's norm, d = rms x drift. Raw, not
/// debiased: debiasing is flat at zero and stops a search there; the floor hardly changes between designs on
/// one map. With `one_error` the
/// intervals are at least value -+ t noise_floor, t Student's one-sided 95 % point: what moves all bins
/// together does not average out over them. Without any counting bin the health becomes "no_bins" and the
/// objective 10.
void judge(const Study& study, Evaluation& evaluation);
/// The limits of [objective] on what this evaluation measured; none for the kinematic picture, which knows
/// neither waste nor supply, and for an evaluation without numbers.
std::vector<ConstraintState> limit_states(const Study& study, const Evaluation& evaluation);
/// GI per unit by which a limit or a constraint is broken: far above the slope of any misfit.
inline constexpr double kBrokenPrice = 10;
/// Objective of an evaluation that has no numbers: worse than any real one (a misfit is at most 1).
inline constexpr double kNotEvaluable = 10;

}  // namespace gradwright
