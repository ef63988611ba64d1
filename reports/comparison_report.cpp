#include "reports/comparison_report.h"

#include <fmt/format.h>

#include "reports/json_support.h"
#include "reports/provenance.h"

namespace gradwright {
namespace {

nlohmann::json row_json(const ComparedStrategy& row) {
    const bool judged = row.confirmations > 0;
    const auto known = [&](double value) { return judged ? number(value) : nlohmann::json(); };
    auto parameters = nlohmann::json::object();
    for (const auto& [name, value] : row.design.parameters) parameters[name] = number(value);
    return {{"name", row.name},
            {"spreads", row.spreads_map + row.spreads_full},
            {"spreads_map", row.spreads_map},
            {"spreads_full", row.spreads_full},
            {"seconds", number(row.seconds)},
            {"seconds_cold", number(row.seconds_cold)},
            {"confirmed_misfit", known(row.misfit.value)},
            {"debiased_misfit", known(row.misfit.debiased)},
            {"interval", {known(row.misfit.interval_low), known(row.misfit.interval_high)}},
            {"noise_floor", known(row.misfit.noise_floor)},
            {"x_drift", known(row.drift_misfit.value)},
            {"x_drift_noise_floor", known(row.drift_misfit.noise_floor)},
            {"gi", numbers(row.confirmed.gi)},
            {"confirmations", row.confirmations},
            {"verdict", to_string(row.verdict)},
            {"own_verdict", to_string(row.own_verdict)},
            {"termination", row.termination},
            {"native", row.native},
            {"reason", row.reason},
            {"design",
             {{"points_m", plan_points(row.design.partition.points)},
              {"parameters", parameters},
              {"dosage_factor", number(row.design.dosage_factor)},
              {"land_m", number(row.design.land)},
              {"footprint_offset_m", number(row.design.footprint_offset)},
              {"dose", {row.design.dose[0], row.design.dose[1]}}}}};
}

}  // namespace

nlohmann::json comparison_json(const Study& study, const StrategyComparison& comparison) {
    auto rows = nlohmann::json::array();
    for (const ComparedStrategy& row : comparison.strategies) rows.push_back(row_json(row));
    return {{"format", "gradwright-comparison-1"},
            {"study", study.name},
            {"study_file", study.file},
            {"seed", study.seed},
            {"status", comparison.status},
            {"fidelity", to_string(comparison.fidelity)},
            {"budget", comparison.budget},
            {"evaluations", comparison.evaluations},
            {"confirmations", comparison.confirmations},
            {"confirmation_seeds", comparison.seeds},
            {"tolerance", study.objective.tolerance},
            {"strategies", rows},
            {"provenance", provenance_json()}};
}

std::string comparison_text(const Study& study, const StrategyComparison& comparison) {
    std::string out = fmt::format(
        "{}: at most {} spreads each, {} evaluations of '{}' where a strategy has the choice; best designs "
        "judged on\n{} unseen bed{} (tolerance {:.3g})\n\n{:<8} {:>7} {:>9} {:>8} {:>16} {:>7} {:>8}  {:<9} "
        "{}\n",
        study.name, comparison.budget, comparison.evaluations, to_string(comparison.fidelity),
        comparison.confirmations, comparison.confirmations == 1 ? "" : "s", study.objective.tolerance,
        "strategy", "spreads", "seconds", "misfit", "95 % bounds", "floor", "x drift", "verdict", "ended");
    for (const ComparedStrategy& row : comparison.strategies) {
        out += fmt::format("{:<8} ", row.name);
        const bool ran = row.termination != "not_run";
        if (ran) out += fmt::format("{:>7} {:>9.1f} ", row.spreads_map + row.spreads_full, row.seconds_cold);
        if (row.confirmations > 0)
            out +=
                fmt::format("{:>8.3f} {:>7.3f} to {:>5.3f} {:>7.3f} {:>8.3f}  {:<9} {}{}\n", row.misfit.value,
                            row.misfit.interval_low, row.misfit.interval_high, row.misfit.noise_floor,
                            row.drift_misfit.value, to_string(row.verdict), row.termination,
                            row.confirmations < comparison.confirmations
                                ? fmt::format(" (judged on {} only)", row.confirmations)
                                : "");
        else
            out += fmt::format("{}{}{}\n", ran ? row.termination : "not run", row.reason.empty() ? "" : ": ",
                               row.reason);
    }
    out +=
        "\nSeconds: of the search with its own confirmations, caches empty. Misfits that differ by less "
        "than their floors\nare equal. Own confirmations are among the spreads, the judgement is not.\n";
    if (comparison.status != "ok") out += "Interrupted: the rest was not run.\n";
    return out;
}

}  // namespace gradwright
