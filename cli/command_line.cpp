#include "cli/command_line.h"

#include <algorithm>

namespace gradwright::cli {
namespace {

/// "a | b | c; b is the default" -> a, b, c: the way in which descriptions list the values of an option.
std::vector<std::string> listed_choices(const std::string& description) {
    std::vector<std::string> parts(1);
    for (std::size_t i = 0; i < description.size(); ++i) {
        if (description.compare(i, 3, " | ") == 0) {
            parts.emplace_back();
            i += 2;
        } else {
            parts.back() += description[i];
        }
    }
    std::vector<std::string> choices;
    if (parts.size() < 2) return choices;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string& part = parts[i];
        // the first stands at the end of what comes before the bars, the others at the beginning of theirs
        const auto space = i == 0 ? part.rfind(' ') : part.find_first_of(" ;,");
        choices.push_back(i == 0 ? part.substr(space == std::string::npos ? 0 : space + 1)
                                 : part.substr(0, space));
    }
    return choices;
}

std::vector<std::string> powder_choices() {
    std::vector<std::string> names;
    for (const Material& material : shipped_materials())
        if (material.name != "geometry") names.push_back(material.name);
    return names;
}

CommandOption described(const CLI::Option& option) {
    CommandOption result;
    for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
    for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
    result.description = option.get_description();
    if (option.get_items_expected_max() > 0) {
        // CLI11 adds a validator's range to the type: "N:INT in [1 - 1024]"
        const std::string type = option.get_type_name();
        result.value = type.substr(0, type.find(':'));
    }
    const std::string what = result.names.empty() ? option.get_name(true) : result.value;
    if (what.find("STUDY") != std::string::npos || what.find("FILE") != std::string::npos)
        result.words = what.find("STUDY") != std::string::npos ? Words::study : Words::file;
    else if (what.find("OUT") != std::string::npos || what == "DIR")
        result.words = Words::folder;
    else if (what == "VERB")
        result.words = Words::verb;
    result.choices = listed_choices(result.description);
    if (result.names == std::vector<std::string>{"--machine"}) {
        for (const MachineInfo& machine : shipped_machines()) result.choices.push_back(machine.name);
        result.words = Words::study;
    }
    if (!result.names.empty() && result.names[0].starts_with("--powder-")) result.choices = powder_choices();
    if (!result.choices.empty() && result.words == Words::none) result.words = Words::choice;
    if (result.names.empty()) result.value = option.get_name(true);
    return result;
}

}  // namespace

std::vector<CommandVerb> command_line(const CLI::App& app) {
    std::vector<CommandVerb> verbs;
    for (const CLI::App* verb : app.get_subcommands(nullptr)) {
        CommandVerb one{verb->get_name(), verb->get_description(), {}, {}};
        for (const CLI::Option* option : verb->get_options())
            (option->get_positional() ? one.positionals : one.options).push_back(described(*option));
        for (const CLI::App* inner : verb->get_subcommands(nullptr))
            one.positionals.push_back(
                {{}, inner->get_name(), inner->get_description(), Words::choice, {inner->get_name()}});
        verbs.push_back(std::move(one));
    }
    return verbs;
}

}  // namespace gradwright::cli
