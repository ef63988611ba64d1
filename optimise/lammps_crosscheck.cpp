#include "optimise/lammps_crosscheck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "dem/gradation.h"
#include "dem/stage.h"
#include "optimise/design_run.h"
#include "optimise/evaluation.h"
#include "optimise/lammps_law.h"
#include "optimise/lammps_spread.h"

namespace gradwright {
namespace {

/// Instants kept by ours on the way; the one nearest to the middle of the platform gives the heap's shape.
constexpr int kInstants = 9;

const Snapshot& nearest_to(const std::vector<Snapshot>& shots, double blade_x) {
    return *std::min_element(shots.begin(), shots.end(), [blade_x](const Snapshot& a, const Snapshot& b) {
        return std::fabs(a.blade_x - blade_x) < std::fabs(b.blade_x - blade_x);
    });
}

/// GI per bin of the study's design, as this layer gives it: carried labels of a full-width run, relabelled
/// origins of a strip.
std::vector<double> gradation(const Study& study, const Design& design, const Layer& layer) {
    const Footprint footprint = footprint_of(study, design);
    if (layer.labelled)
        return plain_profile(layer, carried_labels(layer), footprint, study.bins, layer.packing_seed).gi;
    return homogeneous_profile({&layer, 1}, design.partition, footprint.x_low, footprint.x_high, study.bins,
                               {})
        .gi;
}

CrosscheckRun run_of(const Study& study, const Design& design, const SpreadResult& spread, double heap_x) {
    CrosscheckRun run;
    run.seed = spread.layer.packing_seed;
    run.health = spread.health;
    run.seconds = spread.seconds;
    run.grain_steps = spread.all_grain_steps;
    run.grains = spread.grains;
    run.steps = spread.steps;
    if (!spread.health.ok()) return run;
    run.laid = static_cast<long>(spread.layer.size());
    run.gi = gradation(study, design, spread.layer);
    run.packing_fraction = spread.layer.packing_fraction();
    run.capture_fraction = spread.layer.capture_fraction();
    Footprint whole = footprint_of(study, design);
    whole.y_low = 0;
    whole.y_high = spread.layer.width;
    run.coverage = coverage(spread.layer, whole);
    run.heap = heap_shape(nearest_to(spread.snapshots, heap_x), spread.layer.width);
    return run;
}

void add_up(CrosscheckEngine& engine) {
    double grain_steps = 0;
    engine.seconds = 0;
    for (const CrosscheckRun& run : engine.runs) {
        engine.seconds += run.seconds;
        grain_steps += run.grain_steps;
    }
    engine.grain_steps_per_second = engine.seconds > 0 ? grain_steps / engine.seconds : 0;
}

/// Sum over beds of squared deviations from their mean, and the degrees of freedom behind it.
void spread_between(const CrosscheckEngine& engine, std::size_t bin, double& squares, int& degrees) {
    double sum = 0;
    int count = 0;
    for (const CrosscheckRun& run : engine.runs)
        if (std::isfinite(run.gi[bin])) sum += run.gi[bin], ++count;
    if (count < 2) return;
    for (const CrosscheckRun& run : engine.runs)
        if (std::isfinite(run.gi[bin])) squares += std::pow(run.gi[bin] - sum / count, 2);
    degrees += count - 1;
}

/// gi_p_value of the beds' differences, bin by bin (one row a bed; NaN where one engine laid nothing).
double chance_of(const std::vector<std::vector<double>>& differences) {
    const std::size_t beds = differences.size();
    if (beds == 0 || beds > std::size_t(kMostBeds)) return std::numeric_limits<double>::quiet_NaN();
    const auto size = [&](std::uint32_t negative) {
        double squares = 0;
        for (std::size_t b = 0; b < differences.front().size(); ++b) {
            double sum = 0;
            int count = 0;
            for (std::size_t k = 0; k < beds; ++k) {
                if (!std::isfinite(differences[k][b])) continue;
                sum += (negative >> k & 1) ? -differences[k][b] : differences[k][b];
                ++count;
            }
            if (count > 0) squares += std::pow(sum / count, 2);
        }
        return squares;
    };
    const std::uint32_t patterns = std::uint32_t{1} << (beds - 1);  // the other half are their mirror images
    const double seen = size(0) * (1 - 1e-12);
    std::uint32_t as_large = 0;
    for (std::uint32_t pattern = 0; pattern < patterns; ++pattern) as_large += size(pattern) >= seen;
    return double(as_large) / patterns;
}

/// Everything that is said of all beds together.
void compare(Crosscheck& result) {
    add_up(result.ours);
    add_up(result.lammps);
    result.speed_ratio = result.ours.seconds > 0 ? result.lammps.seconds / result.ours.seconds
                                                 : std::numeric_limits<double>::quiet_NaN();
    compare_gradation(result);
}

}  // namespace

HeapShape heap_shape(const Snapshot& snapshot, double width) {
    HeapShape heap;
    heap.blade_x = snapshot.blade_x;
    std::vector<std::pair<double, double>> solid;  // distance from the face, volume
    double all = 0, moment = 0;
    for (std::size_t k = 0; k < snapshot.x.size(); ++k) {
        const double ahead = snapshot.x[k] - snapshot.blade_x;
        if (!(ahead > 0 && snapshot.z[k] > 0)) continue;
        const double volume = sphere_volume(snapshot.radius[k]);
        const std::size_t bin = static_cast<std::size_t>(ahead / kHeapBin);
        if (heap.solid_depth.size() <= bin) heap.solid_depth.resize(bin + 1, 0);
        heap.solid_depth[bin] += volume / (kHeapBin * width);
        solid.emplace_back(ahead, volume);
        all += volume;
        moment += volume * ahead;
    }
    if (!(all > 0)) return heap;
    heap.solid_section = all / width;
    heap.centre = moment / all;
    std::sort(solid.begin(), solid.end());
    double sum = 0;
    for (const auto& [ahead, volume] : solid) {
        sum += volume;
        heap.length = ahead;
        if (sum >= 0.95 * all) break;
    }
    return heap;
}

void compare_gradation(Crosscheck& result) {
    const std::size_t beds = std::min(result.ours.runs.size(), result.lammps.runs.size());
    double squares = 0, sum = 0, squares_of_means = 0, noise_squares = 0;
    int count = 0, bins = 0, degrees = 0;
    std::vector<std::vector<double>> differences(beds);
    for (std::size_t b = 0; b < result.weight.size(); ++b) {
        if (!(result.weight[b] > 0)) continue;
        double bin_sum = 0;
        int bin_count = 0;
        for (std::size_t k = 0; k < beds; ++k) {
            const double difference = result.lammps.runs[k].gi[b] - result.ours.runs[k].gi[b];
            differences[k].push_back(difference);
            if (!std::isfinite(difference)) continue;
            squares += difference * difference;
            bin_sum += difference;
            ++bin_count;
        }
        if (bin_count == 0) continue;
        sum += bin_sum;
        count += bin_count;
        squares_of_means += std::pow(bin_sum / bin_count, 2);
        ++bins;
        spread_between(result.ours, b, noise_squares, degrees);
        spread_between(result.lammps, b, noise_squares, degrees);
    }
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    result.gi_rmse = count > 0 ? std::sqrt(squares / count) : unknown;
    result.gi_rmse_of_means = bins > 0 ? std::sqrt(squares_of_means / bins) : unknown;
    result.gi_bias = count > 0 ? sum / count : unknown;
    result.noise_rms = degrees > 0 ? std::sqrt(noise_squares / degrees) : unknown;
    std::vector<double> bias;  // bed by bed
    for (const std::vector<double>& of_bed : differences) {
        double of_bins = 0;
        int finite = 0;
        for (const double difference : of_bed)
            if (std::isfinite(difference)) of_bins += difference, ++finite;
        if (finite > 0) bias.push_back(of_bins / finite);
    }
    double scatter = 0;
    const double n = double(bias.size()), middle = std::accumulate(bias.begin(), bias.end(), 0.0) / n;
    for (const double one : bias) scatter += (one - middle) * (one - middle);
    result.gi_bias_error = bias.size() > 1 ? std::sqrt(scatter / (n - 1) / n) : unknown;
    result.gi_p_value = chance_of(differences);
    result.gradation_agrees = std::isfinite(result.gi_p_value) && int(beds) >= kBedsToJudge
                                  ? result.gi_p_value >= kDiffersBelow
                                  : result.gi_rmse <= kNoiseAllowed * result.noise_rms;
    double heap_squares = 0, peak = 0;
    int heap_count = 0;
    for (std::size_t k = 0; k < beds; ++k) {
        const auto &a = result.ours.runs[k].heap.solid_depth, &b = result.lammps.runs[k].heap.solid_depth;
        for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
            const double here = i < a.size() ? a[i] : 0, there = i < b.size() ? b[i] : 0;
            heap_squares += (there - here) * (there - here);
            peak = std::max({peak, here, there});
            ++heap_count;
        }
    }
    result.heap_rmse = peak > 0 ? std::sqrt(heap_squares / heap_count) / peak : unknown;
}

Scene crosscheck_scene(const Study& study, const CrosscheckOptions& options, std::uint64_t seed) {
    Scene scene = scene_of(study, start_design(study), !options.full_width, seed);
    scene.allow_starved = true;  // a heap that runs dry is compared like any other
    if (!options.study_law) {
        if (scene.interaction.rolling_model != RollingModel::none)
            scene.interaction.rolling_model = RollingModel::spring;
        scene.interaction.friction_cap = FrictionCap::thornton;
        scene.adhesive_walls = false;
    }
    return scene;
}

Crosscheck run_crosscheck(const Study& study, const CrosscheckOptions& options) {
    find_lammps(options.ranks);
    const Design design = start_design(study);
    Crosscheck result;
    result.health.status = "ok";
    result.ours.name = "gradwright";
    result.lammps.name = "lammps";
    result.ours.ranks_or_threads = options.threads;
    result.lammps.ranks_or_threads = options.ranks;
    result.weight = bin_weights(study);
    for (int b = 0; b < study.bins.count; ++b) result.y_m.push_back(study.bins.centre(b));
    result.differences =
        lammps_differences(crosscheck_scene(study, options, study.seed), options.rigid_blade);
    const auto tell = [&](const std::string& stage, double fraction) {
        if (options.progress) options.progress(stage, fraction);
    };
    tell("two-body forces", 0);
    result.two_body = compare_two_body(crosscheck_scene(study, options, study.seed),
                                       options.folder + "/two-body", nullptr, options.stop);
    if (result.two_body.interrupted) {
        result.health.status = "interrupted";
        result.health.reason = "stopped among the single contacts";
        compare(result);
        return result;
    }
    result.forces_agree = true;
    for (const TwoBodyCase& one : result.two_body.cases)
        result.forces_agree = result.forces_agree && one.error <= kTwoBodyTolerance;
    result.lammps.version = result.two_body.version;

    for (int k = 0; k < options.seeds; ++k) {
        const Scene scene = crosscheck_scene(study, options, map_seed(study.seed, k));
        const PartitionCurve* const partition = options.full_width ? &design.partition : nullptr;
        SpreadOptions spread;
        spread.threads = options.threads;
        spread.cache_folder = options.cache_folder;
        spread.snapshots = kInstants;
        spread.stop = options.stop;
        const std::string bed = fmt::format("bed {} of {}", k + 1, options.seeds);
        const auto stage_named = [&](const std::string& engine) {
            spread.progress = [&tell, bed, engine](const Progress& p) {
                tell(fmt::format("{}: {}{}", bed, engine, p.stage), p.fraction);
            };
        };
        const auto failed = [&](const RunHealth& health, const char* engine) {
            result.health = health;
            result.health.reason = fmt::format("{}, {}: {}", bed, engine, health.reason);
            // what both engines have finished still counts
            result.ours.runs.resize(k);
            result.lammps.runs.resize(k);
            compare(result);
            return result;
        };
        RunHealth health;
        stage_named("");
        for (const SceneProblem& problem : validate(scene))
            if (problem.fatal) {
                health.status = "invalid";
                health.reason = problem.text;
                return failed(health, "scene");
            }
        const Stage stage = set_stage(scene, partition, spread, health);
        if (!health.ok()) return failed(health, "packing");

        const double heap_x = platform_start(scene) + 0.5 * scene.platform_length;
        stage_named("ours, ");
        const SpreadResult here = spread_stage(scene, stage, spread);
        result.ours.runs.push_back(run_of(study, design, here, heap_x));
        if (!here.health.ok()) return failed(here.health, "gradwright");

        stage_named("");
        LammpsSpreadOptions lammps;
        lammps.folder = fmt::format("{}/bed-{}", options.folder, k + 1);
        lammps.ranks = options.ranks;
        lammps.rigid_blade = options.rigid_blade;
        lammps.shots = {result.ours.runs.back().heap.blade_x};
        LammpsRun facts;
        SpreadResult there;
        try {
            there = run_lammps_stage(scene, stage, spread, lammps, &facts);
        } catch (const LammpsError& error) {
            there.health.status = "failed";
            there.health.reason = std::string(error.what()) + (error.mend.empty() ? "" : "; " + error.mend);
            return failed(there.health, "LAMMPS");
        }
        result.lammps.runs.push_back(run_of(study, design, there, heap_x));
        result.lammps.runs.back().seconds = facts.seconds;
        if (!there.health.ok()) return failed(there.health, "LAMMPS");
    }
    compare(result);
    return result;
}

}  // namespace gradwright
