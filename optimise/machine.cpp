#include "optimise/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "optimise/joined.h"
#include "optimise/toml_reader.h"

namespace gradwright {
namespace fs = std::filesystem;
namespace {

std::string string_at(const toml::table& table, const char* key) {
    const toml::node* node = table.get(key);
    return node && node->is_string() ? node->as_string()->get() : "";
}

/// Parses a machine file; throws InputError.
std::shared_ptr<toml::table> parse_machine(const std::string& file) {
    std::ifstream stream(file);
    std::stringstream text;
    text << stream.rdbuf();
    if (!stream) throw InputError{{{file, 0, "", "", "cannot be read", "check the path"}}};
    try {
        return std::make_shared<toml::table>(toml::parse(text.str(), file));
    } catch (const toml::parse_error& error) {
        throw InputError{{{file, static_cast<int>(error.source().begin.line), "", "",
                           "is not valid TOML: " + std::string(error.description()), "mend this line"}}};
    }
}

bool is_number_with_source(const toml::node& node) {
    return node.is_table() && node.as_table()->contains("value");
}

/// Nobody vouches for a number without a source: it is treated as a stand-in.
std::string source_or_stand_in(const std::string& source) {
    return source.empty() ? "no source given: measure this" : source;
}

/// The file's own title, source and notes are no numbers.
bool is_heading(const std::string& prefix, const std::string& name) {
    return prefix.empty() && (name == "title" || name == "source" || name == "notes");
}

void collect_numbers(const toml::table& table, const std::string& prefix, const std::string& source,
                     std::vector<MachineNumber>& numbers) {
    for (const auto& [key, node] : table) {
        const std::string name = prefix + std::string(key.str());
        if (is_heading(prefix, name) || name == "feed") continue;
        if (node.is_table() && !is_number_with_source(node)) {
            collect_numbers(*node.as_table(), name + ".", source, numbers);
            continue;
        }
        const toml::table* entry = node.as_table();
        const std::string own = entry ? string_at(*entry, "source") : source;
        const std::string shown = source_or_stand_in(own);
        numbers.push_back({name, input_text(entry ? *entry->get("value") : node), shown,
                           shown.find(kMeasureThis) == std::string::npos});
    }
}

/// The numbers of a machine file in the order of machine_keys().
std::vector<MachineNumber> numbers_of(const toml::table& table) {
    std::vector<MachineNumber> numbers;
    collect_numbers(table, "", string_at(table, "source"), numbers);
    const auto& keys = machine_keys();
    std::stable_sort(numbers.begin(), numbers.end(), [&keys](const MachineNumber& a, const MachineNumber& b) {
        return std::find(keys.begin(), keys.end(), a.key) < std::find(keys.begin(), keys.end(), b.key);
    });
    return numbers;
}

bool is_path(const std::string& use) {
    return use.size() > 5 && use.ends_with(".toml");
}

/// File of a machine: a shipped name, or a path relative to `folder`.
fs::path file_of(const std::string& use, const fs::path& folder) {
    return is_path(use) ? folder / use : fs::path(data_folder()) / "machines" / (use + ".toml");
}

/// Walks a machine file; `prefix` is "" or "dispenser." ...; `source` holds for numbers that name none of
/// their own.
void supply_table(TomlReader& reader, const toml::table& table, const std::string& prefix,
                  const std::string& file, const std::string& source) {
    for (const auto& [key, node] : table) {
        const std::string name = prefix + std::string(key.str());
        if (is_heading(prefix, name)) continue;
        const int line = static_cast<int>(key.source().begin.line);
        const auto& keys = machine_keys();
        if (node.is_table() && !is_number_with_source(node)) {
            supply_table(reader, *node.as_table(), name + ".", file, source);
        } else if (std::find(keys.begin(), keys.end(), name) == keys.end()) {
            const std::string nearest = nearest_name(name, keys);
            reader.add({file, line, name, "", "is not a known key of a machine",
                        nearest.empty() ? fmt::format("valid: {}", joined(keys))
                                        : fmt::format("did you mean \"{}\"?", nearest)});
        } else if (node.is_table()) {
            const toml::table& entry = *node.as_table();
            for (const auto& [inner, ignored] : entry)
                if (inner.str() != "value" && inner.str() != "source")
                    reader.add({file, line, name + "." + std::string(inner.str()), "", "is not a known key",
                                "a number of a machine has value and source"});
            reader.supply("machine." + name, *entry.get("value"), file,
                          source_or_stand_in(string_at(entry, "source")));
        } else {
            reader.supply("machine." + name, node, file, source_or_stand_in(source));
        }
    }
}

}  // namespace

const std::vector<std::string>& machine_keys() {
    static const std::vector<std::string> keys = {"dispenser.length",
                                                  "dispenser.width",
                                                  "dispenser.depth",
                                                  "platform.length",
                                                  "platform.width",
                                                  "land",
                                                  "second_land",
                                                  "blade.tip_radius",
                                                  "blade.thickness",
                                                  "wall",
                                                  "feed"};
    return keys;
}

std::string data_folder() {
    std::error_code ignored;
    if (const char* folder = std::getenv("GRADWRIGHT_DATA"); folder && *folder) return folder;
    // Installed, the data lie beside the program wherever both were moved to: an older source tree that is
    // still there must not speak for them.
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    const fs::path installed = (program.parent_path() / GRADWRIGHT_DATA_FROM_PROGRAM).lexically_normal();
    if (fs::exists(installed / "materials.toml", ignored)) return installed.string();
    return (fs::path(GRADWRIGHT_SOURCE_DIR) / "examples").string();
}

std::vector<MachineInfo> shipped_machines() {
    std::vector<MachineInfo> machines;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(fs::path(data_folder()) / "machines", failed)) {
        if (entry.path().extension() != ".toml") continue;
        const auto table = parse_machine(entry.path().string());
        machines.push_back({entry.path().stem().string(), string_at(*table, "title"),
                            string_at(*table, "source"), entry.path().string(), numbers_of(*table)});
    }
    std::sort(machines.begin(), machines.end(),
              [](const MachineInfo& a, const MachineInfo& b) { return a.name < b.name; });
    return machines;
}

std::vector<MachineNumber> machine_numbers(const std::string& use, const std::string& folder) {
    return numbers_of(*parse_machine(file_of(use, folder).string()));
}

std::string supply_machine(TomlReader& reader, const std::string& use, const InputProblem& at) {
    const bool path = is_path(use);
    const fs::path file = file_of(use, fs::path(reader.file()).parent_path());
    std::error_code ignored;
    if ((!path && use.find('/') != std::string::npos) || !fs::is_regular_file(file, ignored)) {
        std::vector<std::string> names;
        for (const MachineInfo& machine : shipped_machines()) names.push_back(machine.name);
        const std::string nearest = nearest_name(use, names);
        InputProblem problem = at;
        problem.rule = path ? "there is no such machine file" : "is not a shipped machine";
        problem.mend = nearest.empty()
                           ? fmt::format("shipped: {}; or a path that ends in .toml", joined(names))
                           : fmt::format("did you mean \"{}\"?", nearest);
        reader.add(problem);
        return {};
    }
    try {
        auto table = parse_machine(file.string());
        supply_table(reader, *table, "", file.string(), string_at(*table, "source"));
        const std::string title = string_at(*table, "title");
        reader.keep(std::move(table));
        return title.empty() ? use : title;
    } catch (const InputError& error) {
        for (const InputProblem& problem : error.problems) reader.add(problem);
        return {};
    }
}

}  // namespace gradwright
