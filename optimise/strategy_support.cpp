#include "optimise/strategy_support.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

namespace gradwright {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begun) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

const char* instruction_set() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f")) return "avx512f";
    if (__builtin_cpu_supports("avx2")) return "avx2";
    return "x86-64";
#else
    return "generic";
#endif
}

/// A map must leave at least one spread for the confirmation, where the budget has two.
Study within_budget(Study study) {
    study.map_spreads = std::clamp(study.map_spreads, 1, std::max(1, study.max_spreads - 1));
    return study;
}

std::string with_interval(const Misfit& misfit) {
    return fmt::format("{:.3f} (95 % bounds {:.3f} and {:.3f}, noise floor {:.3f}, tolerance {:.3g})",
                       misfit.value, misfit.interval_low, misfit.interval_high, misfit.noise_floor,
                       misfit.tolerance);
}

}  // namespace

StrategyRun::StrategyRun(const Study& given, const RunOptions& options)
    : study(within_budget(given)),
      runner(options),
      journal(options.journal_folder, options.resume),
      map(study, runner, &journal),
      full(study, runner, &journal),
      begun_(std::chrono::steady_clock::now()),
      stage_begun_(begun_) {
    result.seed = study.seed;
    result.warnings = study.warnings;
    result.target = bin_targets(study);
    result.weight = bin_weights(study);
    result.field_target = field_targets(study);
    result.field_weight = field_weights(study);
    result.threads = options.threads > 0 ? options.threads : omp_get_max_threads();
    result.host_cores = int(std::thread::hardware_concurrency());
    result.host_isa = instruction_set();
    journal.on_failure = [this](const std::string& reason) {
        runner.halt();  // what is there is reported; more could not be kept
        if (result.unwritten.empty()) result.unwritten = reason;
    };
    runner.on_loss = [this](const std::string& reason) { warn({reason}); };
    result.given_used.emplace_back("threads", fmt::format("{} -> {}", options.threads, result.threads));
    result.given_used.emplace_back("run.map_spreads",
                                   fmt::format("{} -> {}", given.map_spreads, study.map_spreads));
}

void StrategyRun::enter(const std::string& stage) {
    if (!stage_.empty()) result.stage_seconds[stage_] += seconds_since(stage_begun_);
    stage_begun_ = std::chrono::steady_clock::now();
    stage_ = stage;
    if (!stage.empty() && runner.options().progress) runner.options().progress(stage, 0);
}

void StrategyRun::record(const std::string& stage, const Evaluation& evaluation, const std::string& note) {
    HistoryEntry entry;
    entry.iteration = int(result.history.size());
    entry.stage = stage;
    entry.fidelity = evaluation.fidelity;
    entry.objective = evaluation.objective;
    entry.misfit = evaluation.misfit.value;
    entry.drift = evaluation.drift_misfit.value;
    entry.spreads = runner.map_spreads + runner.full_spreads;
    entry.seconds = seconds_since(begun_);
    entry.design = evaluation.design;
    entry.note = evaluation.health.ok()
                     ? note
                     : fmt::format("{}: {}: {}", note, evaluation.health.status, evaluation.health.reason);
    result.history.push_back(std::move(entry));
}

void StrategyRun::warn(const std::vector<std::string>& warnings) {
    const auto kind = [](std::string text) {
        std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
        return text;
    };
    for (const std::string& warning : warnings)
        if (std::none_of(result.warnings.begin(), result.warnings.end(),
                         [&](const std::string& known) { return kind(known) == kind(warning); }))
            result.warnings.push_back(warning);
}

bool StrategyRun::confirm(ConfirmedDesign& round) {
    const std::uint64_t seed = confirmation_seed(study.seed, confirmations_++);
    const Evaluation evaluation = full.evaluate(round.design, seed);
    record("confirm", evaluation, fmt::format("packing seed {}", seed));
    warn(evaluation.health.warnings);
    if (!evaluation.health.ok()) {
        last_failure_ = fmt::format("{}: {}", evaluation.health.status, evaluation.health.reason);
        return false;
    }
    if (round.snapshots.empty()) round.snapshots = full.last().snapshots;
    result.beds.push_back(full.last().bed);
    round.confirmations.push_back(evaluation);
    round.layers.push_back(judged_layer(study, full.last()));
    summarise(study, round);
    return true;
}

void StrategyRun::confirm_until_decided(ConfirmedDesign& round) {
    enter("confirm");
    while (round.verdict == Verdict::undecided && spreads_left() > 0 && !runner.stopped()) {
        const int before = spreads_left();
        // A spread that fails for its packing may pass on another seed; one that never began will not.
        if (!confirm(round) && spreads_left() == before) return;
    }
}

void StrategyRun::close() {
    enter("");
    result.spreads_map = runner.map_spreads;
    result.spreads_full = runner.full_spreads;
    result.given_used.emplace_back("run.max_spreads", fmt::format("{} -> {}", study.max_spreads,
                                                                  runner.map_spreads + runner.full_spreads));
    result.seconds = seconds_since(begun_);
    result.seconds_cold = result.seconds + runner.seconds_saved;
}

void StrategyRun::check_constraints() {
    result.constraints = constraint_states(study, result.design);
    const Evaluation& of = result.confirmations.empty() ? result.predicted : result.confirmations.front();
    if (of.health.ok() && of.fidelity != Fidelity::kinematic)
        for (const ConstraintState& limit : limit_states(study, result.waste_fraction, result.supply_ratio))
            result.constraints.push_back(limit);
    const ConstraintState* nearest = binding(result.constraints);
    if (!nearest) return;
    constexpr double kBinds = 1e-6;  // of its scale
    if (!nearest->kept()) {
        result.verdict = Verdict::not_met;
        result.message = fmt::format("No design was found that keeps every constraint: {}. {}",
                                     describe(*nearest), result.message);
    } else if (result.verdict != Verdict::met && nearest->slack < kBinds * nearest->scale) {
        result.message += fmt::format(" The constraint {} binds.", describe(*nearest));
    }
}

StudyResult StrategyRun::fail(const std::string& reason) {
    close();
    result.termination = runner.stopped() ? "interrupted" : "failed";
    result.message = reason;
    result.verdict = Verdict::undecided;
    return std::move(result);
}

StudyResult StrategyRun::finish_extrapolated(const Evaluation& predicted, const ScaledHeap& heap) {
    close();
    result.design = predicted.design;
    result.predicted = predicted;
    result.extrapolated = heap;
    result.misfit = predicted.misfit;
    result.drift_misfit = predicted.drift_misfit;
    result.verdict = combine(verdict_of(result.misfit), verdict_of(result.drift_misfit));
    result.capture_fraction = predicted.capture_fraction;
    result.supply_ratio = predicted.supply_ratio;
    result.coverage = predicted.coverage;
    result.waste_fraction = predicted.waste_fraction;
    result.packing_fraction = predicted.packing_fraction;
    result.waste_a_share = std::numeric_limits<double>::quiet_NaN();  // a strip carries no labels
    const double factor = common_factor(predicted.profile.degrees);
    for (std::size_t b = 0; b < predicted.profile.gi.size(); ++b) {
        const double gi = predicted.profile.gi[b], half = factor * predicted.profile.standard_error[b];
        result.band_low.push_back(std::max(0.0, gi - half));
        result.band_high.push_back(std::min(1.0, gi + half));
    }
    if (!moves_alike(study))
        result.warnings.push_back(
            "powders A and B are unlike, and the strips hold powder A alone: how they part on the way is not "
            "in the "
            "band");
    result.termination = runner.stopped() ? "interrupted" : "converged";
    result.message = fmt::format(
        "Extrapolated from {} strips of up to {:.3g} mm: misfit {}, x drift {}. No bed of this size was "
        "spread.",
        heap.strips.size(), 1e3 * heap.longest, with_interval(result.misfit),
        with_interval(result.drift_misfit));
    if (result.verdict == Verdict::undecided)
        result.message += " A longer strip in scale_up.lengths narrows the band.";
    check_constraints();
    return std::move(result);
}

StudyResult StrategyRun::finish(const std::vector<ConfirmedDesign>& rounds) {
    const auto best = std::max_element(rounds.begin(), rounds.end(),
                                       [](const auto& a, const auto& b) { return better(b, a); });
    const ConfirmedDesign& round = *best;
    close();
    result.design = round.design;
    result.predicted = round.predicted;
    result.confirmations = round.confirmations;
    result.snapshots = round.snapshots;
    for (const ConfirmedDesign& other : rounds)
        if (&other != &round)
            result.superseded.insert(result.superseded.end(), other.confirmations.begin(),
                                     other.confirmations.end());
    result.confirmed = round.mean;
    result.confirmed_field = round.field;
    result.confirmed_drift = round.drift;
    result.misfit = round.misfit;
    result.drift_misfit = round.drift_misfit;
    result.verdict = round.verdict;

    // Sums of the confirmations where there are any, else of the prediction.
    const std::vector<Evaluation> predicted_only = {round.predicted};
    const std::vector<Evaluation>& sources =
        round.confirmations.empty() ? predicted_only : round.confirmations;
    for (const Evaluation& source : sources) {
        const double n = double(sources.size());
        result.capture_fraction += source.capture_fraction / n;
        result.supply_ratio += source.supply_ratio / n;
        result.coverage += source.coverage / n;
        result.waste_fraction += source.waste_fraction / n;
        result.packing_fraction += source.packing_fraction / n;
        result.waste_a_share += source.waste_a_share / n;
    }
    if (!round.confirmations.empty() && result.coverage < study.objective.min_coverage)
        result.warnings.push_back(
            fmt::format("coverage {:.3f} is below objective.min_coverage {:.3f}: raise the dosage factor",
                        result.coverage, study.objective.min_coverage));

    if (round.confirmations.empty()) {
        result.misfit = round.predicted.misfit;
        result.drift_misfit = round.predicted.drift_misfit;
        const bool failed = !runner.stopped() && !last_failure_.empty();
        result.termination = runner.stopped() ? "interrupted" : failed ? "failed" : "budget";
        result.message =
            failed ? "No confirmation could be spread: " + last_failure_
                   : fmt::format("Not confirmed: {}; the numbers are predictions.",
                                 runner.stopped() ? "interrupted" : "no spread was left in run.max_spreads");
        check_constraints();
        return std::move(result);
    }

    Band band =  // over the bins that the verdict is about
        simultaneous_band(round.mean.gi, round.mean.standard_error, round.mean.degrees, result.weight);
    result.band_low = std::move(band.low);
    result.band_high = std::move(band.high);

    const std::string numbers =
        fmt::format("misfit {}, x drift {}, on {} unseen bed{}", with_interval(round.misfit),
                    with_interval(round.drift_misfit), round.confirmations.size(),
                    round.confirmations.size() == 1 ? "" : "s");
    const bool drift_decides =
        verdict_of(round.drift_misfit) == round.verdict && verdict_of(round.misfit) != round.verdict;
    if (round.verdict == Verdict::met) {
        result.message = "Target met: " + numbers + ".";
    } else if (round.verdict == Verdict::not_met) {
        result.message = fmt::format("Target not met by its {}: {}.",
                                     drift_decides             ? "x drift"
                                     : study.target.is_field() ? "field"
                                                               : "profile",
                                     numbers);
    } else {
        const Misfit& open =
            verdict_of(round.misfit) == Verdict::undecided ? round.misfit : round.drift_misfit;
        result.message = fmt::format(
            "Undecided: {}. {}", numbers,
            open.noise_floor > open.tolerance
                ? "The noise floor lies above the tolerance: raise run.max_spreads or widen the tolerance."
                : "The tolerance lies inside the interval: raise run.max_spreads for more beds.");
    }
    if (round.verdict != Verdict::met && !limit.empty()) result.message += " " + limit;
    result.termination = round.verdict == Verdict::met         ? "converged"
                         : runner.stopped()                    ? "interrupted"
                         : round.verdict == Verdict::undecided ? "budget"
                         : spreads_left() > 0                  ? "converged"
                                                               : "budget";
    check_constraints();
    return std::move(result);
}

}  // namespace gradwright
