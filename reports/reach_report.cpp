#include "reports/reach_report.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/json_support.h"
#include "reports/provenance.h"
#include "reports/result_json.h"

namespace gradwright {
namespace {

nlohmann::json limit_json(ReachLimit limit) {
    return {{"limit", to_string(limit)}, {"says", meaning(limit)}};
}

nlohmann::json point_json(const ReachPoint& point) {
    return {{"target", point.target.describe()},
            {"reachable", point.reachable},
            {"binds", to_string(point.limit)},
            {"misfit", misfit_json(point.misfit)},
            {"x_drift", misfit_json(point.drift)}};
}

nlohmann::json scan_json(const ReachScan& scan) {
    auto points = nlohmann::json::array();
    for (const ReachPoint& point : scan.points) {
        nlohmann::json object = point_json(point);
        object["value_m"] = number(point.value);
        object["on_grid"] = point.on_grid;
        points.push_back(std::move(object));
    }
    return {{"variable", scan.variable},
            {"low_m", number(scan.low)},
            {"high_m", number(scan.high)},
            {"low_binds", limit_json(scan.low_limit)},
            {"high_binds", limit_json(scan.high_limit)},
            {"resolution_m", number(scan.resolution)},
            {"gaps", scan.gaps},
            {"points", points}};
}

std::string numbers_of(const ReachPoint& p) {
    const auto three = [](const Misfit& m) {
        return fmt::format("{:>7.3f} {:>7.3f} {:>7.3f}", m.value, m.interval_high, m.noise_floor);
    };
    return fmt::format("{}  {}", three(p.misfit), three(p.drift));
}

/// The limit of one side, in a line of its own.
std::string side(const char* name, double at, ReachLimit limit, double resolution) {
    const bool searched = limit != ReachLimit::bin_width && limit != ReachLimit::margins;
    return fmt::format("  {:<9} {:.3f} mm{}: {}\n", name, at * 1e3,
                       searched ? fmt::format(" (within {:.3f})", resolution * 1e3) : "", meaning(limit));
}

std::string nothing(const ReachScan& scan) {
    return fmt::format("  none of those tried: {}\n", meaning(scan.low_limit));
}

std::string scan_text(const ReachScan& scan) {
    std::string out = fmt::format("\n{:<38} {:>23}  {:>23}\n{:<38} {:>7} {:>7} {:>7}  {:>7} {:>7} {:>7}\n",
                                  scan.variable + " [mm]", "misfit", "x drift", "", "value", "<= 95 %",
                                  "noise", "value", "<= 95 %", "noise");
    for (const ReachPoint& p : scan.points)
        out +=
            fmt::format("{:>12.3f} {:<25} {}  {}\n", p.value * 1e3, p.on_grid ? "" : "(between grid points)",
                        numbers_of(p), p.reachable ? "reachable" : fmt::format("no: {}", to_string(p.limit)));
    return out;
}

}  // namespace

nlohmann::json reach_json(const Study& study, const Reach& reach) {
    const bool known = reach.own.misfit.tolerance > 0;
    nlohmann::json object = {{"format", "gradwright-reach-1"},
                             {"study", study.name},
                             {"study_file", study.file},
                             {"seed", study.seed},
                             {"status", reach.status},
                             {"reason", reach.reason},
                             {"reachable", reach.own.reachable},
                             {"own", known ? point_json(reach.own) : nlohmann::json()},
                             {"binds", known ? limit_json(reach.own.limit) : nlohmann::json()},
                             {"design", known ? design_json(study, reach.own.design) : nlohmann::json()},
                             {"tolerance", study.objective.tolerance},
                             {"x_drift_tolerance", study.objective.x_drift_tolerance},
                             {"window",
                              {{"low_m", number(reach.window_low)},
                               {"high_m", number(reach.window_high)},
                               {"bins", reach.bins},
                               {"bin_width_m", study.bins.width}}},
                             {"gi", {{"low", reach.gi_low}, {"high", reach.gi_high}, {"rises", reach.rises}}},
                             {"ramp", scan_json(reach.ramp)},
                             {"shift", scan_json(reach.shift)},
                             {"sigmoid", scan_json(reach.sigmoid)},
                             {"remarks", reach.remarks},
                             {"map",
                              {{"spreads", reach.map_spreads},
                               {"capture_fraction", number(reach.capture_fraction)},
                               {"coverage", number(reach.coverage)}}},
                             {"seconds", number(reach.seconds)},
                             {"seconds_cold", number(reach.seconds_cold)},
                             {"provenance", provenance_json()}};
    object["shift"]["ramp_width_m"] =
        reach.shift.points.empty() ? nlohmann::json() : number(reach.shift.ramp_width);
    return object;
}

std::string reach_text(const Study& study, const Reach& reach) {
    std::string out = fmt::format(
        "{}: what is reachable, on a map of {} strip{}; {} bins of {:g} mm count, y = {:g} to {:g} mm\n"
        "Reachable means: misfit within {:g} and x drift within {:g}, both by their upper 95 % bounds and "
        "noise floors.\n",
        study.name, reach.map_spreads, reach.map_spreads == 1 ? "" : "s", reach.bins, study.bins.width * 1e3,
        reach.window_low * 1e3, reach.window_high * 1e3, study.objective.tolerance,
        study.objective.x_drift_tolerance);
    if (reach.own.misfit.tolerance > 0) {
        const Misfit &misfit = reach.own.misfit, &drift = reach.own.drift;
        out += fmt::format(
            "\nThe study's target ({}) is {}: misfit {:.3f} (<= {:.3f}), x drift {:.3f} (<= {:.3f}).\n",
            reach.own.target.describe(), reach.own.reachable ? "reachable" : "NOT reachable", misfit.value,
            misfit.interval_high, drift.value, drift.interval_high);
        if (!reach.own.reachable) out += fmt::format("  What binds is {}.\n", meaning(reach.own.limit));
    }
    const auto finished = [](const ReachScan& scan) { return !scan.points.empty(); };
    if (finished(reach.ramp)) {
        out += fmt::format("\nLinear ramp, GI {:g} to {:g}, full width (10-90 % is 0.8 of it):\n",
                           reach.gi_low, reach.gi_high);
        if (std::isnan(reach.ramp.low))
            out += nothing(reach.ramp);
        else
            out += side("narrowest", reach.ramp.low, reach.ramp.low_limit, reach.ramp.resolution) +
                   side("widest", reach.ramp.high, reach.ramp.high_limit, reach.ramp.resolution);
    }
    if (finished(reach.shift)) {
        out += fmt::format("Centre of a ramp {:.3f} mm wide:\n", reach.shift.ramp_width * 1e3);
        if (std::isnan(reach.shift.low))
            out += nothing(reach.shift);
        else
            out += side("from", reach.shift.low, reach.shift.low_limit, reach.shift.resolution) +
                   side("to", reach.shift.high, reach.shift.high_limit, reach.shift.resolution);
    }
    if (finished(reach.sigmoid)) {
        out += "Sigmoid, 10-90 % width:\n";
        if (std::isnan(reach.sigmoid.low))
            out += nothing(reach.sigmoid);
        else
            out += side("steepest", reach.sigmoid.low, reach.sigmoid.low_limit, reach.sigmoid.resolution);
    }
    for (const ReachScan* scan : {&reach.ramp, &reach.shift, &reach.sigmoid}) {
        if (scan->gaps)
            out += fmt::format("Not one stretch: the {} is reachable elsewhere too, see its scan.\n",
                               scan->variable);
    }
    for (const std::string& remark : reach.remarks) out += fmt::format("Note: {}.\n", remark);
    for (const ReachScan* scan : {&reach.ramp, &reach.shift, &reach.sigmoid})
        if (finished(*scan)) out += scan_text(*scan);
    if (reach.status == "interrupted") out += "Interrupted: this is what was known until then.\n";
    return out;
}

}  // namespace gradwright
