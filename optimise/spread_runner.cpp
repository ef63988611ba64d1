#include "optimise/spread_runner.h"

#include <fmt/format.h>

namespace gradwright {

SpreadResult SpreadRunner::spread(const Scene& scene, const PartitionCurve* partition,
                                  const std::string& stage, int snapshots) {
    SpreadResult result;
    if (stopped()) {
        result.health.status = "interrupted";
        result.health.reason = fmt::format("stopped before {}", stage);
        return result;
    }
    // A stand-in engine has its own idea of what it can spread.
    if (!options_.spread) {
        for (const SceneProblem& problem : validate(scene))
            if (problem.fatal)
                result.health.reason = result.health.reason.empty()
                                           ? problem.text
                                           : fmt::format("{}; {}", result.health.reason, problem.text);
        if (!result.health.reason.empty()) {
            result.health.status = "invalid";
            return result;
        }
    }
    SpreadOptions options;
    options.threads = options_.threads;
    options.cache_folder = options_.cache_folder;
    options.snapshots = snapshots;
    options.stop = options_.stop;
    if (options_.progress)
        options.progress = [this, &stage](const Progress& progress) {
            options_.progress(fmt::format("{}: {}", stage, progress.stage), progress.fraction);
        };
    result =
        options_.spread ? options_.spread(scene, partition, options) : run_spread(scene, partition, options);
    seconds_saved += result.seconds_cold > result.seconds ? result.seconds_cold - result.seconds : 0;
    return result;
}

void copy_health(const SpreadResult& from, Evaluation& to) {
    to.health = from.health;
    to.grains += from.grains;
    to.steps += from.steps;
    to.grain_steps += from.grain_steps;
    to.seconds += from.seconds;
    to.seconds_cold += from.seconds_cold;
}

}  // namespace gradwright
