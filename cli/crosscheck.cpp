// gradwright crosscheck lammps: the contact law force by force and the same beds spread in an outside engine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/lammps_crosscheck.h"
#include "optimise/lammps_speed.h"
#include "reports/json_support.h"
#include "reports/provenance.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

struct CrosscheckCommand {
    std::string engine, study;
    int ranks = 0;  ///< 0 = as many as threads
    int seeds = 3;
    bool study_law = false, full_width = false, rigid_blade = false, speed = false;
    long steps = 1000;
};

double mean_of(const CrosscheckEngine& engine, double (*value)(const CrosscheckRun&)) {
    double sum = 0;
    for (const CrosscheckRun& run : engine.runs) sum += value(run);
    return engine.runs.empty() ? std::nan("") : sum / static_cast<double>(engine.runs.size());
}

double packing(const CrosscheckRun& run) {
    return run.packing_fraction;
}
double capture(const CrosscheckRun& run) {
    return run.capture_fraction;
}
double covered(const CrosscheckRun& run) {
    return run.coverage;
}
double heap_length(const CrosscheckRun& run) {
    return run.heap.length;
}
double heap_centre(const CrosscheckRun& run) {
    return run.heap.centre;
}
double heap_section(const CrosscheckRun& run) {
    return run.heap.solid_section;
}

/// {"gradwright": mean, "lammps": mean, "gradwright_beds": [...], "lammps_beds": [...]}
nlohmann::json of_both(const Crosscheck& result, double (*value)(const CrosscheckRun&)) {
    nlohmann::json out;
    for (const CrosscheckEngine* engine : {&result.ours, &result.lammps}) {
        std::vector<double> beds;
        for (const CrosscheckRun& run : engine->runs) beds.push_back(value(run));
        out[engine->name] = number(mean_of(*engine, value));
        out[engine->name + "_beds"] = numbers(beds);
    }
    return out;
}

/// Mean over the beds, bin by bin; bins that some bed lacks count from those that have them.
std::vector<double> mean_profile_of(const CrosscheckEngine& engine, std::size_t bins) {
    std::vector<double> out(bins, std::nan(""));
    for (std::size_t b = 0; b < bins; ++b) {
        double sum = 0;
        int count = 0;
        for (const CrosscheckRun& run : engine.runs)
            if (b < run.gi.size() && std::isfinite(run.gi[b])) sum += run.gi[b], ++count;
        if (count > 0) out[b] = sum / count;
    }
    return out;
}

std::vector<double> mean_heap_of(const CrosscheckEngine& engine) {
    std::vector<double> out;
    for (const CrosscheckRun& run : engine.runs) {
        if (out.size() < run.heap.solid_depth.size()) out.resize(run.heap.solid_depth.size(), 0);
        for (std::size_t k = 0; k < run.heap.solid_depth.size(); ++k)
            out[k] += run.heap.solid_depth[k] / static_cast<double>(engine.runs.size());
    }
    return out;
}

nlohmann::json run_json(const CrosscheckRun& run) {
    return {{"status", run.health.status},
            {"warnings", run.health.warnings},
            {"gi", numbers(run.gi)},
            {"packing_fraction", number(run.packing_fraction)},
            {"capture_fraction", number(run.capture_fraction)},
            {"coverage", number(run.coverage)},
            {"grains", run.grains},
            {"laid", run.laid},
            {"steps", run.steps},
            {"grain_steps", number(run.grain_steps)},
            {"seconds", number(run.seconds)},
            {"heap",
             {{"blade_x_m", number(run.heap.blade_x)},
              {"solid_depth_m", numbers(run.heap.solid_depth)},
              {"solid_section_m2", number(run.heap.solid_section)},
              {"centre_m", number(run.heap.centre)},
              {"length_m", number(run.heap.length)}}}};
}

nlohmann::json two_body_json(const TwoBodyResult& result) {
    auto cases = nlohmann::json::array();
    for (const TwoBodyCase& one : result.cases)
        cases.push_back({{"name", one.name},
                         {"contacts", one.contacts},
                         {"max_relative_error", number(one.error)},
                         {"relative_to", one.scale},
                         {"decisive", one.decisive}});
    return {{"tolerance", kTwoBodyTolerance},
            {"cases", cases},
            {"bonds_stretched", result.bonds_stretched},
            {"bonds_kept_after_a_rebuild_in_lammps", result.bonds_kept},
            {"bonds_beyond_lammps_tear_off", result.bonds_beyond},
            {"bonds_held_beyond_in_lammps", result.bonds_held_beyond},
            {"lammps_tear_off_share", kLammpsTearOff}};
}

nlohmann::json crosscheck_json(const Crosscheck& result, const CrosscheckOptions& options,
                               const std::vector<std::string>& files) {
    nlohmann::json engines, beds = nlohmann::json::array(), profile, heap;
    for (const CrosscheckEngine* engine : {&result.ours, &result.lammps}) {
        engines[engine->name] = {{"version", engine->version},
                                 {"seconds", number(engine->seconds)},
                                 {"grain_steps_per_second", number(engine->grain_steps_per_second)},
                                 {"ranks_or_threads", engine->ranks_or_threads}};
        profile[engine->name] = numbers(mean_profile_of(*engine, result.y_m.size()));
        heap[engine->name] = numbers(mean_heap_of(*engine));
    }
    profile["y_m"] = numbers(result.y_m);
    profile["weight"] = numbers(result.weight);
    for (std::size_t k = 0; k < result.lammps.runs.size(); ++k)
        beds.push_back({{"seed", result.ours.runs[k].seed},
                        {"gradwright", run_json(result.ours.runs[k])},
                        {"lammps", run_json(result.lammps.runs[k])}});
    return {{"engines", engines},
            {"speed_ratio", number(result.speed_ratio)},
            {"gi_rmse", number(result.gi_rmse)},
            {"gi_rmse_of_means", number(result.gi_rmse_of_means)},
            {"gi_bias", number(result.gi_bias)},
            {"gi_bias_standard_error", number(result.gi_bias_error)},
            {"gi_p_value", number(result.gi_p_value)},
            {"beds_to_judge", kBedsToJudge},
            {"differs_below", kDiffersBelow},
            {"noise_rms", number(result.noise_rms)},
            {"noise_allowed", kNoiseAllowed},
            {"two_body_max_relative_error", number(result.two_body.max_relative_error)},
            {"two_body", two_body_json(result.two_body)},
            {"packing", of_both(result, packing)},
            {"capture_fraction", of_both(result, capture)},
            {"coverage", of_both(result, covered)},
            {"heap",
             {{"bin_m", kHeapBin},
              {"solid_depth_m", heap},
              {"rmse_of_peak", number(result.heap_rmse)},
              {"length_m", of_both(result, heap_length)},
              {"centre_m", of_both(result, heap_centre)},
              {"solid_section_m2", of_both(result, heap_section)}}},
            {"profile", profile},
            {"beds", beds},
            {"law", options.study_law ? "study" : "common"},
            {"scene", options.full_width ? "full width, both powders" : "narrow strip, relabelled"},
            {"lammps_blade", options.rigid_blade ? "rigid" : "soft"},
            {"differences", result.differences},
            {"forces_agree", result.forces_agree},
            {"gradation_agrees", result.gradation_agrees},
            {"status", result.health.status},
            {"reason", result.health.reason},
            {"files", files}};
}

void print_crosscheck(const Study& study, const Crosscheck& result) {
    fmt::print("{}: contact by contact, gradwright against LAMMPS {}\n", study.name, result.two_body.version);
    for (const TwoBodyCase& one : result.two_body.cases)
        fmt::print("  {:<56} {:>3} contacts  {:8.1e} of the {}{}\n", one.name, one.contacts, one.error,
                   one.scale, one.error <= kTwoBodyTolerance ? "" : "  <-- beyond 1e-9");
    if (result.two_body.bonds_stretched > 0)
        fmt::print(
            "  stretched bonds that LAMMPS still has after a neighbour rebuild: {} of {}; beyond {:.2f} of "
            "the "
            "tear-off overlap: {} of {} (ours all)\n",
            result.two_body.bonds_kept, result.two_body.bonds_stretched, kLammpsTearOff,
            result.two_body.bonds_held_beyond, result.two_body.bonds_beyond);
    if (!result.health.ok()) return;
    const auto both = [&](double (*value)(const CrosscheckRun&), double scale = 1) {
        return fmt::format("{:>10.4g} {:>10.4g}", scale * mean_of(result.ours, value),
                           scale * mean_of(result.lammps, value));
    };
    fmt::print("\nthe same beds, {} of them{:>26} {:>10}\n", result.ours.runs.size(), "gradwright", "lammps");
    fmt::print("  packing of the layer                  {}\n", both(packing));
    fmt::print("  captured share of the dose            {}\n", both(capture));
    fmt::print("  coverage                              {}\n", both(covered));
    fmt::print("  heap: length (95 % of the solid), mm  {}\n", both(heap_length, 1e3));
    fmt::print("  heap: centre ahead of the blade, mm   {}\n", both(heap_centre, 1e3));
    fmt::print("  heap: section of solid, mm2           {}\n", both(heap_section, 1e6));
    fmt::print("  wall seconds, spreads alone           {:>10.4g} {:>10.4g}\n", result.ours.seconds,
               result.lammps.seconds);
    fmt::print("  threads, ranks                        {:>10} {:>10}\n", result.ours.ranks_or_threads,
               result.lammps.ranks_or_threads);
    fmt::print("  million grain-steps/s                 {:>10.4g} {:>10.4g}\n",
               result.ours.grain_steps_per_second / 1e6, result.lammps.grain_steps_per_second / 1e6);
    const auto ours = mean_profile_of(result.ours, result.y_m.size()),
               theirs = mean_profile_of(result.lammps, result.y_m.size());
    for (std::size_t b = 0; b < result.y_m.size(); ++b)
        if (result.weight[b] > 0)
            fmt::print("  GI at y = {:.2f} mm                     {:>10.3f} {:>10.3f}\n", 1e3 * result.y_m[b],
                       ours[b], theirs[b]);
    fmt::print(
        "\nGI(y), LAMMPS - gradwright on the same bed: rms {:.4f} (of the means {:.4f}, bias {:+.4f})\n",
        result.gi_rmse, result.gi_rmse_of_means, result.gi_bias);
    const std::size_t beds = result.lammps.runs.size();
    fmt::print(
        "standard error of the bias {:.4f}; one engine between beds: rms {:.4f}, ratio {:.2f}; by chance in "
        "a "
        "share {:.2g} of cases\n",
        result.gi_bias_error, result.noise_rms, result.gi_rmse / result.noise_rms, result.gi_p_value);
    if (beds >= std::size_t(kBedsToJudge))
        fmt::print("the gradation {}: {} beds, chance below {} would tell the engines apart\n",
                   result.gradation_agrees ? "agrees" : "DIFFERS", beds, kDiffersBelow);
    else
        fmt::print("the gradation {}: ratio {} allowed; {} beds are too few to be sure, {} tell\n",
                   result.gradation_agrees ? "seems to agree" : "seems to DIFFER", kNoiseAllowed, beds,
                   kBedsToJudge);
    fmt::print("\nwhat is not the same:\n");
    for (const std::string& difference : result.differences) fmt::print("  - {}\n", difference);
    for (const CrosscheckEngine* engine : {&result.ours, &result.lammps})
        for (std::size_t k = 0; k < engine->runs.size(); ++k)
            for (const std::string& warning : engine->runs[k].health.warnings)
                fmt::print("  warning, bed {}, {}: {}\n", k + 1, engine->name, warning);
}

/// Both engines step by step, without a spread: what a core does in a second.
ExitCode run_speed(const Study& study, const CrosscheckCommand& command, const CommonOptions& common) {
    CrosscheckOptions scene_options;
    scene_options.full_width = command.full_width;
    scene_options.study_law = command.study_law;
    EngineSpeedOptions options;
    options.threads = common.threads > 0 ? common.threads : 1;
    options.ranks = command.ranks > 0 ? command.ranks : options.threads;
    options.steps = command.steps;
    find_lammps(options.ranks);
    options.folder = make_out_folder(common, study.name);
    ProgressLine progress(common.quiet);
    const RunOptions run = run_options(common, progress);
    options.cache_folder = run.cache_folder;
    options.stop = run.stop;
    options.progress = run.progress;
    const EngineSpeed result = run_engine_speed(crosscheck_scene(study, scene_options, study.seed), options);
    progress.finish();
    auto cases = nlohmann::json::array();
    for (const EngineSpeedCase& one : result.cases)
        cases.push_back({{"name", one.name},
                         {"grains", one.grains},
                         {"gradwright_grain_steps_per_second", number(one.ours)},
                         {"lammps_grain_steps_per_second", number(one.lammps)},
                         {"lammps_best_skin_m", number(one.best_skin)},
                         {"lammps_by_skin", numbers(one.lammps_by_skin)},
                         {"speed_ratio", number(one.ratio)}});
    const nlohmann::json object = {{"speed", cases},
                                   {"skins_m", numbers(options.skins)},
                                   {"steps", options.steps},
                                   {"threads", options.threads},
                                   {"ranks", options.ranks},
                                   {"lammps_version", result.version},
                                   {"law", command.study_law ? "study" : "common"},
                                   {"status", result.health.status},
                                   {"reason", result.health.reason},
                                   {"provenance", provenance_json()}};
    const std::string text = json_text(object) + "\n";
    writing(options.folder, [&] { write_file(options.folder + "/speed.json", text); });
    if (common.json) {
        fmt::print("{}", text);
    } else {
        fmt::print("{}: every grain awake, {} thread(s) against {} rank(s) of LAMMPS {}\n", study.name,
                   options.threads, options.ranks, result.version);
        for (const EngineSpeedCase& one : result.cases)
            fmt::print(
                "  {:<8} {} grains: {:.2f} against {:.2f} million grain-steps/s (skin {:.0f} um): {:.2f} "
                "times\n",
                one.name, one.grains, one.ours / 1e6, one.lammps / 1e6, one.best_skin * 1e6, one.ratio);
    }
    if (!result.health.ok())
        fmt::print(stderr, "gradwright: ended with '{}': {}\n", result.health.status, result.health.reason);
    return exit_code_of(result.health);
}

ExitCode run_crosscheck_command(const CrosscheckCommand& command, const CommonOptions& common) {
    const std::vector<std::string> engines = {"lammps"};
    if (command.engine != "lammps")
        throw Failure(ExitCode::usage,
                      fmt::format("crosscheck: there is no engine '{}'{}", command.engine,
                                  hint(command.engine, engines)),
                      "gradwright crosscheck lammps STUDY");
    const Study study = load_study(command.study, common);
    refuse_scale_up(study, "crosscheck");
    refuse_impossible(study, estimate(study, thread_count(common)));
    if (command.speed) return run_speed(study, command, common);
    CrosscheckOptions options;
    options.seeds = command.seeds;
    options.threads = thread_count(common);
    options.ranks = command.ranks > 0 ? command.ranks : options.threads;
    options.study_law = command.study_law;
    options.full_width = command.full_width;
    options.rigid_blade = command.rigid_blade;
    find_lammps(options.ranks);  // before a folder is made for nothing
    options.folder = make_out_folder(common, study.name);
    ProgressLine progress(common.quiet);
    const RunOptions run = run_options(common, progress);
    options.cache_folder = run.cache_folder;
    options.stop = run.stop;
    options.progress = run.progress;
    Crosscheck result = run_crosscheck(study, options);
    progress.finish();
    result.ours.version = provenance_json().value("version", std::string("unknown"));

    std::vector<std::string> files = {"crosscheck.json", "two-body/in.pairs", "two-body/pairs.data"};
    for (std::size_t k = 0; k < result.lammps.runs.size(); ++k)
        for (const char* name : {"in.spread", "bed.data", "log.lammps", "final.dump"})
            files.push_back(fmt::format("bed-{}/{}", k + 1, name));
    const std::string text = json_text(crosscheck_json(result, options, files)) + "\n";
    writing(options.folder, [&] { write_file(options.folder + "/crosscheck.json", text); });
    if (common.json)
        fmt::print("{}", text);
    else
        print_crosscheck(study, result);
    if (!common.quiet) fmt::print(stderr, "gradwright: decks, logs and results are in {}\n", options.folder);
    if (!result.health.ok()) {
        fmt::print(stderr, "gradwright: ended with '{}': {}\n", result.health.status, result.health.reason);
        return result.health.status == "failed" ? ExitCode::external : exit_code_of(result.health);
    }
    return result.forces_agree && result.gradation_agrees ? ExitCode::met : ExitCode::not_met;
}

}  // namespace

void add_crosscheck(CLI::App& app, Call& call) {
    auto command = std::make_shared<CrosscheckCommand>();
    CLI::App* verb =
        app.add_subcommand("crosscheck", "The contact law and the same beds in an outside engine (LAMMPS)");
    verb->add_option("ENGINE", command->engine, "lammps")->required();
    verb->add_option("STUDY", command->study, "Study file (TOML)")->required();
    verb->add_option("--ranks", command->ranks, "MPI processes of LAMMPS; default as many as threads")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    verb->add_option("--seeds", command->seeds,
                     "Beds, spread by both engines; default 3, six tell engines apart")
        ->type_name("N")
        ->check(CLI::Range(2, kMostBeds));
    verb->add_flag(
        "--study-law", command->study_law,
        "Ours with the study's own rolling and adhesive walls; default: the law nearest to LAMMPS's");
    verb->add_flag("--full-width", command->full_width,
                   "Both powders over the whole width; default: the study's narrow strip, relabelled");
    verb->add_flag(
        "--rigid-blade", command->rigid_blade,
        "LAMMPS's blade as hard as the other walls: it shoots the grains that it pinches; default: so "
        "soft that it does the work of our yielding one");
    verb->add_flag("--speed", command->speed,
                   "No spread: both engines step by step on the same bed, settled and flowing, every grain "
                   "awake; one thread and one rank unless --threads and --ranks say more");
    verb->add_option("--steps", command->steps, "With --speed: steps that are timed; default 1000")
        ->type_name("N")
        ->check(CLI::Range(10L, 1000000L));
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_crosscheck_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
