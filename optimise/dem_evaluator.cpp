#include "optimise/dem_evaluator.h"

#include <fmt/format.h>

namespace gradwright {

Evaluation DemEvaluator::evaluate(const Design& design, std::uint64_t seed) {
    const Scene scene = scene_of(study_, design, false, seed);
    Evaluation evaluation;
    evaluation.design = design;
    evaluation.fidelity = Fidelity::full;
    evaluation.seed = seed;
    last_ = runner_.spread(scene, &design.partition, fmt::format("full spread {}", runner_.full_spreads + 1),
                           runner_.options().snapshots);
    copy_health(last_, evaluation);
    evaluation.state_hash = last_.state_hash;
    if (evaluation.health.status != "interrupted" && evaluation.health.status != "invalid") {
        ++runner_.full_spreads;
        evaluation.spreads = 1;
    }
    const Layer& layer = last_.layer;
    if (evaluation.health.ok() && !layer.labelled) {
        evaluation.health.status = "not_labelled";
        evaluation.health.reason = "the spread carried no labels: it cannot confirm a partition";
    }
    if (evaluation.health.ok()) {
        const std::vector<double> label(layer.is_a.begin(), layer.is_a.end());
        const Footprint footprint = footprint_of(study_, design);
        evaluation.profile = plain_profile(layer, label, footprint, study_.bins, seed);
        evaluation.drift = plain_drift(layer, label, footprint, study_.bins, seed);
        allow_for_beds(evaluation, kBedsOverBlocksPlain);
        evaluation.map = gradation_map(
            layer, label, {study_.scene.powder[0].material.density, study_.scene.powder[1].material.density},
            study_.bins.width, study_.dispenser_width);
        evaluation.coverage = coverage(layer, footprint);
        evaluation.capture_fraction = layer.capture_fraction();
        evaluation.kinematic_error_bound = 1 - evaluation.capture_fraction;
        evaluation.packing_fraction = layer.packing_fraction();
        evaluation.supply_ratio = supply_ratio(scene, layer.bed_packing, evaluation.packing_fraction);
        if (layer.dosed_solid_volume > 0)
            evaluation.waste_fraction = layer.overflow_solid_volume / layer.dosed_solid_volume;
        if (layer.overflow_solid_volume > 0)
            evaluation.waste_a_share = layer.overflow_solid_volume_a / layer.overflow_solid_volume;
    }
    judge(study_, evaluation);
    // An interrupted run is not finished: a resumed one starts it again.
    if (journal_ && evaluation.health.status != "interrupted")
        journal_->append(evaluation,
                         evaluation.health.ok() ? std::vector<Layer>{layer} : std::vector<Layer>{});
    return evaluation;
}

}  // namespace gradwright
