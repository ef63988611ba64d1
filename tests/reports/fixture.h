// A plausible study and outcome without a single DEM step: profiles from closed forms plus seeded noise,
// grains on a lattice. Only for the files and pages: no number here claims to be physics.
#pragma once
#include <cmath>
#include <random>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright::fixture {

inline Study study(const std::string& name = "linear coupon") {
    Study s;
    s.name = name;
    s.file = "examples/01_linear_coupon.toml";
    s.text = "# " + name + "\n[process]\nlayer_thickness = \"40 um\"\n</script><script>alert(1)</script>\n";
    s.machine_name = "coupon-rig";
    s.scene.powder[0].material = {"SS17-4PH", 7980, 210e9, 0.3, "table 1"};
    s.scene.powder[1].material = {"IN718", 8200, 195e9, 0.3, "table 1"};
    for (Powder& powder : s.scene.powder) {
        powder.size.cut_low = 25e-6;
        powder.size.cut_high = 62e-6;
    }
    s.scene.width = s.dispenser_width = 1.6e-3;
    s.target = linear_target(0.4e-3, 0, 1.2e-3, 1);
    s.footprint = {1.6e-3, 3.2e-3, 0, 1.6e-3};
    s.bins = {0.2e-3, 8};
    s.design_space.dosage_factor.value = 3;
    s.reductions = {"fines_cut", "shallow_bed"};
    s.inputs = {{"machine.dispenser.length", "3.2 mm", "mm", "given", ""},
                {"machine.blade.tip_radius", "0 um", "um", "default", "sharp edge"},
                {"process.layer_thickness", "40 um", "um", "given", ""},
                {"process.steady_packing", "0.28", "", "assumed", "measured by the spreads themselves later"},
                {"interaction.static_friction", "0.64", "", "default", "paper, table 1"},
                {"interaction.work_of_adhesion", "0.02 J/m2", "J/m2", "given", "<b>not bold</b>"},
                {"run.seed", "1", "", "default", ""}};
    s.warnings = {"the bed is 0.12 mm deep, the real well 1 mm: named reduction shallow_bed"};
    return s;
}

inline GradationProfile profile(const Study& s, double noise, double error, unsigned seed) {
    GradationProfile p;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, noise);
    for (int b = 0; b < s.bins.count; ++b) {
        p.y_m.push_back(s.bins.centre(b));
        p.gi.push_back(
            std::clamp(s.target.bin_mean(s.bins.low(b), s.bins.low(b + 1)) + normal(random), 0.0, 1.0));
        p.standard_error.push_back(error);
        p.volume.push_back(1e-12);
        p.n_eff.push_back(200);
    }
    return p;
}

inline Evaluation evaluation(const Study& s, const Design& design, Fidelity fidelity, std::uint64_t seed) {
    Evaluation e;
    e.design = design;
    e.fidelity = fidelity;
    e.health.status = "ok";
    e.seed = seed;
    e.profile = profile(s, 0.015, 0.012, static_cast<unsigned>(seed));
    for (int b = 0; b < s.bins.count; ++b) {
        e.target.push_back(s.target.bin_mean(s.bins.low(b), s.bins.low(b + 1)));
        e.weight.push_back(1);
        e.drift.difference.push_back(0.05 * std::sin(1.1 * b + 0.3 * static_cast<double>(seed)));
        e.drift.standard_error.push_back(0.02);
    }
    e.drift.value = 0.045;
    e.drift.noise_floor = 0.02;
    e.misfit = {Norm::rmse, 0.021, 0.0172, 0.009, 0.029, 0.012, s.objective.tolerance};
    e.drift_misfit = {Norm::rmse, 0.045, 0.040, 0.02, 0.062, 0.02, s.objective.x_drift_tolerance};
    std::mt19937 random(static_cast<unsigned>(seed) + 7);
    std::normal_distribution<double> normal(0, 0.05);
    for (int i = 0; i < 16; ++i) e.map.x_m.push_back((i + 0.5) * 0.2e-3);
    for (int j = 0; j < 8; ++j) e.map.y_m.push_back((j + 0.5) * 0.2e-3);
    for (double y : e.map.y_m)
        for (double x : e.map.x_m) {
            e.map.gi.push_back(
                std::clamp(s.target(y + 0.15e-3 * (1 - x / 3.2e-3)) + normal(random), 0.0, 1.0));
            e.map.mass_kg.push_back(1.6e-11);
        }
    e.map.gi[3] = std::nan("");  // one cell without powder
    e.map.mass_kg[3] = 0;
    e.capture_fraction = 0.67;
    e.supply_ratio = 1.62;
    e.coverage = 0.99;
    e.waste_fraction = 0.21;
    e.waste_a_share = 0.44;
    e.packing_fraction = 0.29;
    e.grains = 28012;
    e.steps = 310000;
    e.grain_steps = 6.1e9;
    e.seconds = 402;
    e.seconds_cold = 431;
    e.spreads = 1;
    e.state_hash = "0123456789abcdef";
    return e;
}

inline Snapshot snapshot(const Study& s, const Design& design, bool after) {
    Snapshot shot;
    std::mt19937 random(after ? 3 : 2);
    std::uniform_real_distribution<double> u(0, 1);
    const double L = s.scene.dispenser_length, x0 = L + s.scene.land, W = s.dispenser_width;
    const double step = 38e-6;
    for (int layer = 0; layer < (after ? 3 : 6); ++layer)
        for (double y = step / 2; y < W; y += step)
            for (double x = step / 2; x < L; x += step) {
                if (after && u(random) < 0.35) continue;
                const double jitter = 12e-6, gx = x + jitter * (u(random) - 0.5),
                             gy = y + jitter * (u(random) - 0.5);
                const bool a = after ? u(random) < s.target(gy) : design.partition.on_side_a(gx, gy);
                shot.x.push_back(static_cast<float>(after ? x0 + gx : gx));
                shot.y.push_back(static_cast<float>(gy));
                shot.z.push_back(static_cast<float>((after ? -0.12e-3 : -0.1e-3) + layer * 35e-6 +
                                                    jitter * (u(random) - 0.5)));
                shot.radius.push_back(static_cast<float>(12.5e-6 + 14e-6 * u(random) * u(random)));
                shot.is_a.push_back(a);
                shot.vx.push_back(after ? 0.0f : 1e-4f);
                shot.vy.push_back(0.0f);
                shot.vz.push_back(0.0f);
            }
    shot.time = after ? 0.11 : 0;
    shot.blade_x = after ? 11.6e-3 : -1e-3;
    return shot;
}

inline StudyResult result(const Study& s) {
    StudyResult r;
    r.termination = "converged";
    r.message = "two confirmations agree with the map";
    r.verdict = Verdict::met;
    Design d;
    d.partition.points = {
        {0, 0.412e-3}, {0.9e-3, 0.55e-3}, {1.7e-3, 0.77e-3}, {2.4e-3, 0.98e-3}, {3.2e-3, 1.223e-3}};
    d.dosage_factor = 3;
    d.land = s.scene.land;
    for (std::size_t k = 0; k < d.partition.points.size(); ++k)
        d.parameters.emplace_back("partition.y" + std::to_string(k + 1), d.partition.points[k].y);
    r.design = d;
    r.predicted = evaluation(s, d, Fidelity::map, 11);
    r.confirmations = {evaluation(s, d, Fidelity::full, 101), evaluation(s, d, Fidelity::full, 102)};
    r.confirmed = profile(s, 0.012, 0.009, 5);
    r.confirmed.gi[7] = std::nan("");  // an empty bin
    r.confirmed_drift = r.confirmations[0].drift;
    r.target = r.predicted.target;
    r.weight = r.predicted.weight;
    for (double gi : r.confirmed.gi) {
        r.band_low.push_back(std::isfinite(gi) ? std::max(0.0, gi - 0.03) : gi);
        r.band_high.push_back(std::isfinite(gi) ? std::min(1.0, gi + 0.03) : gi);
    }
    r.misfit = {Norm::rmse, 0.0198, 0.0174, 0.0085, 0.0271, 0.0095, s.objective.tolerance};
    r.drift_misfit = {Norm::rmse, 0.047, 0.042, 0.021, 0.063, 0.020, s.objective.x_drift_tolerance};
    Design straight;
    straight.family = Family::straight;
    straight.partition = straight_partition(s.scene.dispenser_length, s.dispenser_width, 0.26, 0);
    straight.parameters = {{"partition.angle", 14.9}, {"partition.offset", 0.0}};
    r.straight = evaluation(s, straight, Fidelity::map, 11);
    r.straight->misfit.value = 0.046;
    r.kinematic = evaluation(s, d, Fidelity::kinematic, 0);
    r.kinematic->misfit.value = 0.11;
    r.capture_fraction = 0.67;
    r.supply_ratio = 1.62;
    r.coverage = 0.99;
    r.waste_fraction = 0.21;
    r.waste_a_share = 0.44;
    r.packing_fraction = 0.29;
    r.spreads_map = 1;
    r.spreads_full = 2;
    for (int i = 0; i < 9; ++i) {
        const bool confirm = i > 6;
        r.history.push_back({i,
                             i == 0    ? "start"
                             : confirm ? "confirm"
                                       : "map",
                             confirm ? Fidelity::full : Fidelity::map, 0.05 / (1 + i),
                             confirm ? 0.021 : 0.014 + 0.08 * std::exp(-0.8 * i),
                             0.05 + 0.1 * std::exp(-0.6 * i), confirm ? i - 5 : 1,
                             90.0 + 3 * i + (confirm ? 400 * (i - 6) : 0), d, i == 0 ? "closed form" : ""});
    }
    r.history[3].objective = std::nan("");
    r.stage_seconds = {
        {"pack map", 21}, {"map spread", 78}, {"search", 2.4}, {"pack full", 96}, {"confirm", 804}};
    r.seconds = 1002;
    r.seconds_cold = 1002;
    r.given_used = {{"strategy", "map -> map"}, {"spreads", "4 -> 3"}};
    Layer layer;
    std::mt19937 random(9);
    std::uniform_real_distribution<double> u(0, 1);
    std::normal_distribution<double> normal(0, 0.55e-3);
    for (int i = 0; i < 3000; ++i) {
        const double to = 3.2e-3 * u(random);
        layer.deposit_x.push_back(to);
        layer.origin_x.push_back(std::clamp(2.5e-3 - 0.35 * to + normal(random), 0.0, 3.2e-3));
        layer.volume.push_back(3e-14);
    }
    r.map_layers = {layer};
    r.snapshots = {snapshot(s, d, false), snapshot(s, d, true)};
    BedFacts bed;
    bed.packing_fraction = 0.56;
    bed.mean_coordination = 4.6;
    bed.max_overlap_ratio = 0.008;
    bed.speed_number = 0.004;
    bed.carried_weight_ratio = 0.998;
    bed.steps = 120000;
    bed.made_d10_d50_d90 = {28.6e-6, 39.8e-6, 54.8e-6};
    r.beds = {bed, bed, bed};
    r.host_isa = "AVX2";
    r.host_cores = 2;
    r.threads = 2;
    return r;
}

}  // namespace gradwright::fixture
