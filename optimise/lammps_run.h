// LAMMPS as a program: found, started in its folder, watched, and its answers read back.
#pragma once
#include <atomic>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace gradwright {

/// LAMMPS (or mpirun) is not there, or ended with an error.
struct LammpsError : std::exception {
    LammpsError(std::string message_, std::string mend_)
        : message(std::move(message_)), mend(std::move(mend_)) {}
    std::string message;  ///< what is wrong
    std::string mend;     ///< what to do: the line that installs it, or where the log lies
    const char* what() const noexcept override { return message.c_str(); }
};

/// Paths of the programs; mpirun empty for one rank.
struct LammpsProgram {
    std::string lmp, mpirun;
};

/// Looks for `lmp`, and for `mpirun` when ranks > 1, in PATH. Throws LammpsError with the line that installs
/// them.
LammpsProgram find_lammps(int ranks);

struct LammpsRunOptions {
    std::string folder;  ///< where it runs; every file of the deck is named relative to it
    std::string input;   ///< name of the deck in it
    int ranks = 1;
    std::function<void(long step)> progress;  ///< the last step that its log tells of
    const std::atomic<bool>* stop = nullptr;
};

struct LammpsRun {
    bool interrupted = false;
    double seconds = 0;   ///< wall, from start to end of the program
    std::string version;  ///< as its log says: "29 Sep 2021 - Update 2"
};

/// Runs a deck to its end. Screen output goes to FOLDER/screen.txt, the log to FOLDER/log.lammps. Throws
/// LammpsError with LAMMPS's own words when it fails, std::filesystem::filesystem_error when the folder is
/// not usable.
LammpsRun run_lammps(const LammpsProgram& program, const LammpsRunOptions& options);

/// Writes a deck or a data file. Throws std::filesystem::filesystem_error.
void write_deck_file(const std::string& file, const std::string& text);

/// One instant of a text dump (dump custom): the columns by name, sorted by id.
struct LammpsDump {
    long step = 0;
    std::vector<std::string> columns;
    std::vector<std::vector<double>> values;  ///< [column][grain]
    /// Column by name. Throws LammpsError when the dump does not hold it.
    const std::vector<double>& column(const std::string& name) const;
    std::size_t size() const { return values.empty() ? 0 : values.front().size(); }
};

/// Reads the last instant of a dump file. Throws LammpsError when it is not there, not whole or no dump.
LammpsDump read_lammps_dump(const std::string& file);

}  // namespace gradwright
