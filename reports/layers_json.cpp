#include "reports/layers_json.h"

#include <fmt/format.h>

#include "optimise/laid_layers.h"
#include "reports/json_support.h"
#include "reports/result_json.h"

namespace gradwright {
namespace {

using nlohmann::json;

json volume(double value) {
    return value > 0 ? json(value) : json(nullptr);
}

json layer_json(const Study& study, const LaidLayer& layer) {
    const GradationProfile& p = layer.profile;
    const Band band = simultaneous_band(p.gi, p.standard_error, p.degrees);
    const int judged = judged_number(study);
    json drift = misfit_json(layer.drift_misfit);
    drift["difference"] = numbers(layer.drift.difference);
    drift["standard_error"] = numbers(layer.drift.standard_error);
    json map = nullptr;
    if (!layer.map.gi.empty()) {
        const auto rows = [&layer](const std::vector<double>& values) {
            const std::size_t columns = layer.map.x_m.size();
            json grid = json::array();
            for (std::size_t start = 0; start + columns <= values.size(); start += columns)
                grid.push_back(numbers(std::span(values).subspan(start, columns)));
            return grid;
        };
        map = {{"x_m", numbers(layer.map.x_m)},
               {"y_m", numbers(layer.map.y_m)},
               {"gi", rows(layer.map.gi)},
               {"mass_kg", rows(layer.map.mass_kg)},
               {"order", "gi[y][x]"}};
    }
    return {{"number", layer.number},
            {"judged", judged == 0 || judged == layer.number},
            {"y_m", numbers(p.y_m)},
            {"gi", numbers(p.gi)},
            {"standard_error", numbers(p.standard_error)},
            {"band_low", numbers(band.low)},
            {"band_high", numbers(band.high)},
            {"misfit", misfit_json(layer.misfit)},
            {"x_drift", drift},
            {"map", map},
            {"gap_m", volume(layer.gap)},
            {"dosed_solid_m3", volume(layer.dosed_solid_volume)},
            {"raised_solid_m3", volume(layer.raised_solid_volume)},
            {"laid_solid_m3", volume(layer.laid_solid_volume)},
            {"carried_off_solid_m3", number(layer.carried_off_solid_volume)},
            {"capture_fraction", number(layer.capture_fraction)},
            {"coverage", number(layer.coverage)},
            {"waste_fraction", number(layer.waste_fraction)},
            {"packing_fraction", number(layer.packing_fraction)}};
}

json list(const Study& study, std::span<const LaidLayer> layers) {
    json rows = json::array();
    for (const LaidLayer& layer : layers) rows.push_back(layer_json(study, layer));
    return rows;
}

}  // namespace

json judged_layer_json(const Study& study) {
    const int number = judged_number(study);
    return number == 0 ? json("all") : json(number);
}

json layers_json(const Study& study, const Evaluation& evaluation) {
    if (!evaluation.health.ok() || evaluation.fidelity == Fidelity::kinematic) return json::array();
    if (!evaluation.layers.empty()) return list(study, evaluation.layers);
    LaidLayer only;  // what its volumes were the evaluation of a single layer does not keep
    only.profile = evaluation.profile;
    only.drift = evaluation.drift;
    only.misfit = evaluation.misfit;
    only.drift_misfit = evaluation.drift_misfit;
    only.map = evaluation.map;
    only.capture_fraction = evaluation.capture_fraction;
    only.coverage = evaluation.coverage;
    only.waste_fraction = evaluation.waste_fraction;
    only.packing_fraction = evaluation.packing_fraction;
    return list(study, {&only, 1});
}

std::vector<LaidLayer> mean_layers(const Study& study, const StudyResult& result) {
    if (result.confirmations.empty()) return result.predicted.layers;
    std::vector<LaidLayer> out;
    const double n = double(result.confirmations.size());
    for (std::size_t k = 0; k < result.confirmations.front().layers.size(); ++k) {
        LaidLayer mean;
        std::vector<GradationProfile> profiles;
        std::vector<XDrift> drifts;
        for (const Evaluation& confirmation : result.confirmations) {
            const LaidLayer& one = confirmation.layers.at(k);
            profiles.push_back(one.profile);
            drifts.push_back(one.drift);
            mean.number = one.number;
            mean.gap = one.gap;
            mean.dosed_solid_volume += one.dosed_solid_volume / n;
            mean.raised_solid_volume += one.raised_solid_volume / n;
            mean.laid_solid_volume += one.laid_solid_volume / n;
            mean.carried_off_solid_volume += one.carried_off_solid_volume / n;
            mean.capture_fraction += one.capture_fraction / n;
            mean.coverage += one.coverage / n;
            mean.waste_fraction += one.waste_fraction / n;
            mean.packing_fraction += one.packing_fraction / n;
        }
        mean.profile = mean_profile(profiles);
        mean.drift = mean_drift(drifts);
        judge_layer(study, result.design, mean);
        out.push_back(std::move(mean));
    }
    return out;
}

json layers_json(const Study& study, const StudyResult& result) {
    return list(study, mean_layers(study, result));
}

std::string layers_text(const Study& study, std::span<const LaidLayer> layers) {
    if (layers.empty()) return {};
    std::string text = "  layer   misfit  x drift  captured  overflow  coverage  packing\n";
    const int judged = judged_number(study);
    for (const LaidLayer& layer : layers)
        text += fmt::format("  {:>5}{} {:>7.3f} {:>8.3f} {:>7.0f} % {:>7.0f} % {:>7.0f} % {:>8.3f}\n",
                            layer.number, judged == 0 || judged == layer.number ? "*" : " ",
                            layer.misfit.value, layer.drift_misfit.value, 100 * layer.capture_fraction,
                            100 * layer.waste_fraction, 100 * layer.coverage, layer.packing_fraction);
    if (study.scene.layers > 1) text += "  * is judged (target.layer)\n";
    return text;
}

}  // namespace gradwright
