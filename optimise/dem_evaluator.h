// The quoted number: a full-width spread with both powders in the state, each with its own density, stiffness
// and sizes, on a packing seed of its own. It never reads an origin map (inverse-design.md): the profile
// comes from the labels that the grains of this spread carried. Powders that move alike between periodic
// sides move by the same law at every y, so there every laid grain tells of every y, by where it came from
// (homogeneous_estimator.h), and without a slot in the bed in the mirror too: half the noise of bins that
// count their own grains only. Those bins are kept
// beside it (`plain_check`), and are what is quoted when they contradict it as the bed lies, or where
// powders, sides or fills allow no such reading.
#pragma once
#include "optimise/chamber_fill.h"
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
    /// Fills profile, drift and their plain check from a labelled layer.
    void read_profile(const Layer& layer, const ChamberFill& fill, Evaluation& evaluation) const;
    GradationMap map_of(const Layer& layer) const;
    /// Every layer of a run of several.
    std::vector<LaidLayer> read_layers(const Evaluation& judged) const;

    const Study& study_;
    SpreadRunner& runner_;
    Journal* journal_;
    SpreadResult last_;
};

}  // namespace gradwright
