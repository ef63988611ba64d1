// The free numbers of a study as one box: the family's parameters, then the motion variables, each as its
// share of its range. Every strategy that searches an evaluator (evaluator_search.h) moves in this box.
#pragma once
#include <array>
#include <vector>

#include "optimise/motion.h"
#include "optimise/partition_family.h"

namespace gradwright {

/// What may move. `labels`: only what relabels an origin map, the partition and the footprint's place; dosage
/// factor and land stay as the start has them, for each new value of theirs needs spreads of its own.
enum class Moves { everything, labels };

class SearchSpace {
  public:
    /// `start` gives all that is not free; `p` = the family's parameters at the start, clipped to its bounds.
    /// The footprint is kept whole on the platform: a cut one would be a smaller part, not a better place.
    SearchSpace(const Study& study, const PartitionFamily& family, const Design& start,
                const std::vector<double>& p, Moves moves = Moves::everything);

    const Study& study() const { return study_; }
    std::size_t size() const { return start_.size(); }
    const std::vector<double>& low() const { return low_; }
    const std::vector<double>& high() const { return high_; }
    const std::vector<double>& start() const { return start_; }
    /// First steps of a search: a tenth of the dispenser's width, a fifth of a motion variable's range.
    const std::vector<double>& step() const { return step_; }
    int free_count() const;
    /// `x` is clipped to the box, optimisers leave it by round-off, and moved to the nearest point that keeps
    /// the study's constraints.
    Design design(const std::vector<double>& x) const;
    /// The point that `design` takes for x.
    std::vector<double> kept(const std::vector<double>& x) const;
    /// Added to the objective at x: the square of the way to that point. 0 where x keeps the constraints.
    double detour(const std::vector<double>& x) const;
    /// What cannot be bent or lies too near to another plate: added to the objective there, 0 for sound
    /// designs and fixed partitions.
    double unsound(const std::vector<double>& x) const;

  private:
    /// Motion and partition numbers at a point of the box; the curve itself only where it is wanted.
    Design at(const std::vector<double>& inside, bool with_curve) const;

    Study study_;  ///< a copy: a space outlives whoever made it
    PartitionFamily family_;
    Design design_;
    bool partition_free_;
    struct Motion {
        double low = 0, range = 0;  ///< range 0: fixed
    };
    std::array<Motion, kMotionVariables.size()> motion_;  ///< in their order
    std::vector<double> low_, high_, start_, step_;
};

}  // namespace gradwright
