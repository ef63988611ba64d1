#include "optimise/constraint_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "optimise/design_run.h"
#include "optimise/joined.h"

namespace gradwright {
namespace {

const char* const kExample =
    "[[constraint]] name = \"knots fall\", terms = { \"partition.y0\" = 1, \"partition.y1\" = -1 }, at_least "
    "= "
    "\"0.1 mm\"";

using Variables = std::vector<std::pair<std::string, std::string>>;  // name, dimension

std::string kind(const std::string& dimension) {
    return dimension.empty() ? "a plain number" : dimension == "angle" ? "an angle" : "a " + dimension;
}

std::string nearest(const std::string& name, const Variables& variables) {
    // most of a mistyped name stands at its beginning or at its end
    const auto common = [&](const std::string& other) {
        const auto front = std::mismatch(name.begin(), name.end(), other.begin(), other.end()).first;
        const auto back = std::mismatch(name.rbegin(), name.rend(), other.rbegin(), other.rend()).first;
        return (front - name.begin()) + (back - name.rbegin());
    };
    return std::max_element(variables.begin(), variables.end(),
                            [&](const auto& a, const auto& b) { return common(a.first) < common(b.first); })
        ->first;
}

/// Terms of one table: names may be quoted ("partition.y0") or dotted (partition.y0), which TOML nests.
void read_terms(Section& section, const TomlReader::Found& found, const toml::table& table,
                const std::string& prefix, const Variables& variables, LinearConstraint& constraint,
                bool& sound) {
    for (const auto& [key, node] : table) {
        const std::string name = prefix + std::string(key.str());
        if (const toml::table* inner = node.as_table()) {
            read_terms(section, found, *inner, name + ".", variables, constraint, sound);
            continue;
        }
        TomlReader::Found at = found;
        at.node = &node;
        const auto variable =
            std::find_if(variables.begin(), variables.end(), [&](const auto& v) { return v.first == name; });
        const std::optional<double> factor = node.value<double>();
        std::vector<std::string> names;
        for (const auto& [valid, dimension] : variables) names.push_back(valid);
        const std::string place = "terms.\"" + name + "\"";
        if (variable == variables.end()) {
            sound = false;
            section.problem(
                at, place, "is no variable of this design",
                fmt::format("did you mean \"{}\"? (valid: {})", nearest(name, variables), joined(names)));
        } else if (!node.is_number() || !factor || !std::isfinite(*factor) || *factor == 0) {
            sound = false;
            section.problem(at, place, "must be a finite number other than 0",
                            "a factor has no unit, such as 1 or -1");
        } else {
            if (constraint.terms.empty()) constraint.dimension = variable->second;
            if (constraint.dimension != variable->second) {
                sound = false;
                section.problem(at, place,
                                fmt::format("is {}, the terms before it are {}", kind(variable->second),
                                            kind(constraint.dimension)),
                                "constrain the two apart: factors have no unit");
            }
            constraint.terms.emplace_back(name, *factor);
        }
    }
}

/// SI of a variable where the user has said it: a fixed value, a start, given points.
std::optional<double> said(const TomlReader& reader, const Study& study, const Design& start,
                           const std::string& name) {
    const DesignSpace& space = study.design_space;
    const auto given = [&](const Variable& variable, const std::string& path) -> bool {
        if (!variable.free) return true;
        const toml::node* node = reader.root().at_path(path).node();
        return node && node->is_table() && node->as_table()->contains("start");
    };
    const std::string path = "design_space." + name;
    for (const auto& [variable, value] :
         {std::pair{&space.dosage_factor, start.dosage_factor},
          std::pair{&space.land, space.land.free || start.land >= 0 ? start.land : study.scene.land},
          std::pair{&space.footprint_offset, start.footprint_offset}})
        if (variable->name == name) return given(*variable, path) ? std::optional(value) : std::nullopt;
    for (const Variable* variable :
         {&space.angle_deg, &space.offset, &space.centre, &space.height, &space.place, &space.width_10_90})
        if (variable->name == name) {
            if (!given(*variable, path)) return {};
            return name == "partition.angle" ? variable->value * std::numbers::pi / 180 : variable->value;
        }
    if (space.given_points.empty()) return {};
    Study alone = study;
    alone.constraints = {{"", {{name, 1.0}}, -1e300, 1e300, "length"}};
    const std::vector<ConstraintState> state = constraint_states(alone, start);
    return state.empty() ? std::nullopt : std::optional(state.front().value);
}

}  // namespace

void read_constraints(TomlReader& reader, Section& root, Study& study) {
    const TomlReader::Found found = root.find("constraint");
    if (!found.node) return;
    const toml::array* array = found.node->as_array();
    if (!array) {
        root.problem(found, "constraint", "must be a list of tables", fmt::format("write {}", kExample));
        return;
    }
    // Without a machine and a design space that can be read there are no variables to name.
    const bool readable = reader.sound({"machine", "design_space", "process"});
    const Variables variables = readable ? constraint_variables(study) : Variables{};
    int index = 0;
    for (const toml::node& item : *array) {
        const std::string key = fmt::format("constraint[{}]", index++);
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        if (!item.is_table()) {
            root.problem(at, key, "must be a table", fmt::format("write {}", kExample));
            continue;
        }
        Section section(reader, item.as_table(), key, at.line);
        LinearConstraint constraint;
        constraint.name = section.text("name", fmt::format("constraint {}", index), "its place in the study");
        const TomlReader::Found terms = section.find("terms");
        bool sound = terms.node != nullptr;
        if (!terms.node) {
            section.missing("terms", fmt::format("name its variables, as in {}", kExample));
        } else if (!terms.node->is_table() || terms.node->as_table()->empty()) {
            sound = false;
            section.problem(terms, "terms", "must be a table of variables and factors",
                            fmt::format("as in {}", kExample));
        } else if (readable) {
            read_terms(section, terms, *terms.node->as_table(), "", variables, constraint, sound);
        }
        const std::string& dimension = constraint.dimension;
        const bool units_known = sound && readable;
        if (!section.has("at_least") && !section.has("at_most")) {
            sound = false;
            section.missing("at_least", "give at_least, at_most or both");
        }
        for (const bool low : {true, false}) {
            const char* bound = low ? "at_least" : "at_most";
            if (units_known && section.has(bound))
                (low ? constraint.low : constraint.high) = section.quantity(
                    bound, dimension, required("a bound on the sum of the terms"), Range::between(-1e6, 1e6));
            section.know(bound);
        }
        section.finish();
        for (const LinearConstraint& other : study.constraints)
            if (other.name == constraint.name)
                section.problem(section.find("name"), "name",
                                fmt::format("\"{}\" is the name of another constraint", other.name),
                                "give it a name of its own");
        if (constraint.low > constraint.high && reader.sound({key + ".at_least", key + ".at_most"}))
            section.problem(section.find("at_least"), "at_least", "must not be above at_most",
                            "swap the two");
        if (!sound || !readable || !reader.sound({key})) continue;
        std::string text;
        for (const auto& [name, factor] : constraint.terms)
            text += fmt::format("{}{:g} {}",
                                text.empty() ? ""
                                : factor < 0 ? " - "
                                             : " + ",
                                text.empty() ? factor : std::abs(factor), name);
        reader.record({key + ".terms", text, "", "given", constraint.name});
        study.constraints.push_back(constraint);

        // What the user himself has set must keep it; what is free is moved.
        if (!reader.sound({"target", "powder"})) continue;
        const Design start = start_design(study);
        double sum = 0;
        bool all_said = true;
        for (const auto& [name, factor] : constraint.terms) {
            const std::optional<double> value = said(reader, study, start, name);
            all_said = all_said && value;
            if (value) sum += factor * *value;
        }
        const double slack = std::min(sum - constraint.low, constraint.high - sum);
        if (all_said && slack < -1e-12)
            section.problem(terms, "terms",
                            fmt::format("add up to {} with the values and starts given: {} beyond the bound",
                                        format_quantity(sum, dimension), format_quantity(-slack, dimension)),
                            "change those values, or the bound");
    }
}

}  // namespace gradwright
