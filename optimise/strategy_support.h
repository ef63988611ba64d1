// What every strategy does around its search: account of time and spreads, confirmation within the budget,
// the result's book-keeping.
#pragma once
#include <chrono>
#include <string>

#include "optimise/confirmation.h"
#include "optimise/dem_evaluator.h"
#include "optimise/journal.h"
#include "optimise/map_evaluator.h"
#include "optimise/spread_runner.h"

namespace gradwright {

/// A run of one strategy. The result is filled as the run goes, so that an interrupted one has what there is.
class StrategyRun {
  public:
    StrategyRun(const Study& study, const RunOptions& options);

    /// Time from here on is booked on `stage`, and people are told.
    void enter(const std::string& stage);
    void record(const std::string& stage, const Evaluation& evaluation, const std::string& note);
    /// Kept once per kind: two beds say the same thing with different numbers (each evaluation keeps its
    /// own).
    void warn(const std::vector<std::string>& warnings);
    int spreads_left() const { return study.max_spreads - runner.map_spreads - runner.full_spreads; }
    /// One more confirmation of `round` on a seed that nothing has seen; false when it gave no numbers
    /// (recorded with its reason).
    bool confirm(ConfirmedDesign& round);
    /// Confirms until the verdict is decided or the budget is spent.
    void confirm_until_decided(ConfirmedDesign& round);
    /// Sets design, verdict, profiles, bands and sums from the best of the rounds, and closes the account.
    StudyResult finish(const std::vector<ConfirmedDesign>& rounds);
    /// For a machine that cannot be spread: the verdict is the prediction's, with the errors of the
    /// extrapolation in it.
    StudyResult finish_extrapolated(const Evaluation& predicted, const ScaledHeap& heap);
    StudyResult fail(const std::string& reason);

    const Study study;  ///< a copy: budgets may have been cut, see given_used
    SpreadRunner runner;
    Journal journal;
    MapEvaluator map;
    DemEvaluator full;
    StudyResult result;
    std::string limit;  ///< what the search says limits the result; goes into the message

  private:
    void close();
    /// Checks the design found against every constraint and limit; one that is broken, or that binds where
    /// the target is not met, is named in the message.
    void check_constraints();

    std::chrono::steady_clock::time_point begun_, stage_begun_;
    std::string stage_;
    int confirmations_ = 0;  ///< seeds used
    std::string last_failure_;
};

}  // namespace gradwright
