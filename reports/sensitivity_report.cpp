#include "reports/sensitivity_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/json_support.h"
#include "reports/provenance.h"
#include "reports/result_json.h"
#include "reports/svg_figure.h"

namespace gradwright {
namespace {

using nlohmann::json;

/// Of an input over its whole range: mu* of GI, rms over the bins.
struct Bar {
    std::string name;
    double size = 0, error = 0;
    bool motion = false, unmeasured = false;
};

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return values.empty() ? 0 : std::sqrt(sum / double(values.size()));
}

std::vector<Bar> bars_of(const Sensitivity& s) {
    std::vector<Bar> bars;
    const std::size_t gi = s.outputs.size() - 2;
    for (std::size_t i = 0; i < s.morris.effect.size(); ++i) {
        std::vector<double> size, error;
        for (std::size_t o = 0; o < gi && o < s.morris.effect[i].size(); ++o) {
            size.push_back(s.morris.effect[i][o].mean_absolute);
            error.push_back(s.morris.effect[i][o].standard_error);
        }
        bars.push_back({s.labels[i].name, rms(size), rms(error), false, false});
    }
    for (std::size_t i = 0; i < s.effects.size(); ++i)  // half a range to a whole one
        bars.push_back({s.motion[i].name, 2 * s.effects[i].gi_rms, 2 * s.effects[i].gi_rms_error, true,
                        s.motion[i].unmeasured});
    std::stable_sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.size > b.size; });
    return bars;
}

/// First and total index of GI, all bins that count together: those of the bins by their variances.
std::pair<double, double> indices_of_gi(const Sensitivity& s, std::size_t input) {
    double first = 0, total = 0, variance = 0;
    for (std::size_t o = 0; o + 2 < s.outputs.size() && o < s.sobol.variance.size(); ++o) {
        first += s.sobol.index[input][o].first * s.sobol.variance[o];
        total += s.sobol.index[input][o].total * s.sobol.variance[o];
        variance += s.sobol.variance[o];
    }
    if (!(variance > 0)) return {0, 0};
    return {first / variance, total / variance};
}

json input_json(const UncertainInput& input) {
    return {{"name", input.name},
            {"unit", input.unit},
            {"value", number(input.value)},
            {"low", number(input.low)},
            {"high", number(input.high)},
            {"origin", input.origin},
            {"unmeasured", input.unmeasured}};
}

json labels_json(const Sensitivity& s) {
    auto rows = json::array();
    for (std::size_t i = 0; i < s.labels.size(); ++i) {
        json row = input_json(s.labels[i]);
        auto morris = json::array(), sobol = json::array();
        if (i < s.morris.effect.size())
            for (const MorrisEffect& e : s.morris.effect[i])
                morris.push_back({{"mu", number(e.mean)},
                                  {"mu_star", number(e.mean_absolute)},
                                  {"sigma", number(e.deviation)},
                                  {"mu_star_standard_error", number(e.standard_error)},
                                  {"effects", e.effects}});
        if (i < s.sobol.index.size())
            for (const SobolIndex& e : s.sobol.index[i])
                sobol.push_back({{"first", number(e.first)},
                                 {"first_interval", {number(e.first_low), number(e.first_high)}},
                                 {"total", number(e.total)},
                                 {"total_interval", {number(e.total_low), number(e.total_high)}}});
        row["morris"] = std::move(morris);
        row["sobol"] = std::move(sobol);
        if (i < s.sobol.index.size()) {
            const auto [first, total] = indices_of_gi(s, i);
            row["gi_first"] = number(first);
            row["gi_total"] = number(total);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

json motion_json(const Sensitivity& s) {
    auto rows = json::array();
    for (std::size_t i = 0; i < s.motion.size(); ++i) {
        json row = input_json(s.motion[i]);
        if (i < s.effects.size()) {
            const MotionEffect& e = s.effects[i];
            row["effect_of_half_the_range"] = numbers(e.half_range);
            row["standard_error"] = numbers(e.standard_error);
            row["gi_rms"] = number(e.gi_rms);
            row["gi_rms_error"] = number(e.gi_rms_error);
            row["share"] = number(e.share);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

json budget_json(const Sensitivity& s) {
    const ToleranceBudget& b = s.budget;
    auto rows = json::array();
    for (const DimensionBudget& d : b.dimensions)
        rows.push_back({{"name", d.name},
                        {"nominal_m", number(d.nominal)},
                        {"tolerance_m", number(d.tolerance)},
                        {"slope_per_m", numbers(d.slope)},
                        {"slope_rms_per_m", number(d.slope_rms)},
                        {"share", number(d.share)},
                        {"needed_m", number(d.needed)},
                        {"tighter_than_general", d.tighter()}});
    return {{"class", std::string("ISO 2768-1 ") + to_string(b.tolerance_class)},
            {"dimensions", rows},
            {"worst_case", numbers(b.worst_case)},
            {"rss", numbers(b.rss)},
            {"band_95", numbers(b.band)},
            {"worst_case_rms", number(b.worst_case_rms)},
            {"rss_rms", number(b.rss_rms)},
            {"band_95_rms", number(b.band_rms)},
            {"gi_error_asked", number(b.asked)},
            {"noise_floor", number(b.noise_floor)},
            {"gi_error_promised", number(b.promised)},
            {"check_on_maps",
             {{"plates", s.band.plates},
              {"inside", number(s.band.inside)},
              {"worst_error", number(s.band.worst_error)}}}};
}

std::string micrometres(double metres) {
    return std::isfinite(metres) ? fmt::format("{:.0f} um", metres * 1e6) : "any";
}

}  // namespace

json sensitivity_json(const Study& study, const Sensitivity& s) {
    auto failed = json::array();
    for (const FailedStrip& f : s.failed)
        failed.push_back({{"inputs", numbers(f.inputs)}, {"status", f.status}, {"reason", f.reason}});
    auto plates = json::array();
    int inside = 0, bins = 0;
    for (const PlateSpread& p : s.plates) {
        plates.push_back(
            {{"seed", p.seed}, {"inside", p.inside}, {"bins", p.bins}, {"gi_rms", number(p.rms)}});
        inside += p.inside;
        bins += p.bins;
    }
    auto ranked = json::array();
    for (const Bar& bar : bars_of(s))
        ranked.push_back({{"name", bar.name},
                          {"gi_rms", number(bar.size)},
                          {"error", number(bar.error)},
                          {"moves_grains", bar.motion},
                          {"unmeasured", bar.unmeasured}});
    return {{"format", "gradwright-sensitivity-1"},
            {"study", study.name},
            {"study_file", study.file},
            {"seed", study.seed},
            {"status", s.status},
            {"reason", s.reason},
            {"design", design_json(study, s.design)},
            {"outputs", s.outputs},
            {"nominal", numbers(s.nominal)},
            {"noise_floor", number(s.noise_floor)},
            {"ranked", ranked},
            {"labels", labels_json(s)},
            {"labels_failed", s.morris.failed + s.sobol.failed},
            {"motion", motion_json(s)},
            {"surrogate",
             {{"strips", s.strips},
              {"leave_one_out", numbers(s.surrogate_error)},
              {"leave_one_out_gi_rms", s.effects.empty() ? json() : number(s.surrogate_gi_error)}}},
            {"failed", failed},
            {"budget", budget_json(s)},
            {"plates", {{"spread", plates}, {"inside", inside}, {"bins", bins}}},
            {"spreads", {{"map", s.map_spreads}, {"full", s.full_spreads}}},
            {"seconds", number(s.seconds)},
            {"seconds_cold", number(s.seconds_cold)},
            {"provenance", provenance_json()}};
}

std::string sensitivity_text(const Study& study, const Sensitivity& s) {
    std::string out = fmt::format("{}: what moves GI (rms over {} bins; the map's noise floor is {:.3f})\n\n",
                                  study.name, s.outputs.size() - 2, s.noise_floor);
    out += fmt::format("{:<30} {:>24} {:>9} {:>8} {:>8} {:>8}\n", "input over its range", "range", "GI rms",
                       "+-", "first", "total");
    const auto range = [](const UncertainInput& input) {
        const bool length = input.unit == "m";
        return fmt::format("{:.4g} .. {:.4g}{}", input.low * (length ? 1e3 : 1),
                           input.high * (length ? 1e3 : 1),
                           length              ? " mm"
                           : input.unit == "1" ? ""
                                               : " " + input.unit);
    };
    for (const Bar& bar : bars_of(s)) {
        const auto& inputs = bar.motion ? s.motion : s.labels;
        const auto found = std::find_if(inputs.begin(), inputs.end(),
                                        [&](const UncertainInput& input) { return input.name == bar.name; });
        const auto i = std::size_t(found - inputs.begin());
        const auto [first, total] =
            bar.motion ? std::pair(s.effects[i].share, s.effects[i].share) : indices_of_gi(s, i);
        out +=
            fmt::format("{:<30} {:>24} {:>9.3f} {:>8.3f} {:>8.2f} {:>8.2f}{}\n", bar.name, range(*found),
                        bar.size, bar.error, first, total, bar.unmeasured ? "  not measured: a default" : "");
    }
    out +=
        "Labels answer on the map, with Morris' mu* and Sobol's indices among themselves; what moves grains "
        "on strips,\n"
        "with a straight line through them and the shares among themselves.\n";
    if (s.effects.empty())
        out += fmt::format("What moves grains was not varied{}: --strips {} and more spreads it (",
                           s.reason.empty() ? "" : " (" + s.reason + ")", s.motion.size() + 3) +
               [&] {
                   std::string names;
                   for (const UncertainInput& input : s.motion)
                       names += (names.empty() ? "" : ", ") + input.name;
                   return names;
               }() +
               ").\n";
    else
        out += fmt::format("{} strips; the line misses a strip it has not seen by {:.3f} GI rms.\n", s.strips,
                           s.surrogate_gi_error);
    for (const FailedStrip& f : s.failed)
        out += fmt::format("Failed and left out: {}: {}\n", f.status, f.reason);
    if (s.morris.failed + s.sobol.failed > 0)
        out += fmt::format("{} of {} answers of the map had no numbers and are left out.\n",
                           s.morris.failed + s.sobol.failed, s.morris.evaluations + s.sobol.evaluations);
    const ToleranceBudget& b = s.budget;
    out += fmt::format(
        "\nTolerance budget, ISO 2768-1 {}: GI error rms {:.3f} at worst, {:.3f} root sum of squares, 95 % "
        "within {:.3f}\n",
        to_string(b.tolerance_class), b.worst_case_rms, b.rss_rms, b.band_rms);
    out += fmt::format("(on {} plates drawn within tolerance {:.1f} % of the bins lie inside that band).\n",
                       s.band.plates, 100 * s.band.inside);
    out += fmt::format("For a GI error of {:.3f}{} each dimension needs:\n", b.promised,
                       b.promised > b.asked ? fmt::format(" (asked {:.3f}, but the noise floor is {:.3f})",
                                                          b.asked, b.noise_floor)
                                            : "");
    for (const DimensionBudget& d : b.dimensions)
        out += fmt::format("  {:<10} {:>9.3f} mm  general +-{:<8} {:>4.0f} % of the error  needs +-{:<8}{}\n",
                           d.name, d.nominal * 1e3, micrometres(d.tolerance), 100 * d.share,
                           micrometres(d.needed), d.tighter() ? "  tighter than general" : "");
    if (!s.plates.empty()) {
        int inside = 0, bins = 0, whole = 0;
        for (const PlateSpread& p : s.plates) {
            inside += p.inside;
            bins += p.bins;
            whole += p.inside == p.bins;
        }
        out += fmt::format(
            "{} plates spread with both powders: {} of {} bins inside the band with the beds' noise, {} "
            "plates with all.\n",
            s.plates.size(), inside, bins, whole);
    }
    if (s.status == "interrupted") out += "Interrupted: this is what was known until then.\n";
    return out;
}

std::string tornado_svg(const Sensitivity& s) {
    const std::vector<Bar> bars = bars_of(s);
    constexpr double width = 860, left = 270, right = 70, top = 60, step = 24, bottom = 60;
    const double height = top + step * double(bars.size()) + bottom;
    SvgFigure figure(width, height, "What moves GI: each input over its range, rms over the bins");
    double reach = s.noise_floor;
    for (const Bar& bar : bars) reach = std::max(reach, bar.size + bar.error);
    reach *= 1.08;
    const auto x = [&](double value) { return left + value / reach * (width - left - right); };
    for (const double tick : ticks(0, reach, 6)) {
        if (tick > reach) continue;
        figure.line(x(tick), top - 6, x(tick), height - bottom, {.colour = "#ddd", .width = 1});
        figure.text(x(tick), height - bottom + 18, fmt::format("{:g}", tick),
                    {.anchor = "middle", .size = 12});
    }
    for (std::size_t k = 0; k < bars.size(); ++k) {
        const Bar& bar = bars[k];
        const double y = top + step * double(k);
        figure.text(left - 10, y + 14, bar.name + (bar.unmeasured ? " (not measured)" : ""),
                    {.anchor = "end", .size = 12});
        figure.rect(left, y + 3, x(bar.size) - left, step - 8, bar.motion ? kColourB : kColourA);
        if (bar.error > 0)
            figure.line(x(std::max(0.0, bar.size - bar.error)), y + step / 2 - 1, x(bar.size + bar.error),
                        y + step / 2 - 1, {.colour = "#111", .width = 1.4});
        figure.text(x(bar.size + bar.error) + 6, y + 14, fmt::format("{:.3f}", bar.size), {.size = 12});
    }
    figure.line(x(s.noise_floor), top - 6, x(s.noise_floor), height - bottom,
                {.colour = "#555", .width = 1.4, .dash = "5 4"});
    figure.text(x(s.noise_floor) + 5, top - 10, "noise floor", {.size = 11, .colour = "#555"});
    figure.text(
        0.5 * (left + width - right), height - 16,
        "change of GI over the input's range (blue: labels, on the map; orange: moves grains, on strips)",
        {.anchor = "middle", .size = 12});
    return figure.document();
}

}  // namespace gradwright
