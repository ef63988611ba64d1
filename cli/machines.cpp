// gradwright machines: the machine files that ship.
#include <fmt/format.h>

#include "cli/common.h"

namespace gradwright::cli {
namespace {

ExitCode run_machines(const CommonOptions& common) {
    const std::vector<MachineInfo> machines = shipped_machines();
    if (common.json) {
        auto rows = nlohmann::json::array();
        for (const MachineInfo& machine : machines)
            rows.push_back({{"name", machine.name},
                            {"title", machine.title},
                            {"source", machine.source},
                            {"file", machine.file}});
        fmt::print("{}\n", json_text(nlohmann::json{{"machines", rows}}));
        return ExitCode::met;
    }
    for (const MachineInfo& machine : machines)
        fmt::print("{:<20} {}\n    source: {}\n    file:   {}\n", machine.name, machine.title, machine.source,
                   machine.file);
    return ExitCode::met;
}

}  // namespace

void add_machines(CLI::App& app, Call& call) {
    CLI::App* verb = app.add_subcommand("machines", "Machines that ship, with their sources");
    add_output_options(*verb, call.options);
    verb->callback([&call] { call.run = [&call] { return run_machines(call.options); }; });
}

}  // namespace gradwright::cli
