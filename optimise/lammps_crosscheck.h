// The same beds in two engines: ours and LAMMPS, seed by seed. Answers one question: is the difference
// between the engines larger than the difference between two packings of the same powder?
#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "optimise/lammps_pairs.h"
#include "optimise/study.h"

namespace gradwright {

struct CrosscheckOptions {
    int seeds = 3;    ///< beds, >= 2: the noise is measured between them
    int ranks = 1;    ///< MPI processes of LAMMPS
    int threads = 1;  ///< of ours
    /// true: the study's own law in ours. false (default): spring rolling and plain Hertz walls, the nearest
    /// to LAMMPS's, so that what is compared is the engines and not the models.
    bool study_law = false;
    bool full_width = false;   ///< true: both powders over the whole width; false: the map's narrow strip
    bool rigid_blade = false;  ///< LAMMPS's blade as in LammpsDeckOptions
    std::string cache_folder;
    std::string folder;  ///< decks, data, logs and dumps go here
    std::function<void(const std::string& stage, double fraction)> progress;
    const std::atomic<bool>* stop = nullptr;
};

/// The heap ahead of the blade at one blade position: solid above the blade's edge per area [m], in bins of
/// `kHeapBin` from the blade's face.
inline constexpr double kHeapBin = 0.1e-3;
struct HeapShape {
    double blade_x = 0;               ///< [m]
    std::vector<double> solid_depth;  ///< [m]
    double solid_section = 0;         ///< sum over the bins x kHeapBin [m2]
    double centre = 0;                ///< centre of the solid ahead of the face [m]
    double length = 0;                ///< where 95 % of it lie within [m]
};

/// One engine on one bed.
struct CrosscheckRun {
    std::uint64_t seed = 0;
    RunHealth health;
    std::vector<double> gi;  ///< per bin of the study, NaN where empty
    double packing_fraction = 0, capture_fraction = 0, coverage = 0;
    HeapShape heap;
    double seconds = 0;      ///< wall, of the spread alone
    double grain_steps = 0;  ///< all mobile grains x steps
    long grains = 0, laid = 0, steps = 0;
};

struct CrosscheckEngine {
    std::string name, version;
    int ranks_or_threads = 1;
    std::vector<CrosscheckRun> runs;  ///< in the order of the seeds
    double seconds = 0;               ///< sum [s]
    double grain_steps_per_second = 0;
};

struct Crosscheck {
    RunHealth health;  ///< of the first run that failed, else ok; "failed": LAMMPS itself. The numbers below
                       ///< are of the beds that both engines finished before
    TwoBodyResult two_body;
    CrosscheckEngine ours, lammps;
    std::vector<std::string> differences;  ///< of the laws, one sentence each
    std::vector<double> y_m, weight;       ///< per bin; weight 0 does not count
    /// rms over counting bins and beds of GI(LAMMPS) - GI(ours) on the same bed.
    double gi_rmse = 0;
    double gi_rmse_of_means = 0;  ///< the same of the means over the beds
    double gi_bias = 0;           ///< mean of the difference
    double gi_bias_error = 0;     ///< its standard error, from bed to bed; NaN with one bed
    /// Share of the ways to give each bed's difference a sign in which gi_rmse_of_means comes out as large as
    /// it did (exact test of paired samples): chance, if the engines do the same. Never below 2^(1 - beds).
    /// NaN without beds or with more than kMostBeds.
    double gi_p_value = 0;
    /// Standard deviation of one run's GI between beds: rms over counting bins and both engines.
    double noise_rms = 0;
    double heap_rmse = 0;    ///< of the solid depth, over beds and bins, relative to its peak
    double speed_ratio = 0;  ///< wall seconds of LAMMPS / ours
    bool forces_agree = false, gradation_agrees = false;
};

/// With few beds gi_rmse may be this many times noise_rms. Two runs that share nothing but the distribution
/// differ by sqrt(2) of it on the mean, and three beds scatter widely about that: a flag, no proof. From
/// kBedsToJudge on gi_p_value decides, which can then fall below kDiffersBelow.
inline constexpr double kNoiseAllowed = 1.5;
inline constexpr int kBedsToJudge = 6;
inline constexpr int kMostBeds = 20;  ///< all choices of their signs are looked at
inline constexpr double kDiffersBelow = 0.05;

/// Where in the study the comparison stands: scene of one seed.
Scene crosscheck_scene(const Study& study, const CrosscheckOptions& options, std::uint64_t seed);

/// Both engines on the same beds. Throws LammpsError when LAMMPS is missing or fails on the single contacts.
Crosscheck run_crosscheck(const Study& study, const CrosscheckOptions& options);

/// Heap ahead of the blade in a snapshot; `width` modelled [m].
HeapShape heap_shape(const Snapshot& snapshot, double width);
/// gi_rmse and company from the runs: `ours` and `lammps` hold GI per bin and bed.
void compare_gradation(Crosscheck& result);

}  // namespace gradwright
