// Gradation of a laid layer (physics.md 5): GI profile and map, standard errors, x drift, coverage; and the
// y-homogeneous estimator that answers every partition from one spread (inverse-design.md). Undefined bins
// are NaN inside the library; the edges (JSON, reports) write null.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "dem/layer.h"
#include "dem/partition.h"

namespace gradwright {

/// Where the part stands: x from the platform's near edge, y across; half-open [low, high) [m].
struct Footprint {
    double x_low = 0, x_high = 0, y_low = 0, y_high = 0;
};

/// Bins from y = 0 with equal width (paper: 0.2 mm); only bins wholly inside the footprint count.
struct BinGrid {
    double width = 0.2e-3;  ///< [m]
    int count = 0;          ///< from y = 0
    double low(int bin) const { return bin * width; }
    double centre(int bin) const { return (bin + 0.5) * width; }
};

struct GradationProfile {
    std::vector<double> y_m;             ///< bin centres [m]
    std::vector<double> gi;              ///< [-], NaN where empty
    std::vector<double> standard_error;  ///< s_b [-]
    std::vector<double> volume;          ///< solid in the bin [m3]
    std::vector<double> n_eff;           ///< (sum V)^2 / sum V^2
    double degrees = 0;  ///< degrees of freedom behind the standard errors; 0 = not known. For bands and
                         ///< misfits: Student's t
};

struct XDrift {
    std::vector<double> difference;  ///< last third minus first third of the footprint, per bin
    std::vector<double> standard_error;
    double value = 0;        ///< rms over counting bins [-]
    double noise_floor = 0;  ///< rms of the standard errors
    double degrees = 0;      ///< degrees of freedom behind them; 0 = not known
};

/// GI over columns along x and bins along y, with what a profile has: the judged twin of the map below.
struct GradationField {
    std::vector<double> x_m;  ///< centres of the columns [m]; empty = no field
    std::vector<double> y_m;  ///< centres of the bins [m]
    /// Column after column: cell column * y_m.size() + bin; y_m of the cells is the bin's.
    GradationProfile cells;
};

struct GradationMap {
    std::vector<double> x_m, y_m;  ///< cell centres [m]
    std::vector<double> gi;        ///< row-major [y][x], NaN where empty
    std::vector<double> mass_kg;   ///< [y][x]
};

/// Labels of every laid grain for a partition: 1 on A's side at its origin (wrapped into [0, W) when
/// periodic). For labelled layers use layer.is_a, that is carried_labels.
std::vector<double> hard_labels(const Layer& layer, const PartitionCurve& partition);
/// The labels that a labelled run carried, as numbers: 1 for A.
std::vector<double> carried_labels(const Layer& layer);

/// Plain bins: label (0..1) per grain. Standard error: block bootstrap over x blocks of `block` [m] (all y),
/// with floor variance gi-independent 1/(n_eff+2) x p(1-p) with p = 1/(n_eff+2) on plateaus. Grain's full
/// volume at its centre; y wrapped when periodic.
GradationProfile plain_profile(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                               const BinGrid& bins, std::uint64_t seed, double block = 0.3e-3,
                               int resamples = 200);
XDrift plain_drift(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                   const BinGrid& bins, std::uint64_t seed, double block = 0.3e-3, int resamples = 200);
/// `columns` equal parts of the footprint along x. Standard errors: a column holds too few blocks for its
/// own, so the design effect of the whole footprint is put on the cell's variance of independent grains, as
/// for the drift.
GradationField plain_field(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                           const BinGrid& bins, int columns, double block = 0.3e-3);
GradationMap gradation_map(const Layer& layer, std::span<const double> label,
                           const std::vector<double>& density_kg_m3_a_b, double cell = 0.2e-3,
                           double width = 0);

/// y-homogeneous estimator over one or more layers pooled (periodic maps): at lateral position y,
///   GI(y) = sum_i V_i [(origin_x_i, y + origin_y_i - deposit_y_i) on A's side] / sum_i V_i, deposit_x in
///   [x_low, x_high).
/// Averaged over `samples_per_bin` y-positions in each bin. `smoothing` = half width of the label kernel [m],
/// 0 = hard labels. Standard error: bootstrap over x blocks and layers (between-layer spread when >= 3
/// layers).
struct HomogeneousOptions {
    int samples_per_bin = 8;
    double smoothing = 0;
    int resamples = 0;  ///< 0: no standard errors (fast path of the search)
    double block = 0.3e-3;
    std::uint64_t seed = 1;
};
GradationProfile homogeneous_profile(std::span<const Layer> layers, const PartitionCurve& partition,
                                     double x_low, double x_high, const BinGrid& bins,
                                     const HomogeneousOptions& options);
/// Drift of the same estimator: profile over the last third minus over the first third of [x_low, x_high).
XDrift homogeneous_drift(std::span<const Layer> layers, const PartitionCurve& partition, double x_low,
                         double x_high, const BinGrid& bins, const HomogeneousOptions& options);

/// Share of 0.2 mm cells of the footprint whose solid depth exceeds half the mean [-].
double coverage(const Layer& layer, const Footprint& footprint, double cell = 0.2e-3);

/// Volume-weighted quantile W^-1 of origin_x over laid grains with deposit_x in [x_low, x_high): the
/// closed-form start needs it [m].
double origin_x_quantile(std::span<const Layer> layers, double x_low, double x_high, double share);

/// Mean profile of replicates (same bins). standard_error: from the replicates when >= 3, else propagated
/// from theirs.
GradationProfile mean_profile(std::span<const GradationProfile> replicates);
/// The same for fields and for the x drift.
GradationField mean_field(std::span<const GradationField> replicates);
XDrift mean_drift(std::span<const XDrift> replicates);

}  // namespace gradwright
