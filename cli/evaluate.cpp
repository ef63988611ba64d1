// gradwright evaluate: one design forward, at the fidelity asked for.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/design_run.h"
#include "reports/result_json.h"
#include "reports/safe_write.h"
#include "reports/summary.h"

namespace gradwright::cli {
namespace {

struct EvaluateOptions {
    std::string study;
    std::string fidelity = "full";
    std::string design;  ///< result.json, partition.json or a design object; empty = the study's start
};

/// Reads the design of an earlier result. What the file leaves out keeps the study's start value.
Design read_design(const std::string& file, const Study& study) {
    std::ifstream stream(file);
    if (!stream)
        throw Failure(ExitCode::io, fmt::format("cannot open the design file '{}'", file),
                      "--design takes the result.json of a design");
    std::vector<InputProblem> problems;
    const auto bad = [&](const std::string& key, const std::string& value, const std::string& rule) {
        problems.push_back(
            {file, 0, key, value, rule, "--design takes the result.json that 'gradwright design' wrote"});
    };
    Design design = start_design(study);
    try {
        nlohmann::json object = nlohmann::json::parse(stream);
        if (object.is_object() && object.contains("design")) object = object["design"];
        const nlohmann::json partition = object.value("partition", object);
        const std::string family = partition.value("family", std::string("polyline"));
        if (family != "polyline" && family != "straight")
            bad("partition.family", family, "is polyline or straight");
        design.family = family == "straight" ? Family::straight : Family::polyline;
        if (!partition.contains("points_m")) {
            bad("partition.points_m", "missing", "holds the [x, y] points of the curve in m");
        } else {
            design.partition.points.clear();
            for (const auto& point : partition["points_m"])
                design.partition.points.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
            if (design.partition.points.size() < 2)
                bad("partition.points_m", partition["points_m"].dump(), "needs at least two points");
            else if (design.partition.self_intersects())
                bad("partition.points_m", partition["points_m"].dump(), "must not cross itself");
        }
        design.parameters.clear();
        // named first: a range-for does not keep the temporary behind items() alive
        const nlohmann::json parameters = partition.value("parameters", nlohmann::json::object());
        for (const auto& [name, value] : parameters.items())
            if (value.is_number()) design.parameters.emplace_back(name, value.get<double>());
        const nlohmann::json fill = object.value("fill_fraction", nlohmann::json::object());
        design.fill_fraction = {fill.value("A", design.fill_fraction[0]),
                                fill.value("B", design.fill_fraction[1])};
        design.dosage_factor = object.value("dosage_factor", design.dosage_factor);
        design.land = object.value("land_m", design.land);
        design.footprint_offset = object.value("footprint_offset_m", design.footprint_offset);
        for (const double fraction : design.fill_fraction)
            if (!(fraction > 0 && fraction <= 1))
                bad("fill_fraction", fmt::format("{}", fraction), "is above 0 and at most 1");
        if (!(design.dosage_factor > 0))
            bad("dosage_factor", fmt::format("{}", design.dosage_factor), "is above 0");
        if (!(design.land >= 0)) bad("land_m", fmt::format("{}", design.land), "is not negative");
    } catch (const nlohmann::json::exception& error) {
        bad("", "", fmt::format("is not a design in JSON: {}", error.what()));
    }
    if (!problems.empty()) throw InputError{problems};
    return design;
}

ExitCode run_evaluate(const EvaluateOptions& options, const CommonOptions& common) {
    const Fidelity fidelity = fidelity_of(options.fidelity);
    const Study study = load_study(options.study, common);
    // The kinematic picture needs no spread, so nothing about a spread can forbid it.
    if (fidelity != Fidelity::kinematic) refuse_impossible(study, estimate(study, thread_count(common)));
    const Design design = options.design.empty() ? start_design(study) : read_design(options.design, study);
    const std::string folder = common.out.empty() ? std::string() : make_out_folder(common, study.name);
    ProgressLine progress(common.quiet);
    const RunOptions run = run_options(common, progress);
    const Evaluation evaluation = evaluate_once(study, design, fidelity, study.seed, run);
    progress.finish();

    std::vector<std::string> files;
    if (!folder.empty()) files.push_back("evaluation.json");
    const std::string text = json_text(evaluation_json(study, evaluation, files)) + "\n";
    if (!folder.empty()) writing(folder, [&] { write_file(folder + "/evaluation.json", text); });
    if (common.json)
        fmt::print("{}", text);
    else
        fmt::print("{}\n", evaluation_summary_text(study, evaluation));
    if (!folder.empty() && !common.quiet) fmt::print(stderr, "gradwright: results are in {}\n", folder);
    const ExitCode code = exit_code_of(evaluation.health);
    if (code == ExitCode::simulation_failed)
        fmt::print(stderr, "gradwright: the simulation ended with '{}': {}\n", evaluation.health.status,
                   evaluation.health.reason);
    return code;
}

}  // namespace

void add_evaluate(CLI::App& app, Call& call) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* verb = app.add_subcommand("evaluate", "One design forward: GI profile, map, drift and bands");
    verb->add_option("STUDY", options->study, "Study file (TOML)")->required();
    verb->add_option("--fidelity", options->fidelity, "kinematic | map | full (default)")->type_name("NAME");
    verb->add_option("--design", options->design,
                     "Take the design of this result.json; default: the study's start")
        ->type_name("FILE");
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_evaluate(*options, call.options); }; });
}

}  // namespace gradwright::cli
