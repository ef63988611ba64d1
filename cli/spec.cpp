// gradwright spec: what a workshop and an operator need of a finished design.
#include "cli/spec.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/design_file.h"
#include "cli/run_options.h"
#include "cli/run_record.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct SpecOptions {
    std::string folder;
    bool ap242 = false;
};

/// What result.json says beside the design itself.
FinishedDesign read_finished(const std::string& file, const Study& study) {
    FinishedDesign finished;
    finished.design = read_design(file, study);
    finished.bed_packing = kAssumedBedPacking;
    try {
        const json result = json::parse(read_file(file));
        result.at("verdict").get_to(finished.verdict);
        result.at("termination").get_to(finished.termination);
        finished.verdict_text = result.value("verdict_text", std::string());
        finished.extrapolated = result.contains("extrapolated") && !result["extrapolated"].is_null();
        const auto maybe = [&result](const char* key) -> std::optional<double> {
            if (!result.contains(key) || !result[key].is_number()) return {};
            return result[key].get<double>();
        };
        finished.waste_fraction = maybe("waste_fraction");
        finished.waste_a_share = maybe("waste_a_share");
        const json beds = result.value("beds", json::array());
        for (const json& bed : beds)
            if (const json packing = bed.value("packing_fraction", json());
                packing.is_number() && packing > 0) {
                finished.bed_packing = packing.get<double>();
                finished.packing_simulated = true;
                break;
            }
    } catch (const json::exception& error) {
        throw Failure(ExitCode::bad_input, fmt::format("{} is damaged: {}", file, error.what()),
                      "run the design again");
    }
    return finished;
}

ExitCode run_spec(const SpecOptions& options, const CommonOptions& common) {
    const fs::path folder = fs::path(options.folder) / "spec";
    std::error_code ignored;
    if (!fs::is_directory(options.folder))
        throw Failure(ExitCode::io, fmt::format("there is no folder '{}'", options.folder),
                      "'gradwright spec OUT' takes the folder that 'gradwright design' wrote");
    if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
        throw Failure(ExitCode::io, fmt::format("'{}' is a file, not a folder", folder.string()),
                      "move it away");
    if (fs::is_directory(folder, ignored) && !fs::is_empty(folder, ignored) && !common.force)
        throw Failure(ExitCode::usage,
                      fmt::format("the folder '{}' already has something in it", folder.string()),
                      "add --force to write the hand-over again");
    const SpecOutcome outcome =
        make_spec(options.folder, common.set, options.ap242 ? StepSchema::ap242 : StepSchema::ap214);
    const HandOver& over = outcome.over;
    if (common.json) {
        fmt::print("{}", read_file((folder / "spec.json").string()));
    } else {
        fmt::print("{}\n{}: {}, {} of {:g} mm\n", over.first_line, over.id, outcome.study.name, over.make,
                   outcome.study.build.thickness * 1e3);
        for (const PlateCheck& check : over.checks)
            fmt::print("  {:<6}  {:<13} {}\n", check.passed ? "ok" : "FAILED", check.id, check.text);
        fmt::print("  {:<6}  {:<13} {}\n", "", "slot", over.slot.text);
        fmt::print("files in {}\n", outcome.folder);
        for (const std::string& name : outcome.files.names) fmt::print("  {}\n", name);
    }
    if (!common.quiet)
        for (const std::string& warning : over.warnings)
            fmt::print(stderr, "gradwright: warning: {}\n", warning);
    // stdout has its one object already: what is missing stands in it, and here in words
    if (!outcome.files.step && outcome.files.step_problem.empty()) {
        fmt::print(stderr,
                   "gradwright: partition.step was not written: built without OpenCASCADE\n  install {} and "
                   "build again; all other files are in {}\n",
                   kStepPackage, outcome.folder);
        return ExitCode::external;
    }
    if (!outcome.files.step)
        fmt::print(stderr, "gradwright: partition.step was not written: {}\n", outcome.files.step_problem);
    return over.buildable() ? ExitCode::met : ExitCode::not_met;
}

}  // namespace

SpecOutcome make_spec(const std::string& out, const std::vector<std::string>& set, StepSchema schema) {
    for (const std::string& one : set)
        if (!one.starts_with("partition_build."))
            throw Failure(
                ExitCode::usage,
                fmt::format("--set {}: the design stands; only partition_build can be changed here", one),
                "for example --set 'partition_build.thickness=\"0.5 mm\"'; for another study run 'design'");
    const RunRecord record = read_record(out);
    const std::string file = (fs::path(out) / "result.json").string();
    if (!fs::exists(file))
        throw Failure(ExitCode::io, fmt::format("'{}' has no result.json: the design is not finished", out),
                      fmt::format("'gradwright status {}' tells how far it is", out));
    std::vector<std::string> all = record.set;
    all.insert(all.end(), set.begin(), set.end());
    SpecOutcome outcome;
    outcome.study = parse_study(record.study_text, record.study_file, all);
    outcome.finished = read_finished(file, outcome.study);
    try {
        outcome.over = hand_over(outcome.study, outcome.finished);
    } catch (const std::invalid_argument& nothing) {
        throw Failure(ExitCode::bad_input, fmt::format("{}: {}", file, nothing.what()),
                      "let the design go on, or fix the partition in the study");
    }
    outcome.folder = (fs::path(out) / "spec").string();
    outcome.files = writing(outcome.folder, [&] {
        return write_spec(outcome.study, outcome.finished, outcome.over, schema, outcome.folder);
    });
    return outcome;
}

void add_spec(CLI::App& app, Call& call) {
    auto options = std::make_shared<SpecOptions>();
    CLI::App* verb = app.add_subcommand(
        "spec",
        "Hand-over of a finished design to OUT/spec: solid, flat pattern, drawing, fill sheet, manifest");
    verb->add_option("OUT", options->folder, "Folder that 'design' wrote")->required();
    verb->add_flag("--ap242", options->ap242, "partition.step as AP242 instead of AP214");
    verb->add_option(
            "--set", call.options.set,
            "Replace one value of [partition_build], e.g. --set 'partition_build.thickness=\"0.5 mm\"'; "
            "may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    verb->add_flag("--force", call.options.force, "Write into OUT/spec though it has something in it");
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_spec(*options, call.options); }; });
}

}  // namespace gradwright::cli
