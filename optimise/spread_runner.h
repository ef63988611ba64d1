// Runs spreads for the evaluators: passes threads, cache, progress and stop on, and keeps the account of what
// was spent.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "optimise/design_run.h"

namespace gradwright {

class SpreadRunner {
  public:
    explicit SpreadRunner(const RunOptions& options) : options_(options) {}

    /// One spread; `stage` is what people read meanwhile ("map spread 1"). Checks the scene first: a scene
    /// that `validate` finds impossible returns status "invalid" with the reasons, for the motion variables
    /// may lead a search there.
    SpreadResult spread(const Scene& scene, const PartitionCurve* partition, const std::string& stage,
                        int snapshots = 0);
    bool stopped() const { return halted_ || (options_.stop && options_.stop->load()); }
    /// No further spread is to begin.
    void halt() { halted_ = true; }
    const RunOptions& options() const { return options_; }

    int map_spreads = 0,
        full_spreads =
            0;  ///< counted by the evaluators: every spread whose result was asked for, cached or not
    std::function<void(const std::string& reason)> on_loss;  ///< a finished spread could not be kept
    double seconds_saved = 0;                                ///< stored cost of what came from a cache [s]

  private:
    RunOptions options_;
    bool halted_ = false;
};

/// Health into an evaluation's words when the run ended without numbers.
void copy_health(const SpreadResult& from, Evaluation& to);

}  // namespace gradwright
