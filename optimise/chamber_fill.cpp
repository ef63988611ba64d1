#include "optimise/chamber_fill.h"

#include <algorithm>
#include <cmath>

#include "dem/block_variance.h"

namespace gradwright {

double ChamberFill::side_share(double gi) const {
    const double a = dose[0] * (share_a[0] - gi), b = dose[1] * (gi - share_a[1]);
    if (!(b > 0)) return 0;
    if (!(a > 0)) return 1;
    return b / (a + b);
}

std::vector<double> ChamberFill::levelled(const std::vector<double>& gi) const {
    std::vector<double> result;
    for (const double value : gi)
        result.push_back(std::isfinite(value) ? share_a[1] + (share_a[0] - share_a[1]) * side_share(value)
                                              : value);
    return result;
}

void ChamberFill::apply(GradationProfile& profile, XDrift& drift) const {
    if (pure() && level()) return;
    for (std::size_t b = 0; b < profile.gi.size() && b < drift.difference.size(); ++b) {
        const double rate = slope(profile.gi[b]);
        drift.difference[b] *= rate;
        drift.standard_error[b] *= rate;
    }
    apply(profile);
    summarise(drift);
}

void ChamberFill::apply(GradationProfile& profile) const {
    if (pure() && level()) return;
    for (std::size_t b = 0; b < profile.gi.size(); ++b) {
        const double s = profile.gi[b];
        profile.gi[b] = gi(s);
        profile.standard_error[b] *= slope(s);
    }
}

void ChamberFill::apply(GradationMap& map) const {
    if (pure() && level()) return;
    for (double& cell : map.gi) cell = gi(cell);
}

ChamberFill chamber_fill(const Study& study, const std::array<double, 2>& fill_fraction, double dose_height) {
    ChamberFill fill;
    fill.share_a = study.scene.share_a;
    for (int chamber = 0; chamber < 2; ++chamber)
        fill.dose[chamber] = dose_height - (1 - fill_fraction[chamber]) * study.scene.dispenser_depth;
    if (fill_fraction[0] == fill_fraction[1]) fill.dose = {1, 1};
    return fill;
}

ChamberFill chamber_fill(const Study& study, const Design& design) {
    return chamber_fill(study, design.fill_fraction, scene_of(study, design, false, 0).dose_height);
}

}  // namespace gradwright
