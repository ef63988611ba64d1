#include "dem/hard_cases.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dem/bulk.h"
#include "dem/gradation.h"
#include "dem/stability.h"
#include "dem/stage.h"

namespace gradwright {
namespace {

/// The paper's powders without fines on a machine of two millimetres: some 600 grains, a few seconds. The
/// platform is longer than the way v sqrt(2 gap/g) = 0.5 mm that a grain flies at the blade's speed while it
/// falls through the gap.
Scene small_scene() {
    Scene s;
    s.dispenser_length = 0.5e-3;
    s.width = 0.26e-3;
    s.bed_depth = 40e-6;
    s.dose_height = 160e-6;
    s.land = 0.4e-3;
    s.platform_length = 1.0e-3;
    s.second_land = 0.6e-3;
    s.gap = 140e-6;
    s.blade_speed = 0.1;
    s.blade_thickness = 0.2e-3;
    s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    for (auto& p : s.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    s.wall = s.powder[0].material;
    s.seed = 3;
    return s;
}

bool finite(const Layer& layer) {
    for (const auto* v : {&layer.deposit_x, &layer.deposit_y, &layer.deposit_z, &layer.volume})
        for (const double x : *v)
            if (!std::isfinite(x)) return false;
    return true;
}

std::string fatal_text(const Scene& scene) {
    std::string text;
    for (const SceneProblem& p : validate(scene))
        if (p.fatal) text += (text.empty() ? "" : "; ") + p.text;
    return text;
}

std::string told(const SpreadResult& r) {
    return r.health.ok() ? fmt::format(
                               "ok: {} of {} grains laid, packing {:.2f}, captured {:.2f}, largest overlap "
                               "{:.1f} % r",
                               r.layer.size(), r.grains, r.layer.packing_fraction(),
                               r.layer.capture_fraction(), 100 * r.health.max_overlap_ratio)
                         : fmt::format("{}: {}", r.health.status, r.health.reason);
}

/// Must not be refused and must end "ok" with a layer of finite numbers.
SpreadResult must_complete(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
                           HardCase& out) {
    const std::string refused = fatal_text(scene);
    if (!refused.empty()) {
        out.happened = "refused: " + refused;
        return {};
    }
    SpreadResult r = run_spread(scene, partition, options);
    out.happened = told(r);
    out.pass = r.health.ok() && r.layer.size() > 0 && finite(r.layer);
    return r;
}

/// Must end with one of `statuses` and, when not "ok", with a reason.
void must_end(const Scene& scene, const SpreadOptions& options, const std::vector<std::string>& statuses,
              HardCase& out) {
    const SpreadResult r = run_spread(scene, nullptr, options);
    out.happened = told(r);
    out.pass = std::find(statuses.begin(), statuses.end(), r.health.status) != statuses.end() &&
               finite(r.layer) && (r.health.ok() || !r.health.reason.empty());
}

void must_refuse(const Scene& scene, const std::string& word, HardCase& out) {
    const std::string text = fatal_text(scene);
    out.happened = text.empty() ? "accepted" : "refused: " + text;
    out.pass = text.find(word) != std::string::npos;
}

template <void (*kChange)(Scene&)>
void completes(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    kChange(s);
    must_complete(s, nullptr, options, out);
}

void restitution_low(Scene& s) {
    s.interaction.coefficient_of_restitution = 0.05;
}
void restitution_one(Scene& s) {
    s.interaction.coefficient_of_restitution = 1;
}
void no_friction(Scene& s) {
    s.interaction.static_friction = s.interaction.rolling_friction = 0;
}
void half_the_edge(Scene& s) {
    s.rayleigh_fraction = 0.5 * kStabilityEdge;
}
void fast_blade(Scene& s) {
    s.blade_speed = 0.3;
    s.platform_length = 2.4e-3;  // v sqrt(2 gap/g) = 1.6 mm
    s.dose_height = 300e-6;
}
void wide_sizes(Scene& s) {
    for (auto& p : s.powder) p.size = {14e-6, 30e-6, 62e-6, 7e-6, 70e-6};
    s.dispenser_length = 0.32e-3;
    s.width = 0.28e-3;
    s.roughness = 30e-6;  // 40 um grains on a floor of their own size would leave holes for 7 um fines
    s.land = 0.2e-3;
    s.platform_length = 0.8e-3;
}
void full_stiffness(Scene& s) {
    s.softening = 1;
    // adhesion as the softened scenes have it: the whole (Bond number 197) sticks to the blade in one bed of
    // three, whatever the stiffness
    s.interaction.work_of_adhesion *= std::pow(1e-4, 0.4);
    for (auto& p : s.powder) p.size.cut_low = 50e-6;
    s.dispenser_length = 0.3e-3;
    s.bed_depth = 30e-6;
    s.dose_height = 170e-6;
    s.land = 0.1e-3;
    s.platform_length = 0.9e-3;
    s.second_land = 0.3e-3;
    s.gap = 110e-6;
}

template <int kGrains>
void few_grains(const SpreadOptions& options, HardCase& out) {
    const Scene scene = small_scene();
    RunHealth health;
    Stage stage = set_stage(scene, nullptr, options, health);
    if (!health.ok()) {
        out.happened = health.status + ": " + health.reason;
        return;
    }
    // the highest grains alone: they are in the blade's way
    std::vector<std::size_t> order(stage.bed.z.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return stage.bed.z[a] > stage.bed.z[b]; });
    Bed few;
    few.facts = stage.bed.facts;
    stage.dosed_solid_volume = 0;
    for (int k = 0; k < kGrains; ++k) {
        const std::size_t i = order[k];
        few.x.push_back(stage.bed.x[i]), few.y.push_back(stage.bed.y[i]), few.z.push_back(stage.bed.z[i]);
        few.radius.push_back(stage.bed.radius[i]), few.material.push_back(stage.bed.material[i]);
        stage.dosed_solid_volume += sphere_volume(stage.bed.radius[i]);
    }
    stage.bed = few;
    const SpreadResult r = spread_stage(scene, stage, options);
    const std::vector<double> labels(r.layer.size(), 1.0);
    const auto profile =
        plain_profile(r.layer, labels, {0, scene.platform_length, 0, scene.width}, {scene.width, 1}, 1);
    const double gi = profile.gi.empty() ? std::nan("") : profile.gi[0];
    out.happened = fmt::format("{}{}; {} grains laid, GI {}", r.health.status,
                               r.health.reason.empty() ? "" : ": " + r.health.reason, r.layer.size(),
                               std::isnan(gi) ? "undefined" : fmt::format("{:.2f}", gi));
    const bool nothing = r.layer.size() == 0;
    out.pass = r.grains == kGrains && finite(r.layer) && std::isnan(gi) == nothing &&
               (kGrains == 0 ? r.health.ok() && nothing : r.health.ok() || r.health.status == "starved");
}

void density_ratio(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.powder[1].material.density = s.powder[0].material.density / 5;
    const auto partition = straight_partition(s.dispenser_length, s.width, 0.3, 0);
    const SpreadResult r = must_complete(s, &partition, options, out);
    std::size_t heavy = 0;
    for (const auto a : r.layer.is_a) heavy += a;
    out.happened += fmt::format("; {} heavy and {} light grains laid", heavy, r.layer.size() - heavy);
    out.pass = out.pass && heavy > 0 && heavy < r.layer.size();
}

/// GI in the middle halves of the two sides of y = W/2, and their standard error from the effective number of
/// grains.
void partition_along(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.width = 0.52e-3;
    const auto partition = straight_partition(s.dispenser_length, s.width, 0, 0);
    const SpreadResult r = must_complete(s, &partition, options, out);
    if (!out.pass) return;
    const BinGrid quarter{s.width / 4, 4};
    // the middles of the halves: W/8..3W/8 is B, 5W/8..7W/8 is A; shift y so that they are bins 0 and 2
    Layer shifted = r.layer;
    for (double& y : shifted.deposit_y) y -= s.width / 8;
    const auto profile =
        plain_profile(shifted, carried_labels(r.layer), {0, s.platform_length, 0, s.width}, quarter, 1);
    out.happened += fmt::format("; GI {:.2f} in the middle of B's half, {:.2f} in the middle of A's",
                                profile.gi[0], profile.gi[2]);
    out.pass = profile.gi[0] < 0.1 && profile.gi[2] > 0.9;
}

void partition_across(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.width = 0.52e-3;
    const auto partition = straight_partition(s.dispenser_length, s.width, 0.5 * std::numbers::pi, 0);
    // Grains come in clumps from one place of the dispenser, so a bed's own standard error says too little
    // (above 4 of them in one bed of four): what is flat is the mean of beds, and they say how far it may be
    // off.
    constexpr int kBeds = 6;
    std::array<std::array<double, 4>, kBeds> off{};
    double mean_gi = 0;
    for (int bed = 0; bed < kBeds; ++bed, ++s.seed) {
        const SpreadResult r = must_complete(s, &partition, options, out);
        if (!out.pass) return;
        const auto p = plain_profile(r.layer, carried_labels(r.layer), {0, s.platform_length, 0, s.width},
                                     {s.width / 4, 4}, 1);
        double volume = 0, mean = 0;
        for (int k = 0; k < 4; ++k) volume += p.volume[k], mean += p.volume[k] * p.gi[k];
        mean /= volume;
        for (int k = 0; k < 4; ++k) off[bed][k] = p.gi[k] - mean;
        mean_gi += mean / kBeds;
    }
    double worst = 0, largest = 0;
    for (int k = 0; k < 4; ++k) {
        double sum = 0, square = 0;
        for (const auto& bed : off) sum += bed[k], square += bed[k] * bed[k];
        const double mean = sum / kBeds,
                     error = std::sqrt((square - kBeds * mean * mean) / (kBeds - 1) / kBeds);
        largest = std::max(largest, std::fabs(mean));
        worst = std::max(worst, std::fabs(mean) / error);
    }
    out.happened += fmt::format(
        "; the same in {} beds: a quarter's GI at most {:.3f} from the mean {:.2f}, {:.1f} standard errors",
        kBeds, largest, mean_gi, worst);
    // Student's t of five degrees of freedom: one set of four quarters in a hundred is beyond 6
    out.pass = worst < 6 && mean_gi > 0 && mean_gi < 1;
}

template <int kTenths>
void beyond_the_edge(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.rayleigh_fraction = 0.1 * kTenths;
    const SpreadResult r = run_spread(s, nullptr, options);
    out.happened = told(r);
    out.pass = r.health.status == "unstable_step" && r.layer.size() == 0 &&
               r.health.reason.find("times the stability edge") != std::string::npos;
}

void strong_adhesion(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.adhesion_scaling = AdhesionScaling::none;
    // Bo = 3/2 pi R* Gamma/(m g) = 1000 for D50 = 40 um against its like: R* = 10 um
    const double r = 20e-6, mass = s.powder[0].material.density * sphere_volume(r);
    s.interaction.work_of_adhesion = 1000 * mass * s.gravity / (1.5 * std::numbers::pi * 0.5 * r);
    must_end(s, options, {"ok", "does_not_flow"}, out);
}

/// One grain on the bare platform, 1.2 gaps high, in the blade's way: gap/d = 0.83 locks at friction 0.64,
/// because it is above (1 + cos(2 atan mu))/2 = 0.71.
void grain_in_the_nip(const SpreadOptions& options, HardCase& out) {
    Scene scene = small_scene();
    scene.substrate = Substrate::plate;
    scene.gap = 50e-6;
    scene.platform_length = 2e-3;
    scene.allow_starved = true;  // one grain covers nothing
    RunHealth health;
    Stage stage = set_stage(scene, nullptr, options, health);
    if (!health.ok()) {
        out.happened = health.status + ": " + health.reason;
        return;
    }
    const BedFacts facts = stage.bed.facts;
    const double r = 0.6 * scene.gap;
    stage.bed = Bed{{platform_start(scene) + 0.3e-3}, {0.5 * scene.width}, {r - scene.gap}, {r}, {0}, facts};
    stage.dosed_solid_volume = sphere_volume(r);
    const SpreadResult result = spread_stage(scene, stage, options);
    out.happened =
        fmt::format("{}{}; {} grain pinched by more than 5 % of its radius, {} laid", result.health.status,
                    result.health.reason.empty() ? "" : ": " + result.health.reason, result.pinched_grains,
                    result.layer.size());
    out.pass = finite(result.layer) && result.pinched_grains == 1 &&
               (result.health.status == "jammed" || result.health.ok());
}

/// A settled bed pressed together in one direction: the grains start in each other.
void overlapping_start(const SpreadOptions& options, HardCase& out) {
    const Scene scene = small_scene();
    RunHealth health;
    Stage stage = set_stage(scene, nullptr, options, health);
    if (health.ok()) {
        for (double& z : stage.bed.z) z = -scene.bed_depth + 0.9 * (z + scene.bed_depth);
        const SpreadResult r = spread_stage(scene, stage, options);
        health = r.health;
    }
    out.happened = health.status + ": " + health.reason;
    out.pass = health.status == "overlap" && health.reason.find("start") != std::string::npos;
}

void starved_dose(const SpreadOptions& options, HardCase& out) {
    Scene s = small_scene();
    s.dose_height = 50e-6;
    s.platform_length = 5.0e-3;
    const SpreadResult r = run_spread(s, nullptr, options);
    out.happened = told(r);
    out.pass = r.health.status == "starved" && r.health.reason.find("coverage") != std::string::npos &&
               finite(r.layer);
}

void dry_chamber(const SpreadOptions&, HardCase& out) {
    Scene s = small_scene();
    s.headspace[1] = s.dose_height;
    must_refuse(s, "starved", out);
}
void narrow_dispenser(const SpreadOptions&, HardCase& out) {
    Scene s = small_scene();
    s.dispenser_length = 2.9 * 62e-6;
    must_refuse(s, "dispenser length", out);
}
void blade_in_substrate(const SpreadOptions&, HardCase& out) {
    Scene s = small_scene();
    s.gap = 10e-6;
    must_refuse(s, "blade", out);
}
void blade_in_floor(const SpreadOptions&, HardCase& out) {
    Scene s = small_scene();
    s.bed_depth = 8e-6;
    must_refuse(s, "blade", out);
}

}  // namespace

const std::vector<HardCaseSpec>& hard_cases() {
    static const std::vector<HardCaseSpec> all = {
        {"restitution-0.05", "coefficient of restitution 0.05", "completes", false,
         completes<restitution_low>},
        {"restitution-1", "coefficient of restitution 1: nothing is lost but by friction", "completes", false,
         completes<restitution_one>},
        {"no-friction", "no friction, no rolling resistance", "completes", false, completes<no_friction>},
        {"grains-0", "no grain at all", "completes; the layer is empty, GI undefined", false, few_grains<0>},
        {"grains-1", "one grain", "completes, or starved", false, few_grains<1>},
        {"grains-2", "two grains", "completes, or starved", false, few_grains<2>},
        {"size-ratio-10", "diameters 7 to 70 um", "completes", false, completes<wide_sizes>},
        {"density-ratio-5", "A five times as dense as B, both in one spread", "completes", false,
         density_ratio},
        {"partition-0", "partition at 0 degrees", "completes; GI(y) is a step", false, partition_along},
        {"partition-90", "partition at 90 degrees", "completes; GI(y) is flat within its noise", false,
         partition_across},
        {"half-the-edge", "time step at half the measured stability edge", "completes", false,
         completes<half_the_edge>},
        {"blade-0.3", "blade at 0.3 m/s", "completes", false, completes<fast_blade>},
        {"full-stiffness", "softening 1 (real Young's modulus), under 200 grains", "completes", false,
         completes<full_stiffness>},
        {"beyond-the-edge", "time step of 6 Rayleigh times",
         "refused as unstable_step, with the factor beyond the edge", false, beyond_the_edge<60>},
        {"edge-x2.5",
         "time step of 1 Rayleigh time, 2.5 times the edge, the largest that a study may ask for",
         "refused as unstable_step, with the factor beyond the edge", false, beyond_the_edge<10>},
        {"edge-x1.5", "time step of 0.6 Rayleigh times, 1.5 times the edge",
         "refused as unstable_step, with the factor beyond the edge", false, beyond_the_edge<6>},
        {"bond-1000", "adhesion of Bond number 1000 at D50", "does_not_flow, or completes", false,
         strong_adhesion},
        {"nip",
         "one grain 1.2 times as high as the gap on a bare plate, friction 0.64: it locks under the edge",
         "jammed, or passed over by the yielding blade and counted as pinched", false, grain_in_the_nip},
        {"overlap-20", "a settled bed pressed to nine tenths of its height: overlaps of 20 % of the radius",
         "refused: overlap", true, overlapping_start},
        {"starved", "a dose for less than half of the platform of 5 mm", "starved, with coverage along x",
         false, starved_dose},
        {"dry-chamber", "a chamber that stands as far below the rim as the floor rises", "refused", true,
         dry_chamber},
        {"narrow-dispenser", "a dispenser 2.9 grains long", "refused", true, narrow_dispenser},
        {"blade-in-substrate", "gap 10 um over fused grains of 40 um", "refused", true, blade_in_substrate},
        {"blade-in-floor", "8 um of powder modelled over floor grains of 40 um", "refused", true,
         blade_in_floor},
    };
    return all;
}

HardCase run_hard_case(const HardCaseSpec& spec, const SpreadOptions& options) {
    HardCase out;
    out.id = spec.id;
    out.tried = spec.tried;
    out.expected = spec.expected;
    const double start = omp_get_wtime();
    spec.run(options, out);
    out.seconds = omp_get_wtime() - start;
    return out;
}

}  // namespace gradwright
