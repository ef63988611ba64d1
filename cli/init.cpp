// gradwright init: a commented study of a machine and two powders, to be changed and then designed.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "cli/common.h"
#include "cli/run_options.h"
#include "optimise/joined.h"
#include "optimise/study_draft.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

namespace fs = std::filesystem;

struct InitOptions {
    std::string file, name, machine, target = "linear", layer;
    std::array<std::string, 2> powder, size;
};

/// Names of the material table that a powder can be of: "geometry" is the machine's wall.
std::vector<std::string> powder_names() {
    std::vector<std::string> names;
    for (const Material& material : shipped_materials())
        if (material.name != "geometry") names.push_back(material.name);
    return names;
}

[[noreturn]] void refuse(const std::string& option, const std::string& value, const std::string& what,
                         const std::vector<std::string>& valid, const std::string& more = "") {
    throw Failure(ExitCode::usage,
                  value.empty()
                      ? fmt::format("init: {} is missing: {}", option, what)
                      : fmt::format("init: {} '{}' is no {}{}", option, value, what, hint(value, valid)),
                  fmt::format("valid: {}{}", joined(valid), more));
}

void check_name(const std::string& option, const std::string& value, const std::string& what,
                const std::vector<std::string>& valid) {
    if (std::find(valid.begin(), valid.end(), value) == valid.end()) refuse(option, value, what, valid);
}

/// The machine as the study will name it: a path that the user gave from here is relative to the study there.
std::string machine_of(const InitOptions& options) {
    std::vector<std::string> names;
    for (const MachineInfo& machine : shipped_machines()) names.push_back(machine.name);
    const std::string more = "; or a machine file that ends in .toml";
    if (!options.machine.ends_with(".toml")) {
        if (std::find(names.begin(), names.end(), options.machine) == names.end())
            refuse("--machine", options.machine, "shipped machine", names, more);
        return options.machine;
    }
    std::error_code failed;
    if (!fs::is_regular_file(options.machine, failed))
        throw Failure(ExitCode::io, fmt::format("init: there is no machine file '{}'", options.machine),
                      fmt::format("check the path, or take a shipped machine: {}", joined(names)));
    if (fs::path(options.machine).is_absolute()) return options.machine;
    const fs::path folder =
        options.file == "-" ? fs::current_path() : fs::absolute(options.file).parent_path();
    return fs::proximate(fs::absolute(options.machine), folder, failed).string();
}

double length_of(const std::string& option, const std::string& text) {
    try {
        const double value = parse_quantity(text, "length");
        if (value > 0) return value;
    } catch (const std::invalid_argument& error) {
        throw Failure(ExitCode::usage, fmt::format("init: {} '{}': {}", option, text, error.what()),
                      fmt::format("for example {} '40 um'", option));
    }
    throw Failure(ExitCode::usage, fmt::format("init: {} '{}' must be > 0", option, text));
}

/// "20 um, 35 um, 55 um": D10, D50, D90.
std::optional<GrainSizes> sizes_of(const std::string& option, const std::string& text) {
    if (text.empty()) return {};
    std::vector<double> values;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) values.push_back(length_of(option, part));
    if (values.size() != 3 || !(values[0] < values[1] && values[1] < values[2]))
        throw Failure(ExitCode::usage, fmt::format("init: {} '{}': needs D10 < D50 < D90", option, text),
                      fmt::format("for example {} '20 um, 35 um, 55 um'", option));
    return GrainSizes{values[0], values[1], values[2]};
}

/// All at once, each with its mend; the first one's exit code.
void refuse_all(const std::vector<Failure>& problems) {
    if (problems.empty()) return;
    if (problems.size() == 1) throw problems.front();
    std::string text = fmt::format("{} problems:", problems.size());
    for (const Failure& problem : problems) {
        text += "\n  " + problem.message;
        if (!problem.mend.empty()) text += "\n    " + problem.mend;
    }
    throw Failure(problems.front().code, text);
}

ExitCode run_init(const InitOptions& options, const CommonOptions& common) {
    DraftOptions draft;
    std::vector<Failure> problems;
    const auto tried = [&problems](const auto& step) {
        try {
            step();
        } catch (const Failure& failure) {
            problems.push_back(failure);
        }
    };
    tried([&] { draft.machine = machine_of(options); });
    const std::vector<std::string> powders = powder_names();
    for (const int i : {0, 1}) {
        tried([&] {
            check_name(i == 0 ? "--powder-a" : "--powder-b", options.powder[i], "material of the table",
                       powders);
        });
        tried([&] { draft.size[i] = sizes_of(i == 0 ? "--size-a" : "--size-b", options.size[i]); });
    }
    draft.powder = options.powder;
    tried([&] {
        check_name("--target", options.target, "shape of a target that init writes",
                   {kDraftTargets.begin(), kDraftTargets.end()});
    });
    draft.target = options.target;
    tried([&] {
        if (!options.layer.empty()) draft.layer_thickness = length_of("--layer", options.layer);
    });
    refuse_all(problems);
    const bool to_stdout = options.file == "-";
    draft.file = to_stdout ? "" : options.file;
    draft.name = options.name;
    if (draft.name.empty() && to_stdout)
        draft.name = fmt::format("{} and {} on {}", draft.powder[0], draft.powder[1], options.machine);

    std::error_code ignored;
    if (!to_stdout && fs::is_directory(options.file, ignored))
        throw Failure(ExitCode::io, fmt::format("init: '{}' is a folder", options.file),
                      "name the study file to write, such as my_study.toml");
    if (!to_stdout && fs::exists(options.file, ignored) && !common.force)
        throw Failure(ExitCode::usage, fmt::format("init: '{}' is there already", options.file),
                      "name another file, or add --force to overwrite it");
    const StudyDraft study = draft_study(draft);
    if (!to_stdout) writing(options.file, [&] { return write_file(options.file, study.text), options.file; });
    if (common.json) {
        nlohmann::json object = {{"file", to_stdout ? nlohmann::json(nullptr) : nlohmann::json(options.file)},
                                 {"machine", draft.machine},
                                 {"machine_title", study.machine_title},
                                 {"powders", {{"A", options.powder[0]}, {"B", options.powder[1]}}},
                                 {"target", options.target},
                                 {"scale_up", study.scale_up},
                                 {"measure", study.measure}};
        if (to_stdout) object["text"] = study.text;
        fmt::print("{}\n", json_text(object));
    } else if (to_stdout) {
        fmt::print("{}", study.text);
    } else if (!common.quiet) {
        fmt::print("{}: {} and {} on {}{}\n{} values say \"measure this\". Next:\n  gradwright check {}\n",
                   options.file, options.powder[0], options.powder[1], study.machine_title,
                   study.scale_up ? ", extrapolated from strips ([scale_up])" : "", study.measure.size(),
                   options.file);
    }
    return ExitCode::met;
}

}  // namespace

void add_init(CLI::App& app, Call& call) {
    auto options = std::make_shared<InitOptions>();
    CLI::App* verb =
        app.add_subcommand("init", "Write a commented study of a machine and two powders, to start from");
    verb->add_option("STUDY", options->file, "Study file to write (TOML); - is stdout")->required();
    verb->add_option("--machine", options->machine,
                     "A shipped machine ('gradwright machines') or a machine file ending in .toml")
        ->type_name("NAME|FILE");
    verb->add_option("--powder-a", options->powder[0], "Material of powder A ('gradwright materials')")
        ->type_name("NAME");
    verb->add_option("--powder-b", options->powder[1], "Material of powder B")->type_name("NAME");
    verb->add_option("--size-a", options->size[0], "D10, D50 and D90 of powder A, e.g. '20 um, 35 um, 55 um'")
        ->type_name("SIZES")
        ->delimiter('\0');
    verb->add_option("--size-b", options->size[1], "The same of powder B; default as powder A")
        ->type_name("SIZES")
        ->delimiter('\0');
    verb->add_option("--target", options->target,
                     fmt::format("{}; linear is the default", fmt::join(kDraftTargets, " | ")))
        ->type_name("SHAPE");
    verb->add_option("--layer", options->layer, "Layer thickness, e.g. '30 um'; default 40 um")
        ->type_name("LENGTH");
    verb->add_option("--name", options->name, "Name of the study; default the file's name")
        ->type_name("TEXT");
    verb->add_flag("--force", call.options.force, "Overwrite a file that is there");
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_init(*options, call.options); }; });
}

}  // namespace gradwright::cli
