// Least squares of the partition on an origin map (inverse-design.md, Default strategy): Ceres
// Levenberg-Marquardt within bounds, derivatives by automatic differentiation through the y-homogeneous
// estimator, several starts, the choice made on hard labels.
//
// Residuals over the bins that count (weight w_b > 0, n of them):
//   sqrt(w_b / sum w) (GI_b - target_b)                then   sqrt(x_drift_weight / n) (drift_b -
//   drift_target_b)
// A target over x and y has its cells for the bins of the first kind, column after column.
// so that |r|^2 = rmse^2 + x_drift_weight drift_rms^2: the square of the objective of `judge` without its
// price of waste, which no partition changes. A family with a least bend radius appends its bend_excess, a
// study with constraints how far each is broken, times kConstraintPrice. That price leaves an optimum on the
// border some 1e-4 of a width outside, so what comes out is moved to the nearest point that keeps the
// constraints before it is judged.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dem/homogeneous_estimator.h"
#include "optimise/chamber_fill.h"
#include "optimise/partition_family.h"

namespace gradwright {

/// What the residuals are made of: grains of the footprint and what is asked of them, bin by bin.
struct FitProblem {
    PooledGrains grains;
    std::vector<PooledGrains> columns;  ///< of a field; else `grains` alone
    Thirds thirds;
    /// Where the map is read powder by powder: the grains of A and those of B, apart. Else empty.
    struct OnePowder {
        std::vector<PooledGrains> columns;
        Thirds thirds;
    };
    std::vector<OnePowder> powders;
    BinGrid bins;
    std::vector<double> target, weight;              ///< per bin of each column [-]
    std::vector<double> drift_target, drift_weight;  ///< per bin [-]
    ChamberFill fill;                                ///< makes GI of the shares
    Norm norm = Norm::rmse;     ///< of the choice and the polish; the least squares are always rmse
    double x_drift_weight = 0;  ///< [-], >= 0; 0 leaves the drift to be only reported
    MotionValues motion = {};   ///< the design's, for constraints that name it

    /// `layers` = the map, footprint shifted as `design` says; targets and weights of the study.
    /// `share` as in pool_grains; `beds`, where there are any, as in pool_powders: pure powders, level
    /// chambers.
    FitProblem(const Study& study, const Design& design, std::span<const Layer> layers,
               std::span<const double> share = {}, std::span<const BedPowders> beds = {});
    bool usable() const;  ///< grains in the footprint and at least one counting bin

    /// Residual vector as above, for T = double or ceres::Jet. `smoothing` = half width of the label kernel
    /// [m].
    template <class T>
    void residuals(const PartitionFamily& family, const T* p, double smoothing, std::vector<T>& out) const;
    /// Of those two kinds; a family's bend_count comes on top.
    int residual_count() const;
    /// GI column after column, and drift; `difference` is empty when a third holds no grain.
    template <class T>
    void gradation(const PartitionFamily& family, const T* p, double smoothing, std::vector<T>& gi,
                   std::vector<T>& difference) const;
    /// Share of every bin on A's side, of these grains.
    template <class T>
    std::vector<T> side_share(const PartitionFamily& family, const T* p, double smoothing,
                              const PooledGrains& pool) const;
    /// GI of every bin from the grains of A and of B (homogeneous_estimator.h).
    template <class T>
    std::vector<T> gi_of_powders(const PartitionFamily& family, const T* p, double smoothing,
                                 const PooledGrains& of_a, const PooledGrains& of_b) const;
    /// sqrt(m^2 + x_drift_weight d^2 + unsound) with hard labels and the norm asked for [-].
    double hard_objective(const PartitionFamily& family, std::span<const double> p) const;
    /// (m, d) of the above.
    std::pair<double, double> hard_misfit_and_drift(const PartitionFamily& family,
                                                    std::span<const double> p) const;
};

struct FitOptions {
    /// Label kernel, widest first [m]: wide kernels see beyond the ripple of single grains, the last is half
    /// a grain.
    std::vector<double> kernels = {100e-6, 50e-6, 20e-6};
    int iterations = 40;        ///< per kernel
    int first_iterations = 12;  ///< at the widest kernel, where all starts take part
    int finalists =
        3;  ///< starts that go on to the narrower kernels: the best on hard labels after the widest
    int perturbed_starts = 6;      ///< around each closed-form start
    double perturbation = 0.2;     ///< half width, in parameters without unit
    int polish_evaluations = 400;  ///< NLopt on hard labels, for norms other than rmse; 0 = none
    /// Where not empty: starts at this curve and closely around it alone. What was learned of one curve says
    /// little of another that is built the other way round.
    std::vector<PlanPoint> near = {};
    std::uint64_t seed = 1;
    std::function<bool()> stop;  ///< looked at between starts
};

struct FitResult {
    bool ok = false;
    std::string message;
    Design design;  ///< partition and parameters set, the rest as in the design given
    Orientation orientation;
    std::vector<double> p;
    double objective = 0;  ///< hard labels
    double misfit = 0, drift = 0;
    double start_objective = 0;  ///< of the closed form
    int starts = 0, evaluations = 0;
    /// The designs of all starts that were followed to the end, `design` among them: on a noisy map several
    /// are as good, and who can tell their noise chooses.
    std::vector<Design> finalists;
};

/// Best partition of `space` on the map. A space that is not free returns `design` as it is, without numbers.
/// `design` gives all that is not partition. Never throws for a poor fit: `ok` is false when there is nothing
/// to fit to.
FitResult fit_partition(const Study& study, const DesignSpace& space, const Design& design,
                        const FitProblem& problem, const FitOptions& options);

template <class T>
std::vector<T> FitProblem::side_share(const PartitionFamily& family, const T* p, double smoothing,
                                      const PooledGrains& pool) const {
    std::vector<T> sum(bins.count, T(0.0)), part;
    family.visit_curves(p, [&](const auto& curve, double sign) {
        smooth_profile_above<T>(pool, curve, bins, smoothing, part);
        for (std::size_t b = 0; b < part.size(); ++b) sum[b] += sign * part[b];
    });
    if (!family.orientation().a_above)
        for (T& share : sum) share = T(1.0 - share);
    return sum;
}

template <class T>
std::vector<T> FitProblem::gi_of_powders(const PartitionFamily& family, const T* p, double smoothing,
                                         const PooledGrains& of_a, const PooledGrains& of_b) const {
    std::vector<T> gi = side_share<T>(family, p, smoothing, of_a);
    const std::vector<T> share_b = side_share<T>(family, p, smoothing, of_b);
    const double all_a = of_a.total_volume(), all_b = of_b.total_volume();
    for (std::size_t b = 0; b < gi.size(); ++b) {
        const T a = all_a * gi[b], sum = a + all_b * (1.0 - share_b[b]);
        gi[b] = sum > 0.0 ? T(a / sum) : T(0.0);
    }
    return gi;
}

template <class T>
void FitProblem::gradation(const PartitionFamily& family, const T* p, double smoothing, std::vector<T>& gi,
                           std::vector<T>& difference) const {
    gi.clear();
    difference.clear();
    if (!powders.empty()) {
        const OnePowder &a = powders[0], &b = powders[1];
        for (std::size_t column = 0; column < a.columns.size(); ++column) {
            const std::vector<T> part =
                gi_of_powders<T>(family, p, smoothing, a.columns[column], b.columns[column]);
            gi.insert(gi.end(), part.begin(), part.end());
        }
        if (thirds.first.size() == 0 || thirds.last.size() == 0) return;
        difference = gi_of_powders<T>(family, p, smoothing, a.thirds.last, b.thirds.last);
        const std::vector<T> before = gi_of_powders<T>(family, p, smoothing, a.thirds.first, b.thirds.first);
        for (std::size_t bin = 0; bin < before.size(); ++bin) difference[bin] -= before[bin];
        return;
    }
    std::vector<T> profile, first, last;
    const auto add = [](std::vector<T>& sum, const std::vector<T>& part, double sign) {
        if (sum.empty())
            sum = part;
        else
            for (std::size_t b = 0; b < part.size(); ++b) sum[b] += sign * part[b];
    };
    family.visit_curves(p, [&](const auto& curve, double sign) {
        std::vector<T> all;
        for (const PooledGrains& column : columns) {
            smooth_profile_above<T>(column, curve, bins, smoothing, profile);
            if (profile.empty()) profile.assign(bins.count, T(0.0));  // weighs nothing: see the constructor
            all.insert(all.end(), profile.begin(), profile.end());
        }
        add(gi, all, sign);
        smooth_profile_above<T>(thirds.first, curve, bins, smoothing, first);
        smooth_profile_above<T>(thirds.last, curve, bins, smoothing, last);
        if (first.empty() || last.empty()) return;
        for (std::size_t b = 0; b < last.size(); ++b) last[b] -= first[b];
        add(difference, last, sign);
    });
    // so far the share above the partition, or between its curves (visit_curves)
    const bool above = family.orientation().a_above;
    for (std::size_t b = 0; b < gi.size(); ++b) {
        const T share = above ? gi[b] : T(1.0 - gi[b]);
        if (columns.size() == 1 && !difference.empty())
            difference[b] = fill.slope(share) * (above ? difference[b] : T(-difference[b]));
        gi[b] = fill.gi(share);
    }
    if (columns.size() == 1 || difference.empty()) return;
    // shares over the whole footprint: where the slope is taken, if it depends on them
    std::vector<T> whole(difference.size(), T(0.0)), part;
    if (!fill.level()) {
        whole.clear();
        family.visit_curves(p, [&](const auto& curve, double sign) {
            smooth_profile_above<T>(grains, curve, bins, smoothing, part);
            add(whole, part, sign);
        });
    }
    for (std::size_t b = 0; b < difference.size(); ++b) {
        const T share = above ? whole[b] : T(1.0 - whole[b]);
        difference[b] = fill.slope(share) * (above ? difference[b] : T(-difference[b]));
    }
}

template <class T>
void FitProblem::residuals(const PartitionFamily& family, const T* p, double smoothing,
                           std::vector<T>& out) const {
    std::vector<T> gi, difference;
    gradation(family, p, smoothing, gi, difference);
    double sum = 0;
    int counting = 0;
    for (const double w : weight) sum += w;
    for (const double w : drift_weight) counting += w > 0;
    out.clear();
    for (std::size_t b = 0; b < weight.size(); ++b)
        if (weight[b] > 0) out.push_back(std::sqrt(weight[b] / sum) * (gi[b] - target[b]));
    for (std::size_t b = 0; b < drift_weight.size(); ++b) {
        if (!(drift_weight[b] > 0)) continue;
        // A third without grains has no drift to be judged by; coverage tells of it.
        if (difference.empty())
            out.push_back(T(0.0));
        else
            out.push_back(std::sqrt(x_drift_weight / counting) * (difference[b] - drift_target[b]));
    }
    family.bend_excess(p, out);
}

}  // namespace gradwright
