#include "reports/tradeoff_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "dem/bench.h"
#include "dem/contact_law.h"
#include "reports/html_report.h"
#include "reports/json_support.h"
#include "reports/provenance.h"

extern "C" {
extern const char gradwright_tradeoff_js[], gradwright_tradeoff_js_end[];
}

namespace gradwright {
namespace {

nlohmann::json settings_json(const ReductionSettings& s) {
    const bool coarse = s.has("coarse_map") || s.has("coarse_grains");
    return {{"names", s.names},
            {"softening", s.softening},
            {"rayleigh_fraction", s.rayleigh_fraction},
            {"coarse_factor", coarse ? s.coarse_factor : 1.0},
            {"strip_width_m", s.strip_width},
            {"blade_speed_m_s", s.blade_speed},
            {"sleep", s.sleep},
            {"set", s.overrides()}};
}

nlohmann::json run_json(const TradeoffRun& run) {
    return {{"seed", run.seed},
            {"status", run.health.status},
            {"reason", run.health.reason},
            {"warnings", run.health.warnings},
            {"max_overlap_ratio", number(run.health.max_overlap_ratio)},
            {"deep_contact_share", number(run.health.deep_contact_share)},
            {"gi", numbers(run.gi)},
            {"packing_fraction", number(run.packing_fraction)},
            {"capture_fraction", number(run.capture_fraction)},
            {"x_drift", number(run.x_drift)},
            {"grains", run.grains},
            {"steps", run.steps},
            {"grain_steps", number(run.grain_steps)},
            {"seconds", number(run.seconds)},
            {"state_hash", run.state_hash}};
}

nlohmann::json level_json(const TradeoffLevel& level) {
    auto beds = nlohmann::json::array();
    for (const TradeoffRun& run : level.runs) beds.push_back(run_json(run));
    const bool ran = level.grains > 0;
    const auto known = [&](double value) { return ran ? number(value) : nlohmann::json(); };
    return {{"name", level.name},
            {"meaning", level.meaning},
            {"reductions", settings_json(level.settings)},
            {"status", level.status},
            {"reason", level.reason},
            {"expected_grain_steps", number(level.expected_grain_steps)},
            {"grains", known(level.grains)},
            {"steps", known(level.steps)},
            {"grain_steps", known(level.grain_steps)},
            {"seconds", known(level.seconds)},
            {"speed_up", known(level.speed_up)},
            {"gi_rmse", known(level.gi_rmse)},
            {"gi_error", known(level.gi_error)},
            {"noise_floor", known(level.noise_floor)},
            {"packing_fraction", known(level.packing_fraction)},
            {"packing_error", known(level.packing_error)},
            {"max_overlap_ratio", known(level.max_overlap_ratio)},
            {"deep_contact_share", known(level.deep_contact_share)},
            {"within_noise", level.within_noise},
            {"overlap_rule_kept", level.overlap_rule_kept},
            {"gi", numbers(level.gi)},
            {"beds", beds}};
}

/// "0" only where there was none at all.
std::string per_million(double share) {
    return share > 0 && share < 1e-6 ? "< 1" : fmt::format("{:.0f}", 1e6 * share);
}

const char* marks(const TradeoffLevel& level, const Tradeoff& t) {
    if (level.name == t.recommended) return "<-- recommended";
    if (level.name == "finest") return "";
    if (!level.within_noise) return "error beyond the noise";
    if (!level.overlap_rule_kept) return "overlaps too large";
    return "";
}

}  // namespace

nlohmann::json tradeoff_json(const Study& study, const Tradeoff& t) {
    auto levels = nlohmann::json::array();
    for (const TradeoffLevel& level : t.levels) levels.push_back(level_json(level));
    nlohmann::json provenance = provenance_json();
    provenance["host"] = {
        {"isa", compiled_isa()}, {"cores", std::thread::hardware_concurrency()}, {"threads", t.threads}};
    return {
        {"format", "gradwright-tradeoff-1"},
        {"study", study.name},
        {"study_file", study.file},
        {"fidelity", to_string(t.fidelity)},
        {"seeds", t.seeds},
        {"seed", study.seed},
        {"status", t.status},
        {"levels", levels},
        {"noise_rms", number(t.noise_rms)},
        {"noise_allowed", kTradeoffNoise},
        {"deep_contacts_allowed", kDeepContacts},
        {"recommended", t.recommended},
        {"why", t.why},
        {"profile", {{"y_m", numbers(t.y_m)}, {"weight", numbers(t.weight)}, {"target", numbers(t.target)}}},
        {"provenance", provenance}};
}

std::string tradeoff_text(const Study& study, const Tradeoff& t) {
    std::string out = fmt::format(
        "{}: speed against error, {} of {} beds each (means; seconds with an empty cache, packing "
        "included)\n\n"
        "{:<22} {:>8} {:>9} {:>11} {:>8} {:>8} {:>7} {:>7} {:>8} {:>8} {:>8}\n",
        study.name, t.fidelity == Fidelity::map ? "relabelled strips" : "labelled spreads", t.seeds, "level",
        "grains", "steps", "grain-steps", "seconds", "speed-up", "GI rms", "floor", "packing", "overlap",
        "deep");
    for (const TradeoffLevel& level : t.levels) {
        if (!(level.grains > 0)) {
            out += fmt::format("{:<22} {}{}{}\n", level.name, level.status, level.reason.empty() ? "" : ": ",
                               level.reason);
            continue;
        }
        out += fmt::format(
            "{:<22} {:>8.0f} {:>9.0f} {:>11.2e} {:>8.1f} {:>8.2f} {:>7.3f} {:>7.3f} {:>+7.1f}% {:>7.1f}% "
            "{:>8}  "
            "{}\n",
            level.name, level.grains, level.steps, level.grain_steps, level.seconds, level.speed_up,
            level.gi_rmse, level.noise_floor, 100 * level.packing_error, 100 * level.max_overlap_ratio,
            per_million(level.deep_contact_share), level.status == "ok" ? marks(level, t) : level.status);
    }
    out += fmt::format(
        "\nGI rms: difference of the mean GI(y) to the finest level's. Floor: what the beds alone would "
        "give. Packing: against\nthe finest; overlap: largest, of a radius; deep: contacts in a million that "
        "overlap by more than 3 %. A level is free\nup to {} floors and {:.0f} deep contacts in a million, "
        "or as many as the finest has.\n",
        kTradeoffNoise, 1e6 * kDeepContacts);
    if (t.recommended.empty())
        out += "Nothing can be recommended: no level has two beds, or none is within the noise.\n";
    else
        out += fmt::format("Recommended: {} ({})\n", t.recommended, t.why);
    for (const TradeoffLevel& level : t.levels)
        if (level.name == t.recommended) {
            out += "  the same as a command:";
            for (const std::string& one : level.settings.overrides())
                if (one != "run.map_spreads=1") out += fmt::format(" --set '{}'", one);
            out += '\n';
        }
    if (t.status != "ok") out += "Interrupted: the table is of what was spread until then.\n";
    return out;
}

std::string tradeoff_html(const nlohmann::json& data) {
    PageParts parts;
    const std::string best = data.value("recommended", "");
    parts.heading = data.value("study", "");
    parts.title = parts.heading + ": speed against error";
    parts.maker = "Gradwright: speed against error";
    parts.subheading =
        fmt::format("{} beds a level, fidelity {}", data.value("seeds", 0), data.value("fidelity", ""));
    parts.headline = best.empty() ? "Nothing to recommend yet" : "Recommended: " + best;
    parts.words = data.value("why", "");
    parts.state = best.empty() ? "undecided" : "met";
    parts.first_figure = "figures";
    return page_html(parts, data,
                     {{gradwright_tradeoff_js,
                       static_cast<std::size_t>(gradwright_tradeoff_js_end - gradwright_tradeoff_js)}});
}

}  // namespace gradwright
