#include "optimise/material_table.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "optimise/toml_reader.h"

namespace gradwright {
namespace {

/// One number of a material: { value = "8200 kg/m3", source = "..." }.
double sourced(Section& material, const std::string& key, const std::string& dimension, const Range& range,
               const std::string& title, std::string& sources) {
    Section entry = material.sub(key);
    const double value = entry.quantity(
        "value", dimension, required("write { value = ..., source = \"where it comes from\" }"), range);
    const std::string source = entry.text("source", "", "");
    if (!entry.has("source")) entry.missing("source", "say where the number comes from");
    entry.finish();
    sources += fmt::format("{}{}: {}", sources.empty() ? "" : "; ", title, source);
    return value;
}

}  // namespace

std::vector<Material> read_materials(const std::string& file) {
    std::ifstream stream(file);
    std::stringstream text;
    text << stream.rdbuf();
    if (!stream)
        throw InputError{
            {{file, 0, "", "", "cannot be read", "set GRADWRIGHT_DATA to the folder of the shipped data"}}};
    TomlReader reader(text.str(), file, {});
    Section root(reader, &reader.root(), "", 0);
    std::vector<Material> materials;
    for (const auto& [key, node] : reader.root()) {
        Section section = root.sub(std::string(key.str()));
        if (!node.is_table()) continue;
        Material material;
        material.name = key.str();
        material.density =
            sourced(section, "density", "density", Range::above(0), "density", material.source);
        material.youngs_modulus = sourced(section, "youngs_modulus", "pressure", Range::above(0),
                                          "Young's modulus", material.source);
        material.poissons_ratio =
            sourced(section, "poissons_ratio", "", Range{.low = 0, .high = 0.5, .high_open = true},
                    "Poisson's ratio", material.source);
        section.finish();
        materials.push_back(std::move(material));
    }
    if (!reader.problems().empty()) throw InputError{reader.problems()};
    return materials;
}

std::vector<Material> shipped_materials() {
    return read_materials(data_folder() + "/materials.toml");
}

}  // namespace gradwright
