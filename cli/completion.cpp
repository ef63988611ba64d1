// gradwright completion: scripts that complete verbs, options, their values and file names in bash, zsh,
// fish.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command_line.h"

namespace gradwright::cli {
namespace {

std::string spaced(const std::vector<std::string>& words) {
    std::string result;
    for (const std::string& word : words) result += (result.empty() ? "" : " ") + word;
    return result;
}

std::string names_of(const std::vector<CommandVerb>& verbs) {
    std::vector<std::string> names;
    for (const CommandVerb& verb : verbs) names.push_back(verb.name);
    return spaced(names);
}

/// One description as a single-quoted word: no quotes inside, in zsh no brackets or colons.
std::string plain(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\'' || c == '`'; }, '"');
    return text;
}

std::string bash_reply(const CommandOption& option, const std::vector<CommandVerb>& verbs) {
    std::string reply;
    if (!option.choices.empty()) reply += fmt::format("_gradwright_words '{}'; ", spaced(option.choices));
    if (option.words == Words::verb) reply += fmt::format("_gradwright_words '{}'; ", names_of(verbs));
    if (option.words == Words::study) reply += "_gradwright_files '*.toml'; ";
    if (option.words == Words::file) reply += "_gradwright_files '*'; ";
    if (option.words == Words::folder) reply += "_gradwright_folders; ";
    return reply.empty() ? ": " : reply;
}

std::string bash_script(const std::vector<CommandVerb>& verbs) {
    std::string text = R"(# bash completion of gradwright; made by 'gradwright completion bash'
_gradwright_add() {
    local line
    while IFS= read -r line; do COMPREPLY+=("$line"); done
}
_gradwright_words() { _gradwright_add < <(compgen -W "$1" -- "$word"); }
_gradwright_folders() {
    compopt -o filenames 2>/dev/null
    _gradwright_add < <(compgen -d -- "$word")
}
_gradwright_files() {
    compopt -o filenames 2>/dev/null
    _gradwright_add < <(compgen -d -- "$word"; compgen -f -X "!$1" -- "$word" | while IFS= read -r one; do [ -d "$one" ] || printf '%s\n' "$one"; done)
}
_gradwright() {
    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" verb="${COMP_WORDS[1]}"
    COMPREPLY=()
    if [ "$COMP_CWORD" = 1 ]; then
)";
    text += fmt::format("        _gradwright_words '{} --help --version'\n        return\n    fi\n",
                        names_of(verbs));
    text += "    case \"$verb $before\" in\n";
    for (const CommandVerb& verb : verbs)
        for (const CommandOption& option : verb.options) {
            if (option.value.empty()) continue;
            std::string pattern;
            for (const std::string& name : option.names)
                pattern += fmt::format("{}'{} {}'", pattern.empty() ? "" : " | ", verb.name, name);
            text += fmt::format("        {}) {}return ;;\n", pattern,
                                bash_reply(option, verbs) + (bash_reply(option, verbs) == ": " ? "; " : ""));
        }
    text += "    esac\n    case \"$verb\" in\n";
    for (const CommandVerb& verb : verbs) {
        std::vector<std::string> names;
        for (const CommandOption& option : verb.options)
            names.insert(names.end(), option.names.begin(), option.names.end());
        text += fmt::format(
            "        {})\n            case \"$word\" in\n                -*) _gradwright_words '{}' ;;\n",
            verb.name, spaced(names));
        std::string replies;
        for (const CommandOption& positional : verb.positionals) {
            const std::string reply = bash_reply(positional, verbs);
            if (reply != ": " && replies.find(reply) == std::string::npos) replies += reply;
        }
        text += fmt::format("                *) {};;\n            esac\n            ;;\n",
                            replies.empty() ? "" : replies);
    }
    text += "    esac\n}\ncomplete -F _gradwright gradwright\n";
    return text;
}

/// A description inside the brackets of zsh's _arguments.
std::string zsh_plain(const std::string& text) {
    std::string result;
    for (const char c : plain(text)) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

std::string zsh_action(const CommandOption& option, const std::vector<CommandVerb>& verbs) {
    switch (option.words) {
        case Words::study:
            return option.choices.empty()
                       ? "_files -g \"*.toml(-.)\""
                       : fmt::format("{{compadd {}; _files -g \"*.toml(-.)\"}}", spaced(option.choices));
        case Words::file:
            return "_files";
        case Words::folder:
            return "_files -/";
        case Words::verb:
            return fmt::format("({})", names_of(verbs));
        case Words::choice:
            return fmt::format("({})", spaced(option.choices));
        case Words::none:
            break;
    }
    return " ";
}

std::string zsh_script(const std::vector<CommandVerb>& verbs) {
    std::string text =
        "#compdef gradwright\n# made by 'gradwright completion zsh'\n_gradwright() {\n    local -a verbs=(\n";
    for (const CommandVerb& verb : verbs)
        text += fmt::format("        '{}:{}'\n", verb.name, zsh_plain(verb.description));
    text += R"(    )
    if (( CURRENT == 2 )); then
        _describe verb verbs
        return
    fi
    local verb=${words[2]}
    shift words
    (( CURRENT-- ))
    case $verb in
)";
    for (const CommandVerb& verb : verbs) {
        text += fmt::format("        {})\n            _arguments", verb.name);
        for (const CommandOption& option : verb.options)
            for (const std::string& name : option.names)
                text += fmt::format(" \\\n                '*{}[{}]{}'", name, zsh_plain(option.description),
                                    option.value.empty() ? ""
                                                         : fmt::format(":{}:{}", zsh_plain(option.value),
                                                                       zsh_action(option, verbs)));
        for (const CommandOption& positional : verb.positionals)
            text += fmt::format(" \\\n                '*:{}:{}'", zsh_plain(positional.value),
                                zsh_action(positional, verbs));
        text += "\n            ;;\n";
    }
    text += "    esac\n}\n_gradwright \"$@\"\n";
    return text;
}

std::string fish_script(const std::vector<CommandVerb>& verbs) {
    std::string text =
        "# fish completion of gradwright; made by 'gradwright completion fish'\ncomplete -c gradwright -f\n";
    const auto quoted = [](const std::string& words) { return "'" + plain(words) + "'"; };
    for (const CommandVerb& verb : verbs)
        text += fmt::format("complete -c gradwright -n __fish_use_subcommand -a {} -d {}\n", verb.name,
                            quoted(verb.description));
    const auto words = [&](const CommandOption& option) -> std::string {
        switch (option.words) {
            case Words::study:
                return " -F" + (option.choices.empty() ? "" : " -a " + quoted(spaced(option.choices)));
            case Words::file:
                return " -F";
            case Words::folder:
                return " -a '(__fish_complete_directories)'";
            case Words::verb:
                return " -a " + quoted(names_of(verbs));
            case Words::choice:
                return " -a " + quoted(spaced(option.choices));
            case Words::none:
                break;
        }
        return "";
    };
    for (const CommandVerb& verb : verbs) {
        const std::string where =
            fmt::format("complete -c gradwright -n '__fish_seen_subcommand_from {}'", verb.name);
        for (const CommandOption& option : verb.options) {
            text += where;
            for (const std::string& name : option.names)
                text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
            if (!option.value.empty()) text += " -r" + words(option);
            text += " -d " + quoted(option.description) + "\n";
        }
        for (const CommandOption& positional : verb.positionals)
            if (positional.words != Words::none) text += where + words(positional) + "\n";
    }
    return text;
}

}  // namespace

std::string completion_script(const std::vector<CommandVerb>& verbs, const std::string& shell) {
    if (shell == "bash") return bash_script(verbs);
    return shell == "zsh" ? zsh_script(verbs) : fish_script(verbs);
}

void add_completion(CLI::App& app, Call& call) {
    auto shell = std::make_shared<std::string>();
    CLI::App* verb =
        app.add_subcommand("completion", "Script that completes verbs, options and files in a shell");
    verb->add_option("SHELL", *shell, "bash | zsh | fish")->required();
    verb->callback([shell, &app, &call] {
        call.run = [shell, &app] {
            const std::vector<std::string> shells = {"bash", "zsh", "fish"};
            if (std::find(shells.begin(), shells.end(), *shell) == shells.end())
                throw Failure(
                    ExitCode::usage,
                    fmt::format("completion: there is none for '{}'{}", *shell, hint(*shell, shells)),
                    "valid: bash, zsh, fish; for bash: gradwright completion bash "
                    ">~/.local/share/bash-completion/completions/gradwright");
            fmt::print("{}", completion_script(command_line(app), *shell));
            return ExitCode::met;
        };
    });
}

}  // namespace gradwright::cli
