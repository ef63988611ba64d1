// gradwright tradeoff: what each reduction gains in speed and costs in gradation.
#include "optimise/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "cli/run_record.h"
#include "reports/output_folder.h"
#include "reports/reduction_cost.h"
#include "reports/safe_write.h"
#include "reports/tradeoff_report.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;

struct TradeoffCommand {
    std::string study, fidelity = "map", around = "finest";
    std::vector<std::string> levels;
    int seeds = 3;
    bool plan = false;
};

std::string names_of(const Tradeoff& t) {
    std::string out;
    for (const TradeoffLevel& level : t.levels) out += (out.empty() ? "'" : ", '") + level.name + "'";
    return out;
}

/// Levels and what they will cost, before anything runs.
void print_plan(const Tradeoff& t, int threads, bool to_stdout) {
    double total = 0;
    for (const TradeoffLevel& level : t.levels) total += t.seeds * level.expected_grain_steps;
    std::FILE* const stream = to_stdout ? stdout : stderr;
    fmt::print(stream, "{:<22} {:>14}  {}\n", "level", "grain-steps", "");
    for (const TradeoffLevel& level : t.levels)
        fmt::print(stream, "{:<22} {:>14}  {}\n", level.name,
                   level.status == "not possible" ? "not possible" : count_text(level.expected_grain_steps),
                   level.status == "not possible" ? level.reason : level.meaning);
    fmt::print(
        stream,
        "{} beds each: {} grain-steps, at most {} at {:.0f} million a second and core; grains that sleep and "
        "beds in the cache cost nothing\n",
        t.seeds, count_text(total), duration_text(total / (kAssumedSpeed * std::max(1, threads))),
        kAssumedSpeed / 1e6);
}

/// The report of a finished design shows what its own reductions cost, instead of the shipped table.
void show_in_report(const std::string& folder, const nlohmann::json& tradeoff,
                    const TradeoffCommand& command) {
    const std::string file = folder + "/report_data.json";
    if (!fs::exists(file)) return;
    std::string again =
        fmt::format("gradwright tradeoff OUT --around {} --seeds {}", command.around, command.seeds);
    if (command.fidelity != "map") again += " --fidelity " + command.fidelity;
    for (const std::string& level : command.levels) again += fmt::format(" --level '{}'", level);
    nlohmann::json cost = reduction_cost(tradeoff, again);
    if (cost.is_null()) return;
    nlohmann::json report = nlohmann::json::parse(read_file(file));
    report["reduction_cost"] = std::move(cost);
    write_file(file, json_text(report) + "\n");
    rebuild_report(folder);
}

ExitCode run_tradeoff_command(const TradeoffCommand& command, const CommonOptions& common) {
    TradeoffOptions options;
    options.seeds = command.seeds;
    options.fidelity = fidelity_of(command.fidelity);
    options.around_study = command.around == "study";
    options.run.threads = thread_count(common);
    const bool finished = fs::is_directory(command.study);
    if (finished && !common.out.empty())
        throw Failure(ExitCode::usage, "tradeoff OUT writes into that folder: --out names another",
                      "leave --out away");
    if (finished && (!common.set.empty() || common.seed))
        throw Failure(ExitCode::usage, "--set and --seed change the study that the design in OUT answers",
                      "leave them out, or name the study file");
    const StudyReader read = [&](const std::vector<std::string>& more) {
        if (finished) {
            const RunRecord record = read_record(command.study);
            std::vector<std::string> set = record.set;
            set.insert(set.end(), more.begin(), more.end());
            return parse_study(record.study_text, record.study_file, set);
        }
        CommonOptions with = common;
        with.set.insert(with.set.end(), more.begin(), more.end());
        return load_study(command.study, with);
    };
    const Study study = read({});
    refuse_scale_up(study, "tradeoff");
    refuse_impossible(study, estimate(study, thread_count(common)));
    Tradeoff result = plan_tradeoff(read, options);
    for (const std::string& wanted : command.levels) {
        std::vector<std::string> names;
        for (const TradeoffLevel& level : result.levels) names.push_back(level.name);
        if (std::find(names.begin(), names.end(), wanted) == names.end())
            throw Failure(ExitCode::usage,
                          fmt::format("--level: there is no level '{}'{}", wanted, hint(wanted, names)),
                          "one of " + names_of(result));
    }
    if (!command.levels.empty()) {
        options.only = command.levels;
        result = plan_tradeoff(read, options);
    }
    if (command.plan) {
        if (common.json)
            fmt::print("{}\n", json_text(tradeoff_json(study, result)));
        else
            print_plan(result, thread_count(common), true);
        return ExitCode::met;
    }
    if (!common.quiet) print_plan(result, thread_count(common), false);

    const std::string folder = finished ? command.study : make_out_folder(common, study.name);
    if (finished && fs::exists(folder + "/tradeoff.json") && !common.force)
        throw Failure(ExitCode::usage, fmt::format("'{}/tradeoff.json' is there already", folder),
                      "add --force to write it again");
    ProgressLine progress(common.quiet);
    options.run = run_options(common, progress);
    options.run.snapshots = 0;
    options.run.journal_folder = folder + (finished ? "/tradeoff" : "/journal");
    const auto write = [&](const Tradeoff& t) {
        const nlohmann::json object = tradeoff_json(study, t);
        write_file(folder + "/tradeoff.json", json_text(object) + "\n");
        write_file(folder + "/tradeoff.html", tradeoff_html(object));
    };
    // What took minutes is on the disk before the next spread begins.
    options.after_run = [&](const Tradeoff& t) { writing(folder, [&] { write(t); }); };
    run_tradeoff(result, read, options);
    progress.finish();
    writing(folder, [&] { write(result); });
    if (finished) writing(folder, [&] { show_in_report(folder, tradeoff_json(study, result), command); });
    if (common.json)
        fmt::print("{}\n", json_text(tradeoff_json(study, result)));
    else
        fmt::print("{}", tradeoff_text(study, result));
    if (!common.quiet)
        fmt::print(stderr, "gradwright: tradeoff.json and tradeoff.html are in {}{}\n", folder,
                   finished ? ", and report.html shows them" : "");
    if (result.status == "interrupted") {
        fmt::print(
            stderr,
            "gradwright: interrupted; the same command takes up the beds and strips that are in the cache\n");
        return ExitCode::interrupted;
    }
    const bool finest_ran = !result.levels.empty() && result.levels.front().grains > 0;
    if (!finest_ran) {
        fmt::print(stderr, "gradwright: the finest level ended with '{}': {}\n", result.levels.front().status,
                   result.levels.front().reason);
        return ExitCode::simulation_failed;
    }
    return ExitCode::met;
}

}  // namespace

void add_tradeoff(CLI::App& app, Call& call) {
    auto command = std::make_shared<TradeoffCommand>();
    CLI::App* verb = app.add_subcommand(
        "tradeoff", "Speed against error: what each reduction gains, and what it costs in gradation");
    verb->add_option("STUDY|OUT", command->study,
                     "Study file (TOML), or the folder that 'design' wrote: its report then shows the table")
        ->required();
    verb->add_option("--seeds", command->seeds, "Beds a level; the noise is measured between them; default 3")
        ->type_name("N")
        ->check(CLI::Range(2, 1000));
    verb->add_option("--around", command->around,
                     "finest (default): each reduction alone, from the finest level | study: the study with "
                     "one reduction "
                     "undone, or one more; cheaper")
        ->type_name("NAME")
        ->check(CLI::IsMember({"finest", "study"}));
    verb->add_option("--fidelity", command->fidelity, "map (default): the study's strip, relabelled | full")
        ->type_name("NAME")
        ->check(CLI::IsMember({"map", "full"}));
    verb->add_option("--level", command->levels, "Only this level beside the finest; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    verb->add_flag("--plan", command->plan, "Only list the levels and what they would cost");
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_tradeoff_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
