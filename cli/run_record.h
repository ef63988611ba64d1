// What an output folder of `design` says of its run: run.json (what was asked), status.json (how far it is),
// run.lock (held while it runs). Written at the start, so that a run that dies can be told about and gone on
// with.
#pragma once
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/common.h"

namespace gradwright::cli {

/// What decides a design's numbers.
struct RunRecord {
    std::string study_file;        ///< as given, for messages and for files named in the study
    std::string study_text;        ///< verbatim
    std::vector<std::string> set;  ///< --set and --seed
    std::string strategy, fidelity;
    int budget = 0;
    bool film = false;                                        ///< the spreads keep instants for a film
    std::vector<std::pair<std::string, std::string>> inputs;  ///< resolved: key and value
    std::string engine;                                       ///< engine format and instruction set
};

RunRecord record_of(const Study& study, const std::vector<std::string>& set, const std::string& strategy,
                    const std::string& fidelity, int budget);
void write_record(const std::string& folder, const RunRecord& record);
/// Throws Failure io without a run.json, bad_input when it is damaged.
RunRecord read_record(const std::string& folder);
/// "process.blade_speed: 100 mm/s there, 50 mm/s now", one line for each difference; empty when the same.
std::vector<std::string> differences(const RunRecord& there, const RunRecord& now);

/// The folder belongs to this process as long as the object lives. Throws Failure usage when another has it.
class FolderLock {
  public:
    explicit FolderLock(const std::string& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    static bool held(const std::string& folder);  ///< by a process that lives

  private:
    int descriptor_ = -1;
};

/// status.json: rewritten every two seconds at most, and when the stage changes.
class StatusFile {
  public:
    explicit StatusFile(std::string folder);
    void update(const std::string& stage, double fraction);
    /// `state`: "finished" | "interrupted" | "failed"
    void end(const std::string& state);

  private:
    void write(const std::string& state) const;

    std::string folder_, stage_;
    double fraction_ = 0;
    std::chrono::steady_clock::time_point begun_, written_{};
};

}  // namespace gradwright::cli
