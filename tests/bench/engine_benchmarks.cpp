// What each stage of a step costs, alone: the law in the cache, the search for pairs, the sums, the walls.
// `gradwright bench` times whole steps on real beds; here one sees which line of the engine a change has
// moved. Items are contacts, grains or grain-steps as the name says.
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "dem/bed.h"
#include "dem/contact_law.h"
#include "dem/random.h"

namespace gradwright {
namespace {

// --- the law: 1024 contacts of a powder bed, in the cache
// ---------------------------------------------------

template <class T>
struct LawInput {
    std::vector<Contact<T>> contact;
    std::vector<ContactHistory<T>> history;
};

template <class T>
T drawn(Random& random, double low, double high) {
    if constexpr (Lane<T>::kWidth == 1) {
        return low + (high - low) * random.uniform();
    } else {
        T out{};
        for (int lane = 0; lane < Lane<T>::kWidth; ++lane)
            out[lane] = static_cast<float>(low + (high - low) * random.uniform());
        return out;
    }
}

template <class T>
LawInput<T> law_input(int contacts) {
    Random random(7);
    LawInput<T> in;
    for (int k = 0; k < contacts / Lane<T>::kWidth; ++k) {
        Contact<T> c{};
        c.nx = splat<T>(0.6), c.ny = splat<T>(0), c.nz = splat<T>(0.8);
        c.overlap = drawn<T>(random, 1e-9, 3e-7);
        c.vx = drawn<T>(random, -0.01, 0.01), c.vy = drawn<T>(random, -0.01, 0.01),
        c.vz = drawn<T>(random, -0.01, 0.01);
        c.wix = drawn<T>(random, -50, 50), c.wiy = drawn<T>(random, -50, 50),
        c.wiz = drawn<T>(random, -50, 50);
        c.wjx = drawn<T>(random, -50, 50), c.wjy = drawn<T>(random, -50, 50),
        c.wjz = drawn<T>(random, -50, 50);
        c.arm_i = c.arm_j = c.reach_i = c.reach_j = splat<T>(20e-6);
        c.radius = splat<T>(10e-6), c.mass = splat<T>(1.3e-10);
        c.e_star = splat<T>(1.15e7), c.g_star8 = splat<T>(3.8e7), c.jkr_radius = splat<T>(3.1e-7);
        c.touching = splat<T>(1);
        in.contact.push_back(c);
        in.history.push_back(
            {splat<T>(1e-9), splat<T>(0), splat<T>(-1e-9), splat<T>(1e-4), splat<T>(0), splat<T>(0)});
    }
    return in;
}

template <class T, bool kAdhesive, RollingModel kRolling>
void law(benchmark::State& state) {
    constexpr int kContacts = 1024;
    LawInput<T> in = law_input<T>(kContacts);
    LawConstants constants;
    constants.time_step = 2.4e-7;
    constants.static_friction = 0.64;
    constants.rolling_friction = 0.1;
    constants.damping_factor = 0.4;
    const LawFault fault;
    for ([[maybe_unused]] auto _ : state) {
        T sum{};
        for (std::size_t k = 0; k < in.contact.size(); ++k) {
            const auto out =
                contact_law<T, kAdhesive, kRolling>(constants, fault, in.contact[k], in.history[k]);
            sum += out.fx + out.tiy + out.tjz;
        }
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(state.iterations() * kContacts);
}

// --- steps on a packed bed ---------------------------------------------------------------------------------

/// Some hundred grains of the default powder, packed once.
const Scene& bed_scene() {
    static const Scene scene = [] {
        Scene s;
        s.dispenser_length = 0.6e-3;
        s.width = 0.4e-3;
        s.bed_depth = 80e-6;
        s.dose_height = 80e-6;
        s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
        s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
        for (Powder& powder : s.powder) powder.size.cut_low = 25e-6, powder.size.cut_high = 62e-6;
        s.wall = s.powder[0].material;
        return s;
    }();
    return scene;
}

std::unique_ptr<Engine> packed(benchmark::State& state, Precision precision) {
    static RunHealth health;
    static const Bed bed = [] {
        SpreadOptions options;
        options.threads = 1;
        return pack_bed(bed_scene(), nullptr, options, health);
    }();
    if (!health.ok()) state.SkipWithError(health.reason.c_str());
    Scene scene = bed_scene();
    scene.precision = precision;
    auto engine = std::make_unique<Engine>(engine_options(scene, 1));
    for (const auto& grain :
         rough_surface(0, scene.dispenser_length, scene.width, -scene.bed_depth, scene.roughness, 1))
        engine->add_grain(grain);
    add_bed(*engine, bed, false);
    add_end_walls(*engine, scene);
    engine->advance(3000);  // contacts form anew
    if (!engine->failed().empty()) state.SkipWithError(engine->failed().c_str());
    return engine;
}

/// One stage of the step by the engine's own clock, per grain-step.
template <double EngineTimes::*kStage>
void stage(benchmark::State& state) {
    const auto engine = packed(state, state.range(0) ? Precision::double_law : Precision::single_law);
    const double before = engine->grain_steps();
    for ([[maybe_unused]] auto _ : state) {
        const double start = engine->times().*kStage;
        engine->advance(400);
        state.SetIterationTime(engine->times().*kStage - start);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(engine->grain_steps() - before));
    state.counters["contacts/grain"] = double(engine->contacts()) / double(engine->mobile());
}

/// Cell order, candidates, near pairs and records from scratch, and one step; per grain.
void lists_from_scratch(benchmark::State& state) {
    const auto engine = packed(state, Precision::single_law);
    for ([[maybe_unused]] auto _ : state) {
        engine->refresh();
        engine->advance(1);
    }
    state.SetItemsProcessed(state.iterations() * std::int64_t(engine->state().size()));
}

/// Grains that touch a floor and nothing else, per grain-step.
void walls(benchmark::State& state) {
    Scene scene = bed_scene();
    scene.width = 2e-3;
    Engine engine(engine_options(scene, 1));
    Body floor;  // the plane z = 0
    floor.material = kWallMaterial;
    engine.add_body(floor);
    const int side = 24;
    for (int i = 0; i < side * side; ++i) {
        GrainSpec grain;
        grain.x = 60e-6 * (i % side);
        grain.y = 60e-6 * (i / side);
        grain.z = 19.99e-6;
        grain.radius = 20e-6;
        engine.add_grain(grain);
    }
    engine.advance(200);
    const double before = engine.grain_steps();
    for ([[maybe_unused]] auto _ : state) {
        const double start = engine.times().law;
        engine.advance(400);
        state.SetIterationTime(engine.times().law - start);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(engine.grain_steps() - before));
}

// --- the machine: what one core moves to and from memory that no cache holds; a bed of a million grains is
// read once and half of it written in every step -----------------------------------------------------------

template <bool kWrites>
void memory(benchmark::State& state) {
    AlignedVector<D8> row(std::size_t{1} << 22, D8{1, 1, 1, 1, 1, 1, 1, 1});  // 256 MB
    for ([[maybe_unused]] auto _ : state) {
        D8 sum[4] = {};
        for (std::size_t k = 0; k < row.size(); k += 4)
            for (std::size_t lane = 0; lane < 4; ++lane) {
                sum[lane] += row[k + lane];
                if constexpr (kWrites) row[k + lane] *= 0.5;
            }
        benchmark::DoNotOptimize(sum);
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * std::int64_t(row.size() * sizeof(D8)) * (kWrites ? 2 : 1));
}

BENCHMARK(law<double, false, RollingModel::none>);
BENCHMARK(law<double, true, RollingModel::constant_torque>);
BENCHMARK(law<WideFloat, false, RollingModel::none>);
BENCHMARK(law<WideFloat, true, RollingModel::none>);
BENCHMARK(law<WideFloat, true, RollingModel::constant_torque>);
BENCHMARK(law<WideFloat, true, RollingModel::edem>);
BENCHMARK(law<WideFloat, true, RollingModel::spring>);
BENCHMARK(stage<&EngineTimes::law>)
    ->Name("contacts_of_a_bed")
    ->ArgName("double")
    ->Arg(0)
    ->Arg(1)
    ->UseManualTime();
BENCHMARK(stage<&EngineTimes::grains>)
    ->Name("sums_and_motion_of_a_bed")
    ->ArgName("double")
    ->Arg(0)
    ->Arg(1)
    ->UseManualTime();
BENCHMARK(stage<&EngineTimes::near_list>)
    ->Name("near_pairs_of_a_bed")
    ->ArgName("double")
    ->Arg(0)
    ->UseManualTime();
BENCHMARK(lists_from_scratch);
BENCHMARK(walls)->UseManualTime();
BENCHMARK(memory<false>);
BENCHMARK(memory<true>);

}  // namespace
}  // namespace gradwright

BENCHMARK_MAIN();
