// Study journal: one file per finished evaluation, there for good before the next begins (interfaces.md,
// Files). A kill at any byte leaves whole files only: written aside, flushed to the disk, renamed, and the
// folder flushed too.
//   000012_full.json   number + fidelity; numbers count up and are never used twice
// Undefined numbers are null in the file and NaN in memory.
// A resumed run goes the same way again, with the spreads it had finished: what it has to say is held against
// the entries that stand there and written only from the first new one on.
#pragma once
#include <functional>
#include <stdexcept>
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

/// A resumed run that does not do again what its journal says it did.
struct OtherWay : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Journal {
  public:
    /// Opens `folder`, made when missing; "" = no journal, append() does nothing. Goes on after the highest
    /// number found. Throws std::runtime_error naming the folder and the reason when it cannot be written.
    /// `replay`: what is appended first is held against the entries found, in their order.
    explicit Journal(std::string folder, bool replay = false);

    /// Number of the entry, 0 without a journal. Throws std::runtime_error naming the file and the reason
    /// (disk full, no permission); entries written before stay whole. While replaying: OtherWay naming the
    /// entry and the key where the run goes another way than before (times and warnings aside).
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
    std::vector<std::string> replayed_;  ///< files still to be met, the next one last
};

}  // namespace gradwright
