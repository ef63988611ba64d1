// Speed against error: one scene at several levels of reduction, several packing seeds each, every level held
// against the finest. Which reductions are free is read off this table, not decided by taste
// (inverse-design.md, "Speed against error").
//
// A level's error is the rms difference, over the bins that count, between its mean GI(y) and the finest's.
// Two means over beds differ even at the same level, by the noise floor
//   floor = sqrt(v_level/n_level + v_finest/n_finest),
// v = variance between beds of one level, mean over the bins. v falls as 1/grains, so all levels share one
// estimate of v x grains: with two or three beds a level its own would be worth next to nothing. What lies
// within `kTradeoffNoise` floors cannot be told from no error, with these seeds. The bins of a relabelled
// strip share their grains and are hardly more than one or two independent numbers: by chance alone the ratio
// passes 2 in 2 % (two numbers: exp(-4)) to 5 % (one) of the levels. All are held against the same finest
// beds: if those are unlucky, every level looks worse.
//
// Softening is judged by how many contacts overlap by more than 3 % of a radius, not by the largest overlap:
// that is often one grain's, wedged between floor and wall, and went from 3 to 12 % with the packing's seed.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "optimise/design_run.h"

namespace gradwright {

inline constexpr double kTradeoffNoise = 2;
/// The finest level beside the study: stiffer by this ...
inline constexpr double kFinestStiffness = 3;
/// ... and its time step shorter by this.
inline constexpr double kFinestStep = 0.5;

/// Everything that trades accuracy for speed, in one place.
struct ReductionSettings {
    std::vector<std::string> names;  ///< of kReductions
    double softening = 1e-4;
    double rayleigh_fraction = 0.2;
    double coarse_factor = 1;  ///< with "coarse_map" or "coarse_grains" among the names
    double strip_width = 0;    ///< [m]; with "strip_map"
    double blade_speed = 0;    ///< [m/s]
    bool sleep = true;

    bool has(const std::string& name) const;
    /// As --set overrides of the study file.
    std::vector<std::string> overrides() const;
};

/// Those of the study as it is.
ReductionSettings settings_of(const Study& study);

struct TradeoffRun {
    std::uint64_t seed = 0;
    RunHealth health;
    std::vector<double> gi;  ///< per bin, NaN where empty
    double packing_fraction = 0, capture_fraction = 0, x_drift = 0;
    long grains = 0, steps = 0;
    double grain_steps = 0;  ///< awake
    double seconds = 0;      ///< wall, packing included, nothing from a cache
    std::string state_hash;
};

struct TradeoffLevel {
    std::string name, meaning;
    std::string step;  ///< the one setting in which it departs from where it started; empty: not one alone
    ReductionSettings settings;
    double expected_grain_steps = 0;  ///< of one spread, before sleep
    std::string scene;                ///< canonical text: two levels may come to the same
    std::vector<TradeoffRun> runs;
    std::string status = "waiting";  ///< "ok", "waiting", "not possible", or the status of a failed run
    std::string reason;
    // means over the runs
    std::vector<double> gi;
    double grains = 0, steps = 0, grain_steps = 0, seconds = 0, packing_fraction = 0;
    double max_overlap_ratio = 0;  ///< of all runs the largest: often one grain's, so nothing is judged by it
    double deep_contact_share = 0;  ///< of all contacts seen, those beyond 3 % of a radius
    double speed_up = 0;            ///< seconds of the finest over this one's
    double gi_rmse = 0;             ///< against the finest [GI]
    double noise_floor = 0;         ///< rms difference expected from the beds alone
    double gi_error = 0;            ///< sqrt(max(0, gi_rmse^2 - noise_floor^2))
    double packing_error = 0;       ///< packing fraction over the finest's - 1
    bool within_noise = false;
    bool overlap_rule_kept = true;  ///< deep_contact_share within kDeepContacts, or not beyond the finest's
};

struct Tradeoff {
    std::vector<TradeoffLevel> levels;  ///< the finest first
    std::vector<double> y_m, weight, target;
    double noise_rms = 0;       ///< floor between two means at the study's own number of grains
    std::string recommended;    ///< name of a level; empty while nothing can be said
    std::string why;            ///< in words
    std::string status = "ok";  ///< or "interrupted"
    int seeds = 0;
    int threads = 0;  ///< of every spread
    Fidelity fidelity = Fidelity::map;
};

struct TradeoffOptions {
    int seeds = 3;  ///< beds a level, >= 2: the noise is measured between them
    Fidelity fidelity = Fidelity::map;
    /// false: each reduction alone, taken from the finest level. true: the study as it stands with one
    /// reduction undone or one more taken: cheaper by far, and it sees what reductions do together.
    bool around_study = false;
    std::vector<std::string> only;  ///< names of levels; empty = all. The finest is always there
    RunOptions run;
    std::function<void(const Tradeoff&)> after_run;  ///< called with all that is known, after every spread
};

/// Study file with these overrides on top of the user's.
using StudyReader = std::function<Study(const std::vector<std::string>& overrides)>;

/// The levels before anything runs; those that the study file refuses have status "not possible" and the
/// reason. Throws InputError when the study itself cannot be read.
Tradeoff plan_tradeoff(const StudyReader& read, const TradeoffOptions& options);
/// Runs what is planned, then the combination of every reduction that is free. Levels that fail stay in the
/// table with their reason.
void run_tradeoff(Tradeoff& tradeoff, const StudyReader& read, const TradeoffOptions& options);
/// Everything that follows from the runs; for tests.
void compare_levels(Tradeoff& tradeoff);

}  // namespace gradwright
