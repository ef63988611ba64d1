// The quoted number: a full-width spread with both powders in the state, each with its own density, stiffness
// and sizes, on a packing seed of its own. It never reads an origin map: the profile is plain bins of the
// labels that the grains carried (inverse-design.md).
#pragma once
#include "optimise/journal.h"
#include "optimise/spread_runner.h"

namespace gradwright {

class DemEvaluator : public Evaluator {
  public:
    /// `journal` may be null. All must outlive the evaluator.
    DemEvaluator(const Study& study, SpreadRunner& runner, Journal* journal)
        : study_(study), runner_(runner), journal_(journal) {}
    /// `seed` = packing seed.
    Evaluation evaluate(const Design& design, std::uint64_t seed) override;
    Fidelity fidelity() const override { return Fidelity::full; }
    /// Of the last evaluate(): pictures and bed.
    const SpreadResult& last() const { return last_; }

  private:
    const Study& study_;
    SpreadRunner& runner_;
    Journal* journal_;
    SpreadResult last_;
};

}  // namespace gradwright
