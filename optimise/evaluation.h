// One finished evaluation of one design at one fidelity, and the interface behind which every fidelity stands.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dem/gradation.h"
#include "optimise/study.h"

namespace gradwright {

enum class Fidelity { kinematic, map, full };
const char* to_string(Fidelity fidelity);

struct Evaluation {
    Design design;
    Fidelity fidelity = Fidelity::full;
    RunHealth health;  ///< status "ok" or why there are no numbers
    std::uint64_t seed = 0;
    GradationProfile profile;
    XDrift drift;
    GradationMap map;  ///< full only; map: relabelled
    std::vector<double> target, weight;  ///< per bin
    Misfit misfit, drift_misfit;
    double capture_fraction = 0, supply_ratio = 0, coverage = 0, waste_fraction = 0, packing_fraction = 0;
    double waste_a_share = 0;  ///< A's share of the overflow [-]
    double objective = 0;      ///< what a search minimises
    double kinematic_error_bound = 0;  ///< 1 - f where f is known, else 1
    long grains = 0, steps = 0;
    double grain_steps = 0, seconds = 0, seconds_cold = 0;
    int spreads = 0;  ///< DEM spreads whose result this used for the first time
    std::string state_hash;
    std::vector<double> residuals;  ///< sqrt(w) (gi - g) per counting bin, then sqrt(x_drift_weight) drift per bin
};

/// Design -> Evaluation. "Not evaluable" is a status in `health`.
class Evaluator {
  public:
    virtual ~Evaluator() = default;
    virtual Evaluation evaluate(const Design& design, std::uint64_t seed) = 0;
    virtual Fidelity fidelity() const = 0;
};

/// From run results to numbers, shared by every evaluator: fills misfits, objective and residuals.
void judge(const Study& study, Evaluation& evaluation);

}  // namespace gradwright
