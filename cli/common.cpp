#include "cli/common.h"

#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace gradwright::cli {

namespace fs = std::filesystem;

const char* to_string(ExitCode code) {
    switch (code) {
        case ExitCode::met:
            return "met";
        case ExitCode::internal:
            return "internal";
        case ExitCode::usage:
            return "usage";
        case ExitCode::bad_input:
            return "bad_input";
        case ExitCode::not_met:
            return "not_met";
        case ExitCode::simulation_failed:
            return "simulation_failed";
        case ExitCode::io:
            return "io";
        case ExitCode::external:
            return "external";
        case ExitCode::interrupted:
            return "interrupted";
    }
    return "internal";
}

void add_output_options(CLI::App& verb, CommonOptions& options) {
    verb.add_flag("--json", options.json, "One JSON object on stdout instead of text");
    verb.add_flag("-q,--quiet", options.quiet, "No progress and no chatter; errors are still printed");
    verb.add_flag("-v,--verbose", options.verbose, "Say more: stages, folders, timings");
}

void add_study_options(CLI::App& verb, CommonOptions& options) {
    verb.add_option(
            "--set", options.set,
            "Replace one value of the study, e.g. --set 'process.blade_speed=\"50 mm/s\"'; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    verb.add_option("--seed", options.seed,
                    "Seed of packing and statistics, instead of the study's [run] seed")
        ->type_name("N");
}

void add_run_options(CLI::App& verb, CommonOptions& options) {
    verb.add_option("--threads", options.threads, "Threads; default OMP_NUM_THREADS, else every core")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    verb.add_option("--cache", options.cache,
                    "Folder of settled beds; default under XDG_CACHE_HOME or ~/.cache; 'none' for no cache")
        ->type_name("DIR");
}

void add_out_options(CLI::App& verb, CommonOptions& options) {
    verb.add_option("-o,--out", options.out, "Folder for the results")->type_name("OUT");
    verb.add_flag("--force", options.force, "Write into a folder that already has something in it");
}

std::string hint(const std::string& word, const std::vector<std::string>& valid) {
    const std::string name = nearest_name(word, valid);
    return name.empty() ? std::string() : fmt::format(" (did you mean '{}'?)", name);
}

void refuse_scale_up(const Study& study, const std::string& what) {
    if (study.scale_up.on())
        throw Failure(
            ExitCode::bad_input,
            fmt::format(
                "{} would spread the whole machine of '{}', which its [scale_up] has extrapolated from "
                "strips",
                what, study.file),
            "it has 'check', 'design' and 'evaluate --fidelity map' or 'kinematic'; leave [scale_up] out to "
            "spread it all the same");
}

Study load_study(const std::string& file, const CommonOptions& options) {
    std::error_code ignored;
    const fs::path path(file);
    if (fs::is_directory(path, ignored))
        throw Failure(ExitCode::io, fmt::format("'{}' is a folder, not a study file", file),
                      "name the .toml file inside it");
    errno = 0;
    if (!std::ifstream(path)) {
        const std::string reason = errno ? std::strerror(errno) : "cannot be opened";
        std::vector<std::string> neighbours;
        const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
        for (const auto& entry : fs::directory_iterator(folder, ignored))
            if (entry.path().extension() == ".toml") neighbours.push_back(entry.path().filename().string());
        std::sort(neighbours.begin(), neighbours.end());
        throw Failure(ExitCode::io,
                      fmt::format("cannot open the study file '{}': {}{}", file, reason,
                                  hint(path.filename().string(), neighbours)),
                      "check the path; shipped studies are in examples/");
    }
    for (const std::string& one : options.set)
        if (one.find('=') == std::string::npos || one.front() == '=')
            throw Failure(ExitCode::usage, fmt::format("--set {}: expected KEY=VALUE", one),
                          "for example --set process.layer_thickness='\"50 um\"'");
    std::vector<std::string> overrides = options.set;
    if (options.seed) overrides.push_back(fmt::format("run.seed={}", *options.seed));
    return read_study(file, overrides);
}

std::string cache_folder(const CommonOptions& options) {
    if (options.cache == "none") return {};
    fs::path folder = options.cache;
    if (folder.empty()) {
        const char* base = std::getenv("XDG_CACHE_HOME");
        const char* home = std::getenv("HOME");
        if (base && *base)
            folder = fs::path(base) / "gradwright";
        else if (home && *home)
            folder = fs::path(home) / ".cache" / "gradwright";
        else
            return {};
    }
    std::error_code failed;
    fs::create_directories(folder, failed);
    const bool usable = !failed && access(folder.c_str(), W_OK) == 0;
    if (usable) return folder.string();
    const std::string reason = failed ? failed.message() : "not writable";
    // A folder that the user named must work; the default one is a convenience, and a run is sound without
    // it.
    if (!options.cache.empty())
        throw Failure(ExitCode::io,
                      fmt::format("cannot use the cache folder '{}': {}", folder.string(), reason),
                      "name another with --cache DIR, or --cache none");
    if (!options.quiet)
        fmt::print(stderr, "gradwright: no cache: '{}': {}; name another with --cache DIR\n", folder.string(),
                   reason);
    return {};
}

int thread_count(const CommonOptions& options) {
    return options.threads > 0 ? options.threads : std::max(1, omp_get_max_threads());
}

namespace {

/// A study's name as a folder's: letters, digits, '.', '_', '-'; never hidden, never a way out of the folder.
std::string folder_name(const std::string& name) {
    std::string result;
    for (const char c : name)
        result += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' ? c : '_';
    if (result.empty() || result[0] == '.') result = "study" + result;
    return result;
}

}  // namespace

std::string make_out_folder(const CommonOptions& options, const std::string& name) {
    std::error_code failed;
    if (options.out.empty()) {
        const fs::path base = fs::path("runs") / folder_name(name);
        fs::create_directories(base, failed);
        if (failed)
            throw Failure(ExitCode::io,
                          fmt::format("cannot make the folder '{}': {}", base.string(), failed.message()),
                          "name another with --out");
        for (int n = 1;; ++n) {
            const fs::path folder = base / std::to_string(n);
            // create_directory is true for the one call that made it: two runs at a time never share a folder
            if (fs::create_directory(folder, failed)) return folder.string();
            if (failed)
                throw Failure(
                    ExitCode::io,
                    fmt::format("cannot make the folder '{}': {}", folder.string(), failed.message()),
                    "name another with --out");
        }
    }
    const fs::path folder(options.out);
    if (fs::exists(folder, failed) && !fs::is_directory(folder, failed))
        throw Failure(ExitCode::io, fmt::format("--out '{}' is a file, not a folder", options.out),
                      "name a folder with --out");
    if (fs::is_directory(folder, failed) && !fs::is_empty(folder, failed) && !failed && !options.force)
        throw Failure(ExitCode::usage,
                      fmt::format("the folder '{}' already has something in it", options.out),
                      "name another with --out, or add --force to overwrite results in it");
    fs::create_directories(folder, failed);
    if (failed || access(folder.c_str(), W_OK) != 0)
        throw Failure(ExitCode::io,
                      fmt::format("cannot write to the folder '{}': {}", options.out,
                                  failed ? failed.message() : std::strerror(errno)),
                      "name another with --out");
    return folder.string();
}

nlohmann::json error_json(ExitCode code, const std::string& message, const std::string& mend,
                          const std::vector<InputProblem>& problems) {
    auto rows = nlohmann::json::array();
    for (const InputProblem& problem : problems)
        rows.push_back({{"file", problem.file},
                        {"line", problem.line > 0 ? nlohmann::json(problem.line) : nlohmann::json(nullptr)},
                        {"key", problem.key},
                        {"value", problem.value},
                        {"rule", problem.rule},
                        {"mend", problem.mend}});
    return {{"error",
             {{"code", static_cast<int>(code)},
              {"kind", to_string(code)},
              {"message", message},
              {"mend", mend},
              {"problems", rows}}}};
}

std::string json_text(const nlohmann::json& object) {
    return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string duration_text(double seconds) {
    if (!(seconds >= 0)) return "unknown";
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const long whole = std::lround(std::min(seconds, 1e15));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    if (whole < 48 * 3600) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
    return fmt::format("{:.3g} days", seconds / 86400);
}

std::string count_text(double count) {
    if (!(count >= 0)) return "unknown";
    if (count < 999999.5) return fmt::format("{:.0f}", count);
    if (count < 1e9) return fmt::format("{:.3g} million", count / 1e6);
    return fmt::format("{:.3g}e9", count / 1e9);
}

std::string bytes_text(double bytes) {
    if (!(bytes >= 0)) return "unknown";
    if (bytes < 1e6) return fmt::format("{:.3g} kB", bytes / 1e3);
    if (bytes < 1e9) return fmt::format("{:.3g} MB", bytes / 1e6);
    return fmt::format("{:.3g} GB", bytes / 1e9);
}

bool colour_allowed(int file_descriptor) {
    const char* no_colour = std::getenv("NO_COLOR");
    const char* term = std::getenv("TERM");
    return !(no_colour && *no_colour) && term && std::strcmp(term, "dumb") != 0 && isatty(file_descriptor);
}

ExitCode exit_code_of(const RunHealth& health) {
    if (health.ok()) return ExitCode::met;
    return health.status == "interrupted" ? ExitCode::interrupted : ExitCode::simulation_failed;
}

}  // namespace gradwright::cli
