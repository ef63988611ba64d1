// Kinematic picture: every y-strip of the dispenser fully mixed in x and laid where it stood, blurred by the
// lateral spread (inverse-design.md, Fidelity ladder). No spread is run; right to 1 - f, where f is the
// captured share of the dose.
//   GI(y) = int N(y' - y; sigma_y) share_A(y') dy',  share_A(y') = part of the dispenser's length on A's side
//   at y' sigma_y = d sqrt(2 k L / H): k = 0.05, d = D50, L = travel, H = heap height. Source: random walk of
//   one grain diameter per heap turnover; k from shear-induced diffusion of dry grains. Validity: start
//   values, tests, teaching.
#pragma once
#include <optional>

#include "optimise/evaluation.h"

namespace gradwright {

class KinematicEvaluator : public Evaluator {
  public:
    /// `capture_fraction` f where a spread has told it [-]: the error bound is then 1 - f, else 1.
    explicit KinematicEvaluator(const Study& study, std::optional<double> capture_fraction = {});
    Evaluation evaluate(const Design& design, std::uint64_t seed) override;
    Fidelity fidelity() const override { return Fidelity::kinematic; }

  private:
    const Study& study_;
    std::optional<double> capture_fraction_;
};

/// sigma_y of a design [m].
double lateral_spread(const Study& study, const Design& design);

}  // namespace gradwright
