// Runs spreads for the evaluators: passes threads, cache, progress and stop on, and keeps the account of what
// was spent.
#pragma once
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "optimise/design_run.h"

namespace gradwright {

/// The progress of several runs that go through the same stages, as one: who is behind speaks for all.
class SlowestProgress {
  public:
    explicit SlowestProgress(std::size_t runs) : runs_(runs) {}
    struct Standing {
        int stages = 0;  ///< entered so far
        std::string stage;
        double fraction = 0;
    };
    /// Run `k` is so far now. Returns the one behind; `stages` is 0 while one of them has not begun.
    const Standing& tell(std::size_t k, const std::string& stage, double fraction);
    void end(std::size_t k);

  private:
    std::vector<Standing> runs_;
};

class SpreadRunner {
  public:
    explicit SpreadRunner(const RunOptions& options);

    /// One spread; `stage` is what people read meanwhile ("map spread 1"). Checks the scene first: a scene
    /// that `validate` finds impossible returns status "invalid" with the reasons, for the motion variables
    /// may lead a search there.
    SpreadResult spread(const Scene& scene, const PartitionCurve* partition, const std::string& stage,
                        int snapshots = 0);
    /// Several spreads without labels, one after the other's number: side by side as far as there are
    /// threads, which on a small heap is faster than all threads on one after the other. The same bits either
    /// way. Their `seconds` count by each one's share of the machine, so that the sum is about what all took.
    /// One that did not end well is the last: what comes after it is not done, or thrown away.
    std::vector<SpreadResult> spread_maps(const std::vector<Scene>& scenes, const std::string& after = "");
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
    using Progress = std::function<void(const std::string& stage, double fraction)>;
    SpreadResult spread_on(int threads, const Scene& scene, const PartitionCurve* partition,
                           const std::string& stage, int snapshots, const Progress& progress);

    RunOptions options_;  ///< with the number of threads that 0 stands for
    std::mutex books_;    ///< over the account and what is told to the caller
    bool halted_ = false;
};

/// Health into an evaluation's words when the run ended without numbers.
void copy_health(const SpreadResult& from, Evaluation& to);

}  // namespace gradwright
