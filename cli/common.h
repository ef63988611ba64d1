// What every verb shares: options, exit codes, failures, where the output goes. No physics and no search
// lives in cli/.
#pragma once
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "optimise/evaluation.h"
#include "optimise/study_file.h"

namespace gradwright::cli {

/// Exit codes: a script may rely on them.
enum class ExitCode {
    met = 0,                ///< target met; for other verbs: done
    internal = 1,           ///< a fault of the program
    usage = 2,              ///< the command line
    bad_input = 3,          ///< the content of a file, or of a value given with --set
    not_met = 4,            ///< ran to its end, verdict not `met`; the best result is written
    simulation_failed = 5,  ///< a spread ended with a named status other than ok
    io = 6,                 ///< a file or folder cannot be opened, read or written
    external = 7,           ///< an external engine or package is missing or failed
    interrupted = 130,      ///< SIGINT or SIGTERM
};
const char* to_string(ExitCode code);

/// A failure with its exit code and the knob to turn; caught in main and nowhere else.
struct Failure : std::exception {
    Failure(ExitCode code_, std::string message_, std::string mend_ = {})
        : code(code_), message(std::move(message_)), mend(std::move(mend_)) {}
    ExitCode code;
    std::string message;  ///< what is wrong, with the value in it
    std::string mend;     ///< what to do; may be empty
    const char* what() const noexcept override { return message.c_str(); }
};

/// Options that several verbs share. Each verb registers only those it obeys.
struct CommonOptions {
    bool json = false;   ///< one JSON object on stdout
    bool quiet = false;  ///< no progress, no chatter; errors are still printed
    int verbose = 0;     ///< 1: stages and timings on stderr
    int threads = 0;     ///< 0 = OMP_NUM_THREADS, else every core
    std::string cache;   ///< as given; empty = the default folder; "none" = no cache
    std::string out;
    bool force = false;
    std::vector<std::string> set;  ///< "key.path=TOML value"
    std::optional<std::uint64_t> seed;
};

/// One call of the program: the verb found on the command line, ready to run.
struct Call {
    CommonOptions options;
    std::function<ExitCode()> run;
    CLI::App* verb = nullptr;
};

// Registration of shared options, by concern.
void add_output_options(CLI::App& verb, CommonOptions& options);  ///< --json --quiet -v
void add_study_options(CLI::App& verb, CommonOptions& options);   ///< --set --seed
void add_run_options(CLI::App& verb, CommonOptions& options);     ///< --threads --cache
void add_out_options(CLI::App& verb, CommonOptions& options);     ///< --out --force

// One function per verb, each in the file of its name: registers the verb and its own options; the parsed
// call runs it.
void add_design(CLI::App& app, Call& call);
void add_init(CLI::App& app, Call& call);
void add_compare(CLI::App& app, Call& call);
void add_evaluate(CLI::App& app, Call& call);
void add_check(CLI::App& app, Call& call);
void add_crosscheck(CLI::App& app, Call& call);
void add_bench(CLI::App& app, Call& call);
void add_tradeoff(CLI::App& app, Call& call);
void add_reach(CLI::App& app, Call& call);
void add_verify(CLI::App& app, Call& call);
void add_bulk(CLI::App& app, Call& call);
void add_limits(CLI::App& app, Call& call);
void add_report(CLI::App& app, Call& call);
void add_sensitivity(CLI::App& app, Call& call);
void add_spec(CLI::App& app, Call& call);
void add_status(CLI::App& app, Call& call);
void add_materials(CLI::App& app, Call& call);
void add_machines(CLI::App& app, Call& call);
void add_completion(CLI::App& app, Call& call);
void add_manual(CLI::App& app, Call& call);

/// Reads the study with --set and --seed applied. A file that cannot be opened is Failure io, with the
/// nearest file name; bad content is InputError with all problems.
Study load_study(const std::string& file, const CommonOptions& options);
/// A study with [scale_up] has `design` and `evaluate --fidelity map` alone: its machine is never spread.
/// `what` was asked for instead.
void refuse_scale_up(const Study& study, const std::string& what);

/// Folder of settled beds and maps: --cache, else $XDG_CACHE_HOME/gradwright, else ~/.cache/gradwright. Made
/// when it is not there. Empty ("no cache") for --cache none, and, with a word on stderr, when the default
/// cannot be written.
std::string cache_folder(const CommonOptions& options);

/// OpenMP threads that a run will use: --threads, else OMP_NUM_THREADS, else every core.
int thread_count(const CommonOptions& options);

/// Makes the folder of --out and returns it. Without --out: runs/<name>/<n>, n counting up from 1; two calls
/// at the same time get two folders. A folder with something in it is refused without --force.
std::string make_out_folder(const CommonOptions& options, const std::string& name);

/// {"error": {...}} of interfaces.md for --json.
nlohmann::json error_json(ExitCode code, const std::string& message, const std::string& mend,
                          const std::vector<InputProblem>& problems = {});

/// Text of a JSON object, indented; bytes that are no UTF-8 (a file name may hold them) are replaced, not
/// thrown about.
std::string json_text(const nlohmann::json& object);

/// Numbers for people: 12.3 s, 4 min 10 s, 2 h 5 min.
std::string duration_text(double seconds);
/// 1234567 -> "1.23 million".
std::string count_text(double count);
std::string bytes_text(double bytes);

/// Escape codes only on a terminal, and not with NO_COLOR set (https://no-color.org).
bool colour_allowed(int file_descriptor);

/// Shortest name of `valid` close to `word`, as " (did you mean 'x'?)"; empty when nothing is near.
std::string hint(const std::string& word, const std::vector<std::string>& valid);

/// Name of the status of a run that did not end well, mapped to its exit code.
ExitCode exit_code_of(const RunHealth& health);

}  // namespace gradwright::cli
