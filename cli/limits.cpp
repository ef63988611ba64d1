// gradwright limits: what the engine does at its limits: hard cases, the stability edge of the time step,
// sticking.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/common.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "dem/hard_cases.h"
#include "dem/stability.h"
#include "reports/json_support.h"

namespace gradwright::cli {
namespace {

struct LimitsCommand {
    std::vector<std::string> parts;  ///< cases, edges, sticking; empty: all
    std::vector<std::string> only;   ///< ids of hard cases; empty: all
};

nlohmann::json cases_json(const LimitsCommand& command, const SpreadOptions& options, ProgressLine& progress,
                          bool& all_pass) {
    auto rows = nlohmann::json::array();
    const auto& all = hard_cases();
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (!command.only.empty() &&
            std::find(command.only.begin(), command.only.end(), all[k].id) == command.only.end())
            continue;
        progress.update(all[k].id, static_cast<double>(k) / static_cast<double>(all.size()));
        const HardCase c = run_hard_case(all[k], options);
        if (options.stop->load()) break;  // a case that was stopped says nothing
        all_pass = all_pass && c.pass;
        rows.push_back({{"id", c.id},
                        {"tried", c.tried},
                        {"expected", c.expected},
                        {"happened", c.happened},
                        {"pass", c.pass},
                        {"seconds", number(c.seconds)}});
    }
    return rows;
}

nlohmann::json edges_json(ProgressLine& progress, const std::atomic<bool>& stop) {
    auto rows = nlohmann::json::array();
    const auto table = stability_table();
    for (std::size_t k = 0; k < table.size(); ++k) {
        if (stop.load()) break;
        progress.update("stability edges", static_cast<double>(k) / static_cast<double>(table.size()));
        const StabilityEdge e = stability_edge(table[k].setup);
        rows.push_back({{"law", table[k].law},
                        {"packing", table[k].setup.packing == StabilityPacking::wedge ? "wedge" : "heap"},
                        {"size_ratio", number(table[k].setup.size_ratio)},
                        {"overlap_asked", number(table[k].setup.overlap)},
                        {"overlap", number(e.overlap)},
                        {"grains", e.grains},
                        {"edge", number(e.edge())},
                        {"stable", number(e.stable)},
                        {"unstable", number(e.unstable)}});
    }
    return rows;
}

nlohmann::json sticking_json(const std::atomic<bool>& stop) {
    auto rows = nlohmann::json::array();
    for (const double ratio : {2.0, 3.0, 5.0, 10.0, 20.0, 50.0}) {
        if (stop.load()) break;
        SaddleSetup setup;
        setup.size_ratio = ratio;
        const SaddleResult ours = roll_off_saddle(setup);
        setup.late_velocity = true;
        const SaddleResult late = roll_off_saddle(setup);
        rows.push_back({{"size_ratio", ratio},
                        {"rayleigh_fraction", number(setup.rayleigh_fraction)},
                        {"expected_seconds", number(ours.expected_time)},
                        {"seconds", number(ours.time)},
                        {"fell", ours.fell},
                        {"farthest_angle_deg", number(ours.farthest_angle_deg)},
                        {"late_velocity",
                         {{"seconds", number(late.time)},
                          {"fell", late.fell},
                          {"farthest_angle_deg", number(late.farthest_angle_deg)}}}});
    }
    return rows;
}

void print_limits(const nlohmann::json& result) {
    if (result.contains("cases"))
        for (const auto& c : result["cases"])
            fmt::print("{}  {}\n    must:     {}\n    happened: {}\n",
                       c["pass"].get<bool>() ? "ok  " : "FAIL", c["tried"].get<std::string>(),
                       c["expected"].get<std::string>(), c["happened"].get<std::string>());
    if (result.contains("edges")) {
        fmt::print(
            "\nStability edge of the time step, in Rayleigh times of the smallest grain; the default is "
            "0.2\n");
        for (const auto& e : result["edges"])
            fmt::print("  {:.2f}  {}, {}, size ratio {:.0f}, overlap {:.1f} % r\n", e["edge"].get<double>(),
                       e["law"].get<std::string>(), e["packing"].get<std::string>(),
                       e["size_ratio"].get<double>(), 100 * e["overlap"].get<double>());
    }
    if (result.contains("sticking")) {
        fmt::print("\nA small grain on a saddle of two large ones: how far round it rolls before it falls\n");
        const auto end = [](const nlohmann::json& one) {
            return one["fell"].get<bool>()
                       ? fmt::format("falls at {:.0f} degrees", one["farthest_angle_deg"].get<double>())
                       : std::string("sticks");
        };
        for (const auto& s : result["sticking"])
            fmt::print("  size ratio {:.0f}: {}; with half-step velocities it {}\n",
                       s["size_ratio"].get<double>(), end(s), end(s["late_velocity"]));
    }
}

ExitCode run_limits(const LimitsCommand& command, const CommonOptions& common) {
    for (const std::string& id : command.only) {
        const auto& all = hard_cases();
        if (std::none_of(all.begin(), all.end(), [&](const auto& c) { return c.id == id; })) {
            std::vector<std::string> names;
            for (const auto& c : all) names.push_back(c.id);
            throw Failure(ExitCode::usage, fmt::format("limits: no hard case '{}'{}", id, hint(id, names)));
        }
    }
    const auto wanted = [&](const char* part) {
        return command.parts.empty()
                   ? command.only.empty() || std::string(part) == "cases"
                   : std::find(command.parts.begin(), command.parts.end(), part) != command.parts.end();
    };
    ProgressLine progress(common.quiet);
    SpreadOptions options;
    options.threads = thread_count(common);
    options.cache_folder = cache_folder(common);
    options.stop = watch_signals();
    bool all_pass = true;
    nlohmann::json result = nlohmann::json::object();
    if (wanted("cases")) result["cases"] = cases_json(command, options, progress, all_pass);
    if (wanted("edges")) result["edges"] = edges_json(progress, *options.stop);
    if (wanted("sticking")) result["sticking"] = sticking_json(*options.stop);
    result["stability_edge"] = kStabilityEdge;
    progress.finish();
    if (common.json)
        fmt::print("{}\n", json_text(result));
    else
        print_limits(result);
    if (options.stop->load()) return ExitCode::interrupted;  // what was finished stands above
    return all_pass ? ExitCode::met : ExitCode::not_met;
}

}  // namespace

void add_limits(CLI::App& app, Call& call) {
    auto command = std::make_shared<LimitsCommand>();
    CLI::App* verb = app.add_subcommand(
        "limits",
        "The engine at its limits: hard cases and their ends, stability edge of the time step, sticking");
    verb->add_option("--part", command->parts, "cases | edges | sticking; default all; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({"cases", "edges", "sticking"}));
    verb->add_option("--only", command->only, "One hard case by its id; may be repeated")
        ->type_name("ID")
        ->allow_extra_args(false);
    add_run_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback(
        [command, &call] { call.run = [command, &call] { return run_limits(*command, call.options); }; });
}

}  // namespace gradwright::cli
