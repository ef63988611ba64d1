#include "optimise/lammps_spread.h"

#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include "dem/stage.h"
#include "optimise/dem_evaluator.h"
#include "optimise/lammps_deck.h"
#include "optimise/lammps_law.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;

std::string file_text(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// `first_mobile`: id of the bed's first grain in the deck.
std::vector<GrainPlace> places_of(const LammpsDump& dump, std::size_t first_mobile) {
    const auto &id = dump.column("id"), &x = dump.column("x"), &y = dump.column("yu"), &z = dump.column("z");
    std::vector<GrainPlace> places(dump.size());
    for (std::size_t k = 0; k < places.size(); ++k)
        places[k] = {static_cast<std::size_t>(id[k]) - first_mobile, x[k], y[k], z[k]};
    return places;
}

/// The bed as it stands before the blade moves.
Snapshot first_snapshot(const Stage& stage) {
    const Bed& bed = stage.bed;
    Snapshot shot;
    shot.blade_x = kBladeStart;
    const auto in_float = [](const std::vector<double>& from, std::vector<float>& to) {
        for (const double value : from) to.push_back(static_cast<float>(value));
    };
    in_float(bed.x, shot.x);
    in_float(bed.y, shot.y);
    in_float(bed.z, shot.z);
    in_float(bed.radius, shot.radius);
    for (const std::uint8_t material : bed.material) shot.is_a.push_back(!stage.labelled || material == 0);
    shot.vx.resize(bed.x.size());
    shot.vy.resize(bed.x.size());
    shot.vz.resize(bed.x.size());
    return shot;
}

Snapshot snapshot_of(const LammpsDump& dump, const Scene& scene, const Stage& stage, double blade_x) {
    const auto &vx = dump.column("vx"), &vy = dump.column("vy"), &vz = dump.column("vz");
    Snapshot shot;
    shot.time = static_cast<double>(dump.step) * scene_time_step(scene);
    shot.blade_x = blade_x;
    const std::vector<GrainPlace> places = places_of(dump, stage.fixed.size() + 1);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const GrainPlace& place = places[k];
        shot.x.push_back(static_cast<float>(place.x));
        shot.y.push_back(static_cast<float>(place.y));
        shot.z.push_back(static_cast<float>(place.z));
        shot.radius.push_back(static_cast<float>(stage.bed.radius.at(place.bed_index)));
        shot.is_a.push_back(!stage.labelled || stage.bed.material[place.bed_index] == 0);
        shot.vx.push_back(static_cast<float>(vx[k]));
        shot.vy.push_back(static_cast<float>(vy[k]));
        shot.vz.push_back(static_cast<float>(vz[k]));
    }
    return shot;
}

/// Grains where no spread can bring them: below the floors, behind the back wall, beside the side walls.
long escaped_grains(std::span<const GrainPlace> places, const Scene& scene) {
    const double low = -deepest_floor(scene) - 2 * scene.roughness;
    long count = 0;
    for (const GrainPlace& place : places)
        count += place.z < low || place.x < -scene.roughness ||
                 (scene.sides != Sides::periodic &&
                  (place.y < -scene.roughness || place.y > scene.width + scene.roughness));
    return count;
}

}  // namespace

SpreadResult run_lammps_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options,
                              const LammpsSpreadOptions& lammps, LammpsRun* facts) {
    const double start = omp_get_wtime();
    SpreadResult out;
    const auto finish = [&]() -> SpreadResult& {
        out.seconds = out.seconds_cold = omp_get_wtime() - start;
        return out;
    };
    if (const std::string obstacle = lammps_obstacle(scene); !obstacle.empty()) {
        out.health.status = "invalid";
        out.health.reason = obstacle;
        return finish();
    }
    const LammpsProgram program = find_lammps(lammps.ranks);
    out.health.status = "ok";
    out.health.max_overlap_ratio = std::numeric_limits<double>::quiet_NaN();
    out.bed = stage.bed.facts;
    const double dt = scene_time_step(scene);
    out.grains = static_cast<long>(stage.bed.x.size());
    out.fixed_grains = static_cast<long>(stage.fixed.size());
    out.time_step = dt;
    out.bond_number = bond_number(scene, LammpsLaw(scene).work_of_adhesion());
    out.snapshots.push_back(first_snapshot(stage));

    const fs::path folder = lammps.folder;
    fs::create_directories(folder);
    write_deck_file(folder / kLammpsDeck,
                    lammps_deck(scene, stage, {lammps.ranks, lammps.shots, lammps.rigid_blade}));
    write_deck_file(folder / kLammpsBed, lammps_bed(scene, stage));
    LammpsRunOptions run;
    run.folder = lammps.folder;
    run.input = kLammpsDeck;
    run.ranks = lammps.ranks;
    run.stop = options.stop;
    if (options.progress) {
        // the way beyond the platform and coming to rest are about a tenth more
        const double all = 1.1 * static_cast<double>(lammps_way_steps(scene));
        run.progress = [&options, all](long step) {
            options.progress({"spread in LAMMPS", std::min(0.99, static_cast<double>(step) / all)});
        };
    }
    const LammpsRun ran = run_lammps(program, run);
    if (facts) *facts = ran;
    if (ran.interrupted) {
        out.health.status = "interrupted";
        out.health.reason = "stopped while LAMMPS was spreading";
        return finish();
    }

    const LammpsDump last = read_lammps_dump(folder / kLammpsFinal);
    const std::vector<GrainPlace> places = places_of(last, stage.fixed.size() + 1);
    for (const GrainPlace& place : places) {
        if (std::isfinite(place.x + place.y + place.z)) continue;
        out.health.status = "diverged";
        out.health.reason = "LAMMPS lost a grain's numbers; lower numerics.time_step.rayleigh_fraction";
        return finish();
    }
    if (const long escaped = escaped_grains(places, scene); escaped > 0)
        out.health.warnings.push_back(
            fmt::format("{} of {} grains went through a wall or a floor in LAMMPS", escaped, out.grains));
    out.steps = last.step;
    out.grain_steps = out.all_grain_steps = static_cast<double>(last.step) * static_cast<double>(out.grains);
    out.state_hash = text_hash(file_text(folder / kLammpsFinal));
    for (std::size_t k = 0; k < lammps.shots.size(); ++k)
        out.snapshots.push_back(
            snapshot_of(read_lammps_dump(folder / lammps_shot_file(k)), scene, stage, lammps.shots[k]));
    const double way = std::strtod(file_text(folder / kLammpsWay).c_str(), nullptr);
    out.snapshots.push_back(snapshot_of(last, scene, stage, kBladeStart + way));
    out.layer = measure_layer(scene, stage, places, out.health);
    return finish();
}

SpreadResult run_lammps_spread(const Scene& scene, const PartitionCurve* partition,
                               const SpreadOptions& options, const LammpsSpreadOptions& lammps) {
    const double start = omp_get_wtime();
    SpreadResult out;
    for (const SceneProblem& problem : validate(scene))
        if (problem.fatal)
            out.health.reason += out.health.reason.empty() ? problem.text : "; " + problem.text;
    if (!out.health.reason.empty()) {
        out.health.status = "invalid";
        return out;
    }
    find_lammps(lammps.ranks);  // before a bed is packed for nothing
    RunHealth health;
    const Stage stage = set_stage(scene, partition, options, health);
    if (health.ok())
        out = run_lammps_stage(scene, stage, options, lammps);
    else
        out.health = health;
    out.bed = stage.bed.facts;
    out.seconds = omp_get_wtime() - start;
    out.seconds_cold = out.seconds - out.bed.seconds + out.bed.seconds_cold;
    return out;
}

SpreadFunction lammps_spread_function(const std::string& folder, int ranks) {
    auto count = std::make_shared<int>(0);
    return [folder, ranks, count](const Scene& scene, const PartitionCurve* partition,
                                  const SpreadOptions& options) {
        return run_lammps_spread(scene, partition, options,
                                 {fmt::format("{}/spread-{}", folder, ++*count), ranks, {}, false});
    };
}

Evaluation LammpsEvaluator::evaluate(const Design& design, std::uint64_t seed) {
    find_lammps(std::max(1, run_.threads));  // before a folder is made for nothing
    std::string folder = folder_;
    if (folder.empty()) {
        std::string pattern = (fs::temp_directory_path() / "gradwright-lammps-XXXXXX").string();
        if (!mkdtemp(pattern.data()))
            throw fs::filesystem_error("cannot make a temporary folder", pattern,
                                       std::error_code(errno, std::generic_category()));
        folder = pattern;
    }
    RunOptions run = run_;
    run.spread = lammps_spread_function(folder, std::max(1, run.threads));
    SpreadRunner runner(run);
    Evaluation evaluation = DemEvaluator(study_, runner, nullptr).evaluate(design, seed);
    evaluation.fidelity = Fidelity::lammps;
    if (folder_.empty()) {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
    if (journal_ && evaluation.health.status != "interrupted") journal_->append(evaluation);
    return evaluation;
}

}  // namespace gradwright
