// gradwright sensitivity: which inputs move a design's gradation, and what its plate's tolerances do to it.
#include "optimise/sensitivity.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/design_file.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "cli/run_record.h"
#include "reports/output_folder.h"
#include "reports/safe_write.h"
#include "reports/sensitivity_report.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;

struct SensitivityCommand {
    std::string what, design, tolerance_class = "m";
    double gi_error = 0;  // 0: half the study's tolerance
    int strips = 0, plates = 0, samples = 256, trajectories = 20, band_plates = 1000;
};

ToleranceClass class_of(const std::string& name) {
    for (const auto c : {ToleranceClass::f, ToleranceClass::m, ToleranceClass::c, ToleranceClass::v})
        if (name == to_string(c)) return c;
    throw Failure(ExitCode::usage, fmt::format("--class '{}': ISO 2768-1 has f, m, c and v", name),
                  "m is the default");
}

ExitCode run_sensitivity_command(const SensitivityCommand& command, CommonOptions common) {
    SensitivityOptions options;
    options.tolerance_class = class_of(command.tolerance_class);
    const bool finished = fs::is_directory(command.what);
    Study study;
    std::string design_file = command.design;
    if (finished) {
        const RunRecord record = read_record(command.what);
        std::vector<std::string> set = record.set;
        set.insert(set.end(), common.set.begin(), common.set.end());
        if (common.seed) set.push_back(fmt::format("run.seed={}", *common.seed));
        study = parse_study(record.study_text, record.study_file, set);
        if (design_file.empty()) design_file = (fs::path(command.what) / "result.json").string();
    } else {
        study = load_study(command.what, common);
    }
    refuse_scale_up(study, "sensitivity");
    const Design design = design_file.empty() ? start_design(study) : read_design(design_file, study);
    if (design.partition.points.size() < 2)
        throw Failure(ExitCode::bad_input, "there is no partition to vary",
                      "give the folder of a finished design, or --design result.json");
    const int inputs = int(motion_inputs(study, design).size());
    if (command.strips > 0 && command.strips < inputs + 3)
        throw Failure(
            ExitCode::usage,
            fmt::format("--strips {}: a line through {} inputs needs {}", command.strips, inputs, inputs + 3),
            fmt::format("twice as many as inputs, {}, is a good number", 2 * inputs));
    options.gi_error = command.gi_error > 0 ? command.gi_error : 0.5 * study.objective.tolerance;
    options.samples = command.samples;
    options.trajectories = command.trajectories;
    options.band_plates = command.band_plates;
    options.strips = command.strips;
    options.spread_plates = command.plates;
    const StudyEstimate cost = estimate(study, thread_count(common));
    refuse_impossible(study, cost);
    if (!common.quiet)
        for (const std::string& warning : all_warnings(study, cost))
            fmt::print(stderr, "gradwright: warning: {}\n", warning);
    std::string folder;
    if (finished)
        folder = command.what;
    else if (!common.out.empty())
        folder = make_out_folder(common, study.name);
    const fs::path page = fs::path(folder) / "sensitivity.json";
    if (finished && fs::exists(page) && !common.force)
        throw Failure(ExitCode::usage, fmt::format("'{}' is there already", page.string()),
                      "add --force to write it again");
    ProgressLine progress(common.quiet);
    options.run = run_options(common, progress);
    options.run.snapshots = 0;
    const Sensitivity found = run_sensitivity(study, design, options);
    progress.finish();
    if (found.status != "ok" && found.status != "interrupted") {
        fmt::print(stderr, "gradwright: no map to ask: {}: {}\n", found.status, found.reason);
        return ExitCode::simulation_failed;
    }
    const nlohmann::json object = sensitivity_json(study, found);
    if (common.json)
        fmt::print("{}\n", json_text(object));
    else
        fmt::print("{}", sensitivity_text(study, found));
    if (!folder.empty()) {
        writing(folder, [&] {
            write_file(page.string(), json_text(object) + "\n");
            write_file((fs::path(folder) / "tornado.svg").string(), tornado_svg(found));
            const std::string data = (fs::path(folder) / "report_data.json").string();
            if (!finished || !fs::exists(data)) return;
            nlohmann::json report = nlohmann::json::parse(read_file(data));
            report["sensitivity"] = object;
            write_file(data, json_text(report) + "\n");
            rebuild_report(folder);
        });
        if (!common.quiet)
            fmt::print(stderr, "gradwright: sensitivity.json and tornado.svg are in {}{}\n", folder,
                       finished ? ", and report.html shows them" : "");
    }
    if (found.status == "interrupted") {
        fmt::print(stderr,
                   "gradwright: interrupted; the same command takes up the strips that are in the cache\n");
        return ExitCode::interrupted;
    }
    return ExitCode::met;
}

}  // namespace

void add_sensitivity(CLI::App& app, Call& call) {
    auto command = std::make_shared<SensitivityCommand>();
    CLI::App* verb = app.add_subcommand(
        "sensitivity", "Which inputs move a design's gradation, and what the plate's tolerances do to it");
    verb->add_option("STUDY|OUT", command->what, "Study file, or the folder that 'design' wrote")->required();
    verb->add_option("--design", command->design,
                     "result.json of a design; default: that of OUT, or the study's start");
    verb->add_option(
            "--strips", command->strips,
            "Strips to spread for what moves grains (friction, sizes, blade speed, ...); default none")
        ->type_name("N")
        ->check(CLI::Range(0, 100000));
    verb->add_option("--plates", command->plates,
                     "Plates drawn within tolerance to spread with both powders, against the budget's band; "
                     "default none")
        ->type_name("N")
        ->check(CLI::Range(0, 10000));
    verb->add_option("--gi-error", command->gi_error,
                     "GI error that the tolerances are to keep, rms; default half the study's tolerance")
        ->type_name("GI")
        ->check(CLI::Range(1e-6, 1.0));
    verb->add_option("--class", command->tolerance_class,
                     "General tolerances of ISO 2768-1: f, m, c or v; default m");
    verb->add_option("--samples", command->samples, "Rows of the Sobol samples; default 256")
        ->check(CLI::Range(2, 1000000));
    verb->add_option("--trajectories", command->trajectories,
                     "Trajectories of the Morris screening; default 20")
        ->check(CLI::Range(2, 1000000));
    verb->add_option("--band-plates", command->band_plates,
                     "Plates on the map that check the band; default 1000")
        ->check(CLI::Range(1, 1000000));
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_sensitivity_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
