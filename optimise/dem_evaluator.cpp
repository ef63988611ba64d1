#include "optimise/dem_evaluator.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "dem/homogeneous_estimator.h"
#include "optimise/laid_layers.h"
#include "optimise/map_evaluator.h"

namespace gradwright {
namespace {

constexpr int kResamples = 200;            // bootstrap resamples of a quoted number
constexpr double kLabelsMayStray = 0.005;  // share of the laid solid whose label is not its origin's side
/// The same where each powder is read by its own grains. Sizes of their own are given to a packed bed, which
/// then settles anew: some grains at the partition cross it (1 % of the solid with 30 beside 50 um), and
/// count for nothing.
constexpr double kPowdersMayStray = 0.03;
constexpr double kSignificance = 0.01;  // of the test that sends a spread back to its plain bins

/// Share of the laid solid that carries a powder which its side of the partition does not hold.
double stray_labels(const Layer& layer, const PartitionCurve& partition, const ChamberFill& fill) {
    const std::vector<double> of_origin = hard_labels(layer, partition);
    double stray = 0, all = 0;
    for (std::size_t i = 0; i < layer.size(); ++i) {
        all += layer.volume[i];
        const double share_a = fill.share_a[of_origin[i] > 0.5 ? 0 : 1];
        if (!((layer.is_a[i] ? share_a : 1 - share_a) > 0)) stray += layer.volume[i];
    }
    return all > 0 ? stray / all : 1;
}

/// Chi-squared test that bins of their own grains say what all grains say, over the bins that count. The
/// latter are part of the former's grains, so the plain bins' variance is about that of the difference.
double agreement(const std::vector<double>& plain, const std::vector<double>& plain_error,
                 const std::vector<double>& all, const std::vector<double>& weight) {
    return bins_p_value(plain, plain_error, all, std::vector<double>(all.size(), 0.0), weight);
}

}  // namespace

void DemEvaluator::read_profile(const Layer& layer, const ChamberFill& fill, Evaluation& evaluation) const {
    const Design& design = evaluation.design;
    const Footprint footprint = footprint_of(study_, design);
    const std::vector<double> label = carried_labels(layer);
    evaluation.profile = plain_profile(layer, label, footprint, study_.bins, evaluation.seed);
    evaluation.drift = plain_drift(layer, label, footprint, study_.bins, evaluation.seed);
    if (study_.target.is_field())
        evaluation.field = plain_field(layer, label, footprint, study_.bins, study_.columns);
    allow_for_beds(evaluation, kBedsOverBlocksPlain);
    // a slot that collapses blurs the sides, which a premix would not show
    const bool alike = moves_alike(study_);
    if (!layer.periodic || !fill.level() || !(fill.pure() || (alike && study_.scene.plate_thickness == 0)) ||
        !(stray_labels(layer, design.partition, fill) <= (alike ? kLabelsMayStray : kPowdersMayStray)))
        return;

    Evaluation every;
    HomogeneousOptions options;
    options.resamples = kResamples;
    options.seed = evaluation.seed;
    const BedPowders bed{design.partition, true};
    PooledGrains grains = alike ? pool_grains({&layer, 1}, footprint.x_low, footprint.x_high)
                                : pool_powders({&layer, 1}, {&bed, 1}, footprint.x_low, footprint.x_high);
    grains.mirrored = spreads_like_its_image(study_);
    every.profile = homogeneous_profile(grains, design.partition, study_.bins, options);
    every.drift = homogeneous_drift(grains, design.partition, study_.bins, options);
    if (study_.target.is_field())
        every.field = homogeneous_field(grains, design.partition, study_.bins, study_.columns, options);
    allow_for_beds(every, beds_over_blocks(grains));
    fill.apply(every.profile, every.drift);
    fill.apply(every.field.cells);

    // the bed against itself: what it went to one side as a whole is in its bins and averaged out in the
    // mirror
    GradationProfile itself = every.profile;
    XDrift itself_drift = every.drift;
    GradationField itself_field = every.field;
    if (grains.mirrored) {
        PooledGrains unmirrored = grains;
        unmirrored.mirrored = false;
        options.resamples = 0;
        itself = homogeneous_profile(unmirrored, design.partition, study_.bins, options);
        itself_drift = homogeneous_drift(unmirrored, design.partition, study_.bins, options);
        if (study_.target.is_field())
            itself_field =
                homogeneous_field(unmirrored, design.partition, study_.bins, study_.columns, options);
        fill.apply(itself, itself_drift);
        fill.apply(itself_field.cells);
    }
    const std::vector<double> weight = bin_weights(study_);
    const double profile_p =
        agreement(evaluation.profile.gi, evaluation.profile.standard_error, itself.gi, weight);
    const double drift_p = agreement(evaluation.drift.difference, evaluation.drift.standard_error,
                                     itself_drift.difference, weight);
    const double field_p = agreement(evaluation.field.cells.gi, evaluation.field.cells.standard_error,
                                     itself_field.cells.gi, field_weights(study_));
    const int tests = study_.target.is_field() ? 3 : 2;
    evaluation.every_grain = std::min({profile_p, drift_p, field_p}) >= kSignificance / tests;
    if (!evaluation.every_grain) {
        evaluation.health.warnings.push_back(fmt::format(
            "bins of their own grains contradict what all grains of the spread say (p = {:.2g}, drift "
            "{:.2g}): transport depends on y; the wider error of the bins is quoted",
            profile_p, drift_p));
        return;
    }
    evaluation.plain_check = std::exchange(evaluation.profile, every.profile);
    evaluation.plain_check_drift = std::exchange(evaluation.drift, every.drift);
    evaluation.field = every.field;
}

std::vector<LaidLayer> DemEvaluator::read_layers(const Evaluation& judged) const {
    std::vector<LaidLayer> out;
    const std::vector<Layer> layers = layers_of(last_);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const int number = static_cast<int>(k) + 1;
        LaidLayer one = laid_layer({&last_, 1}, number, footprint_of(study_, judged.design));
        Evaluation own;
        own.design = judged.design;
        own.seed = judged.seed;
        read_profile(layers[k], chamber_fill_of_layer(study_, judged.design, number), own);
        one.profile = std::move(own.profile);
        one.drift = std::move(own.drift);
        judge_layer(study_, judged.design, one);
        one.map = map_of(layers[k]);
        out.push_back(std::move(one));
    }
    return out;
}

GradationMap DemEvaluator::map_of(const Layer& layer) const {
    return gradation_map(layer, carried_labels(layer),
                         {study_.scene.powder[0].material.density, study_.scene.powder[1].material.density},
                         study_.bins.width, study_.dispenser_width);
}

Evaluation DemEvaluator::evaluate(const Design& design, std::uint64_t seed) {
    const Scene scene = scene_of(study_, design, false, seed);
    Evaluation evaluation;
    evaluation.design = design;
    evaluation.fidelity = Fidelity::full;
    evaluation.seed = seed;
    if (study_.scale_up.on()) {
        evaluation.health.status = "invalid";
        evaluation.health.reason =
            "a study with [scale_up] is too long to be spread: it has the fidelities kinematic and map; "
            "leave "
            "[scale_up] out to spread it all the same";
        judge(study_, evaluation);
        return evaluation;
    }
    last_ = runner_.spread(scene, &design.partition, fmt::format("full spread {}", runner_.full_spreads + 1),
                           runner_.options().snapshots);
    copy_health(last_, evaluation);
    evaluation.state_hash = last_.state_hash;
    if (evaluation.health.status != "interrupted" && evaluation.health.status != "invalid") {
        ++runner_.full_spreads;
        evaluation.spreads = 1;
    }
    const Layer layer = judged_layer(study_, last_);
    if (evaluation.health.ok() && !layer.labelled) {
        evaluation.health.status = "not_labelled";
        evaluation.health.reason = "the spread carried no labels: it cannot confirm a partition";
    }
    if (evaluation.health.ok()) {
        read_profile(layer, chamber_fill(study_, design), evaluation);
        evaluation.map = map_of(layer);
        evaluation.coverage = coverage(layer, footprint_of(study_, design));
        evaluation.capture_fraction = layer.capture_fraction();
        evaluation.kinematic_error_bound = 1 - evaluation.capture_fraction;
        evaluation.packing_fraction = layer.packing_fraction();
        evaluation.supply_ratio = supply_ratio_of(study_, scene, layer);
        if (layer.dosed_solid_volume > 0)
            evaluation.waste_fraction = layer.overflow_solid_volume / layer.dosed_solid_volume;
        if (layer.overflow_solid_volume > 0)
            evaluation.waste_a_share = layer.overflow_solid_volume_a / layer.overflow_solid_volume;
        if (!last_.passes.empty()) evaluation.layers = read_layers(evaluation);
    }
    judge(study_, evaluation);
    // An interrupted run is not finished: a resumed one starts it again.
    if (journal_ && evaluation.health.status != "interrupted")
        journal_->append(evaluation,
                         evaluation.health.ok() ? std::vector<Layer>{layer} : std::vector<Layer>{});
    return evaluation;
}

}  // namespace gradwright
