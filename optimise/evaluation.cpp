#include "optimise/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gradwright {
namespace {

constexpr double kRoundOff = 1e-9;  // bin edges are products of decimal lengths: relative to a bin

/// Mean of the zone weights over [low, high): exact for the piecewise constant weight.
double mean_weight(const Target& target, double low, double high) {
    std::vector<double> cuts = {low, high};
    for (const TargetZone& zone : target.zones)
        for (const double y : {zone.y_low, zone.y_high})
            if (y > low && y < high) cuts.push_back(y);
    std::sort(cuts.begin(), cuts.end());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        sum += (cuts[i + 1] - cuts[i]) * target.weight(0.5 * (cuts[i] + cuts[i + 1]));
    return sum / (high - low);
}

/// Does the bin lie in the footprint and outside the side margins of 2 D90?
bool judged_bin(const Study& study, int bin) {
    const double margin = 2 * study.full_coarsening *
                          std::max(study.scene.powder[0].size.volume_quantile(0.9),
                                   study.scene.powder[1].size.volume_quantile(0.9));
    const double slack = kRoundOff * study.bins.width;
    const double low = std::max(study.footprint.y_low, margin) - slack;
    const double high = std::min(study.footprint.y_high, study.dispenser_width - margin) + slack;
    const double y = study.bins.low(bin);
    return y >= low && y + study.bins.width <= high;
}

/// Target per bin, of a field its mean over [x_low, x_high).
std::vector<double> targets_over(const Study& study, double x_low, double x_high) {
    const Target target = study.target.over_x(x_low, x_high);
    std::vector<double> mean(study.bins.count);
    for (int bin = 0; bin < study.bins.count; ++bin)
        mean[bin] = target.bin_mean(study.bins.low(bin), study.bins.low(bin) + study.bins.width);
    return mean;
}

/// x range of a column of the footprint [m].
std::pair<double, double> column_of(const Study& study, int column) {
    const double low = study.footprint.x_low, width = (study.footprint.x_high - low) / study.columns;
    return {low + column * width, low + (column + 1) * width};
}

void widen_as_one(Misfit& misfit, double degrees) {
    const double one = 1;  // one-sided 95 % is two-sided 90 %
    const double margin = simultaneous_factor({&one, 1}, 0.9, degrees) * misfit.noise_floor;
    misfit.interval_low = std::min(misfit.interval_low, std::max(0.0, misfit.value - margin));
    misfit.interval_high = std::max(misfit.interval_high, std::min(1.0, misfit.value + margin));  // of GI
}

}  // namespace

const char* to_string(Fidelity fidelity) {
    switch (fidelity) {
        case Fidelity::kinematic:
            return "kinematic";
        case Fidelity::map:
            return "map";
        case Fidelity::full:
            return "full";
        case Fidelity::lammps:
            return "lammps";
    }
    return "unknown";
}

Footprint footprint_of(const Study& study, const Design& design) {
    Footprint footprint = study.footprint;
    const double length = study.scene.platform_length;
    footprint.x_low = std::clamp(footprint.x_low + design.footprint_offset, 0.0, length);
    footprint.x_high = std::clamp(footprint.x_high + design.footprint_offset, 0.0, length);
    footprint.y_low = std::max(footprint.y_low, 0.0);
    footprint.y_high = std::min(footprint.y_high, study.dispenser_width);
    return footprint;
}

std::vector<double> bin_weights(const Study& study) {
    std::vector<double> weight(study.bins.count, 0.0);
    for (int bin = 0; bin < study.bins.count; ++bin) {
        if (!judged_bin(study, bin)) continue;
        const double y = study.bins.low(bin);
        weight[bin] =
            study.target.is_field()
                ? study.target
                      .weight_over(study.footprint.x_low, study.footprint.x_high, y, y + study.bins.width)
                      .mean
                : mean_weight(study.target, y, y + study.bins.width);
    }
    return weight;
}

std::vector<double> bin_targets(const Study& study) {
    return targets_over(study, study.footprint.x_low, study.footprint.x_high);
}

std::vector<double> field_targets(const Study& study) {
    std::vector<double> target;
    if (!study.target.is_field()) return target;
    for (int column = 0; column < study.columns; ++column) {
        const auto [low, high] = column_of(study, column);
        const std::vector<double> of_column = targets_over(study, low, high);
        target.insert(target.end(), of_column.begin(), of_column.end());
    }
    return target;
}

std::vector<double> field_weights(const Study& study) {
    std::vector<double> weight;
    if (!study.target.is_field()) return weight;
    for (int column = 0; column < study.columns; ++column) {
        const auto [low, high] = column_of(study, column);
        for (int bin = 0; bin < study.bins.count; ++bin) {
            const double y = study.bins.low(bin);
            weight.push_back(judged_bin(study, bin)
                                 ? study.target.weight_over(low, high, y, y + study.bins.width).mean
                                 : 0);
        }
    }
    return weight;
}

std::vector<double> drift_targets(const Study& study) {
    std::vector<double> change(study.bins.count, 0.0);
    if (!study.target.is_field()) return change;
    const double low = study.footprint.x_low, high = study.footprint.x_high, third = (high - low) / 3;
    const std::vector<double> first = targets_over(study, low, low + third);
    change = targets_over(study, high - third, high);
    for (int bin = 0; bin < study.bins.count; ++bin) change[bin] -= first[bin];
    return change;
}

std::vector<double> drift_weights(const Study& study) {
    std::vector<double> weight = bin_weights(study);
    const double low = study.footprint.x_low, high = study.footprint.x_high, third = (high - low) / 3;
    for (int bin = 0; bin < study.bins.count; ++bin) {
        if (!(weight[bin] > 0)) continue;
        weight[bin] = 1;  // physics.md 5: rms over y, unweighted, over the bins that count
        if (!study.target.is_field()) continue;
        const double y = study.bins.low(bin), y_high = y + study.bins.width;
        const double least = std::min(study.target.weight_over(low, low + third, y, y_high).least,
                                      study.target.weight_over(high - third, high, y, y_high).least);
        weight[bin] = least > 0 ? 1 : 0;
    }
    return weight;
}

void allow_for_beds(Evaluation& evaluation, BedAllowance variance_ratio) {
    for (double& s : evaluation.profile.standard_error) s *= std::sqrt(variance_ratio.profile);
    for (double& s : evaluation.drift.standard_error) s *= std::sqrt(variance_ratio.drift);
    evaluation.drift.noise_floor *= std::sqrt(variance_ratio.drift);
    const double columns = std::max<double>(1, static_cast<double>(evaluation.field.x_m.size()));
    for (double& s : evaluation.field.cells.standard_error)
        s *= std::sqrt(1 + (variance_ratio.profile - 1) / columns);
}

std::vector<ConstraintState> limit_states(const Study& study, const Evaluation& evaluation) {
    if (evaluation.fidelity == Fidelity::kinematic || !evaluation.health.ok()) return {};
    return limit_states(study, evaluation.waste_fraction, evaluation.supply_ratio);
}

void judge(const Study& study, Evaluation& evaluation) {
    const Objective& objective = study.objective;
    evaluation.target = bin_targets(study);
    evaluation.weight = bin_weights(study);
    evaluation.field_target = field_targets(study);
    evaluation.field_weight = field_weights(study);
    evaluation.residuals.clear();
    evaluation.objective = kNotEvaluable;
    if (!evaluation.health.ok()) return;

    const std::size_t bins = evaluation.target.size();
    const auto sized = [bins](std::vector<double>& values, double fill) { values.resize(bins, fill); };
    sized(evaluation.profile.gi, std::numeric_limits<double>::quiet_NaN());
    // Unknown noise stays unknown: a verdict on it is "undecided".
    sized(evaluation.profile.standard_error, std::numeric_limits<double>::quiet_NaN());
    sized(evaluation.drift.difference, std::numeric_limits<double>::quiet_NaN());
    sized(evaluation.drift.standard_error, std::numeric_limits<double>::quiet_NaN());

    GradationProfile& judged = evaluation.judged();
    const std::vector<double>& weight = evaluation.judged_weight();
    const std::vector<double>& target =
        evaluation.field_target.empty() ? evaluation.target : evaluation.field_target;
    judged.gi.resize(target.size(), std::numeric_limits<double>::quiet_NaN());
    judged.standard_error.resize(target.size(), std::numeric_limits<double>::quiet_NaN());

    double weight_sum = 0;
    int counting = 0, counting_drift = 0, wanted = 0;
    for (std::size_t b = 0; b < target.size(); ++b) {
        if (!(weight[b] > 0)) continue;
        ++wanted;
        if (!std::isfinite(judged.gi[b])) continue;
        ++counting;
        weight_sum += weight[b];
    }
    std::vector<double> drift_weight = drift_weights(study);
    for (std::size_t b = 0; b < bins; ++b) {
        if (!std::isfinite(evaluation.drift.difference[b])) drift_weight[b] = 0;
        counting_drift += drift_weight[b] > 0;
    }
    if (counting == 0) {
        evaluation.health.status = "no_bins";
        evaluation.health.reason =
            wanted == 0
                ? "no bin lies in the footprint outside the side margins of 2 D90: widen the footprint or "
                  "narrow the bins"
                : "no counting bin holds a grain: raise the dosage factor or move the footprint";
        return;
    }

    evaluation.misfit = misfit(objective.norm, judged.gi, target, weight, judged.standard_error,
                               objective.tolerance, judged.degrees);
    const std::vector<double> drift_target = drift_targets(study);
    double drift = 0;
    if (counting_drift > 0) {
        evaluation.drift_misfit =
            misfit(Norm::rmse, evaluation.drift.difference, drift_target, drift_weight,
                   evaluation.drift.standard_error, objective.x_drift_tolerance, evaluation.drift.degrees);
        drift = evaluation.drift_misfit.value;
        // The same bins everywhere: the number beside the misfit is the number the verdict is about.
        evaluation.drift.value = drift;
        evaluation.drift.noise_floor = evaluation.drift_misfit.noise_floor;
    }

    if (evaluation.one_error) {
        widen_as_one(evaluation.misfit, evaluation.profile.degrees);
        widen_as_one(evaluation.drift_misfit, evaluation.drift.degrees);
    }

    for (std::size_t b = 0; b < target.size(); ++b)
        if (weight[b] > 0 && std::isfinite(judged.gi[b]))
            evaluation.residuals.push_back(std::sqrt(weight[b] / weight_sum) * (judged.gi[b] - target[b]));
    for (std::size_t b = 0; b < bins; ++b)
        if (drift_weight[b] > 0)
            evaluation.residuals.push_back(std::sqrt(objective.x_drift_weight / counting_drift) *
                                           (evaluation.drift.difference[b] - drift_target[b]));

    const double value = evaluation.misfit.value;
    // Empty bins leave the norm; they must not become a way to a better objective.
    const double missing = double(wanted - counting) / wanted;
    evaluation.objective = std::sqrt(value * value + objective.x_drift_weight * drift * drift) +
                           objective.waste_weight * evaluation.waste_fraction + missing;
    evaluation.objective += kBrokenPrice * broken(limit_states(study, evaluation));
    for (const ConstraintState& limit : limit_states(study, evaluation))
        evaluation.residuals.push_back(kBrokenPrice * std::max(0.0, -limit.slack / limit.scale));
    // The kinematic picture knows no coverage.
    if (evaluation.fidelity != Fidelity::kinematic)
        evaluation.objective += std::max(0.0, objective.min_coverage - evaluation.coverage);
}

}  // namespace gradwright
