// The process: pack -> label -> level -> dose -> spread -> layer (physics.md 1). Each stage is a function;
// run_spread strings them.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "dem/bed.h"
#include "dem/cache_file.h"
#include "dem/random.h"
#include "dem/spread.h"

namespace gradwright {
namespace {

constexpr double kFar = 1.0;  // depth of the solid bodies [m]: anything beyond the scene

// A grain below the edge that meets the dispenser's rim is pinched between blade and rim, whatever the
// stiffness (friction 0.64 locks the wedge). The blade presses it with no more than the force at an overlap
// of 0.6 % r, so that the grains it is pressed against keep within the 3 % rule (at 2 % r the neighbours of a
// pinched grain reached 8 %).
constexpr double kBladeYield = 0.006;
constexpr double kJamOverlap = 0.05;  // of the radius: such a grain counts as pinched

double volume_of(double r) {
    return 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

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
            const double v = volume_of(bed.radius[i]);
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
struct MachineBodies {
    int blade = -1;
};

MachineBodies build_machine(Engine& engine, const Scene& scene) {
    const double platform = scene.dispenser_length + scene.land, end = platform + scene.platform_length;
    for (const auto& g : rough_surface(0, scene.dispenser_length, scene.width, -scene.bed_depth,
                                       scene.roughness, scene.seed ^ 0xf100f))
        engine.add_grain(g);
    if (scene.substrate == Substrate::fused)
        for (const auto& g :
             rough_surface(platform, end, scene.width, -scene.gap, scene.roughness, scene.seed ^ 0x5b57a7e))
            engine.add_grain(g);
    auto box = [&](double x0, double x1, double top) {
        Body b;
        b.kind = Body::Kind::box;
        b.x0 = x0;
        b.x1 = x1;
        b.z0 = -kFar;
        b.z1 = top;
        b.material = kWallMaterial;
        engine.add_body(b);
    };
    Body back;  // x = 0, behind the blade
    back.axis = 0;
    back.sign = 1;
    back.offset = 0;
    back.material = kWallMaterial;
    engine.add_body(back);
    box(scene.dispenser_length, platform, 0);
    box(end, end + kFar, 0);
    if (scene.substrate == Substrate::plate) box(platform, end, -scene.gap);
    Body blade;
    blade.kind = Body::Kind::box;
    blade.x1 = -20e-6;  // clear of the powder
    blade.x0 = blade.x1 - scene.blade_thickness;
    blade.z0 = 0;
    blade.z1 = kFar;
    blade.rounding = scene.blade_tip_radius;
    blade.speed_x = scene.blade_speed;
    blade.material = kWallMaterial;
    blade.yield_ratio = kBladeYield;
    MachineBodies out;
    out.blade = engine.add_body(blade);
    add_side_walls(engine, scene);
    return out;
}

Snapshot snapshot_of(const Engine& engine, double blade_x) {
    const State& s = engine.state();
    Snapshot shot;
    shot.time = engine.time();
    shot.blade_x = blade_x;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.fixed[i]) continue;
        const auto v = engine.velocity(i);
        shot.x.push_back(static_cast<float>(s.x[i]));
        shot.y.push_back(static_cast<float>(s.y[i]));
        shot.z.push_back(static_cast<float>(s.z[i]));
        shot.radius.push_back(static_cast<float>(s.radius[i]));
        shot.is_a.push_back(s.material[i] == 0);
        shot.speed.push_back(static_cast<float>(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])));
    }
    return shot;
}

/// Length of the heap ahead of the blade if it stood at 30 degrees: sqrt(2 A / tan 30 deg), A its section.
double heap_length(const Engine& engine, const Scene& scene, double blade_x, double packing) {
    double solid = 0;
    const State& s = engine.state();
    for (std::size_t i = 0; i < s.size(); ++i)
        if (!s.fixed[i] && s.x[i] > blade_x && s.z[i] > 0) solid += volume_of(s.radius[i]);
    const double section = solid / (scene.width * std::max(packing, 0.3));
    return std::sqrt(2 * section / std::tan(std::numbers::pi / 6));
}

/// What is kept of a finished spread: layer, facts and counts; no snapshots.
std::string spread_bytes(const SpreadResult& r) {
    std::string out;
    const Layer& l = r.layer;
    for (const auto* v : {&l.origin_x, &l.origin_y, &l.origin_z, &l.deposit_x, &l.deposit_y, &l.deposit_z,
                          &l.volume, &l.radius})
        put(out, *v);
    put(out, l.is_a);
    const auto& f = r.bed;
    put(out,
        std::vector<double>{l.dosed_solid_volume,   l.overflow_solid_volume,  l.overflow_solid_volume_a,
                            l.bed_packing,          f.packing_fraction,       f.mean_coordination,
                            f.max_overlap_ratio,    f.speed_number,           f.carried_weight_ratio,
                            double(f.steps),        f.seconds_cold,           double(r.grains),
                            double(r.fixed_grains), double(r.pinched_grains), double(r.steps),
                            r.grain_steps,          r.all_grain_steps,        r.time_step,
                            r.bond_number,          r.seconds_cold,           r.health.max_overlap_ratio});
    put(out, f.made_d10_d50_d90);
    put(out, std::vector<char>(r.state_hash.begin(), r.state_hash.end()));
    std::string warnings;
    for (const auto& w : r.health.warnings) warnings += w + '\n';
    put(out, std::vector<char>(warnings.begin(), warnings.end()));
    return out;
}

bool read_spread(const std::string& bytes, const Scene& scene, SpreadResult& r) {
    std::size_t at = 0;
    Layer& l = r.layer;
    for (auto* v : {&l.origin_x, &l.origin_y, &l.origin_z, &l.deposit_x, &l.deposit_y, &l.deposit_z,
                    &l.volume, &l.radius})
        if (!take(bytes, at, *v)) return false;
    std::vector<double> n;
    std::vector<char> hash, warnings;
    auto& f = r.bed;
    if (!take(bytes, at, l.is_a) || !take(bytes, at, n) || n.size() != 21 ||
        !take(bytes, at, f.made_d10_d50_d90) || !take(bytes, at, hash) || !take(bytes, at, warnings))
        return false;
    l.dosed_solid_volume = n[0], l.overflow_solid_volume = n[1], l.overflow_solid_volume_a = n[2],
    l.bed_packing = n[3];
    f.packing_fraction = n[4], f.mean_coordination = n[5], f.max_overlap_ratio = n[6], f.speed_number = n[7];
    f.carried_weight_ratio = n[8], f.steps = long(n[9]), f.seconds_cold = n[10], f.from_cache = true;
    r.grains = long(n[11]), r.fixed_grains = long(n[12]), r.pinched_grains = long(n[13]),
    r.steps = long(n[14]);
    r.grain_steps = n[15], r.all_grain_steps = n[16], r.time_step = n[17], r.bond_number = n[18],
    r.seconds_cold = n[19];
    r.health.max_overlap_ratio = n[20];
    r.health.status = "ok";
    r.state_hash.assign(hash.begin(), hash.end());
    std::string line;
    for (const char c : warnings) {
        if (c != '\n')
            line += c;
        else
            r.health.warnings.push_back(std::move(line)), line.clear();
    }
    l.periodic = scene.sides == Sides::periodic;
    l.width = scene.width;
    l.dispenser_length = scene.dispenser_length;
    l.platform_length = scene.platform_length;
    l.gap = scene.gap;
    l.packing_seed = scene.seed;
    return true;
}

SpreadResult spread_now(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options);

}  // namespace

SpreadResult run_spread(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options) {
    // A spread without labels is an origin map: kept, because it answers every partition. Labelled ones are
    // never read back: a confirmation is always spread.
    const bool keep = !partition && !options.cache_folder.empty() && options.snapshots == 0;
    if (!keep) return spread_now(scene, partition, options);
    const double start = omp_get_wtime();
    const std::string key = fmt::format("spread format {}\n{}", kEngineFormat, scene.canonical_text());
    SpreadResult out;
    if (const auto bytes = read_cache(options.cache_folder, "map", key);
        bytes && read_spread(*bytes, scene, out)) {
        out.seconds = omp_get_wtime() - start;
        return out;
    }
    out = spread_now(scene, partition, options);
    if (out.health.ok()) write_cache(options.cache_folder, "map", key, spread_bytes(out));
    return out;
}

namespace {

SpreadResult spread_now(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options) {
    const double start = omp_get_wtime();
    SpreadResult out;
    Bed bed = cached_bed(scene, partition, options, out.health);
    out.bed = bed.facts;
    auto finish = [&]() -> SpreadResult& {
        out.seconds = omp_get_wtime() - start;
        out.seconds_cold = out.seconds - out.bed.seconds + out.bed.seconds_cold;
        return out;
    };
    if (!out.health.ok()) return finish();
    double dosed = 0;
    if (!level(bed, scene, partition, dosed)) {
        out.health.status = "not_settled";
        out.health.reason =
            "the settled bed is too low for the dose; raise numerics.bed_depth or lower the dosage factor";
        return finish();
    }

    EngineOptions eo = engine_options(scene, options.threads);
    eo.sleep = scene.sleep;
    const double platform = scene.dispenser_length + scene.land,
                 platform_end = platform + scene.platform_length;
    eo.remove_beyond_x = platform_end + scene.second_land;
    Engine engine(eo);
    const MachineBodies machine = build_machine(engine, scene);
    const int first_mobile = static_cast<int>(engine.state().size());
    add_bed(engine, bed, partition != nullptr);
    out.grains = static_cast<long>(bed.x.size());
    out.fixed_grains = first_mobile;
    out.time_step = engine.time_step();
    {
        // Bond number of the median grain between equals: F_po/(m g), F_po = 3/2 pi R* Gamma', R* = d/4.
        const double d = scene.powder[0].size.number_quantile(0.5);
        out.bond_number = 1.5 * std::numbers::pi * 0.25 * d * engine.work_of_adhesion() /
                          (scene.powder[0].material.density * volume_of(0.5 * d) * scene.gravity);
    }
    out.snapshots.push_back(snapshot_of(engine, -20e-6));

    engine.start_bodies();
    const double dt = engine.time_step();
    const double start_x = -20e-6;
    double goal = platform_end + 0.2e-3;  // known better once the blade is there
    bool goal_known = false;
    const double total = platform_end + scene.second_land * 0.5 - start_x;
    const long burst = std::max<long>(200, std::llround(20e-6 / (scene.blade_speed * dt)));
    int next_shot = 1;
    std::map<int, double> pinched;  // grain -> blade position when the pinch began
    auto blade_x = [&] { return start_x + engine.body_shift_x(machine.blade); };
    auto fail = [&](const std::string& status, const std::string& reason) {
        out.health.status = status;
        out.health.reason = reason;
    };
    while (blade_x() < goal) {
        if (options.stop && options.stop->load()) {
            fail("interrupted", "stopped while spreading");
            break;
        }
        engine.advance(std::max<long>(
            1, std::min<long>(burst, std::llround((goal - blade_x()) / (scene.blade_speed * dt)) + 1)));
        if (!engine.failed().empty()) {
            fail("diverged",
                 fmt::format("grains moved at more than {:.3g} m/s or lost their numbers ({}); lower "
                             "numerics.time_step.rayleigh_fraction (now {})",
                             eo.speed_limit, engine.failed(), scene.rayleigh_fraction));
            break;
        }
        // Pinched at the rim: it rolls between blade and land at half the blade's speed, so the blade is past
        // it after twice its thickness. Pinched for longer: it is dragged along, a jam.
        std::map<int, double> still;
        for (const std::size_t i : engine.overlapping_body(machine.blade, kJamOverlap)) {
            const int id = engine.state().id[i];
            const auto known = pinched.find(id);
            if (known == pinched.end()) ++out.pinched_grains;
            still[id] = known == pinched.end() ? blade_x() : known->second;
        }
        pinched.swap(still);
        const auto longest = std::min_element(pinched.begin(), pinched.end(),
                                              [](auto& a, auto& b) { return a.second < b.second; });
        if (longest != pinched.end() &&
            blade_x() - longest->second > 2 * scene.blade_thickness + 10 * scene.powder[0].size.d50) {
            fail("jammed", fmt::format("a grain has been dragged in the nip over {:.2f} mm; raise the gap or "
                                       "round the blade tip",
                                       1e3 * (blade_x() - longest->second)));
            break;
        }
        // Ten per cent of the radius in more than one grain of a thousand (and at least five): the softening
        // is wrong for this scene. One grain wedged between blade and rim for a moment is a warning instead
        // (its overlap is reported).
        const double crushed = engine.share_overlapping(0.10);
        if (crushed > std::max(1e-3, 4.5 / static_cast<double>(out.grains))) {
            fail("overlap", fmt::format("{:.2f} % of the grains overlap by more than 10 % of the radius; "
                                        "raise numerics.softening (now "
                                        "{:.2g}) or lower the speeds",
                                        100 * crushed, scene.softening));
            break;
        }
        if (!goal_known && blade_x() >= platform_end) {
            goal =
                platform_end + std::min(heap_length(engine, scene, platform_end, bed.facts.packing_fraction),
                                        0.9 * scene.second_land);
            goal = std::max(goal, platform_end + 0.1e-3);
            goal_known = true;
        }
        const double fraction = std::clamp((blade_x() - start_x) / total, 0.0, 1.0);
        if (options.snapshots > 0 && fraction * (options.snapshots + 1) >= next_shot &&
            next_shot <= options.snapshots) {
            out.snapshots.push_back(snapshot_of(engine, blade_x()));
            ++next_shot;
        }
        if (options.progress) options.progress({"spread", std::min(fraction, 0.99)});
    }
    const double last_blade = blade_x();
    engine.stop_bodies();
    // End: mean kinetic energy per grain below 1e-3 m g d.
    const double quiet = 1e-3 * scene.powder[0].material.density * scene.powder[0].size.mean_grain_volume() *
                         scene.gravity * scene.powder[0].size.d50 * static_cast<double>(out.grains);
    for (int k = 0; k < 40 && out.health.ok() && engine.kinetic_energy() > quiet; ++k) engine.advance(500);

    out.steps = engine.steps();
    out.grain_steps = engine.grain_steps();
    out.all_grain_steps = static_cast<double>(out.steps) * static_cast<double>(out.grains);
    out.health.max_overlap_ratio = engine.max_overlap_ratio_seen();
    if (out.health.max_overlap_ratio > 0.03)
        out.health.warnings.push_back(
            fmt::format("overlap reached {:.1f} % of the radius (3 % is the rule): raise numerics.softening",
                        100 * out.health.max_overlap_ratio));
    out.snapshots.push_back(snapshot_of(engine, last_blade));
    out.state_hash = engine.state_hash();

    // The laid layer.
    Layer& layer = out.layer;
    layer.labelled = partition != nullptr;
    layer.periodic = scene.sides == Sides::periodic;
    layer.width = scene.width;
    layer.dispenser_length = scene.dispenser_length;
    layer.platform_length = scene.platform_length;
    layer.gap = scene.gap;
    layer.dosed_solid_volume = dosed;
    layer.bed_packing = bed.facts.packing_fraction;
    layer.packing_seed = scene.seed;
    const State& s = engine.state();
    std::vector<std::size_t> by_id(s.size());
    std::iota(by_id.begin(), by_id.end(), 0);
    std::sort(by_id.begin(), by_id.end(), [&](auto a, auto b) { return s.id[a] < s.id[b]; });
    std::vector<std::uint8_t> present(bed.x.size(), 0);
    std::vector<double> floor_moves;
    for (const std::size_t i : by_id) {
        if (s.fixed[i]) continue;
        const std::size_t k = static_cast<std::size_t>(s.id[i] - first_mobile);
        present[k] = 1;
        const double d50 = scene.powder[0].size.d50;
        if (bed.z[k] < -scene.bed_depth + scene.powder[0].size.d90 && bed.x[k] > 2 * d50 &&
            bed.x[k] < scene.dispenser_length - 4 * d50)
            floor_moves.push_back(std::hypot(s.x[i] - bed.x[k], s.z[i] - bed.z[k]));
        if (s.x[i] >= platform_end) {
            layer.overflow_solid_volume += volume_of(s.radius[i]);
            if (partition && s.material[i] == 0) layer.overflow_solid_volume_a += volume_of(s.radius[i]);
        }
        if (s.x[i] < platform || s.x[i] >= platform_end || s.z[i] >= 0) continue;
        layer.origin_x.push_back(bed.x[k]);
        layer.origin_y.push_back(bed.y[k]);
        layer.origin_z.push_back(bed.z[k]);
        layer.deposit_x.push_back(s.x[i] - platform);
        layer.deposit_y.push_back(s.y[i]);
        layer.deposit_z.push_back(s.z[i]);
        layer.volume.push_back(volume_of(s.radius[i]));
        layer.radius.push_back(s.radius[i]);
        layer.is_a.push_back(partition && s.material[i] == 0);
    }
    for (std::size_t k = 0; k < present.size(); ++k) {
        if (present[k]) continue;
        layer.overflow_solid_volume += volume_of(bed.radius[k]);
        if (partition && bed.material[k] == 0) layer.overflow_solid_volume_a += volume_of(bed.radius[k]);
    }
    if (!floor_moves.empty()) {
        std::sort(floor_moves.begin(), floor_moves.end());
        const double p95 = floor_moves[floor_moves.size() * 95 / 100];
        if (p95 > 0.1 * scene.powder[0].size.d50)
            out.health.warnings.push_back(
                fmt::format("the modelled bed is shallow: grains at its floor moved {:.2f} D50 (95th "
                            "percentile, rule 0.1); raise "
                            "numerics.bed_depth (now {:.0f} um) to see whether the result changes",
                            p95 / scene.powder[0].size.d50, scene.bed_depth * 1e6));
    }
    if (out.health.ok() && layer.size() > 0) {
        // Starved: the last tenth of the platform has less than a third of the mean solid.
        double last = 0;
        for (std::size_t k = 0; k < layer.size(); ++k)
            if (layer.deposit_x[k] > 0.9 * scene.platform_length) last += layer.volume[k];
        if (last * 10 < layer.solid_volume() / 3)
            out.health.warnings.push_back(
                "the heap ran dry before the platform's end: raise the dosage factor");
    }
    if (out.health.ok() && layer.size() == 0 && out.grains > 0)
        fail("starved", "no grain was laid on the platform; raise the dosage factor or the gap");
    return finish();
}

}  // namespace

}  // namespace gradwright
