// gradwright design: the main job. Study in, proved partition out.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <regex>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/design_run.h"
#include "reports/output_folder.h"
#include "reports/result_json.h"
#include "reports/summary.h"

namespace gradwright::cli {
namespace {

struct DesignOptions {
    std::string study;
    std::string strategy = "map";
    std::string fidelity;  ///< empty = map; only the plain strategies have a choice
    int budget = 0;        ///< 0 = the study's, or kPlainBudget
};

/// Evaluations of a plain strategy when --budget is not given: about five times the variables of a five-knot
/// polyline.
constexpr int kPlainBudget = 60;

void refuse_contradictions(const DesignOptions& options) {
    const std::vector<std::string> strategies = {"map", "bobyqa"};
    if (std::find(strategies.begin(), strategies.end(), options.strategy) == strategies.end())
        throw Failure(ExitCode::usage,
                      fmt::format("--strategy: there is no strategy '{}'{}", options.strategy,
                                  hint(options.strategy, strategies)),
                      fmt::format("one of {}", fmt::join(strategies, ", ")));
    if (options.fidelity == "lammps")
        throw Failure(ExitCode::usage,
                      "--fidelity lammps is a witness, not a search: one spread takes minutes to hours",
                      "take it with 'evaluate' or 'crosscheck lammps'");
    if (options.strategy == "map" && !options.fidelity.empty())
        throw Failure(
            ExitCode::usage,
            "--fidelity has no meaning for --strategy map, which searches on the map and confirms in full",
            "leave it out, or take --strategy bobyqa");
}

ExitCode exit_code_of(const StudyResult& result) {
    if (result.termination == "interrupted") return ExitCode::interrupted;
    if (result.termination == "failed" || result.termination == "not_run") return ExitCode::simulation_failed;
    return result.verdict == Verdict::met ? ExitCode::met : ExitCode::not_met;
}

/// With --force: takes away what an earlier design left, so that two runs are never mixed in one folder. Only
/// files whose names this program gives: evaluations (000012_full.json) and instants of the grains
/// (particles_0001.vtkhdf).
void remove_earlier(const std::string& folder) {
    namespace fs = std::filesystem;
    const std::regex evaluation("[0-9]{6}_[a-z]+[.]json"), instant("particles_[0-9]{4}[.]vtkhdf");
    std::error_code failed;
    for (const auto& [place, pattern] :
         {std::pair{fs::path(folder) / "journal", &evaluation}, {fs::path(folder), &instant}})
        for (const auto& entry : fs::directory_iterator(place, failed))
            if (std::regex_match(entry.path().filename().string(), *pattern))
                fs::remove(entry.path(), failed);
}

ExitCode run_design(const DesignOptions& options, CommonOptions common) {
    refuse_contradictions(options);
    // The map strategy's budget is an input of the study, so that it is listed with the others.
    if (options.strategy == "map" && options.budget > 0)
        common.set.push_back(fmt::format("run.max_spreads={}", options.budget));
    Study study = load_study(options.study, common);
    const StudyEstimate cost = estimate(study, thread_count(common));
    refuse_impossible(study, cost);
    study.warnings = all_warnings(study, cost);  // they go into every result
    if (!common.quiet)
        for (const std::string& warning : study.warnings)
            fmt::print(stderr, "gradwright: warning: {}\n", warning);

    const std::string folder = make_out_folder(common, study.name);
    if (common.force) remove_earlier(folder);
    ProgressLine progress(common.quiet);
    RunOptions run = run_options(common, progress);
    run.journal_folder = folder + "/journal";
    if (!common.quiet) fmt::print(stderr, "gradwright: designing {}; results go to {}\n", study.name, folder);
    const StudyResult result =
        options.strategy == "map"
            ? run_map_strategy(study, run)
            : run_bobyqa_strategy(study, fidelity_of(options.fidelity.empty() ? "map" : options.fidelity),
                                  options.budget > 0 ? options.budget : kPlainBudget, run);
    progress.finish();

    // What took minutes is shown even when it cannot be kept.
    std::vector<std::string> files;
    std::optional<Failure> unwritten;
    if (!result.unwritten.empty())
        unwritten = Failure(ExitCode::io, result.unwritten,
                            "is there space and a right to write in '" + folder + "'?");
    try {
        files = writing(folder, [&] { return write_outputs(study, result, folder); });
    } catch (const Failure& failure) {
        unwritten = failure;
    }
    if (common.json) {
        nlohmann::json object = to_json(study, result, files);
        if (unwritten) object.update(error_json(unwritten->code, unwritten->message, unwritten->mend));
        fmt::print("{}\n", json_text(object));
    } else {
        fmt::print("{}\n",
                   summary(study, result, folder, files,
                           colour_allowed(STDOUT_FILENO) ? TerminalColour::ansi : TerminalColour::plain));
    }
    if (unwritten) {
        fmt::print(stderr, "gradwright: {}\n  {}\n", unwritten->message, unwritten->mend);
        return unwritten->code;
    }
    const ExitCode code = exit_code_of(result);
    if (code == ExitCode::interrupted)
        fmt::print(
            stderr,
            "gradwright: interrupted; what is finished lies in {}. The same command{} starts again{}\n",
            folder, common.out.empty() ? "" : " with --force",
            run.cache_folder.empty() ? "" : "; settled beds come from the cache");
    if (code == ExitCode::simulation_failed)
        fmt::print(stderr, "gradwright: the simulation failed: {}\n", result.message);
    return code;
}

}  // namespace

void add_design(CLI::App& app, Call& call) {
    auto options = std::make_shared<DesignOptions>();
    CLI::App* verb = app.add_subcommand(
        "design", "Find the partition that spreads the target, and prove it by labelled DEM spreads");
    verb->add_option("STUDY", options->study, "Study file (TOML)")->required();
    verb->add_option("--strategy", options->strategy, "map (default) | bobyqa")->type_name("NAME");
    verb->add_option("--fidelity", options->fidelity,
                     "What bobyqa evaluates: kinematic | map (default) | full")
        ->type_name("NAME");
    verb->add_option("--budget", options->budget,
                     "map: spreads in all, instead of the study's; bobyqa: evaluations")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_design(*options, call.options); }; });
}

}  // namespace gradwright::cli
