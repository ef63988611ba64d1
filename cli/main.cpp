// gradwright: the front door. Parses the command line, calls one verb, maps every failure to a message and an
// exit code.
#include <fmt/format.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "cli/common.h"
#include "optimise/lammps_run.h"
#include "reports/provenance.h"

namespace gradwright::cli {
namespace {

constexpr const char* kExitCodes = R"(Exit codes:
  0 target met, or done      1 internal fault       2 usage        3 bad input
  4 ran, verdict not 'met'   5 simulation failed    6 file access  7 external engine missing or failed
  130 interrupted

'gradwright help VERB' lists a verb's options. The launcher adds: ./gradwright test | format | clean.)";

/// Prints a failure for people on stderr and, with --json, for machines on stdout.
int report_failure(bool json, ExitCode code, const std::string& message, const std::string& mend = {},
                   const std::vector<InputProblem>& problems = {}) {
    std::fflush(stdout);
    const bool colour = colour_allowed(STDERR_FILENO);
    fmt::print(stderr, "{}gradwright: {}{}\n", colour ? "\033[1;31m" : "", message, colour ? "\033[0m" : "");
    for (const InputProblem& problem : problems) fmt::print(stderr, "  {}\n", problem.text());
    if (!mend.empty()) fmt::print(stderr, "  {}\n", mend);
    if (json) fmt::print("{}\n", json_text(error_json(code, message, mend, problems)));
    return static_cast<int>(code);
}

void print_version(bool json) {
    const nlohmann::json facts = provenance_json();
    if (json) {
        fmt::print("{}\n", json_text(facts));
        return;
    }
    const auto text = [&facts](const char* key) { return facts.value(key, std::string("unknown")); };
    fmt::print("gradwright {} ({}; {}; {})\n", text("version"), text("source"), text("compiler"),
               text("instruction_set"));
}

std::vector<std::string> verb_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* verb : app.get_subcommands(nullptr)) names.push_back(verb->get_name());
    return names;
}

CLI::App* find_verb(CLI::App& app, const std::string& name) {
    for (CLI::App* verb : app.get_subcommands(nullptr))
        if (verb->get_name() == name) return verb;
    return nullptr;
}

std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// First argument that looks like an option and that the verb does not know.
std::string unknown_option(const CLI::App& app, const std::vector<std::string>& arguments) {
    for (const std::string& argument : arguments) {
        if (argument == "--") break;
        if (argument.size() < 2 || argument[0] != '-' ||
            std::isdigit(static_cast<unsigned char>(argument[1])))
            continue;
        const std::string name = argument.substr(0, argument.find('='));
        const bool short_name = name[1] != '-';
        if (!app.get_option_no_throw(short_name ? name.substr(0, 2) : name)) return name;
    }
    return {};
}

int run(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    // Known before parsing, because a usage error must be told in JSON too.
    bool json = false;
    for (const std::string& argument : arguments) json = json || argument == "--json";

    Call call;
    CLI::App app(
        "Given a machine, two powders and a target gradation: finds the dispenser partition that spreads it.",
        "gradwright");
    app.set_help_flag("-h,--help", "This text");
    app.footer(kExitCodes);
    app.require_subcommand(0, 1);
    app.get_formatter()->column_width(34);
    bool version = false;
    app.add_flag("--version", version, "Version, source, compiler, instruction set");
    add_init(app, call);
    add_design(app, call);
    add_compare(app, call);
    add_evaluate(app, call);
    add_check(app, call);
    add_sensitivity(app, call);
    add_spec(app, call);
    add_report(app, call);
    add_status(app, call);
    add_crosscheck(app, call);
    add_tradeoff(app, call);
    add_reach(app, call);
    add_bench(app, call);
    add_verify(app, call);
    add_bulk(app, call);
    add_limits(app, call);
    add_materials(app, call);
    add_machines(app, call);
    add_completion(app, call);
    add_manual(app, call);
    CLI::App* version_verb = app.add_subcommand("version", "Version, source, compiler, instruction set");
    add_output_options(*version_verb, call.options);
    CLI::App* help_verb = app.add_subcommand("help", "This text, or the options of a verb");
    std::string help_topic;
    help_verb->add_option("VERB", help_topic, "The verb in question");

    // Taken before parsing: afterwards CLI11 hands the call on to the verb that was found.
    const std::string all_help = app.help();
    const auto verb_help = [](const CLI::App& one) { return one.help("gradwright"); };
    const std::string hint_to_help = "'gradwright help' lists the verbs";
    std::error_code ignored;
    if (!arguments.empty() && !find_verb(app, arguments[0]) && std::filesystem::exists(arguments[0], ignored))
        return report_failure(
            json, ExitCode::usage, fmt::format("'{}' is a file or folder, not a verb", arguments[0]),
            fmt::format("say what to do with it first: 'gradwright check {0}', 'gradwright design {0}'; {1}",
                        arguments[0], hint_to_help));
    if (!arguments.empty() && !arguments[0].empty() && arguments[0][0] == '-') {
        const std::string unknown = unknown_option(app, {arguments[0]});
        if (!unknown.empty())
            return report_failure(json, ExitCode::usage,
                                  fmt::format("unknown option '{}' in the place of the verb{}", unknown,
                                              hint(unknown, option_names(app))),
                                  "options follow the verb; " + hint_to_help);
    }
    if (!arguments.empty() && !arguments[0].empty() && arguments[0][0] != '-' &&
        !find_verb(app, arguments[0]))
        return report_failure(
            json, ExitCode::usage,
            fmt::format("unknown verb '{}'{}", arguments[0], hint(arguments[0], verb_names(app))),
            hint_to_help);
    CLI::App* verb = arguments.empty() ? nullptr : find_verb(app, arguments[0]);
    if (verb) {
        const std::string unknown = unknown_option(*verb, {arguments.begin() + 1, arguments.end()});
        if (!unknown.empty())
            return report_failure(json, ExitCode::usage,
                                  fmt::format("{}: unknown option '{}'{}", verb->get_name(), unknown,
                                              hint(unknown, option_names(*verb))),
                                  fmt::format("'gradwright help {}' lists its options", verb->get_name()));
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", verb ? verb_help(*verb) : all_help);
        return 0;
    } catch (const CLI::ParseError& error) {
        return report_failure(
            json, ExitCode::usage, fmt::format("{}{}", verb ? verb->get_name() + ": " : "", error.what()),
            verb ? fmt::format("'gradwright help {}' lists its options", verb->get_name()) : hint_to_help);
    }
    if (version || version_verb->parsed()) {
        print_version(json);
        return 0;
    }
    if (help_verb->parsed() && !help_topic.empty()) {
        const CLI::App* topic = find_verb(app, help_topic);
        if (!topic)
            return report_failure(
                json, ExitCode::usage,
                fmt::format("unknown verb '{}'{}", help_topic, hint(help_topic, verb_names(app))),
                hint_to_help);
        fmt::print("{}", verb_help(*topic));
        return 0;
    }
    if (help_verb->parsed()) {
        fmt::print("{}", all_help);
        return 0;
    }
    if (!call.run) {
        fmt::print(stderr, "{}", all_help);
        return static_cast<int>(ExitCode::usage);
    }

    try {
        const int code = static_cast<int>(call.run());
        if (std::fflush(stdout) != 0 || std::ferror(stdout))
            return report_failure(false, ExitCode::io, "the output could not be written to stdout",
                                  "is the disk full, or the reader of the pipe gone?");
        return code;
    } catch (const InputError& error) {
        const std::size_t count = error.problems.size();
        return report_failure(json, ExitCode::bad_input,
                              fmt::format("{} problem{} in the input", count, count == 1 ? "" : "s"), {},
                              error.problems);
    } catch (const Failure& failure) {
        return report_failure(json, failure.code, failure.message, failure.mend);
    } catch (const LammpsError& error) {
        return report_failure(json, ExitCode::external, error.message, error.mend);
    } catch (const std::filesystem::filesystem_error& error) {
        return report_failure(json, ExitCode::io, error.what(),
                              "check the path, its rights and the free space");
    } catch (const std::bad_alloc&) {
        return report_failure(json, ExitCode::internal, "out of memory",
                              "'gradwright check STUDY' tells how much a study needs: make it smaller");
    } catch (const std::exception& error) {
        return report_failure(json, ExitCode::internal, error.what(),
                              "this should not happen: report it with the command line and the study");
    }
}

}  // namespace
}  // namespace gradwright::cli

int main(int argc, char** argv) {
#ifdef __GLIBC__
    // Lists of pairs are made anew many times a second: what they leave is kept for the next ones instead of
    // going back to the system page by page. The strip of the first example, one thread: 26.7 to 26.3 s, at
    // 65 instead of 48 MB.
    mallopt(M_MMAP_THRESHOLD, 1 << 28);
    mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
    return gradwright::cli::run(argc, argv);
}
