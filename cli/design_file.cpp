#include "cli/design_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>

#include "cli/common.h"
#include "optimise/design_run.h"

namespace gradwright::cli {

Design read_design(const std::string& file, const Study& study) {
    std::ifstream stream(file);
    if (!stream)
        throw Failure(ExitCode::io, fmt::format("cannot open the design file '{}'", file),
                      "--design takes the result.json of a design");
    std::vector<InputProblem> problems;
    const auto bad = [&](const std::string& key, const std::string& value, const std::string& rule) {
        problems.push_back(
            {file, 0, key, value, rule, "--design takes the result.json that 'gradwright design' wrote"});
    };
    Design design = start_design(study);
    try {
        nlohmann::json object = nlohmann::json::parse(stream);
        if (object.is_object() && object.contains("design")) object = object["design"];
        const nlohmann::json partition = object.value("partition", object);
        const std::string family = partition.value("family", std::string("polyline"));
        const std::optional<Family> known = family_of(family);
        if (!known) bad("partition.family", family, fmt::format("is one of {}", fmt::join(kFamilies, ", ")));
        design.family = known.value_or(Family::polyline);
        if (!partition.contains("points_m")) {
            bad("partition.points_m", "missing", "holds the [x, y] points of the curve in m");
        } else {
            design.partition.points.clear();
            for (const auto& point : partition["points_m"])
                design.partition.points.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
            if (design.partition.points.size() < 2)
                bad("partition.points_m", partition["points_m"].dump(), "needs at least two points");
            else if (design.partition.self_intersects())
                bad("partition.points_m", partition["points_m"].dump(), "must not cross itself");
        }
        design.partition.second.clear();
        if (partition.contains("points2_m")) {
            for (const auto& point : partition["points2_m"])
                design.partition.second.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
            if (design.partition.second.size() < 2)
                bad("partition.points2_m", partition["points2_m"].dump(), "needs at least two points");
            else if (design.partition.points.size() >= 2 &&
                     (design.partition.self_intersects() || design.partition.pair_disagrees()))
                bad("partition.points2_m", partition["points2_m"].dump(),
                    "must not meet itself or the first curve, and has A on its left as the first has");
        }
        design.parameters.clear();
        // named first: a range-for does not keep the temporary behind items() alive
        const nlohmann::json parameters = partition.value("parameters", nlohmann::json::object());
        for (const auto& [name, value] : parameters.items())
            if (value.is_number()) design.parameters.emplace_back(name, value.get<double>());
        const nlohmann::json fill = object.value("fill_fraction", nlohmann::json::object());
        design.fill_fraction = {fill.value("A", design.fill_fraction[0]),
                                fill.value("B", design.fill_fraction[1])};
        const nlohmann::json dose = object.value("dose", nlohmann::json::object());
        design.dose = {dose.value("A", design.dose[0]), dose.value("B", design.dose[1])};
        design.dosage_factor = object.value("dosage_factor", design.dosage_factor);
        design.land = object.value("land_m", design.land);
        design.blade_speed = object.value("blade_speed_m_s", design.blade_speed);
        design.layer_thickness = object.value("layer_thickness_m", design.layer_thickness);
        design.footprint_offset = object.value("footprint_offset_m", design.footprint_offset);
        for (const double fraction : design.fill_fraction)
            if (!(fraction > 0 && fraction <= 1))
                bad("fill_fraction", fmt::format("{}", fraction), "is above 0 and at most 1");
        for (const double dose_of : design.dose)
            if (!(dose_of > 0)) bad("dose", fmt::format("{}", dose_of), "is above 0");
        if (!(design.dosage_factor > 0))
            bad("dosage_factor", fmt::format("{}", design.dosage_factor), "is above 0");
        if (!(design.land >= 0)) bad("land_m", fmt::format("{}", design.land), "is not negative");
    } catch (const nlohmann::json::exception& error) {
        bad("", "", fmt::format("is not a design in JSON: {}", error.what()));
    }
    if (!problems.empty()) throw InputError{problems};
    return design;
}

}  // namespace gradwright::cli
