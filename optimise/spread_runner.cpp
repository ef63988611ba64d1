#include "optimise/spread_runner.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <limits>
#include <tuple>

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

const SlowestProgress::Standing& SlowestProgress::tell(std::size_t k, const std::string& stage,
                                                       double fraction) {
    Standing& mine = runs_[k];
    mine.stages += stage != mine.stage;
    mine.stage = stage;
    mine.fraction = fraction;
    return *std::min_element(runs_.begin(), runs_.end(), [](const Standing& a, const Standing& b) {
        return std::tie(a.stages, a.fraction) < std::tie(b.stages, b.fraction);
    });
}

void SlowestProgress::end(std::size_t k) {
    runs_[k].stages = std::numeric_limits<int>::max();
}

SpreadRunner::SpreadRunner(const RunOptions& options) : options_(options) {
    if (options_.threads <= 0) options_.threads = omp_get_max_threads();
}

SpreadResult SpreadRunner::spread(const Scene& scene, const PartitionCurve* partition,
                                  const std::string& stage, int snapshots) {
    Progress progress;
    if (options_.progress)
        progress = [this, &stage](const std::string& part, double fraction) {
            options_.progress(fmt::format("{}: {}", stage, part), fraction);
        };
    return spread_on(options_.threads, scene, partition, stage, snapshots, progress);
}

std::vector<SpreadResult> SpreadRunner::spread_maps(const std::vector<Scene>& scenes,
                                                    const std::string& after) {
    const auto name = [&](std::size_t k) {
        return fmt::format("map spread {}{}", map_spreads + 1 + static_cast<int>(k), after);
    };
    // What cannot be spread is the last. A stand-in engine has its own idea of that, and is asked one after
    // the other; so are threads bound to cores, for those begun here would all be bound to this one's.
    const auto impossible = [this](const Scene& scene) {
        const std::vector<SceneProblem> problems = validate(scene);
        return !options_.spread && std::any_of(problems.begin(), problems.end(),
                                               [](const SceneProblem& one) { return one.fatal; });
    };
    const auto bad = std::find_if(scenes.begin(), scenes.end(), impossible);
    const std::size_t wanted = static_cast<std::size_t>(bad - scenes.begin()) + (bad != scenes.end());
    const bool one_by_one = options_.spread || omp_get_proc_bind() != omp_proc_bind_false;
    const std::size_t abreast = one_by_one ? 1 : std::min(wanted, static_cast<std::size_t>(options_.threads));
    std::vector<SpreadResult> out;
    for (std::size_t first = 0; first < wanted; first += abreast) {
        const std::size_t count = std::min(abreast, wanted - first);
        if (count == 1) {
            out.push_back(spread(scenes[first], nullptr, name(first)));
        } else {
            SlowestProgress slowest(count);
            const std::string all =
                fmt::format("map spreads {} {} {}{}", map_spreads + 1 + static_cast<int>(first),
                            count == 2 ? "and" : "to", map_spreads + static_cast<int>(first + count), after);
            std::vector<std::future<SpreadResult>> running;
            for (std::size_t k = 0; k < count; ++k)
                running.push_back(std::async(std::launch::async, [&, k] {
                    Progress progress;
                    if (options_.progress)
                        progress = [&, k](const std::string& part, double fraction) {
                            const std::lock_guard lock(books_);
                            const auto& behind = slowest.tell(k, part, fraction);
                            if (behind.stages > 0)
                                options_.progress(fmt::format("{}: {}", all, behind.stage), behind.fraction);
                        };
                    const int runs = static_cast<int>(count),
                              own = options_.threads / runs + (int(k) < options_.threads % runs);
                    struct Ending {
                        std::mutex& books;
                        SlowestProgress& slowest;
                        std::size_t k;
                        ~Ending() {
                            const std::lock_guard lock(books);
                            slowest.end(k);
                        }
                    } ending{books_, slowest, k};
                    return spread_on(own, scenes[first + k], nullptr, name(first + k), 0, progress);
                }));
            for (auto& one : running) one.wait();  // all have ended before one throws
            for (auto& one : running) out.push_back(one.get());
        }
        for (std::size_t k = first; k < out.size(); ++k)
            if (!out[k].health.ok()) {
                out.resize(k + 1);
                return out;
            }
    }
    return out;
}

SpreadResult SpreadRunner::spread_on(int threads, const Scene& scene, const PartitionCurve* partition,
                                     const std::string& stage, int snapshots, const Progress& progress) {
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
            const std::lock_guard lock(books_);
            seconds_saved += result.seconds_cold;
            return result;
        }
        result = SpreadResult{};
    }
    SpreadOptions options;
    options.threads = threads;
    options.machine_share = double(threads) / options_.threads;
    options.cache_folder = options_.cache_folder;
    options.snapshots = snapshots;
    options.stop = options_.stop;
    if (progress)
        options.progress = [&progress](const gradwright::Progress& now) {
            progress(now.stage, now.fraction);
        };
    result =
        options_.spread ? options_.spread(scene, partition, options) : run_spread(scene, partition, options);
    // Failed ones too: they would fail again. What was interrupted is not finished.
    const bool lost = !options_.spread_folder.empty() && result.health.status != "interrupted" &&
                      !write_cache(options_.spread_folder, "spread", key, spread_bytes(result));
    const std::lock_guard lock(books_);
    seconds_saved += result.seconds_cold > result.seconds ? result.seconds_cold - result.seconds : 0;
    if (lost && on_loss)
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
