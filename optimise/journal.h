// Study journal: one file per finished evaluation, there for good before the next begins (interfaces.md,
// Files). A kill at any byte leaves whole files only: written aside, flushed to the disk, renamed, and the
// folder flushed too.
//   000012_full.json   number + fidelity; numbers count up and are never used twice
// Undefined numbers are null in the file and NaN in memory.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "optimise/evaluation.h"

namespace gradwright {

struct JournalEntry {
    int number = 0;  ///< from 1
    std::string file;
    Evaluation evaluation;
    std::vector<Layer>
        layers;  ///< with origins: the strips of a new set of motion variables, a full spread's own
};

class Journal {
  public:
    /// Opens `folder`, made when missing; "" = no journal, append() does nothing. Goes on after the highest
    /// number found. Throws std::runtime_error naming the folder and the reason when it cannot be written.
    explicit Journal(std::string folder);

    /// Number of the entry, 0 without a journal. Throws std::runtime_error naming the file and the reason
    /// (disk full, no permission); entries written before stay whole.
    int append(const Evaluation& evaluation, const std::vector<Layer>& layers = {});
    const std::string& folder() const { return folder_; }
    /// When set, append() hands its failure to it and returns 0 instead of throwing: an evaluation that cost
    /// minutes must not be lost with the disk.
    std::function<void(const std::string& reason)> on_failure;

    /// Entries in the order written. Left-over aside files (a kill while writing) are passed over; a damaged
    /// entry throws std::runtime_error naming it.
    static std::vector<JournalEntry> read(const std::string& folder);

  private:
    std::string folder_;
    int last_ = 0;
};

}  // namespace gradwright
