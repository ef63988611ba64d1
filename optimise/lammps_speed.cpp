#include "optimise/lammps_speed.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>

#include "dem/bed.h"
#include "dem/stage.h"
#include "optimise/lammps_deck.h"
#include "optimise/lammps_run.h"

namespace gradwright {
namespace {

namespace fs = std::filesystem;

constexpr double kTilt = std::numbers::pi / 3, kPull = 10;  // flowing: angle, times the weight
constexpr long kMostToSlide = 60000;                        // steps

/// The deck up to its first `run`, with this weight.
std::string opening(const std::string& deck, const Scene& scene, bool flowing) {
    std::string text = deck.substr(0, deck.find("\nrun ") + 1);
    const std::size_t at = text.find("fix weight "), end = text.find('\n', at);
    if (flowing)
        text.replace(at, end - at,
                     fmt::format("fix weight mobile gravity {:.17g} vector 0 {:.17g} {:.17g}",
                                 kPull * scene.gravity, std::sin(kTilt), -std::cos(kTilt)));
    // the blade stands: it is no part of what is timed
    const std::size_t way = text.find("variable way equal"), way_end = text.find('\n', way);
    text.replace(way, way_end - way, "variable way equal 0");
    const std::size_t thermo = text.find("\nthermo ") + 1, thermo_end = text.find('\n', thermo);
    text.replace(thermo, thermo_end - thermo, "thermo 100000");
    return text;
}

/// The data file with the places and velocities of `state`.
std::string data_of(const Scene& scene, const Stage& stage, const State& state) {
    Stage moved = stage;
    std::vector<std::size_t> by_id(state.size());
    for (std::size_t i = 0; i < state.size(); ++i) by_id[static_cast<std::size_t>(state.id[i])] = i;
    const std::size_t fixed = stage.fixed.size();
    std::string velocities = "\nVelocities\n\n";
    for (std::size_t k = 0; k < stage.bed.x.size(); ++k) {
        const std::size_t i = by_id[fixed + k];
        moved.bed.x[k] = state.x[i];
        moved.bed.y[k] = state.y[i] - scene.width * std::floor(state.y[i] / scene.width);
        moved.bed.z[k] = state.z[i];
    }
    for (std::size_t id = 0; id < by_id.size(); ++id) {
        const std::size_t i = by_id[id];
        velocities += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", id + 1, state.vx[i],
                                  state.vy[i], state.vz[i], state.wx[i], state.wy[i], state.wz[i]);
    }
    return lammps_bed(scene, moved) + velocities;
}

/// Seconds of the last "Loop time of ..." in a log.
double loop_seconds(const fs::path& log) {
    std::ifstream file(log);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const std::string mark = "Loop time of ";
    const std::size_t at = text.rfind(mark);
    if (at == std::string::npos) throw LammpsError("LAMMPS's log tells no loop time", "read " + log.string());
    return std::strtod(text.c_str() + at + mark.size(), nullptr);
}

}  // namespace

EngineSpeed run_engine_speed(const Scene& scene, const EngineSpeedOptions& options) {
    EngineSpeed out;
    if (const std::string obstacle = lammps_obstacle(scene); !obstacle.empty()) {
        out.health.status = "invalid";
        out.health.reason = obstacle;
        return out;
    }
    const LammpsProgram program = find_lammps(options.ranks);
    SpreadOptions spread;
    spread.threads = options.threads;
    spread.cache_folder = options.cache_folder;
    spread.stop = options.stop;
    spread.progress = [&](const Progress& p) {
        if (options.progress) options.progress(p.stage, p.fraction);
    };
    const Stage stage = set_stage(scene, nullptr, spread, out.health);
    if (!out.health.ok()) return out;
    const std::string deck = lammps_deck(scene, stage, {options.ranks, {}, false});
    const long warming = std::max(1L, options.steps / 10);

    for (const bool flowing : {false, true}) {
        EngineSpeedCase one;
        one.name = flowing ? "flowing" : "settled";
        one.grains = static_cast<long>(stage.bed.x.size());
        EngineOptions eo = engine_options(scene, options.threads);
        eo.sleep = false;
        if (flowing)
            eo.gravity = {0, kPull * scene.gravity * std::sin(kTilt),
                          -kPull * scene.gravity * std::cos(kTilt)};
        Engine engine(eo);
        for (const GrainSpec& grain : stage.fixed) engine.add_grain(grain);
        for (const Body& body : stage.bodies) engine.add_body(body);
        add_bed(engine, stage.bed, stage.labelled);
        const auto sliding = [&] {
            double sum = 0;
            const State& s = engine.state();
            for (std::size_t i = 0; i < s.size(); ++i)
                if (!s.fixed[i]) sum += s.vy[i];
            return sum / static_cast<double>(engine.mobile());
        };
        for (long done = 0; flowing && sliding() < scene.blade_speed && done < kMostToSlide; done += 500) {
            engine.advance(500);
            if (options.progress) options.progress("set in motion", double(done) / kMostToSlide);
        }
        if (flowing && sliding() < scene.blade_speed) {
            out.health.status = "not_flowing";
            out.health.reason = "the bed does not slide under ten times its weight: lower the friction";
            return out;
        }
        const fs::path folder = fs::path(options.folder) / one.name;
        fs::create_directories(folder);
        write_deck_file(folder / kLammpsBed, data_of(scene, stage, engine.state()));
        for (const double skin : options.skins) {
            std::string text = opening(deck, scene, flowing);
            const std::size_t at = text.find("variable skin index"), end = text.find('\n', at);
            text.replace(at, end - at, fmt::format("variable skin index {:.3g}", skin));
            const std::string name = fmt::format("in.skin-{:.3g}", skin * 1e6);
            write_deck_file(folder / name,
                            text + fmt::format("run {}\nrun {} pre no\n", warming, options.steps));
            LammpsRunOptions run;
            run.folder = folder.string();
            run.input = name;
            run.ranks = options.ranks;
            run.stop = options.stop;
            if (options.progress) options.progress(one.name + " in LAMMPS", 0);
            const LammpsRun ran = run_lammps(program, run);
            out.version = ran.version;
            if (ran.interrupted) {
                out.health.status = "interrupted";
                return out;
            }
            one.lammps_by_skin.push_back(double(one.grains) * double(options.steps) /
                                         loop_seconds(folder / "log.lammps"));
            if (one.lammps_by_skin.back() > one.lammps) {
                one.lammps = one.lammps_by_skin.back();
                one.best_skin = skin;
            }
        }
        // Ours last, so that it finds the machine as LAMMPS left it.
        if (options.progress) options.progress(one.name, 0);
        engine.advance(warming);
        // a bed at rest is still on its first list of pairs, made before anything touched: the next one
        // counts
        engine.refresh();
        const double start = omp_get_wtime();
        engine.advance(options.steps);
        one.ours = double(one.grains) * double(options.steps) / (omp_get_wtime() - start);
        if (!engine.failed().empty()) {
            out.health.status = "diverged";
            out.health.reason = engine.failed();
            return out;
        }
        one.ratio = one.ours / one.lammps;
        out.cases.push_back(one);
    }
    return out;
}

}  // namespace gradwright
