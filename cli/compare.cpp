// gradwright compare: strategies side by side on one study, or finished designs side by side.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/strategy_comparison.h"
#include "reports/comparison_report.h"
#include "reports/designs_report.h"
#include "reports/output_folder.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;

struct CompareCommand {
    std::vector<std::string> what;
    std::vector<std::string> strategies = {"map", "bobyqa", "cobyla", "crs", "ceres", "mf"};
    std::string fidelity = "full";
    int budget = 0, evaluations = 60, confirmations = 2;
    bool for_strategies = false;  ///< one of the options above was given
};

void refuse_contradictions(const CompareCommand& command) {
    if (command.what.size() > 1)
        throw Failure(ExitCode::usage,
                      fmt::format("compare takes one study file; {} names were given", command.what.size()),
                      "compare STUDY runs strategies on one study, compare OUT OUT... puts finished designs "
                      "side by side");
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

/// Finished designs side by side: nothing is spread.
ExitCode compare_designs(const CompareCommand& command, const CommonOptions& common) {
    if (command.what.size() < 2)
        throw Failure(
            ExitCode::usage,
            fmt::format("'{}' is one design: what is it to be compared with?", command.what.front()),
            "compare OUT OUT... takes the folders of at least two finished designs");
    if (command.for_strategies || !common.set.empty() || common.seed || common.threads > 0 ||
        !common.cache.empty())
        throw Failure(
            ExitCode::usage,
            "finished designs stay as they are: only --out, --force, --json and --quiet go with them",
            "leave the other options out");
    std::vector<FinishedDesign> designs;
    std::vector<std::string> missing;
    std::vector<InputProblem> damaged;
    for (const std::string& folder : command.what) {
        const std::string file = folder + "/report_data.json";
        if (!fs::exists(file)) {
            missing.push_back(fmt::format("'{}' has no report_data.json", folder));
            continue;
        }
        nlohmann::json data = nlohmann::json::parse(std::ifstream(file), nullptr, false);
        if (!data.is_object() || data.value("format", "") != "gradwright-report-1")
            damaged.push_back(
                {file, 0, "format", "", "holds no design of this program", "run that design again"});
        designs.push_back({folder, std::move(data)});
    }
    if (!missing.empty())
        throw Failure(ExitCode::io, fmt::format("{}", fmt::join(missing, "; ")),
                      "compare OUT OUT... takes folders that 'gradwright design' has finished");
    if (!damaged.empty()) throw InputError{damaged};
    const nlohmann::json object = designs_json(designs);
    if (!common.out.empty()) {
        const std::string folder = make_out_folder(common, "designs");
        writing(folder, [&] {
            write_file(folder + "/comparison.json", json_text(object) + "\n");
            write_file(folder + "/comparison.html", designs_html(object));
        });
        if (!common.quiet)
            fmt::print(stderr, "gradwright: comparison.json and comparison.html are in {}\n", folder);
    }
    if (common.json)
        fmt::print("{}\n", json_text(object));
    else
        fmt::print("{}", designs_text(object));
    return ExitCode::met;
}

ExitCode run_compare(const CompareCommand& command, CommonOptions common) {
    const auto folders = std::count_if(command.what.begin(), command.what.end(),
                                       [](const std::string& one) { return fs::is_directory(one); });
    if (folders == static_cast<long>(command.what.size())) return compare_designs(command, common);
    if (folders > 0)
        throw Failure(ExitCode::usage, "study files and folders of finished designs are named together",
                      "compare STUDY runs strategies on one study, compare OUT OUT... puts finished designs "
                      "side by side");
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
        std::vector<std::string> words;
        if (name != "map") words = {"--strategy", name};
        if (searches_one_fidelity(name)) words.insert(words.end(), {"--fidelity", command.fidelity});
        for (const std::string& one : common.set) words.insert(words.end(), {"--set", one});
        writing(folder, [&] { write_outputs(study, result, folder + "/" + name, Film::none, words); });
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
    CLI::App* verb = app.add_subcommand("compare",
                                        "Strategies side by side on one study, judged on the same unseen "
                                        "beds; or finished designs side by side");
    verb->add_option("STUDY|OUT...", command->what,
                     "Study file (TOML), or two or more folders that 'design' wrote: their numbers, "
                     "profiles, partitions "
                     "and the inputs that differ; with --out also as comparison.json and comparison.html")
        ->required();
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
    verb->callback([command, verb, &call] {
        for (const char* name :
             {"--strategies", "--budget", "--fidelity", "--evaluations", "--confirmations"})
            command->for_strategies = command->for_strategies || verb->count(name) > 0;
        call.run = [command, &call] { return run_compare(*command, call.options); };
    });
}

}  // namespace gradwright::cli
