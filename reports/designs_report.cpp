#include "reports/designs_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "reports/html_report.h"
#include "reports/provenance.h"

extern "C" {
extern const char gradwright_designs_js[], gradwright_designs_js_end[];
}

namespace gradwright {
namespace {

using nlohmann::json;

/// The last part of each folder's name; the whole where two are alike.
std::vector<std::string> names_of(const std::vector<FinishedDesign>& designs) {
    std::vector<std::string> names;
    for (const FinishedDesign& one : designs) {
        const auto path = std::filesystem::path(one.folder).lexically_normal();
        names.push_back((path.has_filename() ? path : path.parent_path()).filename().string());
    }
    std::vector<std::string> out = names;
    for (std::size_t k = 0; k < names.size(); ++k)
        if (std::count(names.begin(), names.end(), names[k]) > 1 || names[k].empty())
            out[k] = designs[k].folder;
    return out;
}

json row_of(const FinishedDesign& one, const std::string& name) {
    if (!one.data.is_object() || one.data.value("format", "") != "gradwright-report-1")
        throw std::runtime_error(one.folder + "/report_data.json holds no design of this program");
    const json& result = one.data.at("result");
    json row = {{"name", name}, {"folder", one.folder}};
    for (const char* key :
         {"study", "target", "verdict", "verdict_text", "target_met", "termination", "misfit", "coverage",
          "capture_fraction", "supply_ratio", "waste_fraction", "packing_fraction", "spreads", "seconds",
          "seconds_cold", "seed", "reductions", "design", "profile"})
        row[key] = result.contains(key) ? result.at(key) : json();
    row["x_drift"] = result.at("x_drift");
    row["x_drift"].erase("profile");
    const json& plan = one.data.at("plan");
    for (const char* key : {"dispenser_length_m", "width_m", "curve", "curve2", "outline_a", "outline_b"})
        row["plan"][key] = plan.contains(key) ? plan.at(key) : json::array();
    return row;
}

/// Inputs that are not the same in all, in the order of the first design that has them.
json differences_of(const std::vector<FinishedDesign>& designs) {
    std::vector<std::string> order;
    std::vector<std::map<std::string, std::string>> values(designs.size());
    for (std::size_t k = 0; k < designs.size(); ++k)
        for (const json& input : designs[k].data.at("result").at("inputs")) {
            const std::string key = input.at("key");
            values[k][key] = input.at("value");
            if (std::find(order.begin(), order.end(), key) == order.end()) order.push_back(key);
        }
    auto out = json::array();
    for (const std::string& key : order) {
        auto row = json::array();
        for (const auto& of : values) row.push_back(of.contains(key) ? json(of.at(key)) : json());
        if (std::any_of(row.begin(), row.end(), [&](const json& v) { return v != row.front(); }))
            out.push_back({{"key", key}, {"values", row}});
    }
    return out;
}

std::string shown(const json& value, int digits, double factor = 1) {
    return value.is_number() ? fmt::format("{:.{}f}", factor * value.get<double>(), digits) : "-";
}

}  // namespace

json designs_json(const std::vector<FinishedDesign>& designs) {
    const std::vector<std::string> names = names_of(designs);
    auto rows = json::array();
    for (std::size_t k = 0; k < designs.size(); ++k) rows.push_back(row_of(designs[k], names[k]));
    const bool same = std::all_of(rows.begin(), rows.end(), [&](const json& row) {
        return row["profile"]["y_m"] == rows[0]["profile"]["y_m"] &&
               row["profile"]["target"] == rows[0]["profile"]["target"];
    });
    return {{"format", "gradwright-designs-1"},
            {"designs", rows},
            {"same_target", same},
            {"differences", differences_of(designs)},
            {"provenance", provenance_json()}};
}

std::string designs_text(const json& object) {
    std::size_t width = 6;
    for (const json& row : object.at("designs"))
        width = std::max(width, row.at("name").get<std::string>().size());
    std::string out = fmt::format("{:<{}}  {:<9} {:>7} {:>16} {:>7} {:>8} {:>9} {:>7} {:>8} {:>8}\n",
                                  "design", width, "verdict", "misfit", "95 % bounds", "floor", "x drift",
                                  "coverage", "waste", "spreads", "seconds");
    for (const json& row : object.at("designs")) {
        const json& misfit = row.at("misfit");
        out += fmt::format("{:<{}}  {:<9} {:>7} {:>7} to {:>5} {:>7} {:>8} {:>7} % {:>5} % {:>8} {:>8}\n",
                           row.at("name").get<std::string>(), width, row.at("verdict").get<std::string>(),
                           shown(misfit.at("value"), 3), shown(misfit.at("interval").at(0), 3),
                           shown(misfit.at("interval").at(1), 3), shown(misfit.at("noise_floor"), 3),
                           shown(row.at("x_drift").at("value"), 3), shown(row.at("coverage"), 0, 100),
                           shown(row.at("waste_fraction"), 0, 100),
                           row.at("spreads").at("map").get<int>() + row.at("spreads").at("full").get<int>(),
                           shown(row.at("seconds_cold"), 0));
    }
    out +=
        "\nMisfits that differ by less than their floors are equal. Waste: share of the dosed powder that "
        "overflows.\nSeconds with an empty cache.\n";
    if (!object.at("same_target"))
        out += "The targets or their bins are not the same: a misfit is held against each design's own.\n";
    const json& differences = object.at("differences");
    if (differences.empty()) return out + "\nEvery input is the same.\n";
    out += "\ninputs that differ\n";
    std::size_t key_width = 0;
    for (const json& one : differences)
        key_width = std::max(key_width, one.at("key").get<std::string>().size());
    for (const json& one : differences) {
        std::vector<std::string> values;
        for (const json& value : one.at("values"))
            values.push_back(value.is_null() ? "-" : value.get<std::string>());
        out += fmt::format("  {:<{}}  {}\n", one.at("key").get<std::string>(), key_width,
                           fmt::join(values, "  |  "));
    }
    return out;
}

std::string designs_html(const json& object) {
    std::vector<std::string> names;
    long met = 0;
    for (const json& row : object.at("designs")) {
        names.push_back(row.at("name"));
        met += row.at("verdict") == "met";
    }
    PageParts parts;
    parts.heading = fmt::format("{}", fmt::join(names, ", "));
    parts.headline = fmt::format("{} of {} designs meet their target", met, names.size());
    parts.title = "Designs side by side: " + parts.heading;
    parts.maker = "Gradwright: designs side by side";
    parts.subheading = object.at("same_target").get<bool>()
                           ? object.at("designs").at(0).value("target", "")
                           : "different targets: each design is held against its own";
    parts.words = "Misfits that differ by less than their noise floors are equal.";
    parts.state = met == static_cast<long>(names.size()) ? "met" : "undecided";
    parts.first_figure = "figures";
    return page_html(parts, object,
                     {{gradwright_designs_js,
                       static_cast<std::size_t>(gradwright_designs_js_end - gradwright_designs_js)}});
}

}  // namespace gradwright
