// The process: pack -> label -> level -> dose -> spread -> layer (physics.md 1). Each stage is a function;
// run_spread strings them.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "dem/cache_file.h"
#include "dem/spread_file.h"
#include "dem/stability.h"
#include "dem/stage.h"

namespace gradwright {
namespace {

constexpr double kJamOverlap = 0.05;  // of the radius: such a grain counts as pinched
constexpr double kWorstStart = 0.15;  // of the radius: more is no settled bed
constexpr double kStickyBond = 100;   // pull-off force over weight: above it a grain hangs where it touches

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
        shot.vx.push_back(static_cast<float>(v[0]));
        shot.vy.push_back(static_cast<float>(v[1]));
        shot.vz.push_back(static_cast<float>(v[2]));
    }
    return shot;
}

/// Length of the heap ahead of the blade if it stood at 30 degrees: sqrt(2 A / tan 30 deg), A its section.
double heap_length(const Engine& engine, const Scene& scene, double blade_x, double packing) {
    double solid = 0;
    const State& s = engine.state();
    for (std::size_t i = 0; i < s.size(); ++i)
        if (!s.fixed[i] && s.x[i] > blade_x && s.z[i] > 0) solid += sphere_volume(s.radius[i]);
    const double section = solid / (scene.width * std::max(packing, 0.3));
    return std::sqrt(2 * section / std::tan(std::numbers::pi / 6));
}

SpreadResult spread_now(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options);

}  // namespace

SpreadResult run_spread(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options) {
    // A spread without labels is an origin map: kept, because it answers every partition. Labelled ones are
    // never read back: a confirmation is always spread.
    const bool keep =
        !partition && !options.cache_folder.empty() && options.snapshots == 0 && !options.energy_account;
    if (!keep) return spread_now(scene, partition, options);
    const double start = omp_get_wtime();
    const std::string key = fmt::format("spread format {}\n{}", kEngineFormat, scene.canonical_text());
    SpreadResult out;
    if (const auto bytes = read_cache(options.cache_folder, "map", key); bytes && read_spread(*bytes, out)) {
        out.bed.from_cache = true;
        out.bed.seconds = 0;
        out.seconds = omp_get_wtime() - start;
        return out;
    }
    out = spread_now(scene, partition, options);
    if (out.health.ok()) {
        SpreadResult kept = out;
        kept.snapshots.clear();
        write_cache(options.cache_folder, "map", key, spread_bytes(kept));
    }
    return out;
}

namespace {

SpreadResult spread_now(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options) {
    const double start = omp_get_wtime();
    RunHealth health;
    const Stage stage = set_stage(scene, partition, options, health);
    SpreadResult out;
    if (health.ok()) {
        out = spread_stage(scene, stage, options);
        // of the packing: "the cache cannot be written"
        out.health.warnings.insert(out.health.warnings.begin(), health.warnings.begin(),
                                   health.warnings.end());
    } else {
        out.health = health;
    }
    out.bed = stage.bed.facts;
    out.seconds = omp_get_wtime() - start;
    out.seconds_cold = out.seconds - out.bed.seconds + out.bed.seconds_cold;
    return out;
}

/// Grains that are no longer between the walls or above the floors, where no force will bring them back.
long lost_grains(const Engine& engine, const Scene& scene) {
    const double low = -std::max(scene.bed_depth, scene.gap) - 2 * scene.roughness,
                 beside = scene.sides == Sides::periodic ? kFar : scene.roughness;
    const State& s = engine.state();
    long count = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
        count += !s.fixed[i] && (s.z[i] < low || s.y[i] < -beside || s.y[i] > scene.width + beside ||
                                 s.x[i] < -scene.roughness);
    return count;
}

}  // namespace

SpreadResult spread_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options) {
    const double start = omp_get_wtime();
    SpreadResult out;
    out.health.status = "ok";
    const Bed& bed = stage.bed;
    out.bed = bed.facts;
    EngineOptions eo = engine_options(scene, options.threads);
    eo.sleep = scene.sleep && !options.energy_account;
    eo.energy_account = options.energy_account;
    const double end = platform_end(scene);
    eo.remove_beyond_x = end + scene.second_land;
    Engine engine(eo);
    for (const GrainSpec& grain : stage.fixed) engine.add_grain(grain);
    for (const Body& body : stage.bodies) engine.add_body(body);
    const int first_mobile = static_cast<int>(engine.state().size());
    add_bed(engine, bed, stage.labelled);
    out.grains = static_cast<long>(bed.x.size());
    out.fixed_grains = first_mobile;
    out.time_step = engine.time_step();
    out.bond_number = bond_number(scene, engine.work_of_adhesion());
    out.snapshots.push_back(snapshot_of(engine, kBladeStart));

    engine.start_bodies();
    const double dt = engine.time_step();
    const double start_x = kBladeStart;
    double goal = end + 0.2e-3;  // known better once the blade is there
    bool goal_known = false, looked = false;
    const double total = end + scene.second_land * 0.5 - start_x;
    const long burst = std::max<long>(200, std::llround(20e-6 / (scene.blade_speed * dt)));
    int next_shot = 1;
    std::map<int, double> pinched;  // grain -> blade position when the pinch began
    auto blade_x = [&] { return start_x + engine.body_shift_x(stage.blade); };
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
                 fmt::format("grains moved at more than {:.3g} m/s or lost their numbers ({}); {}",
                             eo.speed_limit, engine.failed(),
                             step_advice(scene.rayleigh_fraction, scene.interaction)));
            break;
        }
        if (const long lost = lost_grains(engine, scene); lost > 0) {
            fail("diverged", fmt::format("{} grains left the powder through a floor or a wall; make "
                                         "process.roughness no larger than the powder's D50, or lower "
                                         "numerics.time_step.rayleigh_fraction (now {})",
                                         lost, scene.rayleigh_fraction));
            break;
        }
        // The first look sees what the grains started with: released at once it would shoot them apart.
        if (!looked && engine.max_overlap_ratio_seen() > kWorstStart) {
            fail("overlap",
                 fmt::format("grains start with overlaps of {:.0f} % of the radius ({:.0f} % is the "
                             "limit): let the bed settle before it is spread",
                             100 * engine.max_overlap_ratio_seen(), 100 * kWorstStart));
            break;
        }
        looked = true;
        // Pinched at the rim: it rolls between blade and land at half the blade's speed, so the blade is past
        // it after twice its thickness. Pinched for longer: it is dragged along, a jam.
        std::map<int, double> still;
        for (const std::size_t i : engine.overlapping_body(stage.blade, kJamOverlap)) {
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
            if (out.bond_number > kStickyBond)
                fail("does_not_flow", fmt::format("grains stick to the blade (Bond number {:.3g}); lower "
                                                  "interaction.work_of_adhesion",
                                                  out.bond_number));
            else
                fail("jammed",
                     fmt::format("a grain has been dragged in the nip over {:.2f} mm; raise the gap or "
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
        if (!goal_known && blade_x() >= end) {
            goal = end + std::min(heap_length(engine, scene, end, bed.facts.packing_fraction),
                                  0.9 * scene.second_land);
            goal = std::max(goal, end + 0.1e-3);
            if (scene.early_stop) goal = end + 0.1e-3;
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
    const double quiet = quiet_energy(scene, bed.x.size());
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
    out.energy = engine.energy();

    // The laid layer.
    const State& s = engine.state();
    std::vector<GrainPlace> places;
    for (std::size_t i = 0; i < s.size(); ++i)
        if (!s.fixed[i])
            places.push_back({static_cast<std::size_t>(s.id[i] - first_mobile), s.x[i], s.y[i], s.z[i]});
    std::sort(places.begin(), places.end(),
              [](const GrainPlace& a, const GrainPlace& b) { return a.bed_index < b.bed_index; });
    out.layer = measure_layer(scene, stage, places, out.health);
    if (out.health.status == "starved" && out.bond_number > kStickyBond)
        fail("does_not_flow",
             fmt::format("the powder crossed the platform in lumps (Bond number {:.3g}; {}); lower "
                         "interaction.work_of_adhesion",
                         out.bond_number, out.health.reason));
    out.seconds = out.seconds_cold = omp_get_wtime() - start;
    return out;
}

}  // namespace gradwright
