#include "reports/reduction_cost.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "optimise/tradeoff.h"

extern "C" {
extern const char gradwright_speed_json[], gradwright_speed_json_end[];
}

namespace gradwright {
namespace {

using nlohmann::json;

/// Strip width and blade speed are left out: the one is the map's, the other the process.
bool same_reductions(const ReductionSettings& used, const json& measured) {
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); };
    const std::set<std::string> names(used.names.begin(), used.names.end());
    const bool coarse = used.has("coarse_map") || used.has("coarse_grains");
    return names == measured.at("names").get<std::set<std::string>>() &&
           near(used.softening, measured.at("softening")) &&
           near(used.rayleigh_fraction, measured.at("rayleigh_fraction")) &&
           near(coarse ? used.coarse_factor : 1, measured.at("coarse_factor")) &&
           used.sleep == measured.at("sleep").get<bool>();
}

}  // namespace

json reduction_cost(const Study& study) {
    const json tables = json::parse(gradwright_speed_json, gradwright_speed_json_end);
    const ReductionSettings used = settings_of(study);
    // the later table has the newer engine
    for (auto table = tables.rbegin(); table != tables.rend(); ++table)
        for (const json& level : table->at("levels")) {
            if (!same_reductions(used, level.at("reductions"))) continue;
            json cost = *table;
            cost["own"] = false;
            cost["source"] = "docs/speed-against-error.md";
            cost["used"] = level.at("name");
            return cost;
        }
    return nullptr;
}

json reduction_cost(const json& tradeoff, const std::string& command) {
    auto levels = json::array();
    bool spread = false;
    for (json level : tradeoff.at("levels")) {
        if (level.at("gi_rmse").is_null()) continue;
        spread = spread || level.at("name") == "study";
        for (const char* large : {"beds", "gi"}) level.erase(large);
        levels.push_back(std::move(level));
    }
    if (!spread) return nullptr;
    return {{"own", true},
            {"source", "tradeoff.json"},
            {"command", command},
            {"study", tradeoff.at("study")},
            {"seeds", tradeoff.at("seeds")},
            {"noise_allowed", tradeoff.at("noise_allowed")},
            {"isa", tradeoff.at("provenance").at("host").at("isa")},
            {"used", "study"},
            {"levels", levels}};
}

}  // namespace gradwright
