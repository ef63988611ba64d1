// gradwright compare: strategies side by side on one study.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/strategy_comparison.h"
#include "reports/comparison_report.h"
#include "reports/output_folder.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

struct CompareCommand {
    std::vector<std::string> what;
    std::vector<std::string> strategies = {"map", "bobyqa", "cobyla", "crs", "ceres", "mf"};
    std::string fidelity = "full";
    int budget = 0, evaluations = 60, confirmations = 2;
};

void refuse_contradictions(const CompareCommand& command) {
    for (const std::string& one : command.what)
        if (command.what.size() > 1 || std::filesystem::is_directory(one))
            throw Failure(ExitCode::usage,
                          fmt::format("compare takes one study file; {}",
                                      std::filesystem::is_directory(one)
                                          ? "'" + one +
                                                "' is a folder: finished designs cannot be laid side "
                                                "by side yet"
                                          : fmt::format("{} names were given", command.what.size())),
                          "compare STUDY --strategies map,bobyqa,... runs strategies on one study");
    const std::vector<std::string>& names = strategy_names();
    for (auto name = command.strategies.begin(); name != command.strategies.end(); ++name) {
        if (std::find(names.begin(), names.end(), *name) == names.end())
            throw Failure(ExitCode::usage,
                          fmt::format("--strategies: there is no strategy '{}'{}", *name, hint(*name, names)),
                          fmt::format("some of {}", fmt::join(names, ", ")));
        if (std::find(command.strategies.begin(), name, *name) != name)
            throw Failure(ExitCode::usage, fmt::format("--strategies: '{}' is named twice", *name));
    }
}

ExitCode run_compare(const CompareCommand& command, CommonOptions common) {
    refuse_contradictions(command);
    // An input of the study, so that the reports list it with the others.
    if (command.budget > 0) common.set.push_back(fmt::format("run.max_spreads={}", command.budget));
    Study study = load_study(command.what.front(), common);
    refuse_scale_up(study, "compare");
    const StudyEstimate cost = estimate(study, thread_count(common));
    refuse_impossible(study, cost);
    study.warnings = all_warnings(study, cost);
    if (study.max_spreads < 2 || study.max_spreads > kMostCompared)
        throw Failure(ExitCode::usage,
                      fmt::format("run.max_spreads = {} leaves nothing to compare: each strategy needs one "
                                  "spread to search with and one to confirm, and at most {}",
                                  study.max_spreads, kMostCompared),
                      "give --budget N");
    if (!common.quiet) {
        for (const std::string& warning : study.warnings)
            fmt::print(stderr, "gradwright: warning: {}\n", warning);
        fmt::print(stderr,
                   "gradwright: {} strategies, at most {} spreads each, and {} to judge each: {} in all\n",
                   command.strategies.size(), study.max_spreads, command.confirmations,
                   int(command.strategies.size()) * (study.max_spreads + command.confirmations));
    }
    const std::string folder = make_out_folder(common, study.name);
    ProgressLine progress(common.quiet);
    ComparisonOptions options;
    options.strategies = command.strategies;
    options.fidelity = fidelity_of(command.fidelity);
    options.evaluations = command.evaluations;
    options.confirmations = command.confirmations;
    options.folder = folder;
    options.run = run_options(common, progress);
    // Each strategy's design is a folder like any design's: `report OUT/bobyqa` reads it.
    options.after_strategy = [&](const std::string& name, const StudyResult& result) {
        writing(folder, [&] { write_outputs(study, result, folder + "/" + name); });
    };
    const StrategyComparison comparison = compare_strategies(study, options);
    progress.finish();
    const nlohmann::json object = comparison_json(study, comparison);
    writing(folder, [&] { write_file(folder + "/comparison.json", json_text(object) + "\n"); });
    if (common.json)
        fmt::print("{}\n", json_text(object));
    else
        fmt::print("{}", comparison_text(study, comparison));
    if (!common.quiet)
        fmt::print(stderr, "gradwright: comparison.json and a design for each strategy are in {}\n", folder);
    if (comparison.status == "interrupted") {
        fmt::print(stderr,
                   "gradwright: interrupted; the same command takes up the beds that are in the cache\n");
        return ExitCode::interrupted;
    }
    const bool any = std::any_of(comparison.strategies.begin(), comparison.strategies.end(),
                                 [](const ComparedStrategy& row) { return row.confirmations > 0; });
    if (!any)
        fmt::print(stderr, "gradwright: no design could be judged: {}\n",
                   comparison.strategies.front().reason);
    return any ? ExitCode::met : ExitCode::simulation_failed;
}

}  // namespace

void add_compare(CLI::App& app, Call& call) {
    auto command = std::make_shared<CompareCommand>();
    CLI::App* verb = app.add_subcommand(
        "compare", "Strategies side by side: one study, the same budget, judged on the same unseen beds");
    verb->add_option("STUDY", command->what, "Study file (TOML)")->required();
    verb->add_option("--strategies", command->strategies,
                     fmt::format("Separated by commas, of {}; default {}", fmt::join(strategy_names(), ", "),
                                 fmt::join(command->strategies, ",")))
        ->type_name("NAMES")
        ->delimiter(',')
        ->allow_extra_args(false);
    verb->add_option("--budget", command->budget,
                     "Spreads each may spend in all, its own confirmations included; default run.max_spreads")
        ->type_name("N")
        ->check(CLI::Range(2, kMostCompared));
    verb->add_option("--fidelity", command->fidelity,
                     "What all but map and mf evaluate: full (default) | map | kinematic")
        ->type_name("NAME")
        ->check(CLI::IsMember({"full", "map", "kinematic"}));
    verb->add_option("--evaluations", command->evaluations,
                     "Of each of those on map or kinematic, where they cost no spread; default 60")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    verb->add_option("--confirmations", command->confirmations,
                     "Spreads that judge each strategy's best design; default 2")
        ->type_name("N")
        ->check(CLI::Range(1, 100));
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [command, &call] { call.run = [command, &call] { return run_compare(*command, call.options); }; });
}

}  // namespace gradwright::cli
