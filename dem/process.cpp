// The process: pack -> label -> level -> dose -> spread -> layer (physics.md 1). Each stage is a function;
// run_spread strings them.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "dem/cache_file.h"
#include "dem/next_pass.h"
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
        out.seconds = options.machine_share * (omp_get_wtime() - start);
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
    out.seconds = options.machine_share * (omp_get_wtime() - start);
    out.seconds_cold = out.seconds - out.bed.seconds + out.bed.seconds_cold;
    return out;
}

/// Grains that are no longer between the walls or above the floors, where no force will bring them back.
long lost_grains(const Engine& engine, const Scene& scene) {
    const double low = -deepest_floor(scene) - 2 * scene.roughness,
                 beside = scene.sides == Sides::periodic ? kFar : scene.roughness;
    const State& s = engine.state();
    long count = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
        count += !s.fixed[i] && (s.z[i] < low || s.y[i] < -beside || s.y[i] > scene.width + beside ||
                                 s.x[i] < -scene.roughness);
    return count;
}

/// All passes of one stage. The engine lives through them; `out` grows.
class Spreading {
  public:
    Spreading(const Scene& scene, const Stage& stage, const SpreadOptions& options)
        : scene_(scene),
          stage_(stage),
          options_(options),
          engine_(options_of(scene, options)),
          pass_(first_pass(scene, stage)) {
        for (const GrainSpec& grain : stage.fixed) engine_.add_grain(grain);
        for (const Body& body : stage.bodies) engine_.add_body(body);
        first_mobile_ = static_cast<int>(engine_.state().size());
        add_bed(engine_, stage.bed, stage.labelled);
        add_bed(engine_, stage.substrate, true);
    }

    SpreadResult run() {
        const double start = omp_get_wtime();
        out_.health.status = "ok";
        out_.bed = stage_.bed.facts;
        out_.grains = static_cast<long>(stage_.grains());
        out_.fixed_grains = first_mobile_;
        out_.time_step = engine_.time_step();
        out_.bond_number = bond_number(scene_, engine_.work_of_adhesion());
        out_.snapshots.push_back(snapshot_of(engine_, kBladeStart));
        std::string hashes;
        while (true) {
            blade_pass();
            const double last_blade = blade_x();
            engine_.stop_bodies();
            if (out_.health.ok()) come_to_rest(scene_, engine_, stage_.grains());
            hashes += engine_.state_hash();
            const bool last = pass_.number == scene_.layers;
            if (last || !out_.health.ok()) out_.snapshots.push_back(snapshot_of(engine_, last_blade));
            measure();
            if (last || !out_.health.ok()) break;
            out_.earlier.push_back(std::move(out_.layer));
            pass_ = next_pass(scene_, stage_, pass_, engine_, first_mobile_);
            looked_ = false;
        }
        out_.state_hash = pass_.number == 1 ? hashes : text_hash(hashes);
        out_.steps = engine_.steps();
        out_.grain_steps = engine_.grain_steps();
        out_.all_grain_steps = static_cast<double>(out_.steps) * static_cast<double>(out_.grains);
        out_.health.max_overlap_ratio = engine_.max_overlap_ratio_seen();
        out_.health.deep_contact_share = engine_.deep_contact_share();
        if (const RunHealth& h = out_.health; h.max_overlap_ratio > kOverlapRule)
            out_.health.warnings.insert(
                out_.health.warnings.begin(),
                fmt::format("overlap reached {:.1f} % of the radius; {:.0f} contacts in a million went "
                            "beyond the rule of 3 %: above {:.0f} raise numerics.softening",
                            100 * h.max_overlap_ratio, 1e6 * h.deep_contact_share, 1e6 * kDeepContacts));
        if (engine_.late_steps() > 0)
            out_.health.warnings.push_back(fmt::format(
                "in {} of {} steps grains had become so fast that contacts may have been noticed late: lower "
                "numerics.time_step.rayleigh_fraction",
                engine_.late_steps(), out_.steps));
        out_.energy = engine_.energy();
        out_.seconds = out_.seconds_cold = options_.machine_share * (omp_get_wtime() - start);
        return std::move(out_);
    }

  private:
    static EngineOptions options_of(const Scene& scene, const SpreadOptions& options) {
        EngineOptions eo = engine_options(scene, options.threads);
        eo.sleep = scene.sleep && !options.energy_account;
        eo.energy_account = options.energy_account;
        eo.remove_beyond_x = platform_end(scene) + scene.second_land;
        return eo;
    }
    double blade_x() const { return kBladeStart + engine_.body_shift_x(stage_.blade); }
    void fail(const std::string& status, const std::string& reason) {
        out_.health.status = status;
        out_.health.reason = reason;
    }
    /// "layer 2 of 3: ", nothing where there is only one.
    std::string of_layer() const {
        return scene_.layers == 1 ? "" : fmt::format("layer {} of {}: ", pass_.number, scene_.layers);
    }

    /// The blade's way from behind the dispenser to its end; what goes wrong on it stands in the health.
    void blade_pass() {
        engine_.start_bodies();
        const double dt = engine_.time_step(), end = platform_end(scene_), start_x = kBladeStart;
        double goal = end + 0.2e-3;  // known better once the blade is there
        bool goal_known = false;
        const double total = end + scene_.second_land * 0.5 - start_x;
        const long burst = std::max<long>(200, std::llround(20e-6 / (scene_.blade_speed * dt)));
        int next_shot = pass_.number == scene_.layers ? 1 : options_.snapshots + 1;
        const std::string stage =
            scene_.layers == 1 ? "spread" : fmt::format("spread layer {} of {}", pass_.number, scene_.layers);
        std::map<int, double> pinched;  // grain -> blade position when the pinch began
        while (blade_x() < goal) {
            if (options_.stop && options_.stop->load()) return fail("interrupted", "stopped while spreading");
            engine_.advance(std::max<long>(
                1, std::min<long>(burst, std::llround((goal - blade_x()) / (scene_.blade_speed * dt)) + 1)));
            if (!sound()) return;
            look_for_pinched(pinched);
            if (!out_.health.ok()) return;
            // Ten per cent of the radius in more than one grain of a thousand (and at least five): the
            // softening is wrong for this scene. One grain wedged between blade and rim for a moment is a
            // warning instead (its overlap is reported).
            const double crushed = engine_.share_overlapping(0.10);
            if (crushed > std::max(1e-3, 4.5 / static_cast<double>(out_.grains)))
                return fail("overlap",
                            fmt::format("{}{:.2f} % of the grains overlap by more than 10 % of the radius; "
                                        "raise numerics.softening (now "
                                        "{:.2g}) or lower the speeds",
                                        of_layer(), 100 * crushed, scene_.softening));
            if (!goal_known && blade_x() >= end) {
                goal = end + std::min(heap_length(engine_, scene_, end, stage_.bed.facts.packing_fraction),
                                      0.9 * scene_.second_land);
                goal = std::max(goal, end + 0.1e-3);
                if (scene_.early_stop) goal = end + 0.1e-3;
                goal_known = true;
            }
            const double fraction = std::clamp((blade_x() - start_x) / total, 0.0, 1.0);
            if (options_.snapshots > 0 && fraction * (options_.snapshots + 1) >= next_shot &&
                next_shot <= options_.snapshots) {
                out_.snapshots.push_back(snapshot_of(engine_, blade_x()));
                ++next_shot;
            }
            if (options_.progress) options_.progress({stage, std::min(fraction, 0.99)});
        }
    }

    bool sound() {
        if (!engine_.failed().empty()) {
            fail("diverged",
                 fmt::format("{}grains moved at more than {:.3g} m/s or lost their numbers ({}); {}",
                             of_layer(), options_of(scene_, options_).speed_limit, engine_.failed(),
                             step_advice(scene_.rayleigh_fraction, scene_.interaction)));
            return false;
        }
        if (const long lost = lost_grains(engine_, scene_); lost > 0) {
            fail("diverged", fmt::format("{}{} grains left the powder through a floor or a wall; make "
                                         "process.roughness no larger than the powder's D50, or lower "
                                         "numerics.time_step.rayleigh_fraction (now {})",
                                         of_layer(), lost, scene_.rayleigh_fraction));
            return false;
        }
        // The first look sees what the grains started with: released at once it would shoot them apart.
        const double worst = looked_             ? 0
                             : pass_.number == 1 ? engine_.max_overlap_ratio_seen()
                                                 : engine_.max_overlap_ratio();
        looked_ = true;
        if (worst <= kWorstStart) return true;
        fail("overlap", fmt::format("{}grains start with overlaps of {:.0f} % of the radius ({:.0f} % is the "
                                    "limit): let the bed settle before it is spread",
                                    of_layer(), 100 * worst, 100 * kWorstStart));
        return false;
    }

    /// Pinched at the rim: a grain rolls between blade and land at half the blade's speed, so the blade is
    /// past it after twice its thickness. Pinched for longer: it is dragged along, a jam.
    void look_for_pinched(std::map<int, double>& pinched) {
        std::map<int, double> still;
        for (const std::size_t i : engine_.overlapping_body(stage_.blade, kJamOverlap)) {
            const int id = engine_.state().id[i];
            const auto known = pinched.find(id);
            if (known == pinched.end()) ++out_.pinched_grains;
            still[id] = known == pinched.end() ? blade_x() : known->second;
        }
        pinched.swap(still);
        const auto longest = std::min_element(pinched.begin(), pinched.end(),
                                              [](auto& a, auto& b) { return a.second < b.second; });
        if (longest == pinched.end() ||
            blade_x() - longest->second <= 2 * scene_.blade_thickness + 10 * scene_.powder[0].size.d50)
            return;
        if (out_.bond_number > kStickyBond)
            fail("does_not_flow", fmt::format("{}grains stick to the blade (Bond number {:.3g}); lower "
                                              "interaction.work_of_adhesion",
                                              of_layer(), out_.bond_number));
        else
            fail("jammed", fmt::format("{}a grain has been dragged in the nip over {:.2f} mm; raise the gap "
                                       "or round the blade tip",
                                       of_layer(), 1e3 * (blade_x() - longest->second)));
    }

    /// The laid layer of this pass, and its facts where they are told.
    void measure() {
        const State& s = engine_.state();
        std::vector<GrainPlace> places;
        for (std::size_t i = 0; i < s.size(); ++i)
            if (!s.fixed[i])
                places.push_back({static_cast<std::size_t>(s.id[i] - first_mobile_), s.x[i], s.y[i], s.z[i]});
        std::sort(places.begin(), places.end(),
                  [](const GrainPlace& a, const GrainPlace& b) { return a.bed_index < b.bed_index; });
        const bool was_ok = out_.health.ok();
        const std::size_t known = out_.health.warnings.size();
        out_.layer = measure_layer(scene_, stage_, pass_, places, out_.health);
        for (std::size_t k = known; k < out_.health.warnings.size(); ++k)
            out_.health.warnings[k] = of_layer() + out_.health.warnings[k];
        if (was_ok && !out_.health.ok()) out_.health.reason = of_layer() + out_.health.reason;
        if (scene_.layers > 1 || scene_.substrate == Substrate::powder)
            out_.passes.push_back({pass_.raised_solid_volume,
                                   carried_off_solid(scene_, stage_, pass_, places),
                                   proud_solid(scene_, stage_, pass_, places)});
        if (out_.health.status == "starved" && out_.bond_number > kStickyBond)
            fail("does_not_flow",
                 fmt::format("the powder crossed the platform in lumps (Bond number {:.3g}; {}); lower "
                             "interaction.work_of_adhesion",
                             out_.bond_number, out_.health.reason));
    }

    const Scene& scene_;
    const Stage& stage_;
    const SpreadOptions& options_;
    Engine engine_;
    Pass pass_;
    int first_mobile_ = 0;
    bool looked_ = false;
    SpreadResult out_;
};

}  // namespace

SpreadResult spread_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options) {
    if (options.energy_account && scene.layers > 1) {
        SpreadResult refused;
        refused.bed = stage.bed.facts;
        refused.health.status = "invalid";
        refused.health.reason =
            "the energy account follows one pass of the blade, not several: set process.layers to 1";
        return refused;
    }
    return Spreading(scene, stage, options).run();
}

}  // namespace gradwright
