#include "reports/composition_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/json_support.h"
#include "reports/result_json.h"

namespace gradwright {
namespace {

using nlohmann::json;

/// What powder and metal have in common.
json profiles_json(const Composition& composition) {
    const BandedProfile &iron = composition.wt("Fe"), &nickel = composition.wt("Ni");
    json wt = json::object();
    for (const ElementProfile& element : composition.elements)
        wt[element.element] = numbers(element.wt.value);
    return {{"wt_fe", numbers(iron.value)},
            {"wt_ni", numbers(nickel.value)},
            {"band_low", {{"wt_fe", numbers(iron.low)}, {"wt_ni", numbers(nickel.low)}}},
            {"band_high", {{"wt_fe", numbers(iron.high)}, {"wt_ni", numbers(nickel.high)}}},
            {"mass_fraction_a", numbers(composition.mass_fraction_a.value)},
            {"mass_fraction_a_low", numbers(composition.mass_fraction_a.low)},
            {"mass_fraction_a_high", numbers(composition.mass_fraction_a.high)},
            {"wt", wt}};
}

json melt_json(const Composition& melted, const MeltPool& pool) {
    json object = profiles_json(melted);
    object["depth_m"] = number(pool.depth);
    object["width_m"] = number(pool.width);
    object["layer_thickness_m"] = number(pool.layer_thickness);
    object["new_share"] = number(pool.new_share());
    object["dilution"] = number(1 - pool.new_share());
    json base = json::array();
    for (int layer = 1; layer <= 50; ++layer) {
        base.push_back(number(pool.base_share(layer)));
        if (pool.base_share(layer) < 0.01) break;
    }
    object["base_share"] = base;
    object["scatter_factor"] = number(pool.scatter_factor());
    object["formula"] =
        "mean of the mass fraction of A over a window of the melt width in y, weighted by mass; layer n is "
        "(t/D) powder + (1 - t/D) layer n - 1, whose limit over equal layers is the powder's mean profile";
    object["assumes"] =
        "a fully mixed pool, layers laid alike, nothing evaporates; base_share: what is left of the base "
        "plate's composition in layer 1, 2, ...";
    return object;
}

}  // namespace

json composition_json(const Material& alloy) {
    json shares = json::object();
    for (const ElementShare& share : alloy.composition) shares[share.element] = number(share.wt_percent);
    return shares;
}

json composition_json(const GradationProfile& profile, const std::array<Material, 2>& alloys, double factor,
                      const std::optional<MeltPool>& pool) {
    json object = profiles_json(powder_composition(profile, alloys, factor));
    object["y_m"] = numbers(profile.y_m);
    object["unit"] = "wt%";
    object["band"] =
        "simultaneous 95 % band of GI over the bins, carried through density and nominal compositions, which "
        "count as exact";
    object["alloys"] = json::object();
    for (const int i : {0, 1})
        object["alloys"][i == 0 ? "A" : "B"] = {{"material", alloys[i].name},
                                                {"density_kg_m3", number(alloys[i].density)},
                                                {"wt", composition_json(alloys[i])},
                                                {"source", alloys[i].composition_source}};
    object["melt"] =
        pool ? melt_json(melted_composition(profile, alloys, factor, *pool), *pool) : json(nullptr);
    return object;
}

namespace {

std::array<Material, 2> alloys_of(const Study& study) {
    return {study.scene.powder[0].material, study.scene.powder[1].material};
}

}  // namespace

json composition_json(const Study& study, const Evaluation& evaluation, const std::optional<MeltPool>& pool) {
    return composition_json(evaluation.profile, alloys_of(study), band_factor(evaluation.profile), pool);
}

std::string composition_text(const Study& study, const Evaluation& evaluation,
                             const std::optional<MeltPool>& pool) {
    const double factor = band_factor(evaluation.profile);
    const Composition powder = powder_composition(evaluation.profile, alloys_of(study), factor);
    std::optional<Composition> melted;
    if (pool) melted = melted_composition(evaluation.profile, alloys_of(study), factor, *pool);
    const BandedProfile &iron = powder.wt("Fe"), &nickel = powder.wt("Ni");
    const auto cell = [](double value, const char* none) {
        return std::isfinite(value) ? fmt::format("{:6.2f}", value) : std::string(none);
    };
    const auto band = [&](const BandedProfile& wt, std::size_t b) {
        return std::isfinite(wt.low[b]) && std::isfinite(wt.high[b])
                   ? fmt::format("{:5.1f}-{:<5.1f}", wt.low[b], wt.high[b])
                   : std::string(11, ' ');
    };
    std::string text = fmt::format("    y mm   wt% Fe   95 % band    wt% Ni   95 % band{}\n",
                                   melted ? "    melted Fe      Ni" : "");
    for (std::size_t b = 0; b < powder.y_m.size(); ++b) {
        text +=
            fmt::format("  {:6.2f}   {}   {}   {}   {}", powder.y_m[b] * 1e3, cell(iron.value[b], "     -"),
                        band(iron, b), cell(nickel.value[b], "     -"), band(nickel, b));
        if (melted)
            text += fmt::format("      {}  {}", cell(melted->wt("Fe").value[b], "     -"),
                                cell(melted->wt("Ni").value[b], "     -"));
        text += "\n";
    }
    if (pool)
        text += fmt::format(
            "  melt      {:.0f} % of each pool is new powder; {:.0f} % of a base plate is left in layer 5\n",
            100 * pool->new_share(), 100 * pool->base_share(5));
    return text;
}

}  // namespace gradwright
