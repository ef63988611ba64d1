#include "reports/output_folder.h"

#include <fmt/format.h>

#include <stdexcept>

#include "reports/film.h"
#include "reports/heap_order_figure.h"
#include "reports/html_report.h"
#include "reports/map_file.h"
#include "reports/particle_file.h"
#include "reports/partition_drawing.h"
#include "reports/partition_file.h"
#include "reports/report_data.h"
#include "reports/result_json.h"
#include "reports/results_file.h"
#include "reports/safe_write.h"

namespace gradwright {
namespace {

std::string text_of(const nlohmann::json& object, int indent) {
    return object.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace

std::vector<std::string> write_outputs(const Study& study, const StudyResult& result,
                                       const std::string& folder, Film film,
                                       const std::vector<std::string>& called_with) {
    make_folder(folder);
    const auto in_folder = [&](const std::string& name) { return folder + "/" + name; };
    std::vector<const GradationMap*> maps;
    for (const Evaluation& evaluation : result.confirmations) maps.push_back(&evaluation.map);
    if (maps.empty()) maps.push_back(&result.predicted.map);
    const GradationMap map = mean_map(maps);

    // result.json lists the files, so the list comes first
    std::vector<std::string> files = {"result.json",    "results.h5",    "report.html", "report_data.json",
                                      "partition.json", "partition.svg", "study.toml"};
    if (!map.gi.empty()) files.push_back("gi_map.vtkhdf");
    if (result.extrapolated) files.push_back("heap_order.svg");
    std::vector<Snapshot> instants;
    for (const std::size_t k : shown_instants(result.snapshots.size())) {
        files.push_back(fmt::format("particles_{:04}.vtkhdf", instants.size()));
        instants.push_back(result.snapshots[k]);
    }
    if (!result.snapshots.empty()) files.push_back("particles.vtkhdf.series");

    const bool filmed = film == Film::drawn && result.snapshots.size() > 1;
    if (filmed) files.push_back("film.webp");

    write_file(in_folder("study.toml"), study.text);
    write_file(in_folder("result.json"), text_of(to_json(study, result, files), 2));
    write_file(in_folder("partition.json"), text_of(partition_json(study, result), 2));
    write_file(in_folder("partition.svg"), partition_svg(study, result));
    if (result.extrapolated) write_file(in_folder("heap_order.svg"), heap_order_svg(*result.extrapolated));
    write_results_file(study, result, in_folder("results.h5"));
    if (!map.gi.empty())
        write_map_file(map, scene_of(study, result.design, false, result.seed).gap,
                       in_folder("gi_map.vtkhdf"));
    write_particle_series(instants, folder);
    if (filmed)
        write_file(in_folder("film.webp"), film_webp(scene_of(study, result.design, false, result.seed),
                                                     result.design.partition, result.snapshots));
    const nlohmann::json data = report_data(study, result, files, called_with);
    write_file(in_folder("report_data.json"), text_of(data, -1));
    write_report(data, in_folder("report.html"));
    return files;
}

std::string rebuild_report(const std::string& folder) {
    const std::string source = folder + "/report_data.json", page = folder + "/report.html";
    nlohmann::json data;
    try {
        data = nlohmann::json::parse(read_file(source));
        write_report(data, page);
    } catch (const nlohmann::json::exception& error) {
        throw std::runtime_error("cannot use " + source + ": " + error.what());
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error("cannot use " + source + ": " + error.what());
    }
    return page;
}

}  // namespace gradwright
