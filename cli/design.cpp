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
#include "cli/run_record.h"
#include "cli/spec.h"
#include "optimise/journal.h"
#include "optimise/strategies.h"
#include "reports/film.h"
#include "reports/output_folder.h"
#include "reports/result_json.h"
#include "reports/summary.h"

namespace gradwright::cli {
namespace {

struct DesignOptions {
    std::string study;
    bool resume = false;
    std::string resume_folder;  ///< word behind --resume, if any
    std::string strategy = "map";
    std::string fidelity;  ///< empty = map; only the plain strategies have a choice
    int budget = 0;        ///< 0 = the study's, or StrategyChoice's
    bool no_spec = false;  ///< leave out the hand-over
    bool film = false;     ///< keep many instants of the spreads and draw them
};

void refuse_contradictions(const DesignOptions& options) {
    const std::vector<std::string>& strategies = strategy_names();
    if (std::find(strategies.begin(), strategies.end(), options.strategy) == strategies.end())
        throw Failure(ExitCode::usage,
                      fmt::format("--strategy: there is no strategy '{}'{}", options.strategy,
                                  hint(options.strategy, strategies)),
                      fmt::format("one of {}", fmt::join(strategies, ", ")));
    if (options.fidelity == "lammps")
        throw Failure(ExitCode::usage,
                      "--fidelity lammps is a witness, not a search: one spread takes minutes to hours",
                      "take it with 'evaluate' or 'crosscheck lammps'");
    if (!searches_one_fidelity(options.strategy) && !options.fidelity.empty())
        throw Failure(
            ExitCode::usage,
            fmt::format("--fidelity has no meaning for --strategy {}, which searches on the map and "
                        "spreads in full",
                        options.strategy),
            "leave it out, or take another strategy, such as --strategy bobyqa");
}

ExitCode exit_code_of(const StudyResult& result) {
    if (result.termination == "interrupted") return ExitCode::interrupted;
    if (result.termination == "failed" || result.termination == "not_run") return ExitCode::simulation_failed;
    return result.verdict == Verdict::met ? ExitCode::met : ExitCode::not_met;
}

/// With --force: takes away what an earlier design left, so that two runs are never mixed in one folder. Only
/// files whose names this program gives: evaluations (000012_full.json), spreads (spread-0123.bin), instants
/// of the grains (particles_0001.vtkhdf), the film, the hand-over and what says that a run is finished.
void remove_earlier(const std::string& folder) {
    namespace fs = std::filesystem;
    const std::regex evaluation("[0-9]{6}_[a-z]+[.]json"),
        instant("particles_[0-9]{4}[.]vtkhdf|(run|status|result)[.]json|film[.]webp"),
        spread("spread-[0-9a-f]+[.]bin");
    std::error_code failed;
    for (const auto& [place, pattern] : {std::pair{fs::path(folder) / "journal", &evaluation},
                                         {fs::path(folder) / "spreads", &spread},
                                         {fs::path(folder), &instant}})
        for (const auto& entry : fs::directory_iterator(place, failed))
            if (std::regex_match(entry.path().filename().string(), *pattern))
                fs::remove(entry.path(), failed);
    for (const char* name : kSpecNames) fs::remove(fs::path(folder) / "spec" / name, failed);
}

/// Which folder --resume means, and whether it holds a run. `design --resume OUT` alone takes everything from
/// there; a study named too must be the same.
bool find_resumed(DesignOptions& options, CommonOptions& common) {
    namespace fs = std::filesystem;
    if (!options.resume) return false;
    if (!options.resume_folder.empty()) {
        // 'design --resume study.toml --out OUT' is one reading of the same words
        if (options.study.empty() && !common.out.empty())
            options.study = options.resume_folder;
        else if (common.out.empty())
            common.out = options.resume_folder;
        else
            throw Failure(ExitCode::usage, "--resume names one folder and --out another", "leave one out");
    }
    if (common.out.empty())
        throw Failure(ExitCode::usage, "--resume: which folder?", "design STUDY --out OUT --resume");
    if (common.force)
        throw Failure(ExitCode::usage, "--resume goes on with what --force throws away", "leave one out");
    std::error_code failed;
    const bool empty = !fs::exists(common.out, failed) || fs::is_empty(common.out, failed);
    if (empty && !options.study.empty()) return false;  // nothing to go on with: begins
    const RunRecord there = read_record(common.out);
    if (!options.study.empty()) return true;
    if (!common.set.empty() || common.seed)
        throw Failure(ExitCode::usage, "--set and --seed change a study that is to be resumed as it is",
                      "leave them out");
    options.strategy = there.strategy;
    options.fidelity = there.fidelity;
    options.budget = there.budget;
    options.film = there.film;
    return true;
}

/// The study of this call, or of the run that is gone on with.
Study study_of(const DesignOptions& options, const CommonOptions& common, bool resumed) {
    if (!resumed || !options.study.empty()) return load_study(options.study, common);
    const RunRecord there = read_record(common.out);
    return parse_study(there.study_text, there.study_file, there.set);
}

void refuse_other_run(const RunRecord& there, const RunRecord& now, const std::string& folder) {
    const std::vector<std::string> other = differences(there, now);
    if (!other.empty())
        throw Failure(
            ExitCode::bad_input,
            fmt::format("'{}' holds another run; what differs:\n  {}", folder, fmt::join(other, "\n  ")),
            "resume with the study as it was ('gradwright design --resume " + folder +
                "'), or begin anew in another folder");
}

/// The hand-over beside the result. What keeps it from being written is said, and no reason to fail a design.
void hand_over_to(const std::string& folder, const CommonOptions& common) {
    try {
        const SpecOutcome outcome = make_spec(folder, {}, StepSchema::ap214);
        if (common.quiet) return;
        fmt::print(stderr, "gradwright: hand-over {} in {}: {}\n", outcome.over.id, outcome.folder,
                   outcome.over.first_line);
        if (!outcome.files.step)
            fmt::print(stderr, "gradwright: without partition.step: {}\n",
                       outcome.files.step_problem.empty()
                           ? fmt::format("built without OpenCASCADE ({})", kStepPackage)
                           : outcome.files.step_problem);
    } catch (const Failure& failure) {
        fmt::print(stderr, "gradwright: no hand-over: {}\n  {}\n", failure.message, failure.mend);
    } catch (const InputError& error) {
        fmt::print(stderr, "gradwright: no hand-over: {}", report_of(error));
    }
}

/// What decides the numbers beside the study file. `set`: as in RunRecord.
std::vector<std::string> called_with(const DesignOptions& options, const std::vector<std::string>& set) {
    std::vector<std::string> words;
    if (options.strategy != "map") words.insert(words.end(), {"--strategy", options.strategy});
    if (!options.fidelity.empty()) words.insert(words.end(), {"--fidelity", options.fidelity});
    if (searches_one_fidelity(options.strategy) && options.budget > 0)
        words.insert(words.end(), {"--budget", std::to_string(options.budget)});
    for (const std::string& one : set) words.insert(words.end(), {"--set", one});
    return words;
}

ExitCode run_design(DesignOptions options, CommonOptions common) {
    const bool resumed = find_resumed(options, common);
    if (options.study.empty() && !resumed)
        throw Failure(ExitCode::usage, "STUDY is required", "gradwright design STUDY.toml --out OUT");
    refuse_contradictions(options);
    StrategyChoice choice{options.strategy, fidelity_of(options.fidelity.empty() ? "map" : options.fidelity)};
    if (options.budget > 0) choice.budget = options.budget;
    // A budget of spreads is an input of the study, so that it is listed with the others.
    if (!searches_one_fidelity(options.strategy) && options.budget > 0 && !(resumed && options.study.empty()))
        common.set.push_back(fmt::format("run.max_spreads={}", options.budget));
    Study study = study_of(options, common, resumed);
    if (options.strategy != "map") refuse_scale_up(study, "--strategy " + options.strategy);
    if (options.film) refuse_scale_up(study, "--film");
    const StudyEstimate cost = estimate(study, thread_count(common));
    refuse_impossible(study, cost);
    study.warnings = all_warnings(study, cost);  // they go into every result
    if (!common.quiet)
        for (const std::string& warning : study.warnings)
            fmt::print(stderr, "gradwright: warning: {}\n", warning);

    const std::string folder = resumed ? common.out : make_out_folder(common, study.name);
    const FolderLock lock(folder);
    if (common.force) remove_earlier(folder);
    std::vector<std::string> set = common.set;
    if (common.seed) set.push_back(fmt::format("run.seed={}", *common.seed));
    RunRecord record = record_of(study, set, options.strategy, options.fidelity, options.budget);
    record.film = options.film;
    if (resumed) {
        const RunRecord there = read_record(folder);
        refuse_other_run(there, record, folder);
        record.set = there.set;
    } else
        writing(folder, [&] { write_record(folder, record); });
    ProgressLine progress(common.quiet);
    StatusFile status(folder);
    RunOptions run = run_options(common, progress);
    run.progress = [&](const std::string& stage, double fraction) {
        progress.update(stage, fraction);
        status.update(stage, fraction);
    };
    run.journal_folder = folder + "/journal";
    run.spread_folder = folder + "/spreads";
    run.resume = resumed;
    if (options.film) run.snapshots = kFilmInstants;
    if (!common.quiet)
        fmt::print(stderr, "gradwright: {} {}; results go to {}\n", resumed ? "going on with" : "designing",
                   study.name, folder);
    const StudyResult result = [&] {
        try {
            return run_strategy(study, choice, run);
        } catch (const OtherWay& other) {
            throw Failure(ExitCode::bad_input,
                          fmt::format("'{}' cannot be resumed: {}", folder, other.what()),
                          "it was made by another build of the program: begin anew in another folder");
        }
    }();
    progress.finish();

    // What took minutes is shown even when it cannot be kept.
    std::vector<std::string> files;
    std::optional<Failure> unwritten;
    if (!result.unwritten.empty())
        unwritten = Failure(ExitCode::io, result.unwritten,
                            "is there space and a right to write in '" + folder + "'?");
    try {
        files = writing(folder, [&] {
            return write_outputs(study, result, folder, options.film ? Film::drawn : Film::none,
                                 called_with(options, record.set));
        });
    } catch (const Failure& failure) {
        unwritten = failure;
    }
    if (options.film && result.snapshots.empty() && !common.quiet)
        fmt::print(stderr, "gradwright: no film: no design was spread with both powders\n");
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
    if (!options.no_spec) hand_over_to(folder, common);
    const ExitCode code = exit_code_of(result);
    status.end(code == ExitCode::interrupted         ? "interrupted"
               : code == ExitCode::simulation_failed ? "failed"
                                                     : "finished");
    if (code == ExitCode::interrupted)
        fmt::print(stderr,
                   "gradwright: interrupted; what is finished lies in {}. Go on with: gradwright design "
                   "--resume {}\n",
                   folder, folder);
    if (code == ExitCode::simulation_failed)
        fmt::print(stderr, "gradwright: the simulation failed: {}\n", result.message);
    return code;
}

}  // namespace

void add_design(CLI::App& app, Call& call) {
    auto options = std::make_shared<DesignOptions>();
    CLI::App* verb = app.add_subcommand(
        "design", "Find the partition that spreads the target, and prove it by labelled DEM spreads");
    verb->add_option("STUDY", options->study, "Study file (TOML)");
    CLI::Option* resume = verb->add_option("--resume", options->resume_folder,
                                           "Go on with the run in --out, or in OUT: finished spreads are not "
                                           "computed again, and the result is the same bit for bit")
                              ->type_name("[OUT]")
                              ->expected(0, 1);
    verb->add_option("--strategy", options->strategy,
                     fmt::format("{}; map is the default", fmt::join(strategy_names(), " | ")))
        ->type_name("NAME");
    verb->add_option("--fidelity", options->fidelity,
                     "What all but map and mf evaluate: kinematic | map (default) | full")
        ->type_name("NAME");
    verb->add_option("--budget", options->budget,
                     "map, mf: spreads in all, instead of the study's; the others: evaluations, default 60")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    verb->add_flag(
        "--film", options->film,
        fmt::format(
            "Also OUT/film.webp, an animated picture of the first confirming spread, cut along x and "
            "from above: up to {} instants, a few MB; OUT/spreads takes some 2 kB a grain and spread more",
            kFilmInstants));
    verb->add_flag("--no-spec", options->no_spec, "Leave out the hand-over (OUT/spec)");
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([options, resume, &call] {
        options->resume = resume->count() > 0;
        call.run = [options, &call] { return run_design(*options, call.options); };
    });
}

}  // namespace gradwright::cli
