// The y-homogeneous estimator on a partition that is a function of x, for any number type (double, or
// ceres::Jet for derivatives).
//
// Away from side walls transport does not depend on y, so every laid grain i informs every y
// (inverse-design.md): moved across until it lies at y it would have come from (origin_x_i, y - way_i), way_i
// = deposit_y_i - origin_y_i. Its label there is a step, smoothed over a half width h measured across the
// curve,
//   label_i(y) = K((y - way_i - yc(origin_x_i)) / H_i),   H_i = h sqrt(1 + yc'^2)   (h along the normal is H
//   along y)
// with yc(x) the partition (A where y is larger), and the profile is the volume-weighted mean over all
// grains,
//   GI_b = sum_i V_i <label_i>_b / sum_i V_i,   <label_i>_b = (1/w) int_bin K dy = (H/w) [I(u_high) -
//   I(u_low)].
// The mean over the bin is taken in closed form, which is what infinitely many y-positions in the bin would
// give: no sampling error, and the hard label (h = 0) gives a profile that is continuous and piecewise smooth
// in the partition.
//   K(u) = 10 s^3 - 15 s^4 + 6 s^5, s = (1 + u)/2, on [-1, 1]: a quintic step, C2; I(u) = 5 s^4 - 6 s^5 + 2
//   s^6, C3.
// A bed without labels is its own mirror image: a grain from the same x might as well have gone the other way
// across. Grains pooled as `mirrored` count half with way_i and half with -way_i. What that takes out is what
// a bed as a whole has gone to one side, most of the difference between two beds: strips of the coupon differ
// by 0.02 in a bin instead of 0.03 (docs/origin-map.md, "In the mirror too").
// Powders that move differently in one heap. A spread with both tells how A's grains move and how B's, each
// only from its own side of that spread's partition. Weighed by the share r(x) of the dispenser's width that
// its powder took up where it came from, w_i = V_i / r(origin_x_i), the grains of a powder stand for a
// dispenser full of it, and
//   GI_b = N_A / (N_A + N_B),   N_A = sum_A w_i <label_i>_b,   N_B = sum_B w_i (1 - <label_i>_b)
// answers every other partition: each powder moves as it does beside the other, wherever the border between
// them is (what the border does to the heap as a whole is left out). r below kLeastShare counts as that: one
// grain must not stand for a stretch of which nothing is known. A step of finite support was taken rather
// than a Gaussian: a grain is certain outside |u| < 1, so that only the one or two bins its step falls into
// cost anything with derivatives. yc' is interpolated between the middles of the segments: with the slope of
// the segment itself H_i would jump when a knot passes over a grain, and the profile with it.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dem/gradation.h"
#include "dem/layer.h"

namespace gradwright {

/// What the estimator needs of the laid grains in a range of x, over one or more layers. Make once per
/// search.
struct PooledGrains {
    std::vector<double> origin_x;   ///< [m]
    std::vector<double> way;        ///< deposit_y - origin_y, unwrapped [m]
    std::vector<double> deposit_x;  ///< [m]
    std::vector<double> volume;     ///< [m3]
    std::vector<int> layer;         ///< index of the layer it came from
    /// Empty: a grain's label is where it came from. Else 1 a grain of A, 0 of B, and `volume` is its w [m2].
    std::vector<std::uint8_t> carries_a;
    /// A grain stands for its mirror image too.
    bool mirrored = false;
    double x_low = 0, x_high = 0;  ///< range of deposit_x taken, half-open [m]
    int layers = 0;

    std::size_t size() const { return volume.size(); }
    double total_volume() const;  ///< [m3]
    /// Three beds or more of about the same size: the spread between them is the noise. A full-width layer
    /// among strips is no replicate of them.
    bool replicates() const;
};
/// What stood in the bed of a layer that is read powder by powder: both powders on the sides of a partition,
/// or one of them alone.
struct BedPowders {
    PartitionCurve partition;  ///< no points: one powder
    bool a = true;             ///< which
    bool both() const { return !partition.points.empty(); }
};
/// Least share of the dispenser's width that a powder is taken to have had [-].
inline constexpr double kLeastShare = 0.1;

/// Grains with deposit_x in [x_low, x_high). `share`: what each layer counts in the pool, whatever it holds
/// [-], sum 1; layers with share 0 are left out. Empty: every grain by its volume.
PooledGrains pool_grains(std::span<const Layer> layers, double x_low, double x_high,
                         std::span<const double> share = {});
/// The same, powder by powder: `beds` tells what each layer was laid from. Where a powder stood in several
/// beds, each counts by its width.
PooledGrains pool_powders(std::span<const Layer> layers, std::span<const BedPowders> beds, double x_low,
                          double x_high);
/// What a map knows: pool_grains without `beds`, pool_powders with them. Mirrored where the powders move
/// `alike`; of others a strip is a first guess, which its image makes no better: of 32 studies on a made-up
/// heap 22 were met with it and 29 without, with the same misfit, 0.025.
PooledGrains pool_map(std::span<const Layer> layers, std::span<const double> share,
                      std::span<const BedPowders> beds, bool alike, double x_low, double x_high);
/// The grains of one powder of such a pool, read by where they came from.
PooledGrains powder_of(const PooledGrains& grains, bool a);
/// Those of `grains` with deposit_x in [x_low, x_high).
PooledGrains part_of(const PooledGrains& grains, double x_low, double x_high);

/// Integral of the quintic step K from -1 to u: 0 below -1, u above 1, C3.
template <class T>
T step_integral(const T& u) {
    if (u <= -1.0) return T(0.0);
    if (u >= 1.0) return u;
    const T s = 0.5 * (1.0 + u);
    const T s2 = s * s;
    return s2 * s2 * (5.0 + s * (2.0 * s - 6.0));
}

/// A partition y = yc(x) through knots with x_0 < x_1 < ..., continued straight at both ends.
template <class T>
struct CurveOverX {
    std::vector<T> x, y, slope;  ///< knots [m]; slope of each segment [-]

    CurveOverX(std::span<const T> knot_x, std::span<const T> knot_y)
        : x(knot_x.begin(), knot_x.end()), y(knot_y.begin(), knot_y.end()) {
        for (std::size_t k = 0; k + 1 < x.size(); ++k) slope.push_back((y[k + 1] - y[k]) / (x[k + 1] - x[k]));
    }

    /// yc(at) [m], and H/h = sqrt(1 + yc'^2) with the interpolated slope.
    void evaluate(double at, T& yc, T& widening) const {
        using std::sqrt;
        const std::size_t segments = slope.size();
        std::size_t k = 0;
        while (k + 1 < segments && at >= x[k + 1]) ++k;
        yc = y[k] + slope[k] * (at - x[k]);
        T m = slope[k];
        const T middle = 0.5 * (x[k] + x[k + 1]);
        if (at >= middle && k + 1 < segments) {
            const T next = 0.5 * (x[k + 1] + x[k + 2]);
            m = slope[k] + (slope[k + 1] - slope[k]) * ((at - middle) / (next - middle));
        } else if (at < middle && k > 0) {
            const T before = 0.5 * (x[k - 1] + x[k]);
            m = slope[k - 1] + (slope[k] - slope[k - 1]) * ((at - before) / (middle - before));
        }
        widening = sqrt(1.0 + m * m);
    }
};

/// Calls visit(bin, share) for every bin in which a step of half width H at y = c is neither 0 nor 1, and
/// returns the first bin that is wholly above it (share 1 from there on). share = mean of the step over the
/// bin [-].
template <class T, class Visit>
int visit_bins(const BinGrid& bins, const T& c, const T& half_width, Visit&& visit) {
    int bin = 0;
    // whole bins below the step: compare, do not compute, so that no bin is lost to rounding
    while (bin < bins.count && c - half_width >= bins.low(bin + 1)) ++bin;
    for (; bin < bins.count && c + half_width > bins.low(bin); ++bin) {
        const double low = bins.low(bin), high = bins.low(bin + 1);
        if (half_width > 0.0) {
            visit(bin,
                  half_width *
                      (step_integral(T((high - c) / half_width)) - step_integral(T((low - c) / half_width))) *
                      (1.0 / bins.width));
        } else {
            visit(bin, (high - c) * (1.0 / bins.width));
        }
    }
    return bin;
}

/// GI of every bin into `gi` (resized to bins.count) [-]: A where y is larger than on the curve, which tells
/// yc and H/h as CurveOverX does. `smoothing` = h [m], >= 0. Without grains `gi` is left empty.
template <class T, class Curve>
void smooth_profile_above(const PooledGrains& grains, const Curve& curve, const BinGrid& bins,
                          double smoothing, std::vector<T>& gi) {
    gi.clear();
    if (grains.size() == 0) return;
    gi.assign(bins.count, T(0.0));
    // certain grains are plain numbers: counted at the first bin they fill, summed over bins once at the end
    std::vector<double> filled_from(bins.count + 1, 0.0);
    T yc, widening;
    for (std::size_t i = 0; i < grains.size(); ++i) {
        curve.evaluate(grains.origin_x[i], yc, widening);
        const double volume = grains.mirrored ? 0.5 * grains.volume[i] : grains.volume[i];
        const auto count = [&](double way) {
            const int filled = visit_bins<T>(bins, T(yc + way), T(smoothing * widening),
                                             [&](int bin, const T& share) { gi[bin] += volume * share; });
            filled_from[filled] += volume;
        };
        count(grains.way[i]);
        if (grains.mirrored) count(-grains.way[i]);
    }
    const double total = grains.total_volume();
    double certain = 0;
    for (int bin = 0; bin < bins.count; ++bin) {
        certain += filled_from[bin];
        gi[bin] = (gi[bin] + certain) / total;
    }
}

/// The same of a polyline; knots: at least 2, x strictly rising.
template <class T>
void smooth_homogeneous_profile(const PooledGrains& grains, std::span<const T> knot_x,
                                std::span<const T> knot_y, const BinGrid& bins, double smoothing,
                                std::vector<T>& gi) {
    smooth_profile_above<T>(grains, CurveOverX<T>(knot_x, knot_y), bins, smoothing, gi);
}

/// x drift of the same estimator: GI over the last third minus over the first third of [x_low, x_high), per
/// bin. `first` and `last` = part_of(grains, ...) of the thirds, made once per search with thirds_of. Empty
/// when a third holds no grain.
template <class T>
void smooth_homogeneous_drift(const PooledGrains& first, const PooledGrains& last, std::span<const T> knot_x,
                              std::span<const T> knot_y, const BinGrid& bins, double smoothing,
                              std::vector<T>& difference) {
    std::vector<T> before;
    smooth_homogeneous_profile<T>(first, knot_x, knot_y, bins, smoothing, before);
    smooth_homogeneous_profile<T>(last, knot_x, knot_y, bins, smoothing, difference);
    if (before.empty() || difference.empty()) {
        difference.clear();
        return;
    }
    for (int bin = 0; bin < bins.count; ++bin) difference[bin] -= before[bin];
}

/// The estimators of gradation.h on grains pooled once: what a search calls thousands of times.
GradationProfile homogeneous_profile(const PooledGrains& grains, const PartitionCurve& partition,
                                     const BinGrid& bins, const HomogeneousOptions& options);
XDrift homogeneous_drift(const PooledGrains& grains, const PartitionCurve& partition, const BinGrid& bins,
                         const HomogeneousOptions& options);

/// The same estimator over `columns` equal parts of the range of x; with options.resamples 0 without standard
/// errors.
GradationField homogeneous_field(const PooledGrains& grains, const PartitionCurve& partition,
                                 const BinGrid& bins, int columns, const HomogeneousOptions& options);
/// Those parts.
std::vector<PooledGrains> columns_of(const PooledGrains& grains, int columns);

/// First and last third of the range of x of `grains`.
struct Thirds {
    PooledGrains first, last;
};
Thirds thirds_of(const PooledGrains& grains);

}  // namespace gradwright
