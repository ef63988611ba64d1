#include "optimise/tradeoff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/contact_law.h"
#include "optimise/study_file.h"

namespace gradwright {

ReductionSettings settings_of(const Study& study) {
    ReductionSettings s;
    s.names = study.reductions;
    s.softening = study.scene.softening;
    s.rayleigh_fraction = study.scene.rayleigh_fraction;
    s.coarse_factor = study.map_coarsening;
    s.strip_width = study.strip_width;
    s.blade_speed = study.scene.blade_speed;
    s.sleep = study.scene.sleep;
    return s;
}

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void take(ReductionSettings& settings, const std::string& name) {
    if (!settings.has(name)) settings.names.push_back(name);
}
void drop(ReductionSettings& settings, const std::string& name) {
    std::erase(settings.names, name);
}

/// Everything as exact as this ladder goes. The strip stays: without it nothing here would end.
ReductionSettings finest_of(const ReductionSettings& study) {
    ReductionSettings s = study;
    for (const char* name : kReductions)
        if (std::string(name) != "strip_map") drop(s, name);
    s.softening = std::min(1.0, kFinestStiffness * study.softening);
    s.rayleigh_fraction = kFinestStep * study.rayleigh_fraction;
    s.coarse_factor = 1;
    return s;
}

/// One setting that can be turned, both ways. `apply` takes the reduction.
struct Knob {
    std::string step;  ///< knobs of one step exclude each other
    std::string name, meaning;
    std::function<void(ReductionSettings&)> apply;
};

/// `widest`: the dispenser's width [m].
std::vector<Knob> knobs_of(const ReductionSettings& study, bool map, double widest) {
    const std::string coarse = map ? "coarse_map" : "coarse_grains";
    std::vector<Knob> knobs = {
        {"fines_cut", "fines_cut", "only sizes from D10 to D90", [](auto& s) { take(s, "fines_cut"); }},
        {"shallow_bed", "shallow_bed", "3 D50 of powder below the rim, not 8",
         [](auto& s) { take(s, "shallow_bed"); }},
        {"softening", fmt::format("softening {:.0e}", study.softening), "the study's stiffness",
         [=](auto& s) { s.softening = study.softening; }},
        {"softening", fmt::format("softening {:.0e}", study.softening / 3),
         "a third of the study's stiffness", [=](auto& s) { s.softening = study.softening / 3; }},
        {"time_step", fmt::format("time step {:.2g} T_R", study.rayleigh_fraction), "the study's time step",
         [=](auto& s) { s.rayleigh_fraction = study.rayleigh_fraction; }},
        {"time_step", fmt::format("time step {:.2g} T_R", 1.5 * study.rayleigh_fraction),
         "one and a half of the study's time step",
         [=](auto& s) { s.rayleigh_fraction = 1.5 * study.rayleigh_fraction; }},
        {"early_stop", "early_stop", "the blade stops at the platform's end",
         [](auto& s) { take(s, "early_stop"); }},
        {"blade_speed", "blade speed x 1.5", "the process itself run faster",
         [=](auto& s) { s.blade_speed = 1.5 * study.blade_speed; }},
    };
    for (const double factor : {1.25, 1.5, 2.0})
        knobs.push_back(
            {"coarse", fmt::format("coarse x {}", factor),
             fmt::format("grains {} times as large{}", factor, map ? ", the strip as much wider" : ""),
             [=](auto& s) {
                 take(s, coarse);
                 s.coarse_factor = factor;
                 s.strip_width = std::min(factor * study.strip_width, widest);
             }});
    if (map && study.has("strip_map"))
        knobs.push_back({"strip_width", "half the strip", "a strip half as wide",
                         [=](auto& s) { s.strip_width = 0.5 * study.strip_width; }});
    if (study.sleep)
        knobs.push_back(
            {"sleep", "sleep", "grains at rest are not computed", [](auto& s) { s.sleep = true; }});
    return knobs;
}

bool same(const ReductionSettings& a, const ReductionSettings& b) {
    return a.overrides() == b.overrides();
}

/// The study with this knob undone, for knobs that the study has turned.
ReductionSettings undone(const Knob& knob, const ReductionSettings& study, const ReductionSettings& finest) {
    ReductionSettings s = study;
    if (knob.step == "softening")
        s.softening = finest.softening;
    else if (knob.step == "time_step")
        s.rayleigh_fraction = finest.rayleigh_fraction;
    else if (knob.step == "sleep")
        s.sleep = false;
    else
        drop(s, knob.step);
    return s;
}

/// What one spread of the level costs; "not possible" when study file or engine refuse its scene.
void foresee(TradeoffLevel& level, const StudyReader& read, Fidelity fidelity) {
    const auto refused = [&level](const std::string& reason) {
        level.status = "not possible";
        level.reason = reason;
    };
    try {
        const Study study = read(level.settings.overrides());
        const Scene scene = scene_of(study, start_design(study), fidelity == Fidelity::map, study.seed);
        level.expected_grain_steps = estimate_cost(scene).grain_steps;
        level.scene = scene.canonical_text();
        for (const SceneProblem& problem : validate(scene))
            if (problem.fatal) return refused(problem.text);
    } catch (const InputError& error) {
        refused(error.problems.empty() ? "" : error.problems.front().text());
    }
}

TradeoffRun run_of(const Evaluation& evaluation) {
    TradeoffRun run;
    run.seed = evaluation.seed;
    run.health = evaluation.health;
    run.gi = evaluation.profile.gi;
    run.packing_fraction = evaluation.packing_fraction;
    run.capture_fraction = evaluation.capture_fraction;
    run.x_drift = evaluation.drift_misfit.value;
    run.grains = evaluation.grains;
    run.steps = evaluation.steps;
    run.grain_steps = evaluation.grain_steps;
    run.seconds = evaluation.seconds_cold;
    run.state_hash = evaluation.state_hash;
    return run;
}

/// Runs that have numbers, and their means.
void average(TradeoffLevel& level, std::size_t bins) {
    double n = 0;
    level.grains = level.steps = level.grain_steps = level.seconds = level.packing_fraction = 0;
    level.max_overlap_ratio = level.deep_contact_share = 0;
    std::vector<double> sum(bins, 0);
    std::vector<int> count(bins, 0);
    for (const TradeoffRun& run : level.runs) {
        if (!run.health.ok()) continue;
        ++n;
        level.grains += double(run.grains);
        level.steps += double(run.steps);
        level.grain_steps += run.grain_steps;
        level.seconds += run.seconds;
        level.packing_fraction += run.packing_fraction;
        level.max_overlap_ratio = std::max(level.max_overlap_ratio, run.health.max_overlap_ratio);
        level.deep_contact_share += run.health.deep_contact_share;
        for (std::size_t b = 0; b < bins && b < run.gi.size(); ++b)
            if (std::isfinite(run.gi[b])) sum[b] += run.gi[b], ++count[b];
    }
    level.gi.assign(bins, kNan);
    if (n == 0) return;
    for (double* mean : {&level.grains, &level.steps, &level.grain_steps, &level.seconds,
                         &level.packing_fraction, &level.deep_contact_share})
        *mean /= n;
    for (std::size_t b = 0; b < bins; ++b)
        if (count[b] > 0) level.gi[b] = sum[b] / count[b];
}

int sound_runs(const TradeoffLevel& level) {
    return int(std::count_if(level.runs.begin(), level.runs.end(),
                             [](const TradeoffRun& run) { return run.health.ok(); }));
}

/// Variance between beds of one level x its grains, shared by all levels, mean over the bins; NaN without a
/// level of two beds.
double shared_variance(const Tradeoff& t) {
    double squares = 0;
    int degrees = 0;
    for (const TradeoffLevel& level : t.levels) {
        if (sound_runs(level) < 2) continue;
        for (std::size_t b = 0; b < t.weight.size(); ++b) {
            if (!(t.weight[b] > 0)) continue;
            double sum = 0;
            int count = 0;
            for (const TradeoffRun& run : level.runs)
                if (run.health.ok() && std::isfinite(run.gi[b])) {
                    sum += std::pow(run.gi[b] - level.gi[b], 2);
                    ++count;
                }
            if (count < 2) continue;
            squares += sum * level.grains;
            degrees += count - 1;
        }
    }
    return degrees > 0 ? squares / degrees : kNan;
}

bool free_of_charge(const TradeoffLevel& level) {
    return level.status == "ok" && level.within_noise && level.overlap_rule_kept;
}

}  // namespace

bool ReductionSettings::has(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> ReductionSettings::overrides() const {
    std::vector<std::string> quoted;
    for (const char* name : kReductions)  // one order, whatever the order of taking
        if (has(name)) quoted.push_back(fmt::format("\"{}\"", name));
    std::vector<std::string> out = {
        fmt::format("numerics.reductions=[{}]", fmt::join(quoted, ", ")),
        fmt::format("numerics.softening={}", softening),
        fmt::format("numerics.time_step.rayleigh_fraction={}", rayleigh_fraction),
        fmt::format("numerics.sleep={}", sleep),
        fmt::format("process.blade_speed=\"{} m/s\"", blade_speed),
    };
    if (has("strip_map")) out.push_back(fmt::format("numerics.strip_width=\"{} m\"", strip_width));
    if (has("coarse_map") || has("coarse_grains"))
        out.push_back(fmt::format("numerics.coarse_factor={}", coarse_factor));
    out.push_back("run.map_spreads=1");
    return out;
}

Tradeoff plan_tradeoff(const StudyReader& read, const TradeoffOptions& options) {
    const Study study = read({});
    Tradeoff t;
    t.seeds = options.seeds;
    t.threads = options.run.threads;
    t.fidelity = options.fidelity;
    t.weight = bin_weights(study);
    t.target = bin_targets(study);
    for (int b = 0; b < study.bins.count; ++b) t.y_m.push_back(study.bins.centre(b));
    const bool map = options.fidelity == Fidelity::map;
    const ReductionSettings as_is = settings_of(study), finest = finest_of(as_is);

    std::vector<TradeoffLevel> levels(2);
    levels[0].name = "finest";
    levels[0].meaning = "every reduction undone but the strip; stiffer, and in shorter steps, than the study";
    levels[0].settings = finest;
    levels[1].name = "study";
    levels[1].meaning = "as the study file says";
    levels[1].settings = as_is;
    const ReductionSettings& base = options.around_study ? as_is : finest;
    for (const Knob& knob : knobs_of(as_is, map, study.dispenser_width)) {
        TradeoffLevel level;
        level.settings = base;
        level.step = knob.step;
        knob.apply(level.settings);
        level.name = knob.name;
        level.meaning = knob.meaning;
        if (same(level.settings, base)) {
            // already so: shown by undoing it
            if (!options.around_study) continue;
            level.settings = undone(knob, as_is, finest);
            level.name = "without " + knob.step;
            level.meaning = "the study with this undone: " + knob.meaning;
        }
        const auto twin = [&](const TradeoffLevel& other) { return same(other.settings, level.settings); };
        if (std::none_of(levels.begin(), levels.end(), twin)) levels.push_back(level);
    }
    for (TradeoffLevel& level : levels) {
        const bool wanted =
            options.only.empty() || level.name == "finest" ||
            std::find(options.only.begin(), options.only.end(), level.name) != options.only.end();
        if (!wanted) continue;
        foresee(level, read, t.fidelity);
        for (const TradeoffLevel& other : t.levels)
            if (level.status == "waiting" && other.scene == level.scene && level.name != "study") {
                level.status = "not possible";
                level.reason =
                    "the same scene as '" + other.name + "': this study fixes what it would change";
            }
        t.levels.push_back(level);
    }
    return t;
}

void compare_levels(Tradeoff& t) {
    for (TradeoffLevel& level : t.levels) average(level, t.weight.size());
    const double shared = shared_variance(t);
    const auto variance_of_mean = [&](const TradeoffLevel& level) {
        const int n = sound_runs(level);
        return n > 0 && level.grains > 0 ? shared / level.grains / n : kNan;
    };
    const TradeoffLevel& finest = t.levels.front();
    for (TradeoffLevel& level : t.levels) {
        level.speed_up = level.seconds > 0 ? finest.seconds / level.seconds : kNan;
        level.noise_floor = std::sqrt(variance_of_mean(level) + variance_of_mean(finest));
        level.packing_error =
            finest.packing_fraction > 0 ? level.packing_fraction / finest.packing_fraction - 1 : kNan;
        double squares = 0, weights = 0;
        for (std::size_t b = 0; b < t.weight.size(); ++b) {
            const double difference = level.gi[b] - finest.gi[b];
            if (!(t.weight[b] > 0) || !std::isfinite(difference)) continue;
            squares += t.weight[b] * difference * difference;
            weights += t.weight[b];
        }
        level.gi_rmse = weights > 0 ? std::sqrt(squares / weights) : kNan;
        level.gi_error =
            std::sqrt(std::max(0.0, level.gi_rmse * level.gi_rmse - level.noise_floor * level.noise_floor));
        if (!std::isfinite(level.gi_rmse) || !std::isfinite(level.noise_floor)) level.gi_error = kNan;
        level.within_noise = level.gi_rmse <= kTradeoffNoise * level.noise_floor;
        level.overlap_rule_kept =
            level.deep_contact_share <= std::max(kDeepContacts, 1.1 * finest.deep_contact_share);
    }
    const auto study = std::find_if(t.levels.begin(), t.levels.end(),
                                    [](const TradeoffLevel& level) { return level.name == "study"; });
    const TradeoffLevel& usual = study != t.levels.end() && study->grains > 0 ? *study : finest;
    t.noise_rms = usual.grains > 0 ? std::sqrt(2 * shared / usual.grains / std::max(1, t.seeds)) : kNan;

    t.recommended.clear();
    const TradeoffLevel* best = nullptr;
    for (const TradeoffLevel& level : t.levels)
        if (free_of_charge(level) && (!best || level.speed_up > best->speed_up)) best = &level;
    if (!best) return;
    t.recommended = best->name;
    t.why = fmt::format(
        "the largest speed-up ({:.1f}) among the levels whose GI is within {} noise floors of the finest's "
        "({:.3f} "
        "against a floor of {:.3f}) and of whose contacts at most one in {:.0f} overlaps by more than 3 % of "
        "a radius, or no more than of the finest's",
        best->speed_up, kTradeoffNoise, best->gi_rmse, best->noise_floor, 1 / kDeepContacts);
}

namespace {

/// Runs the beds that a level lacks. False when stopped.
bool run_level(Tradeoff& t, std::size_t index, const StudyReader& read, const TradeoffOptions& options,
               std::size_t of) {
    if (t.levels[index].status == "not possible") return true;
    const Study study = read(t.levels[index].settings.overrides());
    for (int k = int(t.levels[index].runs.size()); k < options.seeds; ++k) {
        if (options.run.stop && options.run.stop->load()) return false;
        RunOptions run = options.run;
        if (options.run.progress)
            run.progress = [&, name = t.levels[index].name, k](const std::string& stage, double fraction) {
                options.run.progress(fmt::format("level {} of {}, {}, bed {} of {}: {}", index + 1, of, name,
                                                 k + 1, options.seeds, stage),
                                     fraction);
            };
        const std::uint64_t seed =
            options.fidelity == Fidelity::map ? map_seed(study.seed, k) : confirmation_seed(study.seed, k);
        const Evaluation evaluation = evaluate_once(study, start_design(study), options.fidelity, seed, run);
        if (evaluation.health.status == "interrupted") return false;
        TradeoffLevel& level = t.levels[index];
        level.runs.push_back(run_of(evaluation));
        level.status = evaluation.health.status;
        level.reason = evaluation.health.reason;
        compare_levels(t);
        if (options.after_run) options.after_run(t);
        if (!evaluation.health.ok()) break;  // the next bed of a level that fails would fail too
    }
    return true;
}

/// What every free reduction together comes to; of knobs that exclude each other the fastest.
TradeoffLevel combination_of(const Tradeoff& t, const ReductionSettings& base, const std::vector<Knob>& knobs,
                             const std::vector<std::string>& without) {
    TradeoffLevel all;
    all.name = "combination";
    all.settings = base;
    std::vector<std::string> parts;
    std::vector<std::pair<std::string, const TradeoffLevel*>> chosen;
    for (const TradeoffLevel& level : t.levels) {
        if (level.step.empty() || !free_of_charge(level) || level.name.starts_with("without ")) continue;
        if (std::find(without.begin(), without.end(), level.name) != without.end()) continue;
        const auto known = std::find_if(chosen.begin(), chosen.end(),
                                        [&](const auto& one) { return one.first == level.step; });
        if (known == chosen.end())
            chosen.emplace_back(level.step, &level);
        else if (level.speed_up > known->second->speed_up)
            known->second = &level;
    }
    for (const Knob& knob : knobs)
        for (const auto& [step, level] : chosen)
            if (level->name == knob.name) {
                knob.apply(all.settings);
                parts.push_back(knob.name);
            }
    all.meaning =
        fmt::format("{}{}", parts.empty() ? "nothing more is free" : "every reduction that is free alone: ",
                    fmt::join(parts, ", "));
    return all;
}

}  // namespace

void run_tradeoff(Tradeoff& t, const StudyReader& read, const TradeoffOptions& options) {
    const auto stopped = [&] {
        compare_levels(t);
        t.status = "interrupted";
    };
    const std::size_t planned = t.levels.size();
    for (std::size_t index = 0; index < planned; ++index) {
        if (!run_level(t, index, read, options, planned)) return stopped();
        if (index == 0 && sound_runs(t.levels[0]) < options.seeds)
            return;  // nothing to hold the others against
    }
    const Study study = read({});
    const ReductionSettings as_is = settings_of(study),
                            base = options.around_study ? as_is : finest_of(as_is);
    const std::vector<Knob> knobs = knobs_of(as_is, options.fidelity == Fidelity::map, study.dispenser_width);
    // Together they may cost what none costs alone: then the one that came nearest to its limit is left out.
    std::vector<std::string> without;
    constexpr int kTries = 3;
    for (int attempt = 0; attempt < kTries && options.only.empty(); ++attempt) {
        TradeoffLevel all = combination_of(t, base, knobs, without);
        const auto twin = [&](const TradeoffLevel& other) { return same(other.settings, all.settings); };
        if (std::any_of(t.levels.begin(), t.levels.end(), twin)) break;
        if (attempt > 0) all.name = fmt::format("combination {}", attempt + 1);
        foresee(all, read, t.fidelity);
        t.levels.push_back(all);
        if (!run_level(t, t.levels.size() - 1, read, options, t.levels.size())) return stopped();
        compare_levels(t);
        if (free_of_charge(t.levels.back())) break;
        const TradeoffLevel* dearest = nullptr;
        for (const TradeoffLevel& level : t.levels)
            if (!level.step.empty() && free_of_charge(level) && !level.name.starts_with("without ") &&
                std::find(without.begin(), without.end(), level.name) == without.end() &&
                (!dearest || level.gi_rmse / level.noise_floor > dearest->gi_rmse / dearest->noise_floor))
                dearest = &level;
        if (!dearest) break;
        without.push_back(dearest->name);
    }
    compare_levels(t);
}

}  // namespace gradwright
