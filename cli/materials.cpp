// gradwright materials: what ships, with the source of every number.
#include <fmt/format.h>

#include <algorithm>

#include "cli/common.h"
#include "optimise/material_table.h"
#include "reports/composition_json.h"

namespace gradwright::cli {
namespace {

ExitCode run_materials(const CommonOptions& common) {
    const std::vector<Material> materials = shipped_materials();
    if (common.json) {
        auto rows = nlohmann::json::array();
        for (const Material& material : materials)
            rows.push_back({{"name", material.name},
                            {"density_kg_m3", material.density},
                            {"youngs_modulus_pa", material.youngs_modulus},
                            {"poissons_ratio", material.poissons_ratio},
                            {"source", material.source},
                            {"composition_wt", composition_json(material)},
                            {"composition_source", material.composition_source}});
        fmt::print("{}\n", json_text(nlohmann::json{{"materials", rows}}));
        return ExitCode::met;
    }
    fmt::print("{:<12} {:>13} {:>17} {:>15}\n", "material", "density", "Young's modulus", "Poisson's ratio");
    for (const Material& material : materials) {
        fmt::print("{:<12} {:>7.0f} kg/m3 {:>13.4g} GPa {:>15.2f}\n", material.name, material.density,
                   material.youngs_modulus / 1e9, material.poissons_ratio);
        // One source per number, a line each
        std::size_t from = 0;
        while (from < material.source.size()) {
            const std::size_t to = std::min(material.source.find("; ", from), material.source.size());
            fmt::print("    {}\n", material.source.substr(from, to - from));
            from = to + 2;
        }
        if (!material.composition.empty())
            fmt::print("    composition, wt%: {}\n    composition: {}\n", composition_text(material),
                       material.composition_source);
    }
    return ExitCode::met;
}

}  // namespace

void add_materials(CLI::App& app, Call& call) {
    CLI::App* verb = app.add_subcommand("materials", "Materials that ship, with their sources");
    add_output_options(*verb, call.options);
    verb->callback([&call] { call.run = [&call] { return run_materials(call.options); }; });
}

}  // namespace gradwright::cli
