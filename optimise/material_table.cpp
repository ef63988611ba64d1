#include "optimise/material_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>

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

/// Symbols of the elements up to uranium: a misspelt one must not become a new element.
bool is_element(const std::string& symbol) {
    static constexpr std::string_view kSymbols =
        " H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr "
        "Rb "
        "Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu "
        "Hf Ta W Re Os Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U ";
    return kSymbols.find(" " + symbol + " ") != std::string_view::npos;
}

}  // namespace

void read_composition(Section& material, Material& into, const std::string& source) {
    if (!material.has("composition")) {
        material.know("composition");
        return;
    }
    Section composition = material.sub("composition");
    const TomlReader::Found found = composition.find("wt");
    Section wt = composition.sub("wt");
    const toml::table* table = found.node ? found.node->as_table() : nullptr;
    if (!found.node) composition.missing("wt", "write wt = { Ni = 52.5, Fe = \"balance\" }");
    std::string balance;
    double sum = 0;
    if (table)
        for (const auto& [key, node] : *table) {
            const std::string element(key.str());
            const TomlReader::Found at = wt.find(element);
            if (!is_element(element)) {
                wt.problem(at, element, "is no chemical symbol", "such as Fe, Ni, Cr");
            } else if (node.value<std::string>() == "balance") {
                if (!balance.empty())
                    wt.problem(at, element, "is a second balance", "only one element takes what is left");
                balance = element;
            } else {
                const double share = wt.number(element, {0, "a number of wt%, or \"balance\"", "given", true},
                                               Range::above_to(0, 100));
                into.composition.push_back({element, share});
                sum += share;
            }
        }
    if (sum > 100 + 1e-9)
        composition.problem(found, "wt", fmt::format("adds up to {:.6g} wt%", sum),
                            "100 wt% are all there is");
    else if (!balance.empty())
        into.composition.push_back({balance, 100 - sum});
    wt.finish();
    into.composition_source = composition.text("source", source, "not given");
    if (source.empty() && !composition.has("source"))
        composition.missing("source", "say where the numbers come from");
    composition.finish();
    std::stable_sort(
        into.composition.begin(), into.composition.end(),
        [](const ElementShare& a, const ElementShare& b) { return a.wt_percent > b.wt_percent; });
}

std::string composition_text(const Material& material) {
    std::string text;
    for (const ElementShare& share : material.composition)
        text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", share.element, share.wt_percent);
    return text.empty() ? "not known" : text;
}

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
        read_composition(section, material);
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
