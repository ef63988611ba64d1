// Settled beds on disk: key = every number that shapes the bed.
#include <fmt/format.h>
#include <omp.h>

#include "dem/bed.h"
#include "dem/cache_file.h"

namespace gradwright {
namespace {

std::string bed_key(const Scene& scene, const PartitionCurve* partition) {
    Scene s =
        scene;  // what the bed does not depend on is blanked, so that other lands and gaps find the same bed
    s.land = s.platform_length = s.second_land = s.gap = s.layer_thickness = 0;
    s.blade_speed = s.blade_tip_radius = s.blade_thickness = 0;
    s.headspace = {0, 0};
    s.substrate = Substrate::fused;
    // of `layers` only the deeper floor
    s.bed_depth = scene.floor_depth();
    s.layers = 1;
    s.sleep = false;
    s.allow_starved = false;
    s.adhesive_walls = true;  // of the machine while it spreads; the dispenser's walls are not concerned
    s.dispenser_depth = 0;
    std::string text = fmt::format("format {}\n{}", kEngineFormat, s.canonical_text());
    if (partition) {
        for (const auto& p : partition->points) text += fmt::format("{:.17g} {:.17g}\n", p.x, p.y);
        if (!partition->second.empty()) text += "second curve\n";
        for (const auto& p : partition->second) text += fmt::format("{:.17g} {:.17g}\n", p.x, p.y);
    }
    return text;
}

std::string pack_bytes(const Bed& bed) {
    std::string out;
    put(out, bed.x);
    put(out, bed.y);
    put(out, bed.z);
    put(out, bed.radius);
    put(out, bed.material);
    const auto& f = bed.facts;
    put(out, std::vector<double>{f.packing_fraction, f.mean_coordination, f.max_overlap_ratio, f.speed_number,
                                 f.carried_weight_ratio, static_cast<double>(f.steps), f.seconds_cold});
    put(out, f.made_d10_d50_d90);
    return out;
}

bool unpack(const std::string& bytes, Bed& bed) {
    std::size_t at = 0;
    std::vector<double> facts;
    if (!take(bytes, at, bed.x) || !take(bytes, at, bed.y) || !take(bytes, at, bed.z) ||
        !take(bytes, at, bed.radius) || !take(bytes, at, bed.material) || !take(bytes, at, facts) ||
        !take(bytes, at, bed.facts.made_d10_d50_d90) || facts.size() != 7)
        return false;
    auto& f = bed.facts;
    f.packing_fraction = facts[0];
    f.mean_coordination = facts[1];
    f.max_overlap_ratio = facts[2];
    f.speed_number = facts[3];
    f.carried_weight_ratio = facts[4];
    f.steps = static_cast<long>(facts[5]);
    f.seconds_cold = facts[6];
    f.from_cache = true;
    return true;
}

}  // namespace

Bed cached_bed(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
               RunHealth& health) {
    if (options.cache_folder.empty()) return pack_bed(scene, partition, options, health);
    const double start = omp_get_wtime();
    const std::string key = bed_key(scene, partition);
    Bed bed;
    if (const auto bytes = read_cache(options.cache_folder, "bed", key); bytes && unpack(*bytes, bed)) {
        bed.facts.seconds = options.machine_share * (omp_get_wtime() - start);
        health.status = "ok";
        return bed;
    }
    bed = pack_bed(scene, partition, options, health);
    if (health.ok() && !write_cache(options.cache_folder, "bed", key, pack_bytes(bed)))
        health.warnings.push_back(fmt::format(
            "the cache {} cannot be written; beds are packed anew each time", options.cache_folder));
    return bed;
}

}  // namespace gradwright
