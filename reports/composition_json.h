// Compositions as JSON: lengths in m, shares in wt%, undefined = null.
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "optimise/composition.h"
#include "optimise/evaluation.h"

namespace gradwright {

/// {"Fe": 75.45, ...} of one alloy [wt%].
nlohmann::json composition_json(const Material& alloy);

/// `composition` of `evaluate`: y_m, wt_fe, wt_ni of the powder as laid with band_low and band_high, objects
/// with one array for each of the two; mass_fraction_a; wt, every element; alloys with sources; `melt`: the
/// same after melting with the pool's numbers, null without a pool. `factor` as in powder_composition. Throws
/// as it does.
nlohmann::json composition_json(const GradationProfile& profile, const std::array<Material, 2>& alloys,
                                double factor, const std::optional<MeltPool>& pool);

/// The same over the bins of an evaluation, with the band of its GI (simultaneous 95 % over the defined
/// bins).
nlohmann::json composition_json(const Study& study, const Evaluation& evaluation,
                                const std::optional<MeltPool>& pool);
/// A table of it for people.
std::string composition_text(const Study& study, const Evaluation& evaluation,
                             const std::optional<MeltPool>& pool);

}  // namespace gradwright
