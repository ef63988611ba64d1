// What one full spread shows beyond its profile: GI map, GI(y) with a straight line through it, the velocity
// field ahead of the blade with its circulation, and the mixing in the heap. These are the figures 4 to 7 of
// Choudhury, Annabattula, Amirthalingam (Multi-Material Spreading Strategies for FGM Manufacturing in LPBF),
// for any study.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dem/heap.h"
#include "optimise/composition.h"
#include "optimise/evaluation.h"
#include "targets/linear_fit.h"

namespace gradwright {

/// Saved instants that the figures ask of a spread: about one every tenth of a millimetre in the examples.
inline constexpr int kFigureInstants = 80;

/// A straight line through one quantity over the partition's extent in y.
struct ProfileFit {
    std::string quantity;       ///< "gi" | "mass_fraction_a" | "mass_fraction_a_melted"
    std::vector<double> value;  ///< in the fine bins [-]
    LinearFit line;
};

struct SpreadFigures {
    // GI(y), fig. 7
    GradationProfile
        fine;  ///< bins of an eighth of the partition's extent, at most the study's, at least D50/2
    double y_low = 0, y_high = 0;  ///< the partition's extent across the dispenser [m]
    double unmixed_slope = 0;  ///< +-1/(y_high - y_low): every y-strip mixed along x, nothing across [1/m]
    std::vector<ProfileFit> fits;  ///< over bins whose centre lies in the extent; empty when it is too narrow
    std::optional<Composition> powder, melted;  ///< in the fine bins; when asked for
    // velocity, fig. 5
    HeapField field;
    HeapRotation rotation;
    double blade_speed = 0;  ///< [m/s]
    // mixing, fig. 6
    std::vector<HeapMixing> mixing;  ///< one per instant with a heap
    HeapMixingOptions mixing_options;
    std::vector<std::size_t> shown;  ///< indices of the snapshots drawn: blade over dispenser, at its end,
                                     ///< over the platform's middle, at its end
    std::vector<HeapMixing> shown_mixing;
    // the powder, fig. 2
    std::vector<double> made_d10_d50_d90;  ///< of the set of grains made, by volume [m]
    double bed_packing = 0;                ///< packing fraction of the settled bed [-]
    double bond_number = 0;                ///< F_po/(m g) of the median grain, as computed
};

/// Options of the composition: none = not asked for.
struct CompositionRequest {
    std::optional<MeltPool> pool;
};

/// `spread` needs snapshots and labels (fidelity full, status ok).
SpreadFigures spread_figures(const Study& study, const Design& design, const SpreadResult& spread,
                             const std::optional<CompositionRequest>& composition);

/// `figures` of evaluation.json; lengths in m, undefined = null.
nlohmann::json figures_json(const Study& study, const SpreadFigures& figures,
                            const std::optional<CompositionRequest>& composition);
/// The same in a few lines for people.
std::string figures_text(const SpreadFigures& figures);

/// Writes beds.svg, gi_map.svg, gi_map.vtkhdf, gi_line.svg, heap_velocity.svg, heap_velocity.vtkhdf,
/// heap_mixing.svg, composition.svg (when asked for) and the drawn instants as particles_*.vtkhdf with their
/// series. Returns the names, relative to `folder`. Throws std::runtime_error naming the path.
std::vector<std::string> write_figures(const Study& study, const Evaluation& evaluation,
                                       const SpreadResult& spread, const SpreadFigures& figures,
                                       const std::string& folder);

}  // namespace gradwright
