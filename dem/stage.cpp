// From scene to stage and from final places to layer: pack -> level -> dose -> machine, and the measurement.
#include "dem/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/bulk.h"
#include "dem/substrate.h"

namespace gradwright {
namespace {

// A grain that meets the dispenser's rim below the edge, or the edge itself, is pinched between blade and
// rim, whatever the stiffness (friction 0.64 locks the wedge). The blade's lip presses it with a limited
// force: that at an overlap of 0.6 % r and a softening of 1e-4, about a thousand grain weights, so that the
// grains it is pressed against keep within the 3 % rule. The force is the blade's and stays when the grains
// are made stiffer. It is not what empties a short bed under a fast blade: docs/bulk.md.
constexpr double kBladeYield = 0.006, kYieldSoftening = 1e-4;

/// Level and dose: the bed already stands raised (z = 0 is the blade's plane). Cut it so that the solid above
/// z = 0 is (h - c) x area x bed packing in each chamber. Returns false when the bed is too low.
bool level(Bed& bed, const Scene& scene, const PartitionCurve* partition, double& dosed) {
    const double plan = scene.dispenser_length * scene.width;
    const double area_a = partition ? partition->area_a(scene.dispenser_length, scene.width) : plan;
    const double wanted[2] = {
        (scene.dose_height - scene.headspace[0]) * area_a * bed.facts.packing_fraction,
        (scene.dose_height - scene.headspace[1]) * (plan - area_a) * bed.facts.packing_fraction};
    auto chamber = [&](std::size_t i) {
        return partition && !partition->on_side_a(bed.x[i], bed.y[i]) ? 1 : 0;
    };
    std::vector<std::size_t> above[2];
    for (std::size_t i = 0; i < bed.x.size(); ++i)
        if (bed.z[i] > 0) above[chamber(i)].push_back(i);
    std::vector<std::uint8_t> drop(bed.x.size(), 0);
    dosed = 0;
    for (int k = 0; k < 2; ++k) {
        std::sort(above[k].begin(), above[k].end(), [&](auto a, auto b) { return bed.z[a] < bed.z[b]; });
        double sum = 0;
        for (const std::size_t i : above[k]) {
            const double v = sphere_volume(bed.radius[i]);
            if (sum + 0.5 * v > wanted[k])
                drop[i] = 1;
            else
                sum += v;
        }
        if (sum < 0.97 * wanted[k]) return false;
        dosed += sum;
    }
    Bed kept;
    kept.facts = bed.facts;
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        if (drop[i]) continue;
        kept.x.push_back(bed.x[i]);
        kept.y.push_back(bed.y[i]);
        kept.z.push_back(bed.z[i]);
        kept.radius.push_back(bed.radius[i]);
        kept.material.push_back(bed.material[i]);
    }
    bed = std::move(kept);
    return true;
}

/// Bodies and fixed grains of the machine around the levelled bed.
void build_machine(Stage& stage, const Scene& scene) {
    const double platform = platform_start(scene), end = platform_end(scene);
    stage.fixed = rough_surface(0, scene.dispenser_length, scene.width, -scene.floor_depth(), scene.roughness,
                                scene.seed ^ 0xf100f);
    stage.platform_floor = stage.fixed.size();
    const std::vector<GrainSpec> substrate = scene.substrate == Substrate::fused ? fused_surface(scene, 1)
                                             : scene.substrate == Substrate::powder
                                                 ? powder_floor(scene)
                                                 : std::vector<GrainSpec>{};
    stage.fixed.insert(stage.fixed.end(), substrate.begin(), substrate.end());
    auto add = [&](Body body) {
        body.material = kWallMaterial;
        body.adhesive = scene.adhesive_walls;
        stage.bodies.push_back(body);
    };
    auto box = [&](double x0, double x1, double top) {
        Body b;
        b.kind = Body::Kind::box;
        b.x0 = x0;
        b.x1 = x1;
        b.z0 = -kFar;
        b.z1 = top;
        add(b);
    };
    Body back;  // x = 0, behind the blade
    back.axis = 0;
    back.sign = 1;
    back.offset = 0;
    add(back);
    box(scene.dispenser_length, platform, 0);
    box(end, end + kFar, 0);
    if (scene.substrate == Substrate::plate) {
        stage.plate = static_cast<int>(stage.bodies.size());
        box(platform, end, -scene.gap);
    }
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x1 = kBladeStart;
    blade.x0 = blade.x1 - scene.blade_thickness;
    blade.z0 = 0;
    blade.z1 = kFar;
    blade.rounding = scene.blade_tip_radius;
    blade.speed_x = scene.blade_speed;
    // F ~ E* delta^(3/2)
    blade.yield_ratio = kBladeYield * std::pow(kYieldSoftening / scene.softening, 2.0 / 3.0);
    stage.blade = static_cast<int>(stage.bodies.size());
    add(blade);
    for (const Body& side : side_walls(scene)) add(side);
}

}  // namespace

Stage set_stage(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
                RunHealth& health) {
    Stage stage;
    stage.labelled = partition != nullptr;
    stage.bed = cached_bed(scene, partition, options, health);
    if (!health.ok()) return stage;
    if (!level(stage.bed, scene, partition, stage.dosed_solid_volume)) {
        health.status = "not_settled";
        health.reason =
            "the settled bed is too low for the dose; raise numerics.bed_depth or lower the dosage factor";
        return stage;
    }
    build_machine(stage, scene);
    if (scene.substrate == Substrate::powder) {
        stage.substrate = settled_substrate(scene, options, health);
        BedFacts& facts = stage.bed.facts;
        facts.seconds += stage.substrate.facts.seconds;
        facts.seconds_cold += stage.substrate.facts.seconds_cold;
        facts.from_cache = facts.from_cache && stage.substrate.facts.from_cache;
    }
    return stage;
}

double deepest_floor(const Scene& scene) {
    return std::max(scene.floor_depth(),
                    scene.gap + scene.substrate_depth() + (scene.layers - 1) * scene.sink());
}

double quiet_energy(const Scene& scene, std::size_t grains) {
    const Powder& a = scene.powder[0];
    return 1e-3 * a.material.density * a.size.mean_grain_volume() * scene.gravity * a.size.d50 *
           static_cast<double>(grains);
}

double bond_number(const Scene& scene, double work_of_adhesion) {
    // F_po = 3/2 pi R* Gamma', R* = d/4
    const double d = scene.powder[0].size.number_quantile(0.5);
    return 1.5 * std::numbers::pi * 0.25 * d * work_of_adhesion /
           (scene.powder[0].material.density * sphere_volume(0.5 * d) * scene.gravity);
}

Pass first_pass(const Scene& scene, const Stage& stage) {
    Pass pass;
    pass.gap = scene.gap;
    pass.dosed_solid_volume = pass.raised_solid_volume = stage.dosed_solid_volume;
    pass.stand.assign(stage.grains(), Stand::on_platform);
    std::fill_n(pass.stand.begin(), stage.bed.x.size(), Stand::ahead);
    return pass;
}

double carried_off_solid(const Scene& scene, const Stage& stage, const Pass& pass,
                         std::span<const GrainPlace> places) {
    std::vector<std::uint8_t> stays(pass.stand.size(), 0);
    for (const GrainPlace& place : places) stays[place.bed_index] = place.x < platform_end(scene);
    double solid = 0;
    for (std::size_t k = 0; k < stays.size(); ++k)
        if (pass.stand[k] == Stand::on_platform && !stays[k]) solid += sphere_volume(stage.radius(k));
    return solid;
}

double proud_solid(const Scene& scene, const Stage& stage, const Pass& pass,
                   std::span<const GrainPlace> places) {
    double solid = 0;
    for (const GrainPlace& place : places)
        if (pass.stand[place.bed_index] == Stand::ahead && place.x >= platform_start(scene) &&
            place.x < platform_end(scene) && place.z >= 0)
            solid += sphere_volume(stage.radius(place.bed_index));
    return solid;
}

Layer measure_layer(const Scene& scene, const Stage& stage, std::span<const GrainPlace> places,
                    RunHealth& health) {
    return measure_layer(scene, stage, first_pass(scene, stage), places, health);
}

Layer measure_layer(const Scene& scene, const Stage& stage, const Pass& pass,
                    std::span<const GrainPlace> places, RunHealth& health) {
    const Bed& bed = stage.bed;
    const double platform = platform_start(scene), end = platform_end(scene);
    const double d50 = scene.powder[0].size.d50;
    Layer layer;
    layer.labelled = stage.labelled;
    layer.periodic = scene.sides == Sides::periodic;
    layer.width = scene.width;
    layer.dispenser_length = scene.dispenser_length;
    layer.platform_length = scene.platform_length;
    layer.gap = pass.gap;
    layer.dosed_solid_volume = pass.dosed_solid_volume;
    layer.bed_packing = bed.facts.packing_fraction;
    layer.packing_seed = scene.seed;
    std::vector<std::uint8_t> present(bed.x.size(), 0);
    std::vector<double> floor_moves;
    for (const GrainPlace& place : places) {
        const std::size_t k = place.bed_index;
        if (k >= bed.x.size()) continue;  // the substrate never counts
        const double volume = sphere_volume(bed.radius[k]);
        const bool is_a = stage.labelled && bed.material[k] == 0;
        present[k] = 1;
        if (bed.z[k] < -scene.floor_depth() + scene.powder[0].size.d90 && bed.x[k] > 2 * d50 &&
            bed.x[k] < scene.dispenser_length - 4 * d50)
            floor_moves.push_back(std::hypot(place.x - bed.x[k], place.z - pass.floor_rise - bed.z[k]));
        if (pass.stand[k] != Stand::ahead) continue;
        if (place.x >= end) {
            layer.overflow_solid_volume += volume;
            if (is_a) layer.overflow_solid_volume_a += volume;
        }
        if (place.x < platform || place.x >= end || place.z >= 0) continue;
        layer.origin_x.push_back(bed.x[k]);
        layer.origin_y.push_back(bed.y[k]);
        layer.origin_z.push_back(bed.z[k]);
        layer.deposit_x.push_back(place.x - platform);
        layer.deposit_y.push_back(place.y);
        layer.deposit_z.push_back(place.z);
        layer.volume.push_back(volume);
        layer.radius.push_back(bed.radius[k]);
        layer.is_a.push_back(is_a);
    }
    for (std::size_t k = 0; k < present.size(); ++k) {
        if (present[k] || pass.stand[k] != Stand::ahead) continue;
        layer.overflow_solid_volume += sphere_volume(bed.radius[k]);
        if (stage.labelled && bed.material[k] == 0)
            layer.overflow_solid_volume_a += sphere_volume(bed.radius[k]);
    }
    if (!floor_moves.empty() && pass.number == scene.layers) {
        std::sort(floor_moves.begin(), floor_moves.end());
        const double p95 = floor_moves[floor_moves.size() * 95 / 100];
        if (p95 > 0.1 * d50)
            health.warnings.push_back(
                fmt::format("the modelled bed is shallow: grains at its floor moved {:.2f} D50 (95th "
                            "percentile, rule 0.1); raise "
                            "numerics.bed_depth (now {:.0f} um) to see whether the result changes",
                            p95 / d50, scene.bed_depth * 1e6));
    }
    if (!health.ok()) return layer;
    if (layer.size() == 0) {
        if (!bed.x.empty()) {
            health.status = "starved";
            health.reason = "no grain was laid on the platform; raise the dosage factor or the gap";
        }
        return layer;
    }
    // Dry: the last tenth of the platform has less than a third of the mean solid.
    double last = 0;
    for (std::size_t k = 0; k < layer.size(); ++k)
        if (layer.deposit_x[k] > 0.9 * scene.platform_length) last += layer.volume[k];
    if (last * 10 < layer.solid_volume() / 3) {
        // a part shorter than a cell would have no coverage
        const int parts =
            std::clamp(static_cast<int>(std::lround(scene.platform_length / kCoverageCell)), 1, 10);
        std::string along;
        for (const double share : coverage_along(layer, parts)) along += fmt::format(" {:.2f}", share);
        const std::string text = fmt::format(
            "the heap ran dry before the platform's end (coverage of its {} equal parts along x:{}): raise "
            "the dosage factor",
            parts, along);
        if (scene.allow_starved) {
            health.warnings.push_back(text);
        } else {
            health.status = "starved";
            health.reason = text + ", or let it pass with process.allow_starved = true";
        }
    }
    return layer;
}

}  // namespace gradwright
