#include "dem/bench.h"

#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <stdexcept>
#include <thread>

#include "dem/bed.h"

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

BenchResult run_bench(const BenchOptions& options) {
    BenchResult out;
    out.cores = static_cast<int>(std::thread::hardware_concurrency());
    out.isa = compiled_isa();
    for (const double wanted : options.grains) {
        Scene scene = options.scene;
        scene.sleep = false;
        // the default study's cross-section, longer or wider until the number of grains fits
        const double per_area = estimate_cost(scene).grains / (scene.dispenser_length * scene.width);
        const double area = wanted * 1.08 / per_area;
        if (area < scene.dispenser_length * 0.4e-3) scene.dispenser_length = area / 0.4e-3;
        scene.width = area / scene.dispenser_length;
        SpreadOptions so;
        so.cache_folder = options.cache_folder;
        if (options.progress)
            so.progress = [&](const Progress& p) {
                options.progress(fmt::format("{:.0f} grains: {}", wanted, p.stage), p.fraction);
            };
        RunHealth health;
        const Bed bed = cached_bed(scene, nullptr, so, health);
        if (!health.ok()) throw std::runtime_error("bench: " + health.status + ": " + health.reason);
        for (const int threads : options.threads) {
            EngineOptions eo = engine_options(scene, threads);
            Engine engine(eo);
            for (const auto& g : rough_surface(0, scene.dispenser_length, scene.width, -scene.bed_depth,
                                               scene.roughness, scene.seed ^ 0xf100f))
                engine.add_grain(g);
            add_bed(engine, bed, false);
            add_end_walls(engine, scene);
            add_side_walls(engine, scene);
            engine.advance(200);
            const EngineTimes before = engine.times();
            const double steps_before = engine.grain_steps(), start = omp_get_wtime();
            engine.advance(options.steps);
            BenchCase c;
            c.seconds = omp_get_wtime() - start;
            c.name = "settled";
            c.grains = static_cast<long>(engine.mobile());
            c.threads = threads;
            c.grain_steps_per_second = (engine.grain_steps() - steps_before) / c.seconds;
            c.stages = {{"law", engine.times().law - before.law},
                        {"grains", engine.times().grains - before.grains},
                        {"near_list", engine.times().near_list - before.near_list},
                        {"candidates", engine.times().candidates - before.candidates}};
            c.bytes_per_grain = engine.memory_bytes() / static_cast<double>(engine.state().size());
            c.contacts_per_grain =
                static_cast<double>(engine.contacts()) / static_cast<double>(engine.mobile());
            c.state_hash = engine.state_hash();
            out.cases.push_back(c);
        }
    }
    return out;
}

}  // namespace gradwright
