#include "optimise/confirmation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> squared(const std::vector<double>& values) {
    std::vector<double> squares;
    for (const double value : values) squares.push_back(value * value);
    return squares;
}

double p_value(const std::vector<double>& confirmed, const std::vector<double>& error,
               const std::vector<double>& expected, const std::vector<double>& expected_variance,
               const std::vector<double>& weight) {
    std::vector<double> counting = confirmed;
    for (std::size_t b = 0; b < counting.size(); ++b)
        if (!(weight[b] > 0)) counting[b] = kNan;
    return equality_p_value(counting, expected, squared(error), expected_variance);
}

int rank(Verdict verdict) {
    return verdict == Verdict::met ? 2 : verdict == Verdict::undecided ? 1 : 0;
}

}  // namespace

double ConfirmedDesign::distance() const {
    const auto ratio = [](const Misfit& m) { return m.tolerance > 0 ? m.debiased / m.tolerance : 0; };
    return std::max(ratio(misfit), ratio(drift_misfit));
}

ConfirmedDesign unconfirmed(const Evaluation& predicted) {
    ConfirmedDesign round;
    round.design = predicted.design;
    round.predicted = predicted;
    round.expected = predicted.judged().gi;
    round.expected_variance = squared(predicted.judged().standard_error);
    round.expected_drift = predicted.drift.difference;
    round.expected_drift_variance = squared(predicted.drift.standard_error);
    return round;
}

void summarise(const Study& study, ConfirmedDesign& round) {
    if (round.confirmations.empty()) return;
    std::vector<GradationProfile> profiles;
    std::vector<GradationField> fields;
    std::vector<XDrift> drifts;
    for (const Evaluation& confirmation : round.confirmations) {
        profiles.push_back(confirmation.profile);
        fields.push_back(confirmation.field);
        drifts.push_back(confirmation.drift);
    }
    Evaluation together = round.confirmations.front();
    together.profile = mean_profile(profiles);
    if (study.target.is_field()) together.field = mean_field(fields);
    together.drift = mean_drift(drifts);
    judge(study, together);  // the same rule as for a single one
    round.mean = together.profile;
    round.field = together.field;
    round.drift = together.drift;
    round.misfit = together.misfit;
    round.drift_misfit = together.drift_misfit;
    round.verdict = together.health.ok() ? combine(verdict_of(round.misfit), verdict_of(round.drift_misfit))
                                         : Verdict::undecided;
    round.p_value = p_value(together.judged().gi, together.judged().standard_error, round.expected,
                            round.expected_variance, together.judged_weight());
    round.drift_p_value = p_value(round.drift.difference, round.drift.standard_error, round.expected_drift,
                                  round.expected_drift_variance, drift_weights(study));
}

bool better(const ConfirmedDesign& a, const ConfirmedDesign& b) {
    if (a.confirmations.empty() != b.confirmations.empty()) return b.confirmations.empty();
    if (rank(a.verdict) != rank(b.verdict)) return rank(a.verdict) > rank(b.verdict);
    return a.distance() < b.distance();
}

std::vector<double> smoothed_discrepancy(const std::vector<double>& confirmed,
                                         const std::vector<double>& predicted,
                                         const std::vector<double>& weight, int run) {
    const int bins = int(weight.size());
    const auto counts = [&](int b) {
        return b >= 0 && b < bins && weight[b] > 0 && std::isfinite(confirmed[b]) &&
               std::isfinite(predicted[b]);
    };
    std::vector<double> smooth(bins, 0.0);
    for (int b = 0; b < bins; ++b) {
        if (!counts(b)) continue;
        double sum = 0;
        int n = 0;
        for (int k = b - 1; k <= b + 1; ++k)
            if (counts(k) && k / run == b / run) {
                sum += confirmed[k] - predicted[k];
                ++n;
            }
        smooth[b] = sum / n;
    }
    return smooth;
}

}  // namespace gradwright
