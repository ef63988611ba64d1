// The strips of a machine that is too long to spread, and the map made of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optimise/heap_order.h"
#include "optimise/spread_runner.h"

namespace gradwright {
namespace {

std::string mm(double metres) {
    return fmt::format("{:.3g} mm", 1e3 * metres);
}

/// A seed of its own for every strip, so that one bed's chance is not shared by all, and the same one
/// whatever other strips are asked for: a longer list finds the shorter one's strips in the cache.
std::uint64_t strip_seed(std::uint64_t study_seed, double length, double dosage) {
    return map_seed(study_seed,
                    int(std::lround(1e6 * length)) + 1000003 * int(std::lround(100 * dosage) % 2000));
}

}  // namespace

Scene scaled_strip(const Study& study, const Design& design, double dispenser_length, double dosage_factor,
                   std::uint64_t seed) {
    Study small = study;
    const double scale = dispenser_length / study.scene.dispenser_length;
    small.scene.dispenser_length = dispenser_length;
    small.scene.platform_length = scale * study.scene.platform_length;
    Design strip = design;
    strip.dosage_factor = dosage_factor;
    strip.land = scale * (design.land >= 0 ? design.land : study.scene.land);
    Scene scene = scene_of(small, strip, true, seed);
    scene.powder[1] = scene.powder[0];  // a spread without labels has powder A alone
    return scene;
}

std::vector<std::pair<double, double>> scale_up_plan(const Study& study, double dosage_factor) {
    std::vector<std::pair<double, double>> plan;
    std::vector<double> lengths = study.scale_up.lengths;
    std::sort(lengths.begin(), lengths.end());
    for (const double length : lengths) plan.emplace_back(length, dosage_factor);
    const double middle = lengths[(lengths.size() - 1) / 2];
    for (const double other : study.scale_up.dosage_factors)
        if (std::fabs(other / dosage_factor - 1) > 1e-6) plan.emplace_back(middle, other);
    return plan;
}

ScaledHeap scale_up(const Study& study, const Design& design, SpreadRunner& runner) {
    ScaledHeap heap;
    heap.health.status = "ok";
    const auto failed = [&heap](const std::string& status, const std::string& reason) {
        heap.health.status = status;
        heap.health.reason = reason;
        return heap;
    };
    if (design.fill_fraction[0] != 1 || design.fill_fraction[1] != 1)
        return failed("invalid", "a machine is extrapolated with full chambers: fill both to 1");
    const Scene whole = scene_of(study, design, true, study.seed);
    heap.turnovers = heap_turnovers(whole);
    heap.length = whole.dispenser_length;
    const Footprint footprint = footprint_of(study, design);
    const auto plan = scale_up_plan(study, design.dosage_factor);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        const auto [length, dosage] = plan[i];
        const bool own = dosage == design.dosage_factor;
        const std::string name = fmt::format("strip of {} at dosage {:.3g}", mm(length), dosage);
        const Scene scene =
            scaled_strip(study, design, length, dosage, strip_seed(study.seed, length, dosage));
        const SpreadResult result =
            runner.spread(scene, nullptr, fmt::format("{}, {} of {}", name, i + 1, plan.size()));
        heap.grains += result.grains;
        heap.steps += result.steps;
        heap.grain_steps += result.grain_steps;
        heap.seconds += result.seconds;
        heap.seconds_cold += result.seconds_cold;
        heap.health.max_overlap_ratio =
            std::max(heap.health.max_overlap_ratio, result.health.max_overlap_ratio);
        heap.health.deep_contact_share =
            std::fmax(heap.health.deep_contact_share, result.health.deep_contact_share);
        for (const std::string& warning : result.health.warnings) heap.health.warnings.push_back(warning);
        if (result.health.status != "interrupted" && result.health.status != "invalid") ++runner.map_spreads;
        std::string reason = result.health.reason;
        std::string status = result.health.status;
        if (result.health.ok()) try {
                heap.strips.push_back(heap_order(judged_layer(study, result), scene,
                                                 footprint.x_low / study.scene.platform_length,
                                                 footprint.x_high / study.scene.platform_length));
                heap.strips.back().grains = result.grains;
                heap.strips.back().seconds_cold = result.seconds_cold;
            } catch (const std::invalid_argument& nothing) {
                status = "starved";
                reason = nothing.what();
            }
        if (status == "ok") {
            if (own) heap.kernel = judged_layer(study, result);  // lengths rise: the longest stays
            heap.state_hash += (heap.state_hash.empty() ? "" : "+") + result.state_hash;
        } else if (own || status == "interrupted") {
            return failed(status, fmt::format("{}: {}", name, reason));
        } else {
            heap.health.warnings.push_back(
                fmt::format("{} ended '{}' and is left out: {}", name, status, reason));
        }
    }
    std::stable_sort(heap.strips.begin(), heap.strips.end(),
                     [](const HeapOrder& a, const HeapOrder& b) { return a.turnovers < b.turnovers; });
    std::vector<double> turnovers, profile;
    for (const HeapOrder& strip : heap.strips) {
        turnovers.push_back(strip.turnovers);
        profile.push_back(strip.profile);
    }
    heap.law = fit_order_law(turnovers, profile);
    carry_errors(heap, design.dosage_factor);
    heap.rests_on = {
        fmt::format("dispenser length: spread up to {}, asked for {} ({:.1f} doublings)", mm(heap.longest),
                    mm(heap.length), std::log2(heap.length / heap.longest)),
        fmt::format(
            "the last doubling that was spread moved W by {:.3f} rms and its drift by {:.3f}: those still to "
            "come are taken to be no larger, and independent",
            heap.profile_step, heap.drift_step),
        fmt::format("turnovers of the heap, sqrt(dispenser length / dose): {:.1f} on the longest strip, "
                    "{:.1f} on the "
                    "machine",
                    heap.nearest.turnovers, heap.turnovers),
        fmt::format("heap against grain: {:.0f} D50 on the longest strip, {:.0f} on the machine",
                    std::sqrt(whole.dose_height * heap.longest) / whole.powder[0].size.d50,
                    std::sqrt(whole.dose_height * heap.length) / whole.powder[0].size.d50),
        fmt::format("width: a periodic strip of {} for {}; near a side wall nothing is known",
                    mm(study.strip_width), mm(study.dispenser_width))};
    return heap;
}

Layer stretched_layer(const Study& study, const Design& design, const ScaledHeap& heap) {
    const Scene scene = scene_of(study, design, true, study.seed);
    Layer layer = heap.kernel;
    const double along = scene.dispenser_length / layer.dispenser_length;
    const double across = study.dispenser_width / layer.width;
    const double wander = std::sqrt(heap.turnovers / heap.nearest.turnovers);
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const double way = wander * (layer.deposit_y[i] - layer.origin_y[i]);
        layer.origin_x[i] *= along;
        layer.deposit_x[i] *= along;
        layer.deposit_y[i] *= across;
        layer.origin_y[i] = layer.deposit_y[i] - way;
        layer.volume[i] *= along * across;
    }
    layer.width = study.dispenser_width;
    layer.dispenser_length = scene.dispenser_length;
    layer.platform_length = scene.platform_length;
    for (double* solid :
         {&layer.dosed_solid_volume, &layer.overflow_solid_volume, &layer.overflow_solid_volume_a})
        *solid *= along * across;
    return layer;
}

}  // namespace gradwright
