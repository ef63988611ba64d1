// gradwright reach: which targets this machine and these powders can lay, and what stops the others.
#include "optimise/reach.h"

#include <fmt/format.h>

#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "reports/reach_report.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

struct ReachCommand {
    std::string study, resolution;
    int grid = 7;
};

/// [m]; 0 = the default. Throws Failure usage.
double resolution_of(const std::string& text, const Study& study) {
    if (text.empty()) return 0;
    double length = 0;
    try {
        length = parse_quantity(text, "length");
    } catch (const std::exception& error) {
        throw Failure(ExitCode::usage, fmt::format("--resolution '{}': {}", text, error.what()),
                      "a length with its unit, such as --resolution '50 um'");
    }
    if (!(length >= 1e-6 && length <= study.dispenser_width))
        throw Failure(ExitCode::usage,
                      fmt::format("--resolution '{}': must lie between 1 um and the width {}", text,
                                  format_quantity(study.dispenser_width, "length")),
                      "a quarter of a bin is the default; finer is hardly seen by the bins");
    return length;
}

ExitCode run_reach_command(const ReachCommand& command, const CommonOptions& common) {
    Study study = load_study(command.study, common);
    refuse_scale_up(study, "reach");
    ReachOptions options;
    options.grid = command.grid;
    options.resolution = resolution_of(command.resolution, study);
    if (!study.design_space.partition_free)
        throw InputError{{{study.file, 0, "design_space.partition", "",
                           "is fixed: only its own profile can be reached", "free it, or ask 'evaluate'"}}};
    const StudyEstimate cost = estimate(study, thread_count(common));
    refuse_impossible(study, cost);
    study.warnings = all_warnings(study, cost);
    if (!common.quiet)
        for (const std::string& warning : study.warnings)
            fmt::print(stderr, "gradwright: warning: {}\n", warning);
    const std::string folder = common.out.empty() ? std::string() : make_out_folder(common, study.name);
    ProgressLine progress(common.quiet);
    options.run = run_options(common, progress);
    options.run.snapshots = 0;
    if (!folder.empty()) options.run.journal_folder = folder + "/journal";
    const Reach reach = run_reach(study, options);
    progress.finish();

    const nlohmann::json object = reach_json(study, reach);
    if (common.json)
        fmt::print("{}\n", json_text(object));
    else
        fmt::print("{}", reach_text(study, reach));
    if (!folder.empty()) {
        writing(folder, [&] { write_file(folder + "/reach.json", json_text(object) + "\n"); });
        if (!common.quiet) fmt::print(stderr, "gradwright: reach.json is in {}\n", folder);
    }
    if (reach.status == "interrupted") {
        fmt::print(stderr,
                   "gradwright: interrupted; the same command takes up the beds that are in the cache\n");
        return ExitCode::interrupted;
    }
    if (reach.status != "ok") {
        fmt::print(stderr, "gradwright: no map to ask: {}: {}\n", reach.status, reach.reason);
        return ExitCode::simulation_failed;
    }
    return reach.own.reachable ? ExitCode::met : ExitCode::not_met;
}

}  // namespace

void add_reach(CLI::App& app, Call& call) {
    auto command = std::make_shared<ReachCommand>();
    CLI::App* verb = app.add_subcommand(
        "reach",
        "Which ramps and sigmoids can be laid, and what stops the others; 4 when the study's own cannot");
    verb->add_option("STUDY", command->study, "Study file (TOML)")->required();
    verb->add_option("--grid", command->grid, "Values tried of each limit before bisection; default 7")
        ->type_name("N")
        ->check(CLI::Range(3, 100));
    verb->add_option("--resolution", command->resolution,
                     "How finely a limit is bisected, such as '50 um'; default a quarter of a bin")
        ->type_name("LENGTH");
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_reach_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
