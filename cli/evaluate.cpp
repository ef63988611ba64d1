// gradwright evaluate: one design forward, at the fidelity asked for.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>

#include "cli/check.h"
#include "cli/common.h"
#include "cli/design_file.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "optimise/design_run.h"
#include "reports/composition_json.h"
#include "reports/film.h"
#include "reports/result_json.h"
#include "reports/safe_write.h"
#include "reports/spread_figures.h"
#include "reports/summary.h"

namespace gradwright::cli {
namespace {

struct EvaluateOptions {
    std::string study;
    std::string fidelity = "full";
    std::string design;  ///< result.json, partition.json or a design object; empty = the study's start
    bool composition = false, figures = false, film = false;
    std::string melt_depth, melt_width;  ///< lengths with their units; given together or not at all
};

/// "100 um", or a bare number of metres. Throws Failure usage.
double melt_length(const std::string& option, const std::string& text) {
    const auto wrong = [&](const std::string& rule) {
        return Failure(ExitCode::usage, fmt::format("{} '{}': {}", option, text, rule),
                       fmt::format("a length with its unit, such as {} '100 um'", option));
    };
    double length = 0;
    try {
        std::size_t used = 0;
        length = std::stod(text, &used);
        if (used != text.size()) length = parse_quantity(text, "length");
    } catch (const std::exception& error) {
        throw wrong(error.what());
    }
    if (!(length >= 1e-6 && length <= 10e-3)) throw wrong("must lie between 1 um and 10 mm");
    return length;
}

/// What --composition and the melt options ask for; none when they are absent. Throws Failure usage.
std::optional<CompositionRequest> composition_request(const EvaluateOptions& options, const Study& study) {
    const bool melt = !options.melt_depth.empty() || !options.melt_width.empty();
    if (!options.composition && !melt) return {};
    CompositionRequest request;
    for (const Powder& powder : study.scene.powder)
        if (powder.material.composition.empty())
            throw InputError{{{study.file, 0, "powder material", powder.material.name,
                               "has no composition, which --composition needs",
                               "composition = { wt = { Ni = 52.5, Fe = \"balance\" } } in its material"}}};
    if (!melt) return request;
    if (options.melt_depth.empty() || options.melt_width.empty())
        throw Failure(ExitCode::usage, "a melt pool needs both --melt-depth and --melt-width",
                      "for example --melt-depth '100 um' --melt-width '120 um'");
    MeltPool pool;
    pool.depth = melt_length("--melt-depth", options.melt_depth);
    pool.width = melt_length("--melt-width", options.melt_width);
    pool.layer_thickness = study.scene.layer_thickness;
    if (pool.depth < pool.layer_thickness)
        throw Failure(
            ExitCode::usage,
            fmt::format("--melt-depth {} is less than the layer thickness {}: the layer would not bond",
                        format_quantity(pool.depth, "length"),
                        format_quantity(pool.layer_thickness, "length")),
            "the depth is measured from the top of the new layer");
    request.pool = pool;
    return request;
}

ExitCode run_evaluate(const EvaluateOptions& options, const CommonOptions& common) {
    const Fidelity fidelity = fidelity_of(options.fidelity);
    if (options.figures && fidelity != Fidelity::full)
        throw Failure(ExitCode::usage, "--figures needs the grains of a full spread", "use --fidelity full");
    if (options.film && fidelity != Fidelity::full)
        throw Failure(ExitCode::usage, "--film needs the grains of a full spread", "use --fidelity full");
    Study study = load_study(options.study, common);
    if (fidelity == Fidelity::full || fidelity == Fidelity::lammps)
        refuse_scale_up(study, "evaluate --fidelity " + std::string(to_string(fidelity)));
    const auto composition = composition_request(options, study);
    // The kinematic picture needs no spread, so nothing about a spread can forbid it.
    if (fidelity != Fidelity::kinematic) {
        const StudyEstimate cost = estimate(study, thread_count(common));
        refuse_impossible(study, cost);
        study.warnings = all_warnings(study, cost);
        if (!common.quiet)
            for (const std::string& warning : study.warnings)
                fmt::print(stderr, "gradwright: warning: {}\n", warning);
    }
    const Design design = options.design.empty() ? start_design(study) : read_design(options.design, study);
    const bool writes = !common.out.empty() || options.figures || options.film;
    const std::string folder = writes ? make_out_folder(common, study.name) : std::string();
    ProgressLine progress(common.quiet);
    RunOptions run = run_options(common, progress);
    if (!folder.empty()) run.lammps_folder = folder + "/lammps";
    if (options.figures) run.snapshots = kFigureInstants;
    if (options.film) run.snapshots = std::max(options.figures ? kFigureInstants : 0, kFilmInstants);
    SpreadResult spread;
    Evaluation evaluation = evaluate_once(study, design, fidelity, study.seed, run,
                                          options.figures || options.film ? &spread : nullptr);
    progress.finish();
    evaluation.health.warnings.insert(evaluation.health.warnings.begin(), study.warnings.begin(),
                                      study.warnings.end());

    // What took minutes is shown even when it cannot be kept.
    std::vector<std::string> files;
    std::optional<Failure> unwritten;
    const auto keep = [&](auto write) {
        try {
            writing(folder, write);
        } catch (const Failure& failure) {
            if (!unwritten) unwritten = failure;
        }
    };
    if (!folder.empty()) files.push_back("evaluation.json");
    std::optional<SpreadFigures> figures;
    if (options.figures && evaluation.health.ok()) {
        figures = spread_figures(study, design, spread, composition);
        keep([&] {
            for (const std::string& name : write_figures(study, evaluation, spread, *figures, folder))
                files.push_back(name);
        });
    }
    if (options.film && evaluation.health.ok())
        keep([&] {
            write_file(folder + "/film.webp", film_webp(scene_of(study, design, false, study.seed),
                                                        design.partition, spread.snapshots));
            files.push_back("film.webp");
        });
    nlohmann::json object = evaluation_json(study, evaluation, files);
    if (composition && evaluation.health.ok())
        object["composition"] = composition_json(study, evaluation, composition->pool);
    if (figures) object["figures"] = figures_json(study, *figures, composition);
    if (!folder.empty()) keep([&] { write_file(folder + "/evaluation.json", json_text(object) + "\n"); });
    if (common.json) {
        if (unwritten) object.update(error_json(unwritten->code, unwritten->message, unwritten->mend));
        fmt::print("{}\n", json_text(object));
    } else {
        fmt::print("{}", evaluation_summary_text(study, evaluation));
        if (composition && evaluation.health.ok())
            fmt::print("{}", composition_text(study, evaluation, composition->pool));
        if (figures) fmt::print("{}", figures_text(*figures));
        fmt::print("\n");
    }
    if (unwritten) {
        fmt::print(stderr, "gradwright: {}\n  {}\n", unwritten->message, unwritten->mend);
        return unwritten->code;
    }
    if (!folder.empty() && !common.quiet) fmt::print(stderr, "gradwright: results are in {}\n", folder);
    const ExitCode code = exit_code_of(evaluation.health);
    if (code == ExitCode::simulation_failed)
        fmt::print(stderr, "gradwright: the simulation ended with '{}': {}\n", evaluation.health.status,
                   evaluation.health.reason);
    if (code == ExitCode::interrupted)
        fmt::print(
            stderr,
            "gradwright: interrupted before the layer lay; beds that had settled are kept in the cache, and "
            "the same command takes them up again\n");
    return code;
}

}  // namespace

void add_evaluate(CLI::App& app, Call& call) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* verb = app.add_subcommand("evaluate", "One design forward: GI profile, map, drift and bands");
    verb->add_option("STUDY", options->study, "Study file (TOML)")->required();
    verb->add_option("--fidelity", options->fidelity, "kinematic | map | full (default) | lammps")
        ->type_name("NAME");
    verb->add_option("--design", options->design,
                     "Take the design of this result.json; default: the study's start")
        ->type_name("FILE");
    verb->add_flag("--composition", options->composition,
                   "Also mass fraction and wt% of the layer, from the materials' nominal compositions");
    verb->add_option("--melt-depth", options->melt_depth,
                     "With --melt-width: composition after melting; from the layer's top down, e.g. '100 um'")
        ->type_name("LENGTH");
    verb->add_option("--melt-width", options->melt_width, "Width of the melt pool across y, e.g. '120 um'")
        ->type_name("LENGTH");
    verb->add_flag(
        "--figures", options->figures,
        "Pictures and ParaView files of the layer and of the heap ahead of the blade; without --out to "
        "runs/<study>/<n>");
    verb->add_flag("--film", options->film,
                   "Also film.webp, an animated picture of the spread, cut along x and from above, a few MB; "
                   "without --out to runs/<study>/<n>");
    add_study_options(*verb, call.options);
    add_out_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_evaluate(*options, call.options); }; });
}

}  // namespace gradwright::cli
