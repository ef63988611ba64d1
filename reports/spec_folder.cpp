#include "reports/spec_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "reports/dxf_file.h"
#include "reports/fill_sheet.h"
#include "reports/plate_drawing.h"
#include "reports/safe_write.h"
#include "reports/sha256.h"
#include "reports/spec_json.h"
#include "reports/stl_file.h"

namespace gradwright {
namespace {

/// A program built without OpenCASCADE, and a plate that is none, leave no solid of an earlier call behind.
void try_step(const Study& study, const HandOver& over, StepSchema schema, const std::string& path,
              SpecFiles& written) {
    written.step = false;
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    if (!step_available()) return;
    StepNames names;
    names.product = over.id;
    names.description =
        fmt::format("{} {:g} mm, {}. {}. Side A is on the left of the line from P's first end",
                    study.build.material, study.build.thickness * 1e3, over.make, over.first_line);
    names.title = fmt::format("{}. Dispenser partition, {}", over.first_line, study.name);
    names.organisation = study.build.owner;
    names.author = study.build.creator;
    const auto write = [&] {
        write_aside(path, [&](const std::string& aside) { write_step(over.plates, names, schema, aside); });
        written.step = true;
    };
    if (over.buildable()) {
        write();
        return;
    }
    try {
        write();
    } catch (const std::runtime_error& problem) {
        written.step_problem = problem.what();
    }
}

}  // namespace

SpecFiles write_spec(const Study& study, const FinishedDesign& finished, const HandOver& over,
                     StepSchema schema, const std::string& folder) {
    make_folder(folder);
    SpecFiles written;
    const auto in_folder = [&](const std::string& name) { return folder + "/" + name; };
    const auto put = [&](const std::string& name, const std::string& content) {
        write_file(in_folder(name), content);
        written.names.push_back(name);
    };
    try_step(study, over, schema, in_folder("partition.step"), written);
    if (written.step) written.names.push_back("partition.step");
    put("partition.stl", stl_text(over.plates, fmt::format("{} {}", over.id, over.first_line)));
    DxfNotes notes{fmt::format("{}. {}, mm, seen from side B", over.first_line, over.id), {over.first_line}};
    notes.lines.push_back(
        fmt::format("{}, t = {:g} mm, {}", study.build.material, study.build.thickness * 1e3, over.make));
    if (over.make == "bent sheet")
        notes.lines.push_back(
            fmt::format("bend allowance = q (r + k t), q in rad, r = {:g} mm inside, k = {:.4f}",
                        study.build.bend_radius * 1e3, study.build.k_factor));
    if (over.make == "printed wall")
        notes.lines.push_back("printed standing: the unrolled outline is for its length only");
    put("flat_pattern.dxf", dxf_text(over.flats, notes));
    const DrawPage drawing = plate_drawing(study, finished, over);
    put("drawing.pdf",
        pdf_of(kDrawingWidth, kDrawingHeight, {drawing}, fmt::format("{} {}", over.first_line, over.id)));
    put("drawing.svg", svg_of(kDrawingWidth, kDrawingHeight, drawing));
    put("fill_sheet.pdf", fill_pdf(study, over));
    put("fill_sheet.html", fill_html(study, over));
    std::vector<std::string> files = written.names;
    files.insert(files.end(), {"spec.json", "manifest.sha256"});
    put("spec.json", spec_json(study, finished, over, files)
                             .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                         "\n");
    std::string manifest;
    for (const std::string& name : written.names)
        manifest += fmt::format("{}  {}\n", sha256(read_file(in_folder(name))), name);
    put("manifest.sha256", manifest);
    return written;
}

}  // namespace gradwright
