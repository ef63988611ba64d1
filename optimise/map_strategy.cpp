// Default strategy (inverse-design.md): spread without labels -> partition on the map -> confirm with
// labelled full-width spreads on unseen seeds -> correct where the confirmation contradicts the map ->
// confirm again.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "optimise/ceres_fit.h"
#include "optimise/design_run.h"
#include "optimise/kinematic_evaluator.h"
#include "optimise/motion.h"
#include "optimise/motion_search.h"
#include "optimise/strategy_support.h"

namespace gradwright {
namespace {

constexpr double kSignificance = 0.05;  // of the equality test that calls for a correction
/// Of a tolerance: beyond this an undecided design is hardly good enough, and what its spread has taught is
/// worth more than a second look at it.
constexpr double kBorderline = 0.75;

/// What the confirmations have taught: confirmed - map, smoothed; per bin, or cell of a field, and the
/// drift's per bin.
struct Correction {
    std::vector<double> profile, drift;
    std::vector<double> variance, drift_variance;  ///< of those
    bool active = false;
};

/// Variance of a smoothed discrepancy: mean of up to three independent bins.
std::vector<double> smoothed_variance(const std::vector<double>& standard_error,
                                      const std::vector<double>& weight, int run) {
    const int bins = int(weight.size());
    std::vector<double> variance(bins, 0.0);
    for (int b = 0; b < bins; ++b) {
        double sum = 0;
        int n = 0;
        for (int k = std::max(0, b - 1); k <= std::min(bins - 1, b + 1); ++k)
            if (k / run == b / run && weight[k] > 0 && std::isfinite(standard_error[k])) {
                sum += standard_error[k] * standard_error[k];
                ++n;
            }
        if (n > 0) variance[b] = sum / (n * n);
    }
    return variance;
}

class MapStrategy {
  public:
    MapStrategy(const Study& study, const RunOptions& options) : run_(study, options), study_(run_.study) {}

    StudyResult run() {
        motion_ = start_design(study_);
        run_.enter("map");
        motion_ = MotionSearch(run_, motion_).best();
        OriginMap& map = run_.map.map_of(motion_);
        run_.result.map_layers = map.layers;
        run_.result.beds = map.beds;
        run_.warn(map.health.warnings);
        if (!map.health.ok()) {
            run_.record("map", run_.map.evaluate(motion_, 0), "no origin map");
            return run_.fail(
                fmt::format("The map spread ended '{}': {}", map.health.status, map.health.reason));
        }
        run_.record("start", run_.map.quick(motion_), "start design on the map");

        run_.enter("fit");
        if (!place_partition({})) return run_.fail("No partition could be fitted: " + fit_message_);
        stated_comparisons();
        if (map.heap) return run_.finish_extrapolated(predicted_, *map.heap);
        if (!hold_powders_apart()) return run_.fail("No partition could be fitted: " + fit_message_);

        std::vector<ConfirmedDesign> rounds = {unconfirmed(predicted_)};
        while (confirm_or_correct(rounds)) {
        }
        say_what_limits(rounds);
        return run_.finish(rounds);
    }

  private:
    /// One more spread for the current design, or a corrected design; false when there is nothing left to do.
    bool confirm_or_correct(std::vector<ConfirmedDesign>& rounds) {
        ConfirmedDesign& round = rounds.back();
        if (run_.runner.stopped() || run_.spreads_left() < 1 || round.verdict == Verdict::met) return false;
        if (!round.confirmations.empty()) {
            const bool profile_contradicts = round.p_value < kSignificance;
            const bool drift_contradicts =
                round.drift_p_value < kSignificance && verdict_of(round.drift_misfit) != Verdict::met;
            // unlike powders: the map is a guess, and may agree with a poor spread by its own noise alone
            const bool borderline =
                round.distance() > kBorderline &&
                (!like_ || (round.verdict == Verdict::undecided && full_spreads_are_maps(round)));
            if (study_.design_space.partition_free &&
                (profile_contradicts || drift_contradicts || borderline)) {
                run_.enter("correct");
                ConfirmedDesign corrected = correct(round, profile_contradicts, drift_contradicts);
                if (corrected.design.partition.points.empty()) return false;
                rounds.push_back(std::move(corrected));
            } else if (round.verdict == Verdict::not_met) {
                return false;  // map and spread agree that this is the best there is
            }
        }
        run_.enter("confirm");
        const int before = run_.spreads_left();
        // A spread that failed for its packing may pass on another seed; one that never began would fail for
        // ever.
        return run_.confirm(rounds.back()) || run_.spreads_left() < before;
    }

    /// Best partition on the map of `motion_`, aimed at target - correction; sets predicted_. False when
    /// nothing could be fitted.
    bool place_partition(const Correction& correction) {
        Design design = motion_;
        if (study_.design_space.partition_free) {
            FitOptions options;
            // a discrepancy is one of that curve: of its mirror image it may have the other sign
            if (correction.active && predicted_.design.partition.second.empty())
                options.near = predicted_.design.partition.points;
            const FitResult fit = best_fit(study_.design_space, correction, options);
            fit_message_ = fit.message;
            if (!fit.ok) return false;
            design = fit.design;
        }
        predicted_ = run_.map.evaluate(design, 0);
        fit_message_ = predicted_.health.reason;
        const OriginMap& map = run_.map.map_of(motion_);
        const bool by_powder = !map.beds_of_layers.empty(),
                   together = by_powder && map.beds_of_layers.front().both();
        const bool learned = together || (!by_powder && int(map.layers.size()) > study_.map_spreads);
        run_.record(correction.active || learned ? "correct" : "map", predicted_,
                    correction.active ? "aimed at the corrected target"
                    : together  ? "best partition with each powder moving as it did in the confirmations"
                    : by_powder ? "best partition with each powder moving as on the strip of its own"
                    : learned   ? "best partition on the map with the confirmations' origins in it"
                                : "best partition on the map");
        return predicted_.health.ok();
    }

    /// Least squares with the study's drift weight, and with a smaller and a larger one where misfit or drift
    /// come near their tolerance: the verdict needs both, the weight is only a guess at that. Of all that was
    /// found, the design is taken whose upper 95 % bounds lie furthest inside both tolerances: of two equal
    /// fits the one with less noise, which a partition that snakes through the dispenser has not.
    FitResult best_fit(const DesignSpace& space, const Correction& correction, FitOptions options) {
        options.seed = study_.seed;
        options.stop = [this] { return run_.runner.stopped(); };
        const OriginMap& map = run_.map.map_of(motion_);
        FitProblem problem(study_, motion_, map.layers, map.share, map.beds_of_layers);
        if (correction.active) {
            for (std::size_t b = 0; b < problem.target.size(); ++b)
                problem.target[b] -= correction.profile[b];
            for (std::size_t b = 0; b < problem.drift_target.size(); ++b)
                problem.drift_target[b] -= correction.drift[b];
        }
        const auto distance = [this](const FitResult& fit) {
            return std::max(fit.misfit / study_.objective.tolerance,
                            fit.drift / study_.objective.x_drift_tolerance);
        };
        constexpr double kComfortable = 0.7;  // of a tolerance: leaves room for the spread between beds
        options.finalists = 6;
        FitResult best = fit_partition(study_, space, motion_, problem, options);
        if (!best.ok) return best;
        std::vector<Design> found = best.finalists;
        if (study_.objective.x_drift_weight > 0 && distance(best) >= kComfortable) {
            options.perturbed_starts = 2;  // the landscape is known by now
            for (const double factor : {0.25, 4.0}) {
                problem.x_drift_weight = factor * study_.objective.x_drift_weight;
                const FitResult other = fit_partition(study_, space, motion_, problem, options);
                found.insert(found.end(), other.finalists.begin(), other.finalists.end());
            }
        }
        double least = std::numeric_limits<double>::infinity();
        for (const Design& design : found) {
            const double bound = upper_bound(run_.map.quoted(design), correction);
            if (bound < least) {
                least = bound;
                best.design = design;
            }
        }
        return best;
    }

    /// Larger of misfit and drift, each by its upper 95 % bound over its tolerance, of what a design is
    /// expected to be when spread: the map's answer plus the correction in force. Infinite without numbers.
    double upper_bound(Evaluation expected, const Correction& correction) const {
        if (!expected.health.ok()) return std::numeric_limits<double>::infinity();
        if (correction.active) {
            for (std::size_t b = 0; b < correction.profile.size(); ++b)
                expected.judged().gi[b] += correction.profile[b];
            for (std::size_t b = 0; b < correction.drift.size(); ++b)
                expected.drift.difference[b] += correction.drift[b];
            judge(study_, expected);
        }
        return std::max(expected.misfit.interval_high / study_.objective.tolerance,
                        expected.drift_misfit.interval_high / study_.objective.x_drift_tolerance);
    }

    /// The best straight partition on the same map, and the kinematic picture of the design found.
    void stated_comparisons() {
        DesignSpace straight;
        straight.family = Family::straight;
        const FitResult fit = best_fit(straight, {}, {});
        if (fit.ok) run_.result.straight = run_.map.evaluate(fit.design, 0);
        KinematicEvaluator kinematic(study_, predicted_.capture_fraction);
        run_.result.kinematic = kinematic.evaluate(predicted_.design, 0);
    }

    /// Powders unlike by what they are: one strip of B tells whether they move alike all the same. Its price
    /// is a strip; two spreads are left for confirmations in any case. Where they do not, the design is made
    /// anew with each powder as on its own strip. False when that gave none.
    bool hold_powders_apart() {
        if (like_ || run_.spreads_left() <= kReserve) return true;
        run_.enter("gate");
        const Evaluation all_b = run_.map.with_powder_b(predicted_.design);
        run_.record("gate", all_b, "the same partition on a strip of powder B alone");
        if (!all_b.health.ok()) {
            run_.warn({fmt::format("no strip of powder B alone ({}): the two powders count as unlike",
                                   all_b.health.reason)});
            return true;
        }
        const PowderGate gate = powder_gate(predicted_, all_b, run_.result.weight);
        run_.result.powder_gate = gate;
        if (gate.passes) return true;
        run_.warn(
            {fmt::format("powders A and B move differently: on a strip of B alone GI differs by {:.3f} rms "
                         "(noise {:.3f}, p = {:.2g}; drift p = {:.2g}). The map is a first guess; only "
                         "spreads with both powders count",
                         gate.difference, gate.noise, gate.p_value, gate.drift_p_value)});
        if (!chambers_are_plain() || !study_.design_space.partition_free) return true;
        run_.enter("fit");
        run_.map.read_by_powder(motion_);
        return place_partition({});
    }

    /// Pure powders, level chambers, one layer: a side of the partition is a powder, and all of it.
    bool chambers_are_plain() const {
        const ChamberFill fill = chamber_fill(study_, motion_);
        return fill.pure() && fill.level() && study_.scene.layers == 1;
    }

    /// Powders that move each in its own way, between periodic sides: a spread with both tells how each moves
    /// beside the other.
    bool full_spreads_tell_powders(const ConfirmedDesign& round) const {
        return !like_ && chambers_are_plain() && !round.layers.empty() && round.layers.front().periodic &&
               round.layers.front().labelled;
    }

    /// Powders that move alike between periodic sides, level chambers: a spread's origins tell what a strip's
    /// do.
    bool full_spreads_are_maps(const ConfirmedDesign& round) const {
        return like_ && chamber_fill(study_, motion_).level() && !round.layers.empty() &&
               round.layers.front().periodic;
    }

    /// The next design after a spread that contradicted the map, or found its design hardly good enough.
    /// Powders that move alike: the difference is the beds' chance, and the full spread's origins go into the
    /// map, four strips' worth of them on the coupon. Powders that do not, but are told apart by where they
    /// stood: the same, powder by powder, and what the spread then still contradicts is left to manifold
    /// mapping. Else that alone: aim the map at target - (confirmed - map), so that map + discrepancy meets
    /// the target; on like powders that would build half of one bed's chance into the partition.
    ConfirmedDesign correct(const ConfirmedDesign& round, bool profile, bool drift) {
        if (full_spreads_are_maps(round)) {
            for (std::size_t k = 0; k < round.layers.size(); ++k)
                run_.map.learn(motion_, round.layers[k], round.confirmations.at(k).state_hash);
            return place_partition({}) ? unconfirmed(predicted_) : ConfirmedDesign{};
        }
        Evaluation mapped = round.predicted;
        if (full_spreads_tell_powders(round)) {
            for (std::size_t k = 0; k < round.layers.size(); ++k)
                run_.map.learn_powders(motion_, round.layers[k], round.design.partition,
                                       round.confirmations.at(k).state_hash);
            mapped = run_.map.quoted(round.design);
            const GradationProfile& confirmed = study_.target.is_field() ? round.field.cells : round.mean;
            profile =
                bins_p_value(confirmed.gi, confirmed.standard_error, mapped.judged().gi,
                             mapped.judged().standard_error, round.predicted.judged_weight()) < kSignificance;
            drift = bins_p_value(round.drift.difference, round.drift.standard_error, mapped.drift.difference,
                                 mapped.drift.standard_error, drift_weights(study_)) < kSignificance;
            correction_ = {};  // of another map
            if (!profile && !drift) return place_partition({}) ? unconfirmed(predicted_) : ConfirmedDesign{};
        }
        if (!profile && !drift)
            profile = drift = true;  // neither speaks up alone, and yet it is not good enough
        const std::vector<double> weight = round.predicted.judged_weight();
        const std::vector<double> drift_weight = drift_weights(study_);
        const int run = study_.bins.count;
        if (!correction_.active) {
            correction_.profile.assign(weight.size(), 0.0);
            correction_.variance = correction_.profile;
            correction_.drift.assign(drift_weight.size(), 0.0);
            correction_.drift_variance = correction_.drift;
            correction_.active = true;
        }
        if (profile) {
            const GradationProfile& confirmed = study_.target.is_field() ? round.field.cells : round.mean;
            correction_.profile = smoothed_discrepancy(confirmed.gi, mapped.judged().gi, weight, run);
            correction_.variance = smoothed_variance(confirmed.standard_error, weight, run);
        }
        if (drift) {
            correction_.drift =
                smoothed_discrepancy(round.drift.difference, mapped.drift.difference, drift_weight, run);
            correction_.drift_variance = smoothed_variance(round.drift.standard_error, drift_weight, run);
        }
        if (!place_partition(correction_)) return {};
        ConfirmedDesign corrected = unconfirmed(predicted_);
        for (std::size_t b = 0; b < weight.size(); ++b) {
            corrected.expected[b] += correction_.profile[b];
            corrected.expected_variance[b] += correction_.variance[b];
        }
        for (std::size_t b = 0; b < drift_weight.size(); ++b) {
            corrected.expected_drift[b] += correction_.drift[b];
            corrected.expected_drift_variance[b] += correction_.drift_variance[b];
        }
        return corrected;
    }

    void say_what_limits(const std::vector<ConfirmedDesign>& rounds) {
        const Misfit &misfit = rounds.front().predicted.misfit,
                     &drift = rounds.front().predicted.drift_misfit;
        std::string& limit = run_.limit;
        limit = fmt::format(
            "The best that the map offers is misfit {:.3f} (noise floor {:.3f}) and x drift {:.3f} (noise "
            "floor {:.3f})",
            misfit.value, misfit.noise_floor, drift.value, drift.noise_floor);
        const DesignSpace& space = study_.design_space;
        const bool motion_free = !free_motion(space).empty();
        if (misfit.debiased > misfit.tolerance || drift.debiased > drift.tolerance)
            limit +=
                motion_free
                    ? ": this motion range limits it; widen land, dosage_factor or footprint, or add knots."
                    : ": the transport limits it; free land, dosage_factor or footprint_offset, or add "
                      "knots.";
        else if (rounds.size() > 1)
            limit +=
                ": the spreads with both powders differ from the map, and run.max_spreads ended the "
                "corrections.";
        else
            limit += ": the spread between beds limits it.";
    }

    StrategyRun run_;
    const Study& study_;
    Design motion_;         ///< motion variables in force; its partition is the start's
    Evaluation predicted_;  ///< of the design in force, on the map
    Correction correction_;
    std::string fit_message_;
    /// By what they are. A gate that passes says that one noisy strip found no difference: the strips of A go
    /// on being the first guess, but what spreads with both say is read powder by powder all the same.
    const bool like_ = moves_alike(study_);
};

}  // namespace

StudyResult run_map_strategy(const Study& study, const RunOptions& options) {
    return MapStrategy(study, options).run();
}

}  // namespace gradwright
