#include "optimise/spread_runner.h"

#include <fmt/format.h>

#include <chrono>

#include "dem/cache_file.h"
#include "dem/spread_file.h"

namespace gradwright {
namespace {

/// What a spread depends on. The points of the partition in hexadecimal: not a bit is lost.
std::string key_of(const Scene& scene, const PartitionCurve* partition, int snapshots) {
    std::string key =
        fmt::format("spread format {}, {} snapshots\n{}", kEngineFormat, snapshots, scene.canonical_text());
    if (!partition) return key;
    for (const auto* curve : {&partition->points, &partition->second}) {
        key += "\ncurve";
        for (const PlanPoint& point : *curve) key += fmt::format("\n{:a} {:a}", point.x, point.y);
    }
    return key;
}

}  // namespace

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
    const std::string key = key_of(scene, partition, snapshots);
    if (options_.resume && !options_.spread_folder.empty()) {
        const auto begun = std::chrono::steady_clock::now();
        if (const auto bytes = read_cache(options_.spread_folder, "spread", key);
            bytes && read_spread(*bytes, result)) {
            result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
            seconds_saved += result.seconds_cold;
            return result;
        }
        result = SpreadResult{};
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
    // Failed ones too: they would fail again. What was interrupted is not finished.
    if (!options_.spread_folder.empty() && result.health.status != "interrupted" &&
        !write_cache(options_.spread_folder, "spread", key, spread_bytes(result)) && on_loss)
        on_loss(fmt::format("{} cannot be kept in {}: a run that dies cannot be resumed from it", stage,
                            options_.spread_folder));
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
