// Variance of a volume-weighted share (a bin's GI) whose grains are correlated along x (inverse-design.md,
// Statistics).
//
// Neighbouring laid grains share origins, so grains are no independent draws. The grains of a bin are summed
// over blocks of x, and the blocks are what is resampled: the block bootstrap. For a ratio of sums its
// variance over infinitely many resamples is known in closed form, and that limit is taken here, with the
// loss of degrees of freedom put back:
//   raw = n/(n - lost) sum_j e_j^2 / (sum V)^2,  e_j = sum_{i in j} V_i (l_i - p - slope (x_i - x_mean))
// A linear trend along x is taken out first (lost = 2): a drift along the platform repeats in every spread,
// is shown as x drift, and is no noise of the x-averaged GI. Without trend (replicates as blocks) lost = 1.
// A handful of blocks says little about one bin (5 blocks after the trend: 3 degrees of freedom, the variance
// is known to a factor of two), so the bins share what they know. iid = sum V^2 (l - p)^2/(sum V)^2 is the
// variance of independent grains, and
//   design_effect = sum_b raw_b / sum_b iid_b,   v_b = (d raw_b + d0 design_effect iid_b)/(d + d0),  d = n -
//   lost, d0 = 12
// (shrinkage towards a common design effect, as for the variances of many small samples: Smyth 2004). iid
// takes p pulled towards 1/2 by two grains of each kind (Agresti and Coull 1998): a bin that by luck holds
// hardly any grain of one powder is not that certain. On plateaus both vanish though a grain of the other
// powder may still turn up: v_b >= p0 (1 - p0)/n_eff with p0 = 1/(n_eff + 2), n_eff = (sum V)^2 / sum V^2.
// The degrees of freedom of v_b are handed on: with 3 of them a band of 1.96 s holds the truth in 86 % of
// cases, not 95 %, so bands and bounds of misfits take Student's t (misfit.h). s itself is not widened: noise
// floors and tests of equality need it unbiased. Checked on synthetic layers whose grains share origins in
// patches (tests/dem/gradation_test.cpp): 150 um patches are covered; patches as long as the block leave s
// about 15 % too small. What a whole bed has in common no block of it can know; whoever quotes a single bed
// allows for that (optimise/evaluation.h).
#pragma once
#include <vector>

#include "dem/gradation.h"

namespace gradwright {

/// Sums over the grains of one bin.
struct BinMoments {
    std::vector<double> volume, volume_x, volume_label;  ///< per block: sum V, sum V x, sum V l
    double v2 = 0, v2_label = 0, v2_label2 = 0;          ///< sum V^2, sum V^2 l, sum V^2 l^2

    explicit BinMoments(int blocks = 1) : volume(blocks, 0), volume_x(blocks, 0), volume_label(blocks, 0) {}
    void add(int block, double x, double grain_volume, double label) {
        volume[block] += grain_volume;
        volume_x[block] += grain_volume * x;
        volume_label[block] += grain_volume * label;
        v2 += grain_volume * grain_volume;
        v2_label += grain_volume * grain_volume * label;
        v2_label2 += grain_volume * grain_volume * label * label;
    }
    double total() const;         ///< sum V
    double mean() const;          ///< p; NaN when empty
    double n_eff() const;         ///< (sum V)^2 / sum V^2; 0 when empty
    double iid_variance() const;  ///< of independent grains; 0 when empty
    double floor_variance() const;
};

enum class BlockTrend { none, linear };
/// Whether bins hold grains of their own (plain bins) or all the same grains (y-homogeneous): then n bins
/// know no more than one.
enum class BinGrains { own, common };

struct BinVariances {
    std::vector<double> variance;  ///< v_b; NaN for empty bins
    double degrees = 0;            ///< of v_b, mean over the bins that have a variance
};

/// Variance of p in every bin as above.
BinVariances bin_variances(const std::vector<BinMoments>& bins, BlockTrend trend, BinGrains grains);

/// v_b of the text from raw_b, a reference of the same shape and the degrees of freedom of each raw_b. NaN
/// entries stay NaN.
BinVariances pooled_variances(const std::vector<double>& raw, const std::vector<double>& reference,
                              const std::vector<double>& degrees, BinGrains grains);

/// p0 (1 - p0)/n_eff, p0 = 1/(n_eff + 2); NaN without grains.
double plateau_variance(double n_eff);

/// Blocks of about `block` [m] that cut [x_low, x_high) into equal parts; at least 5, so that a trend leaves
/// 3 degrees.
int block_count(double x_low, double x_high, double block);

/// No variances asked for: NaN for every bin.
BinVariances unknown_variances(int bins);

/// The moments as a profile.
GradationProfile profile_of(const std::vector<BinMoments>& moments, const BinVariances& variances,
                            const BinGrid& bins);
/// Last third minus first. A third holds too few blocks for a variance of its own, so the design effect of
/// the whole range, v_b / iid_b, is put on the thirds' variance of independent grains; floors as above.
XDrift drift_of(const std::vector<BinMoments>& whole, const BinVariances& whole_variances,
                const std::vector<BinMoments>& first, const std::vector<BinMoments>& last);
/// The same for columns of [x_low, x_high), equally wide: `columns` holds the moments of each, bin by bin.
GradationField field_of(const std::vector<BinMoments>& whole, const BinVariances& whole_variances,
                        const std::vector<std::vector<BinMoments>>& columns, const BinGrid& bins,
                        double x_low, double x_high);
/// Columns whose moments have blocks of their own, one for each of three replicates or more.
GradationField field_of(const std::vector<std::vector<BinMoments>>& columns, const BinGrid& bins,
                        double x_low, double x_high);
/// Sets value and noise_floor (rms over the bins that are defined) from difference and standard_error.
void summarise(XDrift& drift);

}  // namespace gradwright
