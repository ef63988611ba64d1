// A spread in LAMMPS: our stage goes in, places come out, and everything after that is ours (measure_layer).
// It is what run_spread is, so every evaluator can stand on it.
#pragma once
#include <string>
#include <vector>

#include "dem/stage.h"
#include "optimise/design_run.h"
#include "optimise/journal.h"
#include "optimise/lammps_run.h"

namespace gradwright {

struct LammpsSpreadOptions {
    std::string folder;         ///< deck, data, log and dumps of this spread; made when it is not there
    int ranks = 1;              ///< MPI processes
    std::vector<double> shots;  ///< blade positions of snapshots on the way [m]
    bool rigid_blade = false;   ///< as in LammpsDeckOptions
};

/// One stage in LAMMPS, as spread_stage: our bed, levelled and raised, our time step, our end condition, our
/// measurement of the layer. Snapshots: first, shots, last. `seconds` are those of LAMMPS with writing and
/// reading its files, `grain_steps` counts every mobile grain; health.max_overlap_ratio is not known (NaN).
/// `facts`, when given, takes version and seconds of the program itself. Throws LammpsError when LAMMPS is
/// missing or fails.
SpreadResult run_lammps_stage(const Scene& scene, const Stage& stage, const SpreadOptions& options,
                              const LammpsSpreadOptions& lammps, LammpsRun* facts = nullptr);

/// The same from the scene on, as run_spread.
SpreadResult run_lammps_spread(const Scene& scene, const PartitionCurve* partition,
                               const SpreadOptions& options, const LammpsSpreadOptions& lammps);

/// Writes into `folder` one sub-folder per spread ("spread-1", ...): what RunOptions::spread wants.
SpreadFunction lammps_spread_function(const std::string& folder, int ranks);

/// Fidelity `lammps`: as DemEvaluator, but the spread is LAMMPS's. `folder` empty: a temporary one, taken
/// away again unless LAMMPS failed.
class LammpsEvaluator : public Evaluator {
  public:
    /// `run`: threads become ranks. `journal` may be null. All must outlive the evaluator.
    LammpsEvaluator(const Study& study, const RunOptions& run, std::string folder, Journal* journal)
        : study_(study), run_(run), folder_(std::move(folder)), journal_(journal) {}
    Evaluation evaluate(const Design& design, std::uint64_t seed) override;
    Fidelity fidelity() const override { return Fidelity::lammps; }

  private:
    const Study& study_;
    const RunOptions& run_;
    std::string folder_;
    Journal* journal_;
};

}  // namespace gradwright
