#include "optimise/lammps_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <omp.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace gradwright {
namespace {

namespace fs = std::filesystem;

std::string in_path(const std::string& name) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::string file = (folder.empty() ? std::string(".") : folder) + "/" + name;
        if (access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file)) return file;
    }
    return {};
}

std::string tail_of(const fs::path& file, std::streamoff most) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return {};
    const std::streamoff size = stream.tellg();
    stream.seekg(std::max<std::streamoff>(0, size - most));
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// First number of the last whole line that begins with one: the thermo table's step.
long last_step(const fs::path& log) {
    const std::string text = tail_of(log, 4096);
    std::istringstream lines(text);
    long step = 0;
    for (std::string line; std::getline(lines, line);) {
        if (lines.eof()) break;  // not whole yet
        std::istringstream words(line);
        long first = 0;
        double second = 0;
        if (words >> first >> second && first > step) step = first;
    }
    return step;
}

/// "LAMMPS (29 Sep 2021 - Update 2)" -> "29 Sep 2021 - Update 2".
std::string version_of(const fs::path& log) {
    std::ifstream stream(log);
    std::string line;
    while (std::getline(stream, line)) {
        if (line.rfind("LAMMPS (", 0) != 0) continue;
        const std::size_t end = line.rfind(')');
        return line.substr(8, end == std::string::npos ? end : end - 8);
    }
    return "unknown";
}

/// The last ERROR line of its output, else its last line.
std::string complaint(const fs::path& folder) {
    std::string found, last;
    for (const char* name : {"log.lammps", "screen.txt"}) {
        std::istringstream lines(tail_of(folder / name, 16384));
        for (std::string line; std::getline(lines, line);) {
            if (line.find("ERROR") != std::string::npos) found = line;
            if (!line.empty()) last = line;
        }
    }
    return found.empty() ? last : found;
}

}  // namespace

LammpsProgram find_lammps(int ranks) {
    LammpsProgram program;
    program.lmp = in_path("lmp");
    if (program.lmp.empty())
        throw LammpsError(
            "LAMMPS is not installed: there is no 'lmp' in PATH",
            "run this as root, then call again: apt-get install --no-install-recommends lammps");
    if (ranks > 1) {
        program.mpirun = in_path("mpirun");
        if (program.mpirun.empty())
            throw LammpsError(
                fmt::format("{} ranks need 'mpirun', which is not in PATH", ranks),
                "run this as root, then call again: apt-get install --no-install-recommends openmpi-bin; or "
                "take --ranks 1");
    }
    return program;
}

LammpsRun run_lammps(const LammpsProgram& program, const LammpsRunOptions& options) {
    const fs::path folder(options.folder);
    std::vector<std::string> words;
    if (options.ranks > 1) {
        words = {program.mpirun, "-np", std::to_string(options.ranks)};
        // Open MPI refuses root without this; a container has nobody else.
        if (geteuid() == 0) words.push_back("--allow-run-as-root");
        if (options.ranks > omp_get_num_procs()) words.push_back("--oversubscribe");
    }
    words.insert(words.end(), {program.lmp, "-in", options.input, "-log", "log.lammps", "-nocite"});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // Ranks are the only parallelism: a threaded library beneath LAMMPS must not multiply it.
    std::vector<std::string> settings = {"OMP_NUM_THREADS=1"};
    std::vector<char*> environment;
    for (char** entry = environ; *entry; ++entry)
        if (std::strncmp(*entry, "OMP_NUM_THREADS=", 16) != 0) environment.push_back(*entry);
    environment.push_back(settings[0].data());
    environment.push_back(nullptr);

    fs::remove(folder / "log.lammps");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "screen.txt", O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    const auto start = std::chrono::steady_clock::now();
    pid_t child = 0;
    const int failed =
        posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environment.data());
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        throw fs::filesystem_error("cannot start " + words[0], folder,
                                   std::error_code(failed, std::generic_category()));

    LammpsRun run;
    int status = 0;
    for (int waits = 0;; ++waits) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child) break;
        if (ended < 0 && errno != EINTR)
            throw LammpsError("LAMMPS was lost sight of: " + std::string(std::strerror(errno)), {});
        if (options.stop && options.stop->load()) {
            run.interrupted = true;
            kill(child, SIGTERM);  // mpirun passes it on to its ranks
            bool gone = false;
            for (int k = 0; k < 50 && !gone; ++k) {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                gone = waitpid(child, &status, WNOHANG) == child;
            }
            if (!gone) {
                kill(child, SIGKILL);
                waitpid(child, &status, 0);
            }
            return run;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (options.progress && waits % 25 == 24) options.progress(last_step(folder / "log.lammps"));
    }
    run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    // A terminal's Ctrl-C reaches the child too.
    if (options.stop && options.stop->load()) run.interrupted = true;
    if (!run.interrupted && !(WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
        const std::string how = WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status))
                                                  : fmt::format("signal {}", WTERMSIG(status));
        throw LammpsError(fmt::format("LAMMPS failed ({}): {}", how, complaint(folder)),
                          fmt::format("its deck, log and output lie in '{}'", options.folder));
    }
    run.version = version_of(folder / "log.lammps");
    return run;
}

void write_deck_file(const std::string& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
        throw fs::filesystem_error("cannot be written", file,
                                   std::error_code(errno, std::generic_category()));
}

const std::vector<double>& LammpsDump::column(const std::string& name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found == columns.end()) throw LammpsError("a LAMMPS dump lacks the column '" + name + "'", {});
    return values[found - columns.begin()];
}

LammpsDump read_lammps_dump(const std::string& file) {
    const auto broken = [&](const std::string& what) {
        return LammpsError(fmt::format("the LAMMPS dump '{}' {}", file, what), "look into the log beside it");
    };
    std::ifstream stream(file);
    if (!stream) throw broken("cannot be opened");
    LammpsDump dump;
    std::string line;
    bool whole = false;
    long count = 0;
    while (std::getline(stream, line)) {
        if (line == "ITEM: TIMESTEP") {
            dump = {};
            whole = false;
            if (!(stream >> dump.step)) throw broken("names no step");
        } else if (line == "ITEM: NUMBER OF ATOMS") {
            if (!(stream >> count) || count < 0) throw broken("names no number of atoms");
        } else if (line.rfind("ITEM: ATOMS", 0) == 0) {
            std::istringstream words(line.substr(11));
            for (std::string word; words >> word;) dump.columns.push_back(word);
            std::vector<std::vector<double>> rows(count, std::vector<double>(dump.columns.size()));
            // strtod, not >>: a stream refuses "nan", and that must arrive as what it is
            for (auto& row : rows) {
                if (!std::getline(stream, line)) throw broken("ends too early");
                const char* at = line.c_str();
                for (double& value : row) {
                    char* end = nullptr;
                    value = std::strtod(at, &end);
                    if (end == at) throw broken("holds a line that is no row of numbers: " + line);
                    at = end;
                }
            }
            const auto id = std::find(dump.columns.begin(), dump.columns.end(), "id");
            if (id == dump.columns.end()) throw broken("holds no ids");
            const std::size_t key = id - dump.columns.begin();
            std::sort(rows.begin(), rows.end(),
                      [key](const auto& a, const auto& b) { return a[key] < b[key]; });
            dump.values.assign(dump.columns.size(), std::vector<double>(rows.size()));
            for (std::size_t k = 0; k < rows.size(); ++k)
                for (std::size_t c = 0; c < dump.columns.size(); ++c) dump.values[c][k] = rows[k][c];
            whole = true;
        }
    }
    if (!whole) throw broken("holds no whole instant");
    return dump;
}

}  // namespace gradwright
