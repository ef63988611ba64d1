// gradwright report: rebuilds report.html of a finished design from the data beside it.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/common.h"
#include "cli/run_options.h"
#include "reports/output_folder.h"

namespace gradwright::cli {
namespace {

struct ReportOptions {
    std::string folder;
};

ExitCode run_report(const ReportOptions& options, const CommonOptions& common) {
    namespace fs = std::filesystem;
    const fs::path folder(options.folder);
    const char* mend = "'gradwright report OUT' takes the folder that 'gradwright design' wrote";
    if (!fs::is_directory(folder))
        throw Failure(ExitCode::io, fmt::format("there is no folder '{}'", options.folder), mend);
    if (!fs::exists(folder / "report_data.json"))
        throw Failure(ExitCode::io, fmt::format("'{}' has no report_data.json", options.folder), mend);
    const std::string file = (folder / "report_data.json").string();
    if (!nlohmann::json::accept(std::ifstream(file)))
        throw Failure(ExitCode::bad_input, fmt::format("{} is damaged: it is no JSON", file),
                      "run the design again");
    const std::string page = writing(options.folder, [&] { return rebuild_report(options.folder); });
    if (common.json)
        fmt::print("{}\n", json_text(nlohmann::json{{"report", page}}));
    else
        fmt::print("{}\n", page);
    return ExitCode::met;
}

}  // namespace

void add_report(CLI::App& app, Call& call) {
    auto options = std::make_shared<ReportOptions>();
    CLI::App* verb = app.add_subcommand("report", "Rebuild the report of a finished design");
    verb->add_option("OUT", options->folder, "Folder that 'design' wrote")->required();
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_report(*options, call.options); }; });
}

}  // namespace gradwright::cli
