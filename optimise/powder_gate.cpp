#include "optimise/powder_gate.h"

#include <algorithm>
#include <cmath>

namespace gradwright {
namespace {

constexpr double kSignificance = 0.025;  // two tests

}  // namespace

PowderGate powder_gate(const Evaluation& all_a, const Evaluation& all_b, const std::vector<double>& weight) {
    PowderGate gate;
    int counting = 0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
        const double difference = all_b.profile.gi[k] - all_a.profile.gi[k],
                     variance = std::pow(all_a.profile.standard_error[k], 2) +
                                std::pow(all_b.profile.standard_error[k], 2);
        if (!(weight[k] > 0) || !std::isfinite(difference + variance)) continue;
        gate.difference += difference * difference;
        gate.noise += variance;
        ++counting;
    }
    gate.difference = std::sqrt(gate.difference / std::max(counting, 1));
    gate.noise = std::sqrt(gate.noise / std::max(counting, 1));
    gate.p_value = bins_p_value(all_a.profile.gi, all_a.profile.standard_error, all_b.profile.gi,
                                all_b.profile.standard_error, weight);
    gate.drift_p_value = bins_p_value(all_a.drift.difference, all_a.drift.standard_error,
                                      all_b.drift.difference, all_b.drift.standard_error, weight);
    gate.passes = counting > 0 && gate.p_value >= kSignificance && gate.drift_p_value >= kSignificance;
    return gate;
}

}  // namespace gradwright
