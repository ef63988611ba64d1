#include "reports/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/field_json.h"
#include "reports/layers_json.h"
#include "reports/result_json.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

constexpr int kBarCells = 30;

/// GI in 0..1 as a bar with eighths: "██████▌".
std::string bar(double gi) {
    if (!std::isfinite(gi)) return "";
    static constexpr const char* kEighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
    const int eighths = static_cast<int>(std::lround(std::clamp(gi, 0.0, 1.0) * kBarCells * 8));
    std::string text;
    for (int i = 0; i < eighths / 8; ++i) text += "█";
    return text + kEighths[eighths % 8];
}

std::string cell(double value) {
    return std::isfinite(value) ? fmt::format("{:9.3f}", value) : "        -";
}

double at(const std::vector<double>& values, std::size_t index) {
    return index < values.size() ? values[index] : std::nan("");
}

std::string profile_table(const GradationProfile& found, const std::vector<double>& target,
                          const GradationProfile* predicted, const std::vector<double>& low,
                          const std::vector<double>& high, const char* name) {
    std::string text =
        fmt::format("    y mm   target {} {:>9}   95 % band\n", predicted ? "predicted" : "", name);
    for (std::size_t b = 0; b < found.gi.size(); ++b) {
        const bool band = std::isfinite(at(low, b)) && std::isfinite(at(high, b));
        text += fmt::format(
            "  {:6.2f}{}{}{}   {:<13}  {}\n", found.y_m[b] * 1e3, cell(at(target, b)),
            predicted ? fmt::format(" {}", cell(at(predicted->gi, b))) : std::string(), cell(found.gi[b]),
            band ? fmt::format("{:.3f}-{:.3f}", at(low, b), at(high, b)) : "", bar(found.gi[b]));
    }
    return text;
}

std::string painted(const std::string& state, const std::string& words, TerminalColour colour) {
    if (colour == TerminalColour::plain) return words;
    const char* code = state == "met" ? "1;32" : state == "not_met" || state == "failed" ? "1;31" : "1;33";
    return fmt::format("\033[{}m{}\033[0m", code, words);
}

}  // namespace

std::string summary(const Study& study, const StudyResult& result, const std::string& folder,
                    const std::vector<std::string>& files, TerminalColour colour) {
    const Wording words = wording(study, result);
    const bool proved = !result.confirmed.gi.empty();
    const auto line = [](const char* name, const std::string& text) {
        return text.empty() ? "" : fmt::format("  {:<10}{}\n", name, text);
    };
    std::string text =
        fmt::format("{}  {}\n{}\n", painted(words.state, words.headline, colour), study.name, words.verdict);
    text += "\n";
    text += line("asked", study.target.describe());
    text += line("found", words.misfit);
    text += line("", words.drift);
    text += line("sure", words.sure);
    text += "\n";
    const auto rows = partition_rows(study, result.design);
    if (rows.size() < 2) {
        text += line("build", words.build);
    } else {
        text +=
            line("build", partition_name(result.design) + ", corners in mm from rear wall and y = 0 side");
        for (const PartitionRow& row : rows)
            text += fmt::format("              {:<4} x {:>8}   y {:>8}\n", row.name(),
                                millimetres(row.x_mm * 1e-3), millimetres(row.y_mm * 1e-3));
    }
    for (std::size_t i = 0; i < words.fill.size(); ++i) text += line(i == 0 ? "fill" : "", words.fill[i]);
    text += line("dose", words.dose);
    text += line("powder", words.losses);
    for (const ConstraintState& state : result.constraints)
        text += line(state.kept() ? "keeps" : "breaks", describe(state));
    text += "\n";
    if (proved)
        text += profile_table(result.confirmed, result.target, &result.predicted.profile, result.band_low,
                              result.band_high, "confirmed");
    else if (!result.predicted.profile.gi.empty())
        text += profile_table(result.predicted.profile, result.target, nullptr, result.band_low,
                              result.band_high, "predicted");
    if (study.scene.layers > 1) text += "\n" + layers_text(study, mean_layers(study, result));
    if (!result.field_target.empty() && !result.predicted.field.x_m.empty())
        text += "\n" + field_table(proved ? result.confirmed_field : result.predicted.field,
                                   result.field_target, proved ? "confirmed" : "predicted");
    if (result.straight && result.straight->health.ok())
        text += fmt::format(
            "\n  straight  the best straight partition on the same map: misfit {:.3f}, x drift {:.3f}\n",
            result.straight->misfit.value, result.straight->drift.value);
    text += "\n";
    text +=
        line("spent",
             fmt::format(
                 "{} map strip{} and {} full spread{}, {} ({} with an empty cache), seed {}, {} thread{}",
                 result.spreads_map, result.spreads_map == 1 ? "" : "s", result.spreads_full,
                 result.spreads_full == 1 ? "" : "s", duration(result.seconds), duration(result.seconds_cold),
                 result.seed, result.threads, result.threads == 1 ? "" : "s"));
    text +=
        line("ended", result.termination +
                          (result.message.empty() || words.state == "failed" ? "" : ": " + result.message));
    for (const std::string& warning : words.warnings) text += line("warning", warning);
    if (!folder.empty()) {
        text += line("files", folder + "/");
        std::string names;
        for (const std::string& file : files) {
            if (file.rfind("particles_", 0) == 0) continue;  // the series names them
            if (names.size() + file.size() > 84) {
                text += line("", names);
                names.clear();
            }
            names += (names.empty() ? "" : "  ") + file;
        }
        text += line("", names);
    }
    return text;
}

std::string evaluation_summary_text(const Study& study, const Evaluation& evaluation) {
    std::string text = fmt::format("{}, fidelity {}: {}{}\n", study.name, to_string(evaluation.fidelity),
                                   evaluation.health.status,
                                   evaluation.health.reason.empty() ? "" : ": " + evaluation.health.reason);
    if (!evaluation.health.ok()) return text;
    const GradationProfile& profile = evaluation.profile;
    const Band band = simultaneous_band(profile.gi, profile.standard_error, profile.degrees);
    text += profile_table(profile, evaluation.target, nullptr, band.low, band.high, "GI");
    if (!evaluation.field_target.empty())
        text += field_table(evaluation.field, evaluation.field_target, "GI");
    text += fmt::format(
        "  misfit {:.3f} (floor {:.3f}), x drift {:.3f} (floor {:.3f}), captured {:.0f} %, supply ratio "
        "{:.2f}, coverage {:.0f} %\n",
        evaluation.misfit.value, evaluation.misfit.noise_floor, evaluation.drift.value,
        evaluation.drift.noise_floor, 100 * evaluation.capture_fraction, evaluation.supply_ratio,
        100 * evaluation.coverage);
    text += layers_text(study, evaluation.layers);
    text += fmt::format("  {} grains, {} steps, {}, seed {}\n", evaluation.grains, evaluation.steps,
                        duration(evaluation.seconds), evaluation.seed);
    for (const ConstraintState& state : constraint_states(study, evaluation.design))
        text += fmt::format("  {} {}\n", state.kept() ? "keeps" : "breaks", describe(state));
    for (const ConstraintState& state : limit_states(study, evaluation))
        text += fmt::format("  {} {}\n", state.kept() ? "keeps" : "breaks", describe(state));
    for (const std::string& warning : evaluation.health.warnings) text += "  warning   " + warning + "\n";
    return text;
}

}  // namespace gradwright
