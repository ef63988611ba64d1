#include "dem/bench.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "dem/stage.h"

namespace gradwright {

std::string compiled_isa() {
#if defined(__AVX512F__)
    return "AVX-512";
#elif defined(__AVX2__)
    return "AVX2";
#elif defined(__AVX__)
    return "AVX";
#elif defined(__SSE2__)
    return "SSE2";
#elif defined(__ARM_NEON)
    return "NEON";
#else
    return "baseline";
#endif
}

namespace {

double core_round_trip() {
    if (omp_get_num_procs() < 2) return std::numeric_limits<double>::quiet_NaN();
    constexpr double kSeconds = 0.02;
    constexpr int kAtOnce = 100;  // trips between two looks at the clock
    alignas(64) std::atomic<int> turn{0};
    double seconds = 0;
    long trips = 0;
#pragma omp parallel num_threads(2)
    if (omp_get_num_threads() == 2) {
        if (omp_get_thread_num() == 0) {
            const double start = omp_get_wtime();
            for (; seconds < kSeconds; seconds = omp_get_wtime() - start, trips += kAtOnce)
                for (int k = 0; k < kAtOnce; ++k) {
                    turn.store(1, std::memory_order_release);
                    while (turn.load(std::memory_order_acquire) != 0) {
                    }
                }
            turn.store(2, std::memory_order_release);
        } else {
            for (int now; (now = turn.load(std::memory_order_acquire)) != 2;)
                if (now == 1) turn.store(0, std::memory_order_release);
        }
    }
    return trips > 0 ? seconds / static_cast<double>(trips) : std::numeric_limits<double>::quiet_NaN();
}

BenchCase timed(Engine& engine, const std::string& name, int threads, long steps) {
    const EngineTimes before = engine.times();
    const double steps_before = engine.grain_steps(), start = omp_get_wtime();
    engine.advance(steps);
    BenchCase c;
    c.seconds = omp_get_wtime() - start;
    c.name = name;
    c.grains = static_cast<long>(engine.mobile());
    c.threads = threads;
    c.grain_steps_per_second = (engine.grain_steps() - steps_before) / c.seconds;
    c.awake_share =
        (engine.grain_steps() - steps_before) / (static_cast<double>(steps) * static_cast<double>(c.grains));
    c.stages = {{"law", engine.times().law - before.law},
                {"grains", engine.times().grains - before.grains},
                {"near_list", engine.times().near_list - before.near_list},
                {"candidates", engine.times().candidates - before.candidates}};
    c.bytes_per_grain = engine.memory_bytes() / static_cast<double>(engine.state().size());
    c.contacts_per_grain = static_cast<double>(engine.contacts()) / static_cast<double>(engine.mobile());
    c.steps_at_once = engine.steps_at_once();
    c.near_pairs_per_grain = static_cast<double>(engine.near_pairs()) / static_cast<double>(engine.mobile());
    c.steps_per_near_list =
        static_cast<double>(steps) / static_cast<double>(engine.times().near_lists - before.near_lists);
    c.steps_per_candidate_list = static_cast<double>(steps) /
                                 static_cast<double>(engine.times().candidate_lists - before.candidate_lists);
    if (threads > 1) c.core_round_trip = core_round_trip();
    c.state_hash = engine.state_hash();
    if (!engine.failed().empty()) throw std::runtime_error("bench: " + name + ": " + engine.failed());
    return c;
}

/// `copies` of a bed of period `width` side by side along y.
Bed side_by_side(const Bed& one, double width, int copies) {
    Bed out = one;
    for (int copy = 1; copy < copies; ++copy)
        for (std::size_t k = 0; k < one.x.size(); ++k) {
            out.x.push_back(one.x[k]);
            out.y.push_back(one.y[k] + copy * width);
            out.z.push_back(one.z[k]);
            out.radius.push_back(one.radius[k]);
            out.material.push_back(one.material[k]);
        }
    return out;
}

/// The packed bed on its floor, `copies` times side by side. Settled: at rest under its weight. Flowing:
/// under ten times its weight at 60 degrees across the periodic width, until it slides over its floor as fast
/// as the blade would push it.
BenchCase of_bed(const Scene& tile, const Bed& one, int copies, bool flowing, int threads,
                 const BenchOptions& options) {
    Scene scene = tile;
    scene.width *= copies;
    const Bed bed = side_by_side(one, tile.width, copies);
    EngineOptions eo = engine_options(scene, threads);
    if (flowing) {
        const double g = 10 * scene.gravity;
        eo.gravity = {0, g * std::sin(std::numbers::pi / 3), -g * std::cos(std::numbers::pi / 3)};
    }
    Engine engine(eo);
    for (int copy = 0; copy < copies; ++copy)
        for (auto g : rough_surface(0, tile.dispenser_length, tile.width, -tile.bed_depth, tile.roughness,
                                    tile.seed ^ 0xf100f)) {
            g.y += copy * tile.width;
            engine.add_grain(g);
        }
    add_bed(engine, bed, false);
    add_end_walls(engine, scene);
    add_side_walls(engine, scene);
    engine.advance(200);
    // The first list of pairs knows of no contact yet and mixes pairs that touch with those that do not;
    // every later one puts them apart. A bed at rest would keep the slow first one all the time.
    engine.refresh();
    engine.advance(1);
    if (flowing) {
        const auto speed = [&engine] {
            double sum = 0;
            const State& s = engine.state();
            for (std::size_t i = 0; i < s.size(); ++i)
                if (!s.fixed[i]) sum += s.vy[i];
            return sum / static_cast<double>(engine.mobile());
        };
        for (int k = 0; k < 200 && speed() < scene.blade_speed && engine.failed().empty(); ++k)
            engine.advance(200);
        if (speed() < scene.blade_speed)
            throw std::runtime_error("bench: flowing: the bed does not slide under ten times its weight");
    }
    return timed(engine, flowing ? "flowing" : "settled", threads, options.steps);
}

/// A spread as it runs, sleeping grains and all, timed when the blade has gone a quarter of the dispenser and
/// a heap stands before it.
BenchCase of_spread(const Scene& scene, const Stage& stage, int threads, const BenchOptions& options) {
    EngineOptions eo = engine_options(scene, threads);
    eo.sleep = scene.sleep;
    eo.remove_beyond_x = platform_end(scene) + scene.second_land;
    Engine engine(eo);
    for (const GrainSpec& grain : stage.fixed) engine.add_grain(grain);
    for (const Body& body : stage.bodies) engine.add_body(body);
    add_bed(engine, stage.bed, stage.labelled);
    engine.start_bodies();
    const double way = 0.25 * scene.dispenser_length;
    while (engine.body_shift_x(stage.blade) < way && engine.failed().empty()) {
        engine.advance(500);
        if (options.progress)
            options.progress("heap before the blade", std::min(0.99, engine.body_shift_x(stage.blade) / way));
    }
    return timed(engine, "spread", threads, options.steps);
}

}  // namespace

BenchResult run_bench(const BenchOptions& options) {
    BenchResult out;
    out.cores = static_cast<int>(std::thread::hardware_concurrency());
    out.isa = compiled_isa();
    for (const double wanted : options.grains) {
        Scene scene = options.scene;
        scene.sides = Sides::periodic;
        // one pass is timed, over nothing that moves
        scene.layers = 1;
        if (scene.substrate == Substrate::powder) scene.substrate = Substrate::fused;
        // the default study's cross-section, longer or wider until the number of grains fits
        const double per_area = estimate_cost(scene).grains / (scene.dispenser_length * scene.width);
        const double area = wanted * 1.08 / per_area;
        if (area < scene.dispenser_length * 0.4e-3) scene.dispenser_length = area / 0.4e-3;
        scene.width = area / scene.dispenser_length;
        const auto spreads = std::count(options.states.begin(), options.states.end(), "spread");
        const int copies =
            spreads > 0 ? 1 : std::max(1, static_cast<int>(std::ceil(wanted / options.largest_packed)));
        scene.width /= copies;
        SpreadOptions so;
        so.cache_folder = options.cache_folder;
        if (options.progress)
            so.progress = [&](const Progress& p) {
                options.progress(fmt::format("{:.0f} grains: {}", wanted, p.stage), p.fraction);
            };
        RunHealth health;
        const bool rests = spreads < static_cast<std::ptrdiff_t>(options.states.size());
        const Bed bed = rests ? cached_bed(scene, nullptr, so, health) : Bed{};
        if (rests && !health.ok()) throw std::runtime_error("bench: " + health.status + ": " + health.reason);
        const Stage stage = spreads > 0 ? set_stage(scene, nullptr, so, health) : Stage{};
        if (spreads > 0 && !health.ok())
            throw std::runtime_error("bench: " + health.status + ": " + health.reason);
        for (const std::string& state : options.states)
            for (const int threads : options.threads)
                out.cases.push_back(state == "spread"
                                        ? of_spread(scene, stage, threads, options)
                                        : of_bed(scene, bed, copies, state == "flowing", threads, options));
    }
    return out;
}

}  // namespace gradwright
