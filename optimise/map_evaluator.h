// One spread, every partition: relabelling of an origin map measured on narrow periodic strips
// (inverse-design.md). The map belongs to the motion variables (dosage factor, land, fills); the partition
// and the footprint's place only relabel it.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "dem/homogeneous_estimator.h"
#include "optimise/heap_order.h"
#include "optimise/journal.h"
#include "optimise/spread_runner.h"

namespace gradwright {

/// The spreads without labels behind one set of motion variables.
struct OriginMap {
    RunHealth health;  ///< of the first spread that failed, else ok
    std::vector<Layer> layers;
    /// Of a map that was not spread but lies between others: what each layer counts, sum 1. Empty: a map that
    /// was spread.
    std::vector<double> share;
    /// Of a map that is read powder by powder, one for each layer: what stood in its bed. Else empty.
    std::vector<BedPowders> beds_of_layers;
    bool alike = false;                 ///< powders that move alike: read in the mirror too
    std::vector<SpreadResult> spreads;  ///< without pictures; of several layers only: what each of them is
    std::vector<BedFacts> beds;
    Scene scene;  ///< of the first strip
    std::uint64_t seed = 0;
    // means over the layers
    double capture_fraction = 0, packing_fraction = 0, waste_fraction = 0, bed_packing = 0;
    long grains = 0, steps = 0;
    double grain_steps = 0, seconds = 0, seconds_cold = 0;
    std::string state_hash;
    /// The laid grains in a range of x as this map reads them.
    PooledGrains pooled(double x_low, double x_high) const {
        return pool_map(layers, share, beds_of_layers, alike, x_low, x_high);
    }
    double share_of(std::size_t layer) const {
        return share.empty() ? 1 / double(layers.size()) : share[layer];
    }
    /// Sets the means from the layers.
    void average();
    /// A machine extrapolated from strips: the layer is the longest one's, stretched, and its errors are
    /// carried.
    std::optional<ScaledHeap> heap;
    bool told = false;  ///< its spreads and their time have been handed out with an evaluation
};

class MapEvaluator : public Evaluator {
  public:
    /// study.map_spreads strips are pooled per map. `journal` may be null; new strips are written to it with
    /// their layers as soon as they lie. All three must outlive the evaluator.
    MapEvaluator(const Study& study, SpreadRunner& runner, Journal* journal);

    /// Full answer with standard errors, GI map and plain bins. `seed` = first packing seed; 0 = the study's
    /// map seeds.
    Evaluation evaluate(const Design& design, std::uint64_t seed) override;
    Fidelity fidelity() const override { return Fidelity::map; }
    /// The same, not kept: for choosing between designs.
    Evaluation quoted(const Design& design);
    /// Hard-label misfits and objective only, in milliseconds: for searches.
    Evaluation quick(const Design& design);
    /// Runs the strips when these motion variables are new. The reference stays valid.
    OriginMap& map_of(const Design& design, std::uint64_t seed = 0);
    /// A map between those of `motions`, which were spread: each counts its share, sum 1, so that the GI of
    /// any partition is the same mean of theirs. Not kept, costs no spread.
    OriginMap between(const std::vector<Design>& motions, const std::vector<double>& share);
    /// `quick` on a map of that kind.
    Evaluation quick(const Design& design, OriginMap& map) { return with(design, map, false); }
    /// Adds the layer of another spread with the same motion, wide or narrow, periodic sides, to the map of
    /// `design`: its origins are as good as the strips'. `state_hash`: of that spread.
    void learn(const Design& design, const Layer& layer, const std::string& state_hash);
    /// From here on the map of `design` is read powder by powder: from its own strips for A, and from the
    /// strip of B alone, which was spread before.
    void read_by_powder(const Design& design);
    /// The same from spreads with both: adds the layer of one behind `partition`. The first takes the strips'
    /// place, in which no powder had the other beside it.
    void learn_powders(const Design& design, const Layer& layer, const PartitionCurve& partition,
                       const std::string& state_hash);
    /// The design on a map of its own: one strip with powder B in every grain, on a bed that no other map has
    /// seen. Held against the map of powder A it tells whether the two move alike.
    Evaluation with_powder_b(const Design& design);

  private:
    using Key = std::array<double, 6>;
    Key key_of(const Design& design, std::uint64_t seed) const;
    Evaluation with(const Design& design, OriginMap& map, bool quoted);

    /// Every layer of a run of several.
    std::vector<LaidLayer> read_layers(const Design& design, const OriginMap& map,
                                       const HomogeneousOptions& options) const;
    static void describe_turnover(const OriginMap& map, Evaluation& evaluation);

    const Study& study_;
    SpreadRunner& runner_;
    Journal* journal_;
    /// Spreads `count` strips into the map; `powder`: in every grain.
    void fill(OriginMap& map, const Design& design, std::uint64_t seed, int count, int powder);

    void extrapolate(OriginMap& map, const Design& design);

    std::map<Key, OriginMap> maps_, maps_b_;
};

/// Do A and B move alike by what they are, so that a label moves nothing and a spread with both is a map as
/// good as one without labels? Same sizes, densities within 5 %. Else a strip of B decides (powder_gate.h).
bool moves_alike(const Study& study);
/// Is a full spread between periodic sides as likely as its mirror image? Powders that move alike, and no
/// slot in the bed, which would tell left from right.
bool spreads_like_its_image(const Study& study);

/// Periodic strip laid side by side until it fills `width`: y-homogeneity as a picture, and for plain bins
/// [m].
Layer tiled(const Layer& strip, double width);

}  // namespace gradwright
