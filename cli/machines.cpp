// gradwright machines: the machine files that ship.
#include <fmt/format.h>

#include "cli/common.h"

namespace gradwright::cli {
namespace {

nlohmann::json numbers_json(const MachineInfo& machine) {
    auto rows = nlohmann::json::array();
    for (const MachineNumber& number : machine.numbers)
        rows.push_back({{"key", number.key},
                        {"value", number.value},
                        {"source", number.source},
                        {"measured", number.measured}});
    return rows;
}

ExitCode run_machines(const CommonOptions& common) {
    const std::vector<MachineInfo> machines = shipped_machines();
    if (common.json) {
        auto rows = nlohmann::json::array();
        for (const MachineInfo& machine : machines)
            rows.push_back({{"name", machine.name},
                            {"title", machine.title},
                            {"source", machine.source},
                            {"file", machine.file},
                            {"numbers", numbers_json(machine)}});
        fmt::print("{}\n", json_text(nlohmann::json{{"machines", rows}}));
        return ExitCode::met;
    }
    for (const MachineInfo& machine : machines) {
        fmt::print("{}  {}\n    {}\n", machine.name, machine.title, machine.file);
        for (const MachineNumber& number : machine.numbers)
            fmt::print("    {:<18} {:>8}  {}\n", number.key, number.value, number.source);
    }
    fmt::print(
        "\nAll are fed by a piston. A number that says \"measure this\" is a stand-in: set yours under "
        "[machine] of\nthe study, or copy the file, change it and name it with use = \"my-machine.toml\".\n");
    return ExitCode::met;
}

}  // namespace

void add_machines(CLI::App& app, Call& call) {
    CLI::App* verb = app.add_subcommand("machines", "Machines that ship, with their sources");
    add_output_options(*verb, call.options);
    verb->callback([&call] { call.run = [&call] { return run_machines(call.options); }; });
}

}  // namespace gradwright::cli
