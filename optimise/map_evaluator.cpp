#include "optimise/map_evaluator.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <tuple>

#include "dem/homogeneous_estimator.h"
#include "optimise/chamber_fill.h"
#include "optimise/laid_layers.h"

namespace gradwright {
namespace {

constexpr int kResamples = 200;  // bootstrap resamples of a quoted number

/// Without labels there are no chambers: a level step would follow the partition, so the map takes the mean
/// level, and one floor that rises by the mean dose.
Design levelled(const Design& design) {
    Design level = design;
    const auto& [fill, dose] = std::tie(design.fill_fraction, design.dose);
    if (fill[0] != fill[1]) level.fill_fraction.fill(0.5 * (fill[0] + fill[1]));
    if (dose[0] != 1 || dose[1] != 1) level.dosage_factor *= 0.5 * (dose[0] + dose[1]);
    level.dose = {1, 1};
    return level;
}

}  // namespace

Layer tiled(const Layer& strip, double width) {
    Layer whole = strip;
    for (auto* numbers : {&whole.origin_x, &whole.origin_y, &whole.origin_z, &whole.deposit_x,
                          &whole.deposit_y, &whole.deposit_z, &whole.volume, &whole.radius})
        numbers->clear();
    whole.is_a.clear();
    whole.width = width;
    whole.periodic = false;  // the curve is continued straight beyond the sides, not wrapped
    const int copies = int(std::ceil(width / strip.width - 1e-9));
    for (int copy = 0; copy < copies; ++copy)
        for (std::size_t i = 0; i < strip.size(); ++i) {
            const double wrapped =
                strip.deposit_y[i] - strip.width * std::floor(strip.deposit_y[i] / strip.width);
            const double y = wrapped + copy * strip.width;
            if (y >= width) continue;
            whole.origin_x.push_back(strip.origin_x[i]);
            whole.origin_y.push_back(y - (strip.deposit_y[i] - strip.origin_y[i]));
            whole.origin_z.push_back(strip.origin_z[i]);
            whole.deposit_x.push_back(strip.deposit_x[i]);
            whole.deposit_y.push_back(y);
            whole.deposit_z.push_back(strip.deposit_z[i]);
            whole.volume.push_back(strip.volume[i]);
            whole.radius.push_back(strip.radius[i]);
            whole.is_a.push_back(strip.is_a[i]);
        }
    return whole;
}

MapEvaluator::MapEvaluator(const Study& study, SpreadRunner& runner, Journal* journal)
    : study_(study), runner_(runner), journal_(journal) {}

MapEvaluator::Key MapEvaluator::key_of(const Design& design, std::uint64_t seed) const {
    const Design level = levelled(design);
    // rounded: chambers that only trade powder have the same mean but for the last bits
    const auto rounded = [](double value) { return std::round(value * 1e10); };
    return {rounded(level.dosage_factor),    rounded(level.land),
            rounded(level.fill_fraction[0]), rounded(level.blade_speed),
            rounded(level.layer_thickness),  double(seed)};
}

void OriginMap::average() {
    capture_fraction = packing_fraction = waste_fraction = bed_packing = 0;
    for (std::size_t l = 0; l < layers.size(); ++l) {
        const Layer& layer = layers[l];
        const double n = 1 / share_of(l);
        capture_fraction += layer.capture_fraction() / n;
        packing_fraction += layer.packing_fraction() / n;
        bed_packing += layer.bed_packing / n;
        if (layer.dosed_solid_volume > 0)
            waste_fraction += layer.overflow_solid_volume / layer.dosed_solid_volume / n;
    }
}

OriginMap MapEvaluator::between(const std::vector<Design>& motions, const std::vector<double>& share) {
    OriginMap map;
    map.health.status = "ok";
    map.alike = moves_alike(study_);
    map.told = true;
    for (std::size_t k = 0; k < motions.size(); ++k) {
        if (!(share[k] > 0)) continue;
        const OriginMap& part = map_of(motions[k]);
        for (const Layer& layer : part.layers) {
            map.layers.push_back(layer);
            map.share.push_back(share[k] / double(part.layers.size()));
        }
        if (map.seed == 0) {
            map.scene = part.scene;
            map.seed = part.seed;
        }
    }
    map.average();
    return map;
}

bool moves_alike(const Study& study) {
    const auto& [a, b] = study.scene.powder;
    constexpr double kLikeDensity = 0.05;  // inverse-design.md, When a map holds
    return a.size == b.size && std::fabs(a.material.density / b.material.density - 1) <= kLikeDensity;
}

bool spreads_like_its_image(const Study& study) {
    return moves_alike(study) && study.scene.plate_thickness == 0;
}

void MapEvaluator::learn(const Design& design, const Layer& layer, const std::string& state_hash) {
    OriginMap& map = map_of(design);
    map.layers.push_back(layer);
    map.state_hash += "+" + state_hash;
    map.average();
}

void MapEvaluator::read_by_powder(const Design& design) {
    OriginMap& map = map_of(design);
    const auto of_b = maps_b_.find(key_of(design, 0));
    if (of_b == maps_b_.end() || !of_b->second.health.ok()) return;
    map.beds_of_layers.assign(map.layers.size(), BedPowders{{}, true});
    for (const Layer& layer : of_b->second.layers) {
        map.layers.push_back(layer);
        map.beds_of_layers.push_back({{}, false});
    }
    map.state_hash += "+" + of_b->second.state_hash;
    map.average();
}

void MapEvaluator::learn_powders(const Design& design, const Layer& layer, const PartitionCurve& partition,
                                 const std::string& state_hash) {
    OriginMap& map = map_of(design);
    if (map.beds_of_layers.empty() || !map.beds_of_layers.front().both()) {
        map.layers.clear();
        map.beds_of_layers.clear();
    }
    map.layers.push_back(layer);
    map.beds_of_layers.push_back({partition, true});
    map.state_hash += "+" + state_hash;
    map.average();
}

OriginMap& MapEvaluator::map_of(const Design& design, std::uint64_t seed) {
    const Key key = key_of(design, seed);
    const auto found = maps_.find(key);
    if (found != maps_.end()) return found->second;
    OriginMap& map = maps_[key];
    fill(map, design, seed, study_.map_spreads, 0);
    // The spread is what costs: kept before anything is made of it.
    if (journal_ && map.health.status != "interrupted") {
        journal_->append(with(design, map, false), map.layers);
        map.told = false;
    }
    return map;
}

Evaluation MapEvaluator::with_powder_b(const Design& design) {
    OriginMap& map = maps_b_[key_of(design, 0)];
    if (map.health.status == "not_run") fill(map, design, map_seed(study_.seed, study_.map_spreads), 1, 1);
    const Evaluation evaluation = with(design, map, true);
    if (journal_ && evaluation.health.status != "interrupted") journal_->append(evaluation, map.layers);
    return evaluation;
}

void MapEvaluator::fill(OriginMap& map, const Design& design, std::uint64_t seed, int count, int powder) {
    map.alike = moves_alike(study_);
    if (study_.scale_up.on()) return extrapolate(map, design);
    map.health.status = "ok";
    const Design level = levelled(design);
    std::vector<Scene> scenes;
    for (int i = 0; i < count; ++i) {
        const std::uint64_t packing_seed = seed == 0 ? map_seed(study_.seed, i) : seed + 2 * i;
        Scene scene = scene_of(study_, level, true, packing_seed);
        if (powder == 1 && scene.substrate == Substrate::powder) {
            // the powder under the layer is the same, whichever is laid on it
            std::swap(scene.powder[0], scene.powder[1]);
            scene.substrate_share_a = 1 - scene.substrate_share_a;
        } else {
            scene.powder[0] = scene.powder[powder];  // a spread without labels has powder A alone
        }
        scenes.push_back(scene);
        if (i == 0) {
            map.scene = scene;
            map.seed = packing_seed;
        }
    }
    for (const SpreadResult& result : runner_.spread_maps(scenes, powder == 0 ? "" : " with powder B")) {
        map.grains += result.grains;
        map.steps += result.steps;
        map.grain_steps += result.grain_steps;
        map.seconds += result.seconds;
        map.seconds_cold += result.seconds_cold;
        map.health.max_overlap_ratio =
            std::max(map.health.max_overlap_ratio, result.health.max_overlap_ratio);
        map.health.deep_contact_share =
            std::fmax(map.health.deep_contact_share, result.health.deep_contact_share);
        for (const std::string& warning : result.health.warnings) map.health.warnings.push_back(warning);
        // What never began (stopped, impossible scene) has cost no spread.
        if (result.health.status != "interrupted" && result.health.status != "invalid") ++runner_.map_spreads;
        if (!result.health.ok()) {
            map.health.status = result.health.status;
            map.health.reason = result.health.reason;
            break;
        }
        map.layers.push_back(judged_layer(study_, result));
        if (!result.passes.empty()) {
            map.spreads.push_back(result);
            map.spreads.back().snapshots.clear();
        }
        map.beds.push_back(result.bed);
        map.state_hash = map.state_hash.empty() ? result.state_hash
                                                : fmt::format("{}+{}", map.state_hash, result.state_hash);
    }
    if (design.fill_fraction[0] != design.fill_fraction[1] || design.dose[0] != design.dose[1])
        map.health.warnings.push_back(
            "the map was spread with level chambers: what unequal fills or doses lay is reckoned from it by "
            "their "
            "shares "
            "of the dose, and the step between the levels is only in the confirmation");
    map.average();
}

void MapEvaluator::extrapolate(OriginMap& map, const Design& design) {
    map.heap = scale_up(study_, design, runner_);
    const ScaledHeap& heap = *map.heap;
    map.health = heap.health;
    map.grains = heap.grains;
    map.steps = heap.steps;
    map.grain_steps = heap.grain_steps;
    map.seconds = heap.seconds;
    map.seconds_cold = heap.seconds_cold;
    map.state_hash = heap.state_hash;
    map.scene = scene_of(study_, design, true, study_.seed);
    map.seed = study_.seed;
    if (!map.health.ok()) return;
    map.layers = {stretched_layer(study_, design, heap)};
    map.average();
}

Evaluation MapEvaluator::evaluate(const Design& design, std::uint64_t seed) {
    Evaluation evaluation = with(design, map_of(design, seed), true);
    if (journal_ && evaluation.health.status != "interrupted") journal_->append(evaluation);
    return evaluation;
}

Evaluation MapEvaluator::quoted(const Design& design) {
    return with(design, map_of(design), true);
}

Evaluation MapEvaluator::quick(const Design& design) {
    return with(design, map_of(design), false);
}

void MapEvaluator::describe_turnover(const OriginMap& map, Evaluation& evaluation) {
    constexpr int kParts = 6;
    std::vector<double> volume(kParts, 0), first(kParts, 0), second(kParts, 0);
    for (const Layer& layer : map.layers)
        for (std::size_t i = 0; i < layer.size(); ++i) {
            const int part =
                std::clamp(int(layer.deposit_x[i] / layer.platform_length * kParts), 0, kParts - 1);
            const double origin = layer.origin_x[i] / layer.dispenser_length;
            volume[part] += layer.volume[i];
            first[part] += layer.volume[i] * origin;
            second[part] += layer.volume[i] * origin * origin;
        }
    for (int part = 0; part < kParts; ++part) {
        const double mean =
            volume[part] > 0 ? first[part] / volume[part] : std::numeric_limits<double>::quiet_NaN();
        evaluation.origin_mean.push_back(mean);
        evaluation.origin_deviation.push_back(
            std::sqrt(std::max(0.0, second[part] / volume[part] - mean * mean)));
        if (!(volume[part] > 0)) evaluation.origin_deviation.back() = mean;
    }
}

std::vector<LaidLayer> MapEvaluator::read_layers(const Design& design, const OriginMap& map,
                                                 const HomogeneousOptions& options) const {
    std::vector<LaidLayer> out;
    const Footprint footprint = footprint_of(study_, design);
    Footprint in_strip = footprint;
    in_strip.y_low = 0;
    in_strip.y_high = map.spreads.front().layer.width;
    for (int number = 1; number <= int(map.spreads.front().earlier.size()) + 1; ++number) {
        LaidLayer one = laid_layer(map.spreads, number, in_strip);
        std::vector<Layer> strips;
        for (const SpreadResult& spread : map.spreads)
            strips.push_back(layers_of(spread).at(static_cast<std::size_t>(number) - 1));
        const PooledGrains grains = pool_map(strips, {}, {}, map.alike, footprint.x_low, footprint.x_high);
        Evaluation own;
        own.profile = homogeneous_profile(grains, design.partition, study_.bins, options);
        own.drift = homogeneous_drift(grains, design.partition, study_.bins, options);
        if (!grains.replicates()) allow_for_beds(own, beds_over_blocks(grains));
        chamber_fill_of_layer(study_, design, number).apply(own.profile, own.drift);
        one.profile = std::move(own.profile);
        one.drift = std::move(own.drift);
        judge_layer(study_, design, one);
        out.push_back(std::move(one));
    }
    return out;
}

Evaluation MapEvaluator::with(const Design& design, OriginMap& map, bool quoted) {
    const auto begun = std::chrono::steady_clock::now();
    Evaluation evaluation;
    evaluation.design = design;
    evaluation.fidelity = Fidelity::map;
    evaluation.seed = map.seed;
    evaluation.health = map.health;
    evaluation.grains = map.grains;
    evaluation.steps = map.steps;
    evaluation.grain_steps = map.grain_steps;
    evaluation.state_hash = map.state_hash;
    evaluation.capture_fraction = map.capture_fraction;
    evaluation.kinematic_error_bound = 1 - map.capture_fraction;
    evaluation.packing_fraction = map.packing_fraction;
    evaluation.waste_fraction = map.waste_fraction;
    evaluation.supply_ratio = map.spreads.empty()
                                  ? supply_ratio(map.scene, map.bed_packing, map.packing_fraction)
                                  : supply_ratio_of(study_, map.scene, map.layers.front());
    if (map.health.ok()) {
        Footprint footprint = footprint_of(study_, design);
        HomogeneousOptions options;
        options.resamples = quoted ? kResamples : 0;
        options.seed = map.seed;
        // what was a block on the strip is one on the machine
        if (map.heap) options.block *= map.heap->length / map.heap->longest;
        const PooledGrains grains = map.pooled(footprint.x_low, footprint.x_high);
        evaluation.profile = homogeneous_profile(grains, design.partition, study_.bins, options);
        evaluation.drift = homogeneous_drift(grains, design.partition, study_.bins, options);
        if (study_.target.is_field())
            evaluation.field =
                homogeneous_field(grains, design.partition, study_.bins, study_.columns, options);
        if (!grains.replicates()) allow_for_beds(evaluation, beds_over_blocks(grains));
        if (map.heap) carry_extrapolation(*map.heap, evaluation);
        const ChamberFill fill = chamber_fill(study_, design);
        fill.apply(evaluation.profile, evaluation.drift);
        fill.apply(evaluation.field.cells);
        Footprint in_strip = footprint;
        in_strip.y_low = 0;
        for (std::size_t l = 0; l < map.layers.size(); ++l) {
            in_strip.y_high = map.layers[l].width;
            // stretched grains lie far apart: how they cover is known from the strip
            evaluation.coverage +=
                (map.heap ? map.heap->nearest.coverage : coverage(map.layers[l], in_strip)) * map.share_of(l);
        }
        if (quoted) {
            describe_turnover(map, evaluation);
            const Layer whole = tiled(map.layers.front(), study_.dispenser_width);
            const std::vector<double> label = hard_labels(whole, design.partition);
            std::vector<double> density;  // of what each chamber holds
            for (const double share : fill.share_a)
                density.push_back(share * study_.scene.powder[0].material.density +
                                  (1 - share) * study_.scene.powder[1].material.density);
            // stretched grains would leave small cells empty, and bins of their own grains say nothing new of
            // a machine
            const double cell =
                map.heap ? std::max(study_.bins.width, study_.dispenser_width / 20) : study_.bins.width;
            evaluation.map = gradation_map(whole, label, density, cell, study_.dispenser_width);
            // bins of their own grains are relabelled whole: not where each powder moves in its own way
            if (!map.heap && map.beds_of_layers.empty()) {
                evaluation.plain_check = plain_profile(whole, label, footprint, study_.bins, map.seed);
                for (double& s : evaluation.plain_check.standard_error)
                    s *= std::sqrt(kBedsOverBlocksPlain.profile);
                evaluation.plain_check_drift = plain_drift(whole, label, footprint, study_.bins, map.seed);
                for (double& s : evaluation.plain_check_drift.standard_error)
                    s *= std::sqrt(kBedsOverBlocksPlain.drift);
                fill.apply(evaluation.plain_check, evaluation.plain_check_drift);
            }
            fill.apply(evaluation.map);
            if (!map.spreads.empty()) evaluation.layers = read_layers(design, map, options);
        }
    }
    judge(study_, evaluation);
    evaluation.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    evaluation.seconds_cold = evaluation.seconds;
    if (!map.told) {
        evaluation.spreads = map.heap ? int(map.heap->strips.size()) : int(map.layers.size());
        evaluation.seconds += map.seconds;
        evaluation.seconds_cold += map.seconds_cold;
        map.told = true;
    }
    return evaluation;
}

}  // namespace gradwright
