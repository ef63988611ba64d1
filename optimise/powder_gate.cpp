#include "optimise/powder_gate.h"

#include <cmath>

namespace gradwright {
namespace {

constexpr double kSignificance = 0.025;  // two tests

/// Only bins that count and have numbers on both sides.
struct Pairs {
    std::vector<double> a, b, variance_a, variance_b;
    void add(double x, double y, double sx, double sy) {
        if (!std::isfinite(x + y + sx + sy)) return;
        a.push_back(x);
        b.push_back(y);
        variance_a.push_back(sx * sx);
        variance_b.push_back(sy * sy);
    }
    double p_value() const { return a.empty() ? 1 : equality_p_value(a, b, variance_a, variance_b); }
};

}  // namespace

PowderGate powder_gate(const Evaluation& all_a, const Evaluation& all_b, const std::vector<double>& weight) {
    Pairs profile, drift;
    for (std::size_t k = 0; k < weight.size(); ++k) {
        if (!(weight[k] > 0)) continue;
        profile.add(all_a.profile.gi[k], all_b.profile.gi[k], all_a.profile.standard_error[k],
                    all_b.profile.standard_error[k]);
        drift.add(all_a.drift.difference[k], all_b.drift.difference[k], all_a.drift.standard_error[k],
                  all_b.drift.standard_error[k]);
    }
    PowderGate gate;
    for (std::size_t k = 0; k < profile.a.size(); ++k) {
        gate.difference += std::pow(profile.b[k] - profile.a[k], 2) / double(profile.a.size());
        gate.noise += (profile.variance_a[k] + profile.variance_b[k]) / double(profile.a.size());
    }
    gate.difference = std::sqrt(gate.difference);
    gate.noise = std::sqrt(gate.noise);
    gate.p_value = profile.p_value();
    gate.drift_p_value = drift.p_value();
    gate.passes = !profile.a.empty() && gate.p_value >= kSignificance && gate.drift_p_value >= kSignificance;
    return gate;
}

}  // namespace gradwright
