#include "optimise/laid_layers.h"

namespace gradwright {

LaidLayer laid_layer(std::span<const SpreadResult> spreads, int number, const Footprint& footprint) {
    LaidLayer mean;
    mean.number = number;
    const auto at = static_cast<std::size_t>(number) - 1;
    const double n = double(spreads.size());
    for (const SpreadResult& spread : spreads) {
        const Layer& layer = at < spread.earlier.size() ? spread.earlier[at] : spread.layer;
        mean.gap = layer.gap;
        mean.dosed_solid_volume += layer.dosed_solid_volume / n;
        mean.laid_solid_volume += layer.solid_volume() / n;
        mean.capture_fraction += layer.capture_fraction() / n;
        mean.packing_fraction += layer.packing_fraction() / n;
        mean.coverage += coverage(layer, footprint) / n;
        if (layer.dosed_solid_volume > 0)
            mean.waste_fraction += layer.overflow_solid_volume / layer.dosed_solid_volume / n;
        if (at >= spread.passes.size()) continue;
        mean.raised_solid_volume += spread.passes[at].raised_solid_volume / n;
        mean.carried_off_solid_volume += spread.passes[at].carried_off_solid_volume / n;
    }
    return mean;
}

void judge_layer(const Study& study, const Design& design, LaidLayer& layer) {
    Evaluation one;
    one.design = design;
    one.health.status = "ok";
    one.profile = layer.profile;
    one.drift = layer.drift;
    judge(study, one);
    layer.misfit = one.misfit;
    layer.drift_misfit = one.drift_misfit;
    layer.drift = one.drift;  // its value is now over the bins that count
}

double supply_ratio_of(const Study& study, const Scene& scene, const Layer& layer) {
    Scene one = scene;  // a dose and a gap belong to one layer
    one.gap = judged_number(study) == 0 ? layer.gap / study.scene.layers : layer.gap;
    return supply_ratio(one, layer.bed_packing, layer.packing_fraction());
}

}  // namespace gradwright
