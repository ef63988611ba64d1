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

Scene scaled_strip(const Study& study, double dispenser_length, double dosage_factor, std::uint64_t seed) {
    Study small = study;
    const double scale = dispenser_length / study.scene.dispenser_length;
    small.scene.dispenser_length = dispenser_length;
    small.scene.platform_length = scale * study.scene.platform_length;
    small.scene.land = scale * study.scene.land;
    Design design;
    design.dosage_factor = dosage_factor;
    design.land = small.scene.land;
    Scene scene = scene_of(small, design, true, seed);
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

void carry_errors(ScaledHeap& heap) {
    const HeapOrder& nearest = heap.nearest();
    if (!heap.law.fitted) {
        heap.profile_error = std::hypot(nearest.profile, nearest.profile_rest);
        heap.drift_error = nearest.drift;
        heap.health.warnings.push_back(
            "too few strips to see how the heap loses its order: the order of the strip that turned over "
            "most is "
            "carried; give scale_up five strips or more");
        return;
    }
    for (const HeapOrder& strip : heap.strips)
        heap.drift_amplitude =
            std::max(heap.drift_amplitude, strip.drift * std::exp(strip.turnovers / heap.law.memory));
    heap.profile_error =
        std::hypot(heap.law.envelope(heap.turnovers), heap.law.collapse_error, nearest.profile_rest);
    heap.drift_error = std::hypot(heap.drift_amplitude * std::exp(-heap.turnovers / heap.law.memory),
                                  std::numbers::sqrt2 * heap.law.collapse_error);
    // A law that could not have told the longest strip is not believed further than that strip.
    if (std::isfinite(heap.law.longest_miss) &&
        std::fabs(nearest.profile) > heap.law.longest_envelope + 2 * heap.law.collapse_error) {
        heap.profile_error = std::max(heap.profile_error, std::hypot(nearest.profile, nearest.profile_rest));
        heap.drift_error = std::max(heap.drift_error, nearest.drift);
        heap.health.warnings.push_back(
            fmt::format("the longest strip shows more order ({:.3f}) than the law of the shorter ones allows "
                        "({:.3f}): its order is "
                        "carried as it is; give scale_up a longer strip",
                        std::fabs(nearest.profile), heap.law.longest_envelope));
    }
}

ScaledHeap scale_up(const Study& study, const Design& design, SpreadRunner& runner) {
    ScaledHeap heap;
    heap.health.status = "ok";
    const Scene whole = scene_of(study, design, true, study.seed);
    heap.turnovers = heap_turnovers(whole);
    const Footprint footprint = footprint_of(study, design);
    const auto plan = scale_up_plan(study, design.dosage_factor);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        const auto [length, dosage] = plan[i];
        const Scene scene = scaled_strip(study, length, dosage, strip_seed(study.seed, length, dosage));
        const SpreadResult result = runner.spread(
            scene, nullptr,
            fmt::format("strip {} of {}, {}, dosage {:.3g}", i + 1, plan.size(), mm(length), dosage));
        heap.grains += result.grains;
        heap.steps += result.steps;
        heap.grain_steps += result.grain_steps;
        heap.seconds += result.seconds;
        heap.seconds_cold += result.seconds_cold;
        heap.health.max_overlap_ratio =
            std::max(heap.health.max_overlap_ratio, result.health.max_overlap_ratio);
        for (const std::string& warning : result.health.warnings) heap.health.warnings.push_back(warning);
        if (result.health.status != "interrupted" && result.health.status != "invalid") ++runner.map_spreads;
        const auto failed = [&](const std::string& status, const std::string& reason) {
            heap.health.status = status;
            heap.health.reason = fmt::format("strip of {} at dosage {:.3g}: {}", mm(length), dosage, reason);
            return heap;
        };
        if (!result.health.ok()) return failed(result.health.status, result.health.reason);
        try {
            heap.strips.push_back(heap_order(result.layer, scene,
                                             footprint.x_low / study.scene.platform_length,
                                             footprint.x_high / study.scene.platform_length));
        } catch (const std::invalid_argument& nothing) {
            return failed("starved", std::string(nothing.what()) + ": leave the shortest length out");
        }
        heap.strips.back().grains = result.grains;
        heap.strips.back().seconds_cold = result.seconds_cold;
        heap.longest = std::max(heap.longest, length);
        heap.state_hash += (heap.state_hash.empty() ? "" : "+") + result.state_hash;
    }
    std::stable_sort(heap.strips.begin(), heap.strips.end(),
                     [](const HeapOrder& a, const HeapOrder& b) { return a.turnovers < b.turnovers; });
    std::vector<double> turnovers, profile;
    for (const HeapOrder& strip : heap.strips) {
        turnovers.push_back(strip.turnovers);
        profile.push_back(strip.profile);
        heap.lateral += strip.lateral / double(heap.strips.size());
    }
    heap.law = fit_order_law(turnovers, profile);
    carry_errors(heap);
    const HeapOrder& nearest = heap.nearest();
    heap.rests_on = {
        fmt::format("dispenser length: spread up to {}, asked for {} ({:.3g} times)", mm(heap.longest),
                    mm(whole.dispenser_length), whole.dispenser_length / heap.longest),
        fmt::format(
            "turnovers of the heap, sqrt(dispenser length / dose): spread up to {:.1f}, asked for {:.1f}",
            nearest.turnovers, heap.turnovers),
        fmt::format(
            "width: a periodic strip of {}, asked for {}; within some grains of a side wall nothing is known",
            mm(study.strip_width), mm(study.dispenser_width)),
        fmt::format("heap against grain: {:.0f} D50 long on the longest strip, {:.0f} on the machine",
                    std::sqrt(whole.dose_height * heap.longest) / whole.powder[0].size.d50,
                    std::sqrt(whole.dose_height * whole.dispenser_length) / whole.powder[0].size.d50)};
    return heap;
}

Layer mixed_layer(const Study& study, const Design& design, const ScaledHeap& heap, int grains) {
    const Scene scene = scene_of(study, design, true, study.seed);
    const HeapOrder& nearest = heap.nearest();
    Layer layer;
    layer.periodic = true;
    layer.width = study.dispenser_width;
    layer.dispenser_length = scene.dispenser_length;
    layer.platform_length = scene.platform_length;
    layer.gap = scene.gap;
    layer.bed_packing = nearest.bed_packing;
    layer.dosed_solid_volume = scene.dose_height * scene.dispenser_length * layer.width * nearest.bed_packing;
    layer.overflow_solid_volume = nearest.waste_fraction * layer.dosed_solid_volume;
    layer.packing_seed = study.seed;
    const double volume = nearest.capture_fraction * layer.dosed_solid_volume / grains;
    const double d50 = 0.5 * (scene.powder[0].size.d50 + scene.powder[1].size.d50);
    const double sigma = d50 * std::sqrt(heap.lateral * heap.turnovers);
    // Points of a Kronecker sequence fill the box of origin x, deposit x, deposit y and the two numbers
    // behind a normal way (Box-Muller) evenly: hardly any sampling noise. Steps: powers of 1/g, g^6 = g + 1
    // (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
    constexpr int kDimensions = 5;
    constexpr double g = 1.1347241384015194;
    double step[kDimensions], at[kDimensions];
    for (int k = 0; k < kDimensions; ++k) {
        step[k] = std::pow(g, -(k + 1));
        at[k] = 0.5;
    }
    for (int i = 0; i < grains; ++i) {
        for (int k = 0; k < kDimensions; ++k) {
            at[k] += step[k];
            at[k] -= std::floor(at[k]);
        }
        const double y = at[2] * layer.width;
        layer.origin_x.push_back(at[0] * scene.dispenser_length);
        layer.deposit_x.push_back(at[1] * scene.platform_length);
        layer.deposit_y.push_back(y);
        const double way =
            std::sqrt(-2 * std::log(std::max(at[3], 1e-12))) * std::cos(2 * std::numbers::pi * at[4]);
        layer.origin_y.push_back(y - sigma * way);
        layer.origin_z.push_back(0);
        layer.deposit_z.push_back(-0.5 * scene.gap);
        layer.volume.push_back(volume);
        layer.radius.push_back(0.5 * d50);
        layer.is_a.push_back(0);
    }
    return layer;
}

}  // namespace gradwright
