// gradwright bench: how fast the engine is on this machine, by stage, size and threads.
#include "dem/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "cli/common.h"
#include "cli/progress.h"
#include "reports/json_support.h"

namespace gradwright::cli {
namespace {

struct BenchCommand {
    std::string study;  ///< empty: the shipped linear coupon
    std::vector<double> grains = {20000};
    std::vector<int> threads;  ///< empty: one thread, and every core when there are more
    std::vector<std::string> states = {"settled"};
    long steps = 2000;
};

nlohmann::json bench_json(const BenchResult& result) {
    auto cases = nlohmann::json::array();
    for (const BenchCase& one : result.cases) {
        auto stages = nlohmann::json::object();
        for (const auto& [stage, seconds] : one.stages) stages[stage] = number(seconds);
        cases.push_back({{"name", one.name},
                         {"grains", one.grains},
                         {"threads", one.threads},
                         {"grain_steps_per_second", number(one.grain_steps_per_second)},
                         {"awake_share", number(one.awake_share)},
                         {"seconds", number(one.seconds)},
                         {"stages", stages},
                         {"bytes_per_grain", number(one.bytes_per_grain)},
                         {"contacts_per_grain", number(one.contacts_per_grain)},
                         {"steps_per_near_list", number(one.steps_per_near_list)},
                         {"steps_per_candidate_list", number(one.steps_per_candidate_list)},
                         {"near_pairs_per_grain", number(one.near_pairs_per_grain)},
                         {"steps_at_once", one.steps_at_once},
                         {"core_round_trip_ns", number(1e9 * one.core_round_trip)},
                         {"state_hash", one.state_hash}});
    }
    return {{"host", {{"cores", result.cores}, {"isa", result.isa}}}, {"cases", cases}};
}

void print_bench(const BenchResult& result) {
    fmt::print("{} cores, compiled for {}\n", result.cores, result.isa);
    for (const BenchCase& one : result.cases) {
        fmt::print(
            "\n{}, {} grains, {:.0f} % awake, {} thread{}: {:.2f} million grain-steps/s ({:.2f} per thread), "
            "{:.0f} "
            "bytes/grain, {:.2f} contacts/grain\n",
            one.name, one.grains, 100 * one.awake_share, one.threads, one.threads == 1 ? "" : "s",
            one.grain_steps_per_second / 1e6, one.grain_steps_per_second / 1e6 / std::max(1, one.threads),
            one.bytes_per_grain, one.contacts_per_grain);
        if (one.steps_at_once > 1)
            fmt::print("    {} steps at once: the bed does not fit in the cache\n", one.steps_at_once);
        if (std::isfinite(one.core_round_trip))
            fmt::print("    from one thread's core to the other's and back in {:.0f} ns\n",
                       1e9 * one.core_round_trip);
        for (const auto& [stage, seconds] : one.stages)
            fmt::print("    {:<16} {:>6.1f} %\n", stage, one.seconds > 0 ? 100 * seconds / one.seconds : 0.0);
    }
}

ExitCode run_bench_command(const BenchCommand& command, const CommonOptions& common) {
    const std::string file = command.study.empty()
                                 ? (std::filesystem::path(data_folder()) / "01_linear_coupon.toml").string()
                                 : command.study;
    BenchOptions options;
    options.scene = load_study(file, common).scene;
    options.grains = command.grains;
    options.threads = command.threads;
    options.steps = command.steps;
    options.states = command.states;
    options.cache_folder = cache_folder(common);
    if (options.threads.empty()) {
        options.threads = {1};
        if (thread_count(common) > 1) options.threads.push_back(thread_count(common));
    }
    ProgressLine progress(common.quiet);
    options.progress = [&progress](const std::string& stage, double fraction) {
        progress.update(stage, fraction);
    };
    BenchResult result;
    try {
        result = run_bench(options);
    } catch (const std::runtime_error& error) {
        throw Failure(ExitCode::simulation_failed, error.what(), "try another number of --grains");
    }
    progress.finish();
    if (common.json)
        fmt::print("{}\n", json_text(bench_json(result)));
    else
        print_bench(result);
    return ExitCode::met;
}

}  // namespace

void add_bench(CLI::App& app, Call& call) {
    auto command = std::make_shared<BenchCommand>();
    CLI::App* verb =
        app.add_subcommand("bench", "Speed of the engine on this machine, by stage, size and threads");
    verb->add_option("STUDY", command->study,
                     "Study whose physics is timed; default the shipped linear coupon");
    verb->add_option("--grains", command->grains, "Grains of the bed; default 20000; may be repeated")
        ->type_name("N")
        ->allow_extra_args(false)
        ->check(CLI::Range(100.0, 1e8));
    verb->add_option("--threads", command->threads, "Threads; default one, then every core; may be repeated")
        ->type_name("N")
        ->allow_extra_args(false)
        ->check(CLI::Range(1, 1024));
    verb->add_option(
            "--state", command->states,
            "settled (default) | flowing: the bed slides over its floor | spread: a heap before the blade, "
            "minutes of preparation; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({"settled", "flowing", "spread"}));
    verb->add_option("--steps", command->steps, "Time steps that are timed; default 2000")
        ->type_name("N")
        ->check(CLI::Range(1L, 1000000000L));
    verb->add_option("--cache", call.options.cache, "Folder of settled beds; 'none' for no cache")
        ->type_name("DIR");
    add_study_options(*verb, call.options);
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_bench_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
