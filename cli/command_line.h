// The command line as data, read off the program's own parser: what completion scripts and the man page are
// made of, so that neither can tell of an option that is not there.
#pragma once
#include <string>
#include <vector>

#include "cli/common.h"

namespace gradwright::cli {

/// What a word may be completed to.
enum class Words { none, study, folder, file, verb, choice };

struct CommandOption {
    std::vector<std::string> names;  ///< "--out", "-o"; empty for a positional
    std::string value;               ///< "OUT"; empty for a flag
    std::string description;
    Words words = Words::none;
    std::vector<std::string> choices;  ///< with Words::choice, and beside files: what else is valid
};

struct CommandVerb {
    std::string name, description;
    std::vector<CommandOption> positionals, options;
};

/// Every verb with its options, in the order of the help text.
std::vector<CommandVerb> command_line(const CLI::App& app);

/// Completion script; `shell`: "bash", "zsh" or "fish".
std::string completion_script(const std::vector<CommandVerb>& verbs, const std::string& shell);
/// gradwright.1 in man macros.
std::string manual_page(const std::vector<CommandVerb>& verbs, const std::string& summary,
                        const std::string& version);

}  // namespace gradwright::cli
