// gradwright verify: the verification ladder through the production stepping path, and the page that shows
// it.
#include "cli/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/common.h"
#include "cli/progress.h"
#include "cli/run_options.h"
#include "cli/signals.h"
#include "reports/json_support.h"
#include "reports/safe_write.h"

namespace gradwright::cli {
namespace {

struct VerifyCommand {
    std::vector<std::string> only;
    std::string law = "both";
    std::string mutate;
    std::string docs;
};

const char* law_name(Precision law) {
    return law == Precision::double_law ? "double" : "single";
}

std::vector<std::string> rung_names() {
    std::vector<std::string> names;
    for (const VerificationRung& rung : verification_ladder()) names.push_back(rung.id);
    return names;
}

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
    return out;
}

/// The value of an option must be one of `valid`.
void check_choice(const std::string& option, const std::string& value,
                  const std::vector<std::string>& valid) {
    if (std::find(valid.begin(), valid.end(), value) != valid.end()) return;
    throw Failure(ExitCode::usage, fmt::format("--{} '{}' is not known{}", option, value, hint(value, valid)),
                  fmt::format("one of {}", joined(valid)));
}

const Mutation* mutation_named(const std::string& name) {
    if (name.empty()) return nullptr;
    std::vector<std::string> names;
    for (const Mutation& m : mutations()) {
        if (m.name == name) return &m;
        names.push_back(m.name);
    }
    check_choice("mutate", name, names);
    return nullptr;
}

void write_page(const std::string& folder, const std::vector<VerificationRun>& runs, ProgressLine& progress) {
    const VerificationPage page = verification_page(
        runs, [&progress](const std::string& stage, double fraction) { progress.update(stage, fraction); });
    writing(folder, [&] {
        const auto images = std::filesystem::path(folder) / "images";
        make_folder(images.string());
        for (const auto& [name, svg] : page.images) write_file((images / name).string(), svg);
        write_file((std::filesystem::path(folder) / "verification.md").string(), page.markdown);
    });
}

ExitCode run_verify_command(const VerifyCommand& command, const CommonOptions& common) {
    for (const std::string& rung : command.only) check_choice("only", rung, rung_names());
    check_choice("law", command.law, {"both", "double", "single"});
    const Mutation* mutation = mutation_named(command.mutate);
    if (!command.docs.empty() && (mutation || !command.only.empty() || command.law != "both"))
        throw Failure(ExitCode::usage, "--docs writes the page of the whole ladder as it is",
                      "leave out --only, --law and --mutate");
    std::vector<Precision> laws;
    if (command.law != "single") laws.push_back(Precision::double_law);
    if (command.law != "double") laws.push_back(Precision::single_law);

    ProgressLine progress(common.quiet);
    std::vector<VerificationRung> rungs;
    for (const VerificationRung& rung : verification_ladder())
        if (command.only.empty() ||
            std::find(command.only.begin(), command.only.end(), rung.id) != command.only.end())
            rungs.push_back(rung);
    const std::atomic<bool>& stop = *watch_signals();
    std::vector<VerificationRun> runs;
    double done = 0;
    const double all = static_cast<double>(rungs.size() * laws.size());
    for (const Precision law : laws) {
        VerificationOptions options;
        options.precision = law;
        if (mutation) options.fault = mutation->fault;
        runs.push_back({law, {}});
        for (const VerificationRung& rung : rungs) {
            if (stop.load()) break;
            progress.update(fmt::format("{}, {} law", rung.id, law_name(law)), done++ / all);
            const VerificationCases cases = rung.run(options);
            runs.back().cases.insert(runs.back().cases.end(), cases.begin(), cases.end());
            if (common.json) continue;
            progress.finish();
            fmt::print("{}", rung_text(rung, law, cases, common.quiet));
            std::fflush(stdout);
        }
    }
    std::size_t failed = 0;
    for (const VerificationRun& run : runs)
        failed += static_cast<std::size_t>(
            std::count_if(run.cases.begin(), run.cases.end(), [](const auto& c) { return !c.pass; }));
    if (!command.docs.empty() && !stop.load()) write_page(command.docs, runs, progress);
    progress.finish();
    if (common.json)
        fmt::print("{}\n", json_text(verify_json(runs, command.mutate)));
    else
        fmt::print("{}", verify_summary(runs, mutation));
    if (stop.load()) return ExitCode::interrupted;  // the rungs that were finished stand above
    return failed == 0 ? ExitCode::met : ExitCode::not_met;
}

}  // namespace

nlohmann::json verify_json(const std::vector<VerificationRun>& runs, const std::string& mutation) {
    auto cases = nlohmann::json::array();
    std::size_t passed = 0;
    for (const VerificationRun& run : runs)
        for (const VerificationCase& c : run.cases) {
            passed += c.pass;
            cases.push_back({{"id", c.id},
                             {"name", c.name},
                             {"quantity", c.quantity},
                             {"expected", number(c.expected)},
                             {"obtained", number(c.obtained)},
                             {"error", number(c.error)},
                             {"tolerance", number(c.tolerance)},
                             {"pass", c.pass},
                             {"source", c.source},
                             {"law", law_name(run.precision)}});
        }
    const std::size_t all = cases.size();
    return {{"cases", cases},
            {"passed", passed},
            {"failed", all - passed},
            {"mutation", mutation.empty() ? nlohmann::json(nullptr) : nlohmann::json(mutation)}};
}

std::string rung_text(const VerificationRung& rung, Precision law, const VerificationCases& cases,
                      bool only_red) {
    std::string rows;
    for (const VerificationCase& c : cases) {
        if (only_red && c.pass) continue;
        rows +=
            fmt::format("  {} {:>13.6g} {:>13.6g} {:>9.2g} {:>9.2g}  {}: {} ({})\n", c.pass ? "ok " : "RED",
                        c.expected, c.obtained, c.error, c.tolerance, c.name, c.quantity, c.source);
    }
    if (only_red && rows.empty()) return {};
    return fmt::format("{}: {} ({} law)\n      {:>13} {:>13} {:>9} {:>9}  case: quantity (source)\n{}\n",
                       rung.id, rung.claim, law_name(law), "expected", "obtained", "error", "tolerance",
                       rows);
}

std::string verify_summary(const std::vector<VerificationRun>& runs, const Mutation* mutation) {
    std::size_t all = 0, passed = 0;
    std::vector<std::string> red, ran;
    auto note = [](std::vector<std::string>& list, const std::string& id) {
        if (std::find(list.begin(), list.end(), id) == list.end()) list.push_back(id);
    };
    for (const VerificationRun& run : runs)
        for (const VerificationCase& c : run.cases) {
            ++all;
            passed += c.pass;
            note(ran, c.id);
            if (!c.pass) note(red, c.id);
        }
    std::string out = fmt::format("{} of {} cases pass", passed, all);
    if (passed < all) out += fmt::format("; {} red, in {}", all - passed, joined(red));
    out += "\n";
    if (!mutation) return out;
    out += fmt::format("The law was broken on purpose: {}.\n", mutation->fault_text);
    std::vector<std::string> blind;
    for (const std::string& id : mutation->red)
        if (std::find(ran.begin(), ran.end(), id) != ran.end() &&
            std::find(red.begin(), red.end(), id) == red.end())
            blind.push_back(id);
    out += blind.empty() ? "Every rung run that must see it does.\n"
                         : fmt::format("It goes UNSEEN by {}, which must see it.\n", joined(blind));
    return out;
}

void add_verify(CLI::App& app, Call& call) {
    auto command = std::make_shared<VerifyCommand>();
    CLI::App* verb =
        app.add_subcommand("verify", "The contact law and the engine against formulas and published values");
    verb->add_option("--only", command->only,
                     fmt::format("One rung of the ladder ({}); may be repeated", joined(rung_names())))
        ->type_name("RUNG")
        ->allow_extra_args(false);
    verb->add_option("--law", command->law,
                     "Number type of the law: double, single (what spreads use) or both; default both")
        ->type_name("LAW");
    std::vector<std::string> faults;
    for (const Mutation& m : mutations()) faults.push_back(m.name);
    verb->add_option("--mutate", command->mutate,
                     fmt::format("Break the law on purpose ({}): cases must turn red", joined(faults)))
        ->type_name("FAULT");
    verb->add_option("--docs", command->docs,
                     "Write verification.md and its plots (images/) into this folder")
        ->type_name("DIR");
    add_output_options(*verb, call.options);
    verb->callback([command, &call] {
        call.run = [command, &call] { return run_verify_command(*command, call.options); };
    });
}

}  // namespace gradwright::cli
