// What stands in the two chambers, and what that makes of the partition's shares.
//
// A map answers with the share s of the laid solid that came from chamber A's side. With a premix the powder
// of chamber k holds a share m_k of powder A; with unequal levels chamber k stands d_k = h - c_k above the
// rim in the pass (physics.md 1.3), c_k its headspace and what its own piston rises less than the other's, so
// that much less of it is there to be laid. To first order (the level
// step itself moves no powder) both act bin by bin,
//   GI = (s d_A m_A + (1 - s) d_B m_B) / (s d_A + (1 - s) d_B),
// which is s itself with pure powders and equal levels. Exact for a premix of powders that move alike.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "dem/gradation.h"
#include "optimise/study.h"

namespace gradwright {

struct ChamberFill {
    std::array<double, 2> share_a = {1, 0};  ///< m: share of powder A in the powder of chamber A, B [-]
    std::array<double, 2> dose = {1, 1};     ///< d, in any unit
    std::array<double, 2> later = {1, 1};    ///< d of every later pass: of the pistons alone

    bool pure() const { return share_a[0] == 1 && share_a[1] == 0; }
    bool level() const { return dose[0] == dose[1]; }
    /// Are later passes dosed in the same ratio?
    bool lasts() const {
        return std::fabs(dose[0] * later[1] - dose[1] * later[0]) <= 1e-9 * dose[0] * later[1];
    }

    /// GI of a bin whose share of chamber A is s, for double or ceres::Jet.
    template <class T>
    T gi(const T& s) const {
        if (pure() && level()) return s;
        if (level()) return share_a[1] + (share_a[0] - share_a[1]) * s;
        const T a = s * dose[0], b = (1.0 - s) * dose[1];
        return (a * share_a[0] + b * share_a[1]) / (a + b);
    }
    /// d GI / d s.
    template <class T>
    T slope(const T& s) const {
        const double rise = share_a[0] - share_a[1];
        if (level()) return T(rise);
        const T sum = s * dose[0] + (1.0 - s) * dose[1];
        return rise * dose[0] * dose[1] / (sum * sum);
    }
    /// Share of chamber A that gives this GI; 0 or 1 beyond what the two powders span.
    double side_share(double gi) const;

    /// GI that the same partition lays in later passes: fill fractions act in the first only, pistons of
    /// their own in all (physics.md 1.3).
    std::vector<double> levelled(const std::vector<double>& gi) const;

    /// The same chambers as they lay layer `number` (from 1) of several, 0 = all `layers` together: levels
    /// act in the first one only.
    ChamberFill of_layer(int number, int layers, double dose_height) const;

    /// Shares into GI, with their standard errors and cells.
    void apply(GradationProfile& profile, XDrift& drift) const;
    void apply(GradationProfile& profile) const;
    void apply(GradationMap& map) const;
};

/// Of the chambers of a study as a design fills and lifts them, for the judged layer.
ChamberFill chamber_fill(const Study& study, const Design& design);
/// Doubt about a map's profile `gi` at `y` [m] where the chambers stand at unequal levels: what is higher
/// than the other side by more than one grain (D50) flows sideways, nobody knows how far short of as far as
/// it is high. rms over the bins of |dGI/dy| (step - D50), by `weight`; 0 below one grain [-]. An estimate,
/// to weigh designs with, held against one spread (docs/search.md): 0.18 for a step of 126 um that added
/// 0.16.
double step_doubt(const Study& study, const Design& design, const GradationProfile& profile,
                  const std::vector<double>& weight);
/// For layer `number` from 1.
ChamberFill chamber_fill_of_layer(const Study& study, const Design& design, int number);

}  // namespace gradwright
