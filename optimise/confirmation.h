// Confirmation of one design by labelled full-width spreads on unseen packing seeds, and what they say
// together (inverse-design.md, Statistics).
#pragma once
#include <vector>

#include "optimise/dem_evaluator.h"
#include "optimise/study_result.h"

namespace gradwright {

/// One design with all that was said of it.
struct ConfirmedDesign {
    Design design;
    Evaluation predicted;  ///< on the map, or the search's own evaluator
    /// What the confirmed mean is expected to be, per bin or cell of a field: prediction plus the correction
    /// in force, with its variance.
    std::vector<double> expected, expected_variance, expected_drift, expected_drift_variance;
    std::vector<Evaluation> confirmations;  ///< those with numbers
    std::vector<Layer> layers;              ///< of those
    std::vector<Snapshot> snapshots;        ///< of the first of those
    GradationProfile mean;
    GradationField field;  ///< mean of the fields, where one is asked for
    XDrift drift;
    Misfit misfit, drift_misfit;
    Verdict verdict = Verdict::undecided;
    double p_value = 1,
           drift_p_value = 1;  ///< chi-squared equality of expected and confirmed over what counts

    /// How far from its tolerances: max(misfit / tolerance, drift / tolerance), debiased; < 1 is good.
    double distance() const;
};

/// Expected = prediction as it stands.
ConfirmedDesign unconfirmed(const Evaluation& predicted);

/// Means, errors, misfits, verdict and p-values of the confirmations so far; leaves "undecided" when there
/// are none. With three or more confirmations standard errors come from the replicates, else from theirs
/// (mean_profile).
void summarise(const Study& study, ConfirmedDesign& round);

/// Is `a` the better evidence? By verdict, then by distance to the tolerances; a confirmed design before an
/// unconfirmed one.
bool better(const ConfirmedDesign& a, const ConfirmedDesign& b);

/// Discrepancy confirmed - predicted, mean of three neighbouring counting bins; 0 where nothing counts
/// (manifold mapping: noise of single bins must not be built into a partition). Neighbours stand in one run
/// of `run` bins: a field's column.
std::vector<double> smoothed_discrepancy(const std::vector<double>& confirmed,
                                         const std::vector<double>& predicted,
                                         const std::vector<double>& weight, int run);

}  // namespace gradwright
