// A heap whose transport kernel is known in closed form: stands in for the DEM engine so that the truth of
// every partition is known.
//   deposit_x uniform on the platform; origin_x | deposit_x normal, mean L_d (centre + turn (x/L_b - 1/2)),
//   sd = mixing L_d, cut to the dispenser; deposit_y - origin_y normal with sd sigma_y; log-normal volumes.
//   Drawn by quantile, independent between grains but for the bed's own shift.
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dem/random.h"
#include "optimise/design_run.h"

namespace gradwright::testing_heap {

struct Heap {
    double centre = 0.55, turn = -0.05, mixing = 0.2;
    double sigma_y = 40e-6;
    double grains_per_m2 = 3000 / (3.2e-3 * 0.4e-3);
    double full_shift = 0;   ///< the labelled spread's physics: centre moved by this
    double light_shift = 0;  ///< a strip all of a powder lighter than 6000 kg/m3: centre moved by this
    double b_shift = 0;      ///< beside A, B's grains: centre moved by this ...
    double b_more = 1;       ///< ... and so many times as likely to be laid
    double bed_shift = 0;    ///< sd of what all grains of one bed share: a shift of the centre
    double bed_aside = 0;    ///< the same across: sd of how far a bed as a whole goes to one side [m]
    double across = 0;       ///< centre moves by this from one side to the other: transport that depends on y
    double stray = 0;        ///< share of the labels that are drawn by lot
    double land_turn = 0;    ///< turn changes by this per m of land beyond 3.2 mm
    int fail_full = 0;       ///< this many of the first labelled spreads end "jammed"
    bool fail_map = false;
    double capture = 0.6;

    bool apart() const { return b_shift != 0 || b_more != 1; }
    double mean(const Scene& scene, double deposit_x, bool labelled) const {
        const double turning = turn + land_turn * (scene.land - 3.2e-3);
        return scene.dispenser_length * (centre +
                                         (labelled                                  ? full_shift
                                          : scene.powder[0].material.density < 6000 ? light_shift
                                                                                    : 0) +
                                         turning * (deposit_x / scene.platform_length - 0.5));
    }
};

/// What was asked of the stand-in engine.
struct Calls {
    std::vector<std::uint64_t> map_seeds, full_seeds;
    std::vector<double> full_widths, map_widths;
};

inline SpreadResult spread(const Heap& heap, Calls& calls, const Scene& scene,
                           const PartitionCurve* partition) {
    const bool labelled = partition != nullptr;
    (labelled ? calls.full_seeds : calls.map_seeds).push_back(scene.seed);
    (labelled ? calls.full_widths : calls.map_widths).push_back(scene.width);
    SpreadResult result;
    result.health.status = "ok";
    result.health.deep_contact_share = 0;
    if ((labelled && int(calls.full_seeds.size()) <= heap.fail_full) || (!labelled && heap.fail_map)) {
        result.health.status = "jammed";
        result.health.reason = "a grain sits in the nip";
        return result;
    }
    Random random(scene.seed);
    Layer& layer = result.layer;
    layer.labelled = labelled;
    layer.periodic = scene.sides == Sides::periodic;
    layer.width = scene.width;
    layer.dispenser_length = scene.dispenser_length;
    layer.platform_length = scene.platform_length;
    layer.gap = scene.gap;
    layer.packing_seed = scene.seed;
    layer.bed_packing = 0.55;
    const double shift = heap.bed_shift * scene.dispenser_length * Random(scene.seed ^ 0xbedULL).normal();
    const double aside = heap.bed_aside * Random(scene.seed ^ 0xa51deULL).normal();
    const int grains = int(heap.grains_per_m2 * scene.platform_length * scene.width);
    for (int i = 0; i < grains; ++i) {
        const double x = scene.platform_length * random.uniform();
        const double y = scene.width * random.uniform();
        // powders that move each in its own way are drawn apart: a grain that its kernel would bring from the
        // other's side is not there
        const bool apart = labelled && heap.apart();
        const bool of_b = apart && random.uniform() < heap.b_more / (1 + heap.b_more);
        const double mean = heap.mean(scene, x, labelled) + shift +
                            (of_b ? heap.b_shift * scene.dispenser_length : 0) +
                            heap.across * scene.dispenser_length * (y / scene.width - 0.5),
                     sd = heap.mixing * scene.dispenser_length;
        double origin_x = -1;
        while (!(origin_x >= 0 && origin_x < scene.dispenser_length)) origin_x = mean + sd * random.normal();
        const double origin_y = y - aside - heap.sigma_y * random.normal();
        if (apart &&
            partition->on_side_a(origin_x, layer.periodic
                                               ? origin_y - scene.width * std::floor(origin_y / scene.width)
                                               : origin_y) == of_b)
            continue;
        const double volume = 3.35e-14 * std::exp(0.5 * random.normal());
        layer.deposit_x.push_back(x);
        layer.deposit_y.push_back(y);
        layer.deposit_z.push_back(-70e-6);
        layer.origin_x.push_back(origin_x);
        layer.origin_y.push_back(origin_y);
        layer.origin_z.push_back(-50e-6);
        layer.volume.push_back(volume);
        layer.radius.push_back(std::cbrt(volume * 0.75 / std::numbers::pi));
        const double from =
            layer.periodic ? origin_y - scene.width * std::floor(origin_y / scene.width) : origin_y;
        const bool side_a = labelled && partition->on_side_a(origin_x, from);
        const double share = scene.share_a[side_a ? 0 : 1];
        layer.is_a.push_back(labelled && (share == 0 || share == 1 ? share > 0 : random.uniform() < share));
        if (labelled && heap.stray > 0 && random.uniform() < heap.stray)
            layer.is_a.back() = random.uniform() < 0.5;
        layer.dosed_solid_volume += volume / heap.capture;
    }
    layer.overflow_solid_volume = layer.dosed_solid_volume * (1 - heap.capture);
    result.grains = grains;
    result.steps = 1000;
    result.seconds = 0;
    result.seconds_cold = 5;  // as if half of it lay in the bed cache
    result.state_hash = "synthetic";
    return result;
}

inline SpreadFunction engine(const Heap& heap, std::shared_ptr<Calls> calls) {
    return [heap, calls](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        return spread(heap, *calls, scene, partition);
    };
}

/// Coupon of the first example: 3.2 x 1.6 mm dispenser, footprint the platform's second half, linear 0 -> 1
/// ramp.
inline Study coupon() {
    Study study;
    study.name = "synthetic";
    study.scene.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    study.scene.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    for (Powder& powder : study.scene.powder) {
        powder.size.cut_low = 25e-6;
        powder.size.cut_high = 62e-6;
    }
    study.scene.sides = Sides::frictional;
    study.target = linear_target(0.4e-3, 0, 1.2e-3, 1);
    study.footprint = {1.6e-3, 3.2e-3, 0, 1.6e-3};
    study.bins = {0.2e-3, 8};
    study.design_space.dosage_factor.value = 3;
    return study;
}

/// True GI of the bins, and true drift per bin, by quadrature of the kernel: P(A) = <Phi((y - yc(origin_x)) /
/// sigma_y)>; of powders drawn apart P_A / (P_A + b_more (1 - P_B)), each by its own kernel.
struct Truth {
    std::vector<double> gi, drift;
};
inline Truth truth(const Heap& heap, const Study& study, const Design& design, bool labelled) {
    const Scene scene = scene_of(study, design, !labelled, 1);
    const Footprint footprint = footprint_of(study, design);
    const int deposits = 24, origins = 400, heights = 10;
    const double length = scene.dispenser_length;
    // yc at each origin: bisection of the side along y, which is monotone for the families used here
    std::vector<double> yc(origins);
    const bool above = design.partition.on_side_a(0.5 * length, 1.0);
    for (int i = 0; i < origins; ++i) {
        double low = -0.02, high = 0.02;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (low + high);
            (design.partition.on_side_a((i + 0.5) * length / origins, middle) == above ? high : low) = middle;
        }
        yc[i] = 0.5 * (low + high);
    }
    Truth result;
    for (int bin = 0; bin < study.bins.count; ++bin) {
        // shares of A and of B over all x, the first and the last third
        double of_a[3] = {}, of_b[3] = {};
        for (int d = 0; d < deposits; ++d) {
            const double x = footprint.x_low + (d + 0.5) / deposits * (footprint.x_high - footprint.x_low);
            const double sd = heap.mixing * length;
            for (const bool a : {true, false}) {
                const double mean =
                    heap.mean(scene, x, labelled) + (labelled && !a ? heap.b_shift * length : 0);
                double norm = 0, share = 0;
                for (int i = 0; i < origins; ++i) {
                    const double z = ((i + 0.5) * length / origins - mean) / sd,
                                 weight = std::exp(-0.5 * z * z);
                    norm += weight;
                    for (int h = 0; h < heights; ++h) {
                        const double y = study.bins.low(bin) + (h + 0.5) / heights * study.bins.width;
                        const double p = 0.5 * std::erfc(-(y - yc[i]) / heap.sigma_y * std::sqrt(0.5));
                        share += weight * (above ? p : 1 - p) / heights;
                    }
                }
                double* const laid = a ? of_a : of_b;
                const double amount = a ? share / norm : (labelled ? heap.b_more : 1) * (1 - share / norm);
                laid[0] += amount;
                if (d < deposits / 3) laid[1] += amount;
                if (d >= deposits - deposits / 3) laid[2] += amount;
            }
        }
        const auto gi = [&](int part) { return of_a[part] / (of_a[part] + of_b[part]); };
        const double sum = gi(0), first = gi(1), last = gi(2);
        result.gi.push_back(sum);
        result.drift.push_back(last - first);
    }
    return result;
}

/// True rmse against the study's target over the bins that count.
inline double true_rmse(const Study& study, const Truth& truth) {
    const std::vector<double> target = bin_targets(study), weight = bin_weights(study);
    std::vector<double> residual = truth.gi;
    for (std::size_t b = 0; b < residual.size(); ++b) residual[b] -= target[b];
    return norm_of(Norm::rmse, residual, weight);
}

}  // namespace gradwright::testing_heap
