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
    ChamberFill level = *this;
    level.dose = later;
    std::vector<double> result;
    for (const double value : gi)
        result.push_back(std::isfinite(value) ? level.gi(side_share(value)) : value);
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

ChamberFill ChamberFill::of_layer(int number, int layers, double dose_height) const {
    ChamberFill fill = *this;
    if (level() || number == 1) return fill;
    if (number > 1)
        fill.dose = later;
    else
        for (std::size_t k = 0; k < 2; ++k) fill.dose[k] += (layers - 1) * dose_height * later[k];
    return fill;
}

ChamberFill chamber_fill_of_layer(const Study& study, const Design& design, int number) {
    ChamberFill fill;
    fill.share_a = study.scene.share_a;
    const Scene scene = scene_of(study, design, false, 0);
    if (design.fill_fraction[0] != design.fill_fraction[1] || design.dose[0] != design.dose[1])
        for (int chamber = 0; chamber < 2; ++chamber)
            fill.dose[chamber] = scene.dose_height - scene.headspace[chamber];
    fill.later = design.dose;
    // `dose` is a ratio to the common rise, the scene's height that of the larger piston
    return fill.of_layer(number, study.scene.layers,
                         scene.dose_height / std::max(design.dose[0], design.dose[1]));
}

double step_doubt(const Study& study, const Design& design, const GradationProfile& profile,
                  const std::vector<double>& weight) {
    const Scene scene = scene_of(study, design, false, 0);
    const double grain = std::min(scene.powder[0].size.d50, scene.powder[1].size.d50),
                 beyond = std::fabs(scene.headspace[0] - scene.headspace[1]) - grain;
    if (!(beyond > 0)) return 0;
    double sum = 0, all = 0;
    const std::size_t bins = profile.gi.size();
    for (std::size_t b = 0; b < bins; ++b) {
        const std::size_t from = b > 0 ? b - 1 : b, to = std::min(b + 1, bins - 1);
        if (!(weight[b] > 0) || from == to) continue;
        const double slope = (profile.gi[to] - profile.gi[from]) / (profile.y_m[to] - profile.y_m[from]);
        if (!std::isfinite(slope)) continue;
        sum += weight[b] * slope * slope;
        all += weight[b];
    }
    return all > 0 ? beyond * std::sqrt(sum / all) : 0;
}

ChamberFill chamber_fill(const Study& study, const Design& design) {
    return chamber_fill_of_layer(study, design, judged_number(study));
}

}  // namespace gradwright
