// gradwright status: how far the design in a folder is, while it runs and after it died.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/common.h"
#include "cli/run_record.h"
#include "optimise/journal.h"
#include "reports/json_support.h"

namespace gradwright::cli {
namespace {

struct StatusOptions {
    std::string folder;
};

/// "running" | "finished" | "interrupted" | "failed" | "died"
std::string state_of(const std::string& folder, const nlohmann::json& told) {
    if (FolderLock::held(folder)) return "running";
    const std::string state = told.value("state", "running");
    return state == "running" ? "died" : state;
}

ExitCode run_status(const StatusOptions& options, const CommonOptions& common) {
    const std::string& folder = options.folder;
    const RunRecord record = read_record(folder);
    nlohmann::json told = nlohmann::json::parse(std::ifstream(folder + "/status.json"), nullptr, false);
    if (!told.is_object()) told = nlohmann::json::object();
    const std::string state = state_of(folder, told);
    std::vector<JournalEntry> entries;
    try {
        entries = Journal::read(folder + "/journal");
    } catch (const std::runtime_error& damaged) {
        throw Failure(ExitCode::bad_input, damaged.what(), "begin the design anew in another folder");
    }
    int spreads = 0;
    for (const JournalEntry& entry : entries) spreads += entry.evaluation.spreads;

    if (common.json) {
        auto rows = nlohmann::json::array();
        for (const JournalEntry& entry : entries) {
            const Evaluation& e = entry.evaluation;
            rows.push_back({{"number", entry.number},
                            {"fidelity", to_string(e.fidelity)},
                            {"status", e.health.status},
                            {"reason", e.health.reason},
                            {"misfit", number(e.misfit.value)},
                            {"x_drift", number(e.drift_misfit.value)},
                            {"spreads", e.spreads},
                            {"seconds", number(e.seconds)}});
        }
        fmt::print("{}\n", json_text({{"state", state},
                                      {"stage", told.value("stage", "")},
                                      {"fraction", told.value("fraction", 0.0)},
                                      {"seconds", told.value("seconds", 0.0)},
                                      {"strategy", record.strategy},
                                      {"study_file", record.study_file},
                                      {"spreads", spreads},
                                      {"evaluations", rows}}));
        return ExitCode::met;
    }
    fmt::print("{}: {}", folder, state);
    if (state != "finished" && !told.value("stage", "").empty())
        fmt::print(", {} at {:.0f} %", told.value("stage", ""), 100 * told.value("fraction", 0.0));
    fmt::print(", {}\n{} spread{} finished\n", duration_text(told.value("seconds", 0.0)), spreads,
               spreads == 1 ? "" : "s");
    for (const JournalEntry& entry : entries) {
        const Evaluation& e = entry.evaluation;
        fmt::print("  {:>3}  {:<10} {}\n", entry.number, to_string(e.fidelity),
                   e.health.ok()
                       ? fmt::format("misfit {:.3f}, x drift {:.3f}", e.misfit.value, e.drift_misfit.value)
                       : fmt::format("{}: {}", e.health.status, e.health.reason));
    }
    if (state == "died" || state == "interrupted")
        fmt::print("Go on with: gradwright design --resume {}\n", folder);
    return ExitCode::met;
}

}  // namespace

void add_status(CLI::App& app, Call& call) {
    auto options = std::make_shared<StatusOptions>();
    CLI::App* verb = app.add_subcommand("status", "How far the design in a folder is, running or not");
    verb->add_option("OUT", options->folder, "Folder of 'design'")->required();
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_status(*options, call.options); }; });
}

}  // namespace gradwright::cli
