// gradwright manual: the man page, made from the program's own help.
#include <fmt/format.h>

#include "cli/command_line.h"
#include "reports/provenance.h"

namespace gradwright::cli {
namespace {

/// Text for troff: no character of it is a command or a typographic mark.
std::string roff(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else if (c == '\'')
            result += "\\(aq";
        else
            result += c == '\n' ? ' ' : c;
    }
    return result.starts_with('.') ? "\\&" + result : result;
}

std::string entry(const std::string& head, const std::string& text) {
    return fmt::format(".TP\n{}\n{}\n", head, roff(text));
}

std::string bold(const std::string& text) {
    return "\\fB" + roff(text) + "\\fR";
}

std::string option_head(const CommandOption& option) {
    if (option.names.empty()) return "\\fI" + roff(option.value) + "\\fR";
    std::string head;
    for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + bold(name);
    return option.value.empty() ? head : head + " \\fI" + roff(option.value) + "\\fR";
}

std::string meaning(ExitCode code) {
    switch (code) {
        case ExitCode::met:
            return "The target is met; for other verbs: done.";
        case ExitCode::internal:
            return "A fault of the program.";
        case ExitCode::usage:
            return "Usage: unknown verb or option, a value that an option does not take, a folder or file "
                   "that "
                   "would be overwritten.";
        case ExitCode::bad_input:
            return "Bad input: every problem is listed with file, line, key, value, rule and how to mend it.";
        case ExitCode::not_met:
            return "It ran to its end, but the verdict is not met, or the plate cannot be built as drawn; "
                   "the "
                   "best result is written.";
        case ExitCode::simulation_failed:
            return "The simulation failed; the message names the reason and the knob to turn.";
        case ExitCode::io:
            return "A file or folder cannot be opened, read or written.";
        case ExitCode::external:
            return "Something external is missing or failed: LAMMPS, OpenCASCADE.";
        case ExitCode::interrupted:
            return "Interrupted by SIGINT or SIGTERM; 'gradwright design --resume OUT' goes on with a "
                   "design.";
    }
    return {};
}

}  // namespace

std::string manual_page(const std::vector<CommandVerb>& verbs, const std::string& summary,
                        const std::string& version) {
    std::string page = "'\\\" made by 'gradwright manual'\n";
    page += fmt::format(".TH GRADWRIGHT 1 \"\" \"gradwright {}\" \"User Commands\"\n", roff(version));
    page += ".SH NAME\ngradwright \\- partitions of powder dispensers for graded parts\n";
    page += ".SH SYNOPSIS\n.B gradwright\n.I VERB\n.RI [ OPTION ...]\n";
    page += ".SH DESCRIPTION\n" + roff(summary) + "\n";
    page += ".PP\n" +
            roff(
                "Data goes to stdout, progress and messages to stderr. A study is a TOML file; "
                "'gradwright init' writes one, 'gradwright check' reads one and tells every value, its "
                "origin and what it will cost.") +
            "\n";
    page += ".SH VERBS\n";
    for (const CommandVerb& verb : verbs) {
        std::string usage = verb.name;
        for (const CommandOption& positional : verb.positionals) usage += " " + positional.value;
        page += fmt::format(".SS {}\n{}\n", roff(usage), roff(verb.description));
        for (const CommandOption& positional : verb.positionals)
            page += entry(option_head(positional), positional.description);
        for (const CommandOption& option : verb.options)
            page += entry(option_head(option), option.description);
    }
    page += ".SH EXIT STATUS\n";
    for (const ExitCode code :
         {ExitCode::met, ExitCode::internal, ExitCode::usage, ExitCode::bad_input, ExitCode::not_met,
          ExitCode::simulation_failed, ExitCode::io, ExitCode::external, ExitCode::interrupted})
        page += entry(bold(fmt::format("{}", static_cast<int>(code))), meaning(code));
    page += ".SH ENVIRONMENT\n";
    page += entry(bold("GRADWRIGHT_DATA"), "Folder of the shipped machines and materials.");
    page += entry(bold("OMP_NUM_THREADS"), "Threads, where --threads does not say.");
    page += entry(bold("XDG_CACHE_HOME"), "Settled beds are kept in gradwright/ under it; default ~/.cache.");
    page += entry(bold("NO_COLOR"), "No colour on a terminal.");
    page += ".SH EXAMPLES\n";
    for (const char* line :
         {"gradwright init first.toml --machine coupon-rig --powder-a 316L --powder-b CuCrZr",
          "gradwright check first.toml", "gradwright design first.toml --out first"})
        page += fmt::format(".PP\n.EX\n{}\n.EE\n", roff(line));
    return page;
}

void add_manual(CLI::App& app, Call& call) {
    CLI::App* verb = app.add_subcommand("manual", "The man page, for man -l -");
    verb->callback([&app, &call] {
        call.run = [&app] {
            fmt::print("{}", manual_page(command_line(app), app.get_description(),
                                         provenance_json().value("version", std::string("unknown"))));
            return ExitCode::met;
        };
    });
}

}  // namespace gradwright::cli
