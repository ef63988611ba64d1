// The gate of the map strategy: do A and B, unlike by density or size, still move alike on this machine? One
// strip all of A (the map) and one all of B, read with the same partition (inverse-design.md, When a map
// holds). Where they differ, the map is a first guess and only spreads with both powders count.
#pragma once
#include "optimise/evaluation.h"

namespace gradwright {

struct PowderGate {
    bool passes = false;       ///< no difference found
    double difference = 0;     ///< rms over the bins that count, GI of all-B minus all-A [-]
    double noise = 0;          ///< rms of its standard error: a smaller difference could not be seen [-]
    double p_value = 1;        ///< of equal profiles, chi-squared over the bins that count
    double drift_p_value = 1;  ///< of equal x drift
};

/// Both evaluations with numbers, of the same design, from independent beds. Each test at half of 5 %, so
/// that alike powders pass in 95 of 100 gates.
PowderGate powder_gate(const Evaluation& all_a, const Evaluation& all_b, const std::vector<double>& weight);

}  // namespace gradwright
