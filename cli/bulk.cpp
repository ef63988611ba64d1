// gradwright bulk: packing and static angle of repose of a study's powder, as the engine has them.
#include "dem/bulk.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli/common.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "reports/json_support.h"

namespace gradwright::cli {
namespace {

struct BulkCommand {
    std::string study;
    std::string length = "1 mm", width = "0.26 mm", height = "0.4 mm";
};

nlohmann::json bulk_json(const ReposeResult& r) {
    return {{"status", r.health.status},
            {"reason", r.health.reason},
            {"packing_fraction", number(r.bed.packing_fraction)},
            {"mean_coordination", number(r.bed.mean_coordination)},
            {"max_overlap_ratio", number(r.bed.max_overlap_ratio)},
            {"bond_number", number(r.bond_number)},
            {"grains", r.grains},
            {"angle_of_repose_deg", number(r.angle_deg)},
            {"angle_standard_error_deg", number(r.fit_error_deg)},
            {"left_fraction", number(r.left_fraction)},
            {"gate_height_m", number(r.gate_height)},
            {"back_height_m", number(r.back_height)},
            {"flow_seconds", number(r.flow_time)},
            {"at_rest", r.at_rest},
            {"surface", {{"x_m", numbers(r.x)}, {"height_m", numbers(r.surface)}}},
            {"seconds", number(r.seconds)}};
}

double length_of(const char* option, const std::string& text) {
    try {
        return parse_quantity(text, "length");
    } catch (const std::invalid_argument& error) {
        throw Failure(ExitCode::usage, fmt::format("bulk: {} {}: {}", option, text, error.what()),
                      fmt::format("such as {} \"0.4 mm\"", option));
    }
}

ExitCode run_bulk(const BulkCommand& command, const CommonOptions& common) {
    const Scene scene = load_study(command.study, common).scene;
    ReposeSetup setup;
    setup.length = length_of("--length", command.length);
    setup.width = length_of("--width", command.width);
    setup.height = length_of("--height", command.height);
    const double d_max = std::max(scene.powder[0].size.cut_high, scene.powder[1].size.cut_high);
    if (setup.width < 4 * d_max || setup.length < 8 * d_max || setup.height < 4 * d_max)
        throw Failure(
            ExitCode::usage,
            fmt::format("bulk: the box must be at least 8 x 4 x 4 of the largest grains ({:.0f} um)",
                        d_max * 1e6),
            "raise --length, --width or --height");
    ProgressLine progress(common.quiet);
    SpreadOptions options;
    options.threads = thread_count(common);
    options.cache_folder = cache_folder(common);
    options.progress = [&progress](const Progress& p) { progress.update(p.stage, p.fraction); };
    options.stop = watch_signals();
    const ReposeResult r = drain(scene, setup, options);
    progress.finish();
    if (common.json) {
        fmt::print("{}\n", json_text(bulk_json(r)));
    } else if (r.health.ok()) {
        fmt::print("packing fraction     {:.3f}, {:.1f} contacts per grain\n", r.bed.packing_fraction,
                   r.bed.mean_coordination);
        fmt::print("Bond number          {:.3g} (pull-off force over weight, median grain)\n", r.bond_number);
        if (std::isnan(r.angle_deg))
            fmt::print("angle of repose      none: {}\n",
                       r.left_fraction > 0.5 ? "the powder stands upright; drain a taller bed (--height)"
                                             : "too little stays for a slope; drain a longer bed (--length)");
        else
            fmt::print("angle of repose      {:.1f} +- {:.1f} degrees, drained from {:.2f} mm{}\n",
                       r.angle_deg, r.fit_error_deg, 1e3 * setup.height, r.at_rest ? "" : ", still creeping");
        fmt::print("left behind the gate {:.0f} % of the powder; {:.2f} mm stand at the edge\n",
                   100 * r.left_fraction, 1e3 * r.gate_height);
    }
    if (!r.health.ok()) {
        fmt::print(stderr, "gradwright: the simulation ended with '{}': {}\n", r.health.status,
                   r.health.reason);
        return exit_code_of(r.health);
    }
    return ExitCode::met;
}

}  // namespace

void add_bulk(CLI::App& app, Call& call) {
    auto command = std::make_shared<BulkCommand>();
    CLI::App* verb = app.add_subcommand("bulk", "Packing and static angle of repose of a study's powder A");
    verb->add_option("STUDY", command->study, "Study file (TOML)")->required();
    verb->add_option("--length", command->length, "Box along the flow; default \"1 mm\"")
        ->type_name("LENGTH");
    verb->add_option("--width", command->width, "Periodic width; default \"0.26 mm\"")->type_name("LENGTH");
    verb->add_option("--height", command->height, "Height of the bed before it drains; default \"0.4 mm\"")
        ->type_name("LENGTH");
    add_study_options(*verb, call.options);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [command, &call] { call.run = [command, &call] { return run_bulk(*command, call.options); }; });
}

}  // namespace gradwright::cli
