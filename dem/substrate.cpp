#include "dem/substrate.h"

#include <algorithm>

#include "dem/stage.h"

namespace gradwright {
namespace {

constexpr std::uint64_t kFusedSeed = 0x5b57a7e, kPowderSeed = 0x9b0d5ull << 24;

}  // namespace

std::vector<GrainSpec> fused_surface(const Scene& scene, int layer) {
    const std::uint64_t draw = static_cast<std::uint64_t>(layer - 1) * 0x9e3779b97f4a7c15ull;
    return rough_surface(platform_start(scene), platform_end(scene), scene.width, -scene.gap, scene.roughness,
                         scene.seed ^ kFusedSeed ^ draw);
}

Scene substrate_scene(const Scene& scene) {
    Scene bed = scene;
    bed.dispenser_length = scene.platform_length;
    bed.bed_depth = scene.substrate_depth();
    bed.layers = 1;
    // what is cut off: the fuzzy top, however large its grains
    bed.dose_height = std::max(scene.powder[0].size.cut_high, scene.powder[1].size.cut_high);
    bed.share_a = {scene.substrate_share_a, scene.substrate_share_a};
    bed.plate_thickness = 0;
    bed.seed = scene.seed ^ kPowderSeed;
    return bed;
}

std::vector<GrainSpec> powder_floor(const Scene& scene) {
    const Scene bed = substrate_scene(scene);
    // drawn where it was packed on, then moved: the very surface, whatever the rounding of the lattice
    std::vector<GrainSpec> floor =
        rough_surface(0, bed.dispenser_length, bed.width, -bed.bed_depth, bed.roughness, bed.seed ^ 0xf100f);
    for (GrainSpec& grain : floor) {
        grain.x += platform_start(scene);
        grain.z -= scene.gap;
    }
    return floor;
}

Bed settled_substrate(const Scene& scene, const SpreadOptions& options, RunHealth& health) {
    const Scene bed = substrate_scene(scene);
    // pure A needs no chambers; any partition does for a premix, which is the same on both its sides
    const PartitionCurve middle = straight_partition(bed.dispenser_length, bed.width, 0, 0);
    const Bed settled = cached_bed(bed, scene.substrate_share_a == 1 ? nullptr : &middle, options, health);
    Bed cut;
    cut.facts = settled.facts;
    if (!health.ok()) {
        health.reason = "the powder under the layer: " + health.reason;
        return cut;
    }
    for (std::size_t i = 0; i < settled.x.size(); ++i) {
        if (settled.z[i] + settled.radius[i] > 0) continue;
        cut.x.push_back(settled.x[i] + platform_start(scene));
        cut.y.push_back(settled.y[i]);
        cut.z.push_back(settled.z[i] - scene.gap);
        cut.radius.push_back(settled.radius[i]);
        cut.material.push_back(settled.material[i]);
    }
    return cut;
}

}  // namespace gradwright
