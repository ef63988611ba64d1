#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "dem/bed.h"
#include "dem/random.h"
#include "dem/stability.h"

namespace gradwright {
namespace {

/// Random sequential placement, largest first, in a box at packing `fill` (0.28: far below the 0.38 where
/// placement jams).
struct Placement {
    std::vector<double> x, y, z, radius;
    std::vector<std::uint8_t> material, chamber;
};

Placement pour(const Scene& scene, const PartitionCurve* partition, double solid_volume, double z_low,
               double fill, Random& random) {
    const double length = scene.dispenser_length, width = scene.width;
    const double height = solid_volume / (fill * length * width);
    // grains of each chamber by its share of the plan area
    const double area_a = partition ? partition->area_a(length, width) : length * width;
    std::array<double, 2> volume = {solid_volume * area_a / (length * width), 0};
    volume[1] = solid_volume - volume[0];
    struct Grain {
        double radius;
        std::uint8_t material, chamber;
    };
    std::vector<Grain> grains;
    for (int chamber = 0; chamber < 2; ++chamber)
        for (int k = 0; k < 2; ++k) {
            // a bed without labels is of powder A alone
            const double of_a = partition ? scene.share_a[chamber] : 1;
            const double wanted = volume[chamber] * (k == 0 ? of_a : 1 - of_a);
            const auto& size = scene.powder[k].size;
            const auto count = static_cast<std::size_t>(std::llround(wanted / size.mean_grain_volume()));
            if (count == 0) continue;
            for (const double d : size.draw(count, random.next()))
                grains.push_back({0.5 * d, static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(chamber)});
        }
    std::stable_sort(grains.begin(), grains.end(),
                     [](const Grain& a, const Grain& b) { return a.radius > b.radius; });

    Placement out;
    const double cell = grains.empty() ? 1 : 2 * grains.front().radius;
    const bool periodic = scene.sides == Sides::periodic;
    const int nx = std::max(1, static_cast<int>(length / cell)),
              ny = std::max(1, static_cast<int>(width / cell));
    const int nz = static_cast<int>(height * 1.6 / cell) + 2;
    std::vector<std::vector<std::int32_t>> cells(static_cast<std::size_t>(nx) * ny * nz);
    double top = height;
    for (const Grain& g : grains) {
        for (int tries = 0;; ++tries) {
            if (tries > 0 && tries % 400 == 0) top = std::min(top + cell, height * 1.6);
            const double r = g.radius;
            const double px = r + random.uniform() * (length - 2 * r);
            const double py = periodic ? random.uniform() * width : r + random.uniform() * (width - 2 * r);
            const double pz = z_low + r + random.uniform() * top;
            if (partition) {
                const double side = partition->signed_distance(px, py);
                if ((g.chamber == 0) != (side > 0)) continue;
                if (std::fabs(side) < 0.5 * scene.plate_thickness + r && scene.plate_thickness > 0) continue;
            }
            const int cx = std::min(static_cast<int>(px / length * nx), nx - 1),
                      cy = std::min(static_cast<int>(py / width * ny), ny - 1);
            const int cz = std::clamp(static_cast<int>((pz - z_low) / cell), 0, nz - 1);
            bool free = true;
            for (int ix = std::max(cx - 1, 0); free && ix <= std::min(cx + 1, nx - 1); ++ix)
                for (int jy = -1; free && jy <= 1; ++jy) {
                    const int iy = periodic ? (cy + jy + ny) % ny : cy + jy;
                    if (iy < 0 || iy >= ny) continue;
                    for (int iz = std::max(cz - 1, 0); free && iz <= std::min(cz + 1, nz - 1); ++iz)
                        for (const std::int32_t j :
                             cells[(static_cast<std::size_t>(ix) * ny + iy) * nz + iz]) {
                            double dy = py - out.y[j];
                            if (periodic) dy -= width * std::nearbyint(dy / width);
                            const double dx = px - out.x[j], dz = pz - out.z[j], s = r + out.radius[j];
                            if (dx * dx + dy * dy + dz * dz < s * s) {
                                free = false;
                                break;
                            }
                        }
                }
            if (!free) continue;
            cells[(static_cast<std::size_t>(cx) * ny + cy) * nz + cz].push_back(
                static_cast<std::int32_t>(out.x.size()));
            out.x.push_back(px);
            out.y.push_back(py);
            out.z.push_back(pz);
            out.radius.push_back(r);
            out.material.push_back(g.material);
            out.chamber.push_back(g.chamber);
            break;
        }
    }
    return out;
}

struct Settling {
    Engine& engine;
    const Scene& scene;
    const SpreadOptions& options;
    double weight = 0;
    double unit_speed() const { return std::sqrt(scene.gravity * scene.powder[0].size.d50); }
    double speed_number() const { return engine.max_speed() / unit_speed(); }
    /// Share of the mobile grains that are faster than a bed at rest allows; what is asleep stands still.
    double moving_share() const {
        const State& s = engine.state();
        const double limit = 0.01 * unit_speed();
        std::size_t moving = 0;
        for (std::size_t i = 0; i < s.size(); ++i)
            moving += s.vx[i] * s.vx[i] + s.vy[i] * s.vy[i] + s.vz[i] * s.vz[i] > limit * limit;
        return static_cast<double>(moving) / static_cast<double>(engine.mobile());
    }
    /// Upward force of floor and walls over the weight of the mobile grains.
    double carried() const {
        double up = -engine.force_on_fixed().z;
        for (std::size_t b = 0; b < engine.bodies().size(); ++b)
            up -= engine.force_on_body(static_cast<int>(b)).z;
        return up / weight;
    }
    void weigh() {
        weight = 0;
        for (std::size_t i = 0; i < engine.state().size(); ++i)
            if (!engine.state().fixed[i]) weight += engine.state().mass[i] * scene.gravity;
    }
    /// Runs until accepted or `most` steps are spent. Grains at rest sleep meanwhile, so that the last
    /// rollers cost little; before a bed is accepted all are woken and must stand for 750 steps, or as long
    /// as none falls asleep again: speed number < 0.01, floor and walls carry the weight within 1 %. The law
    /// has no twisting resistance, so a grain that hangs on one adhesive contact can twirl for ever, and
    /// swing the grains that hang on it: once hardly any grain moves, all motion is quartered from time to
    /// time, less and less often: without friction against rolling a grain may take long to topple, and one
    /// that is held up again and again never does.
    bool settle(long most, const char* stage) {
        weigh();
        engine.wake_all();
        const long start = engine.steps();
        const long burst = 250;
        // Long steps: none may fall asleep again while all must stand, for what sleeps presses on nothing.
        const bool drowsy = 3 * static_cast<double>(burst) * engine.time_step() > engine.sleep_time();
        int bursts = 0, quench = 20, pause = 20;  // in bursts
        while (engine.steps() - start < most && engine.failed().empty()) {
            if (options.stop && options.stop->load()) return false;
            engine.advance(burst);
            const double done = static_cast<double>(engine.steps() - start);
            if (options.progress)
                options.progress({stage, 0.99 * (1 - std::exp(-3 * done / static_cast<double>(most)))});
            if (speed_number() > 0.01) {
                if (++bursts < quench) continue;
                if (moving_share() < 0.01) {
                    engine.scale_velocities(0.25);
                    pause += pause / 4;
                }
                quench = bursts + pause;
                continue;
            }
            engine.wake_all();
            if (drowsy) engine.allow_sleep(false);
            engine.advance(3 * burst);
            if (drowsy) engine.allow_sleep(true);
            if (speed_number() < 0.01 && std::fabs(carried() - 1) < 0.01) return true;
        }
        return false;
    }
};

}  // namespace

double rayleigh_time_step(double radius, double density, double shear_modulus, double poissons_ratio) {
    return std::numbers::pi * radius * std::sqrt(density / shear_modulus) /
           (0.1631 * poissons_ratio + 0.8766);
}

double scene_time_step(const Scene& scene) {
    double least = 1e9;
    for (const Powder& p : scene.powder) {
        const double g = p.material.youngs_modulus * scene.softening / (2 * (1 + p.material.poissons_ratio));
        least = std::min(least, rayleigh_time_step(0.5 * p.size.cut_low, p.material.density, g,
                                                   p.material.poissons_ratio));
    }
    return scene.rayleigh_fraction * least;
}

EngineOptions engine_options(const Scene& scene, int threads) {
    EngineOptions o;
    o.materials = {scene.powder[0].material, scene.powder[1].material, scene.wall};
    o.interaction = scene.interaction;
    o.softening = scene.softening;
    o.adhesion_scaling = scene.adhesion_scaling;
    o.time_step = scene_time_step(scene);
    o.gravity = {0, 0, -scene.gravity};
    o.period_y = scene.sides == Sides::periodic ? scene.width : 0;
    o.precision = scene.precision;
    o.threads = threads;
    o.speed_limit = std::max(5.0, 50 * scene.blade_speed);
    return o;
}

void add_end_walls(Engine& engine, const Scene& scene) {
    for (const double sign : {1.0, -1.0}) {
        Body end;
        end.axis = 0;
        end.sign = sign;
        end.offset = sign > 0 ? 0 : scene.dispenser_length;
        end.material = kWallMaterial;
        engine.add_body(end);
    }
}

void add_bed(Engine& engine, const Bed& bed, bool labelled) {
    for (std::size_t k = 0; k < bed.x.size(); ++k) {
        GrainSpec g;
        g.x = bed.x[k];
        g.y = bed.y[k];
        g.z = bed.z[k];
        g.radius = bed.radius[k];
        g.material = labelled ? bed.material[k] : 0;
        engine.add_grain(g);
    }
}

std::vector<Body> side_walls(const Scene& scene) {
    std::vector<Body> sides;
    if (scene.sides == Sides::periodic) return sides;
    for (const double sign : {1.0, -1.0}) {
        Body side;
        side.axis = 1;
        side.sign = sign;
        side.offset = sign > 0 ? 0 : scene.width;
        side.material = kWallMaterial;
        side.frictionless = scene.sides == Sides::frictionless;
        sides.push_back(side);
    }
    return sides;
}

void add_side_walls(Engine& engine, const Scene& scene) {
    for (const Body& side : side_walls(scene)) engine.add_body(side);
}

std::vector<GrainSpec> rough_surface(double x0, double x1, double width, double plane, double roughness,
                                     std::uint64_t seed) {
    std::vector<GrainSpec> out;
    const double r = 0.5 * roughness, spacing = 0.95 * roughness;
    const int rows = std::max(
        2,
        2 * static_cast<int>(std::ceil(width / (spacing * std::sqrt(3.0)))));  // even: fits a periodic width
    const int columns = std::max(1, static_cast<int>(std::ceil((x1 - x0) / spacing)));
    const double dy = width / rows, dx = (x1 - x0) / columns;
    Random random(seed);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            GrainSpec g;
            g.x = x0 + dx * (column + (row % 2 ? 0.75 : 0.25));
            g.y = dy * (row + 0.5);
            g.z = plane + 0.395 * r - r + 0.1 * roughness * (random.uniform() - 0.5) * 2;
            g.radius = r;
            g.material = kWallMaterial;
            g.fixed = true;
            out.push_back(g);
        }
    return out;
}

double solid_between(const std::vector<double>& z, const std::vector<double>& radius, double low,
                     double high) {
    // Volume of a sphere below a plane at height t above its centre: pi (2 r^3/3 + r^2 t - t^3/3), |t| <= r.
    auto below = [](double r, double t) {
        t = std::clamp(t, -r, r);
        return std::numbers::pi * (2 * r * r * r / 3 + r * r * t - t * t * t / 3);
    };
    double sum = 0;
    for (std::size_t i = 0; i < z.size(); ++i)
        sum += below(radius[i], high - z[i]) - below(radius[i], low - z[i]);
    return sum;
}

Bed pack_bed(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options,
             RunHealth& health) {
    const double start = omp_get_wtime();
    Bed bed;
    // A bed at rest hardly shows it: its overlaps are small, and dashpots and friction hold together what
    // gains energy all the time. Under the blade it would.
    if (scene.rayleigh_fraction > kStabilityEdge) {
        health.status = "unstable_step";
        health.reason = "not packed: " + step_advice(scene.rayleigh_fraction, scene.interaction);
        return bed;
    }
    Random random(scene.seed * 0x9e3779b97f4a7c15ull + 17);
    const double area = scene.dispenser_length * scene.width;
    const double d50 = std::max(scene.powder[0].size.d50, scene.powder[1].size.d50);
    const double wanted_height = scene.floor_depth() + scene.dose_height;
    // Adhesive frictional beds of these powders settle at 0.50-0.60; pour for 0.60 plus one and a half
    // grains, the rest is levelled off.
    const double solid = 0.60 * area * (wanted_height + 1.5 * d50);
    const double z_floor = -scene.floor_depth();

    // Rolling while packing is always the elastic-plastic spring: constant_torque and edem have no rest
    // (grains creep down at up to 4e-4 m/s below its regularisation, twice what "settled" allows). The spread
    // uses the scene's own model.
    EngineOptions eo = engine_options(scene, options.threads);
    if (eo.interaction.rolling_model != RollingModel::none)
        eo.interaction.rolling_model = RollingModel::spring;
    // Nor has a bed rest that loses nothing at its contacts: with e = 1 it rings for ever.
    eo.interaction.coefficient_of_restitution = std::min(eo.interaction.coefficient_of_restitution, 0.5);
    eo.sleep = true;
    eo.sleep_speed = 0.01 * std::sqrt(scene.gravity * scene.powder[0].size.d50);
    Engine engine(eo);
    for (const auto& g : rough_surface(0, scene.dispenser_length, scene.width, z_floor, scene.roughness,
                                       scene.seed ^ 0xf100f))
        engine.add_grain(g);
    const std::size_t first_poured = engine.state().size();  // ids count from 0
    Placement poured = pour(scene, partition, solid, z_floor + 0.4 * scene.roughness, 0.30, random);
    for (std::size_t k = 0; k < poured.x.size(); ++k) {
        GrainSpec g;
        g.x = poured.x[k];
        g.y = poured.y[k];
        g.z = poured.z[k];
        g.vz = -0.05;  // poured, not placed [m/s]
        g.radius = poured.radius[k];
        g.material = poured.material[k];
        engine.add_grain(g);
    }
    add_end_walls(engine, scene);
    add_side_walls(engine, scene);
    std::vector<int> plates;
    const auto add_plate = [&](const std::vector<PlanPoint>& curve) {
        Body body;
        body.kind = Body::Kind::plate;
        // the ends run on straight to the walls, as the partition's rule says
        body.curve = curve;
        auto extend = [&](PlanPoint& tip, const PlanPoint& inner) {
            const double l = std::hypot(tip.x - inner.x, tip.y - inner.y),
                         far = 2 * (scene.dispenser_length + scene.width);
            tip = {tip.x + (tip.x - inner.x) / l * far, tip.y + (tip.y - inner.y) / l * far};
        };
        const auto second = body.curve[1], before = body.curve[body.curve.size() - 2];
        extend(body.curve.front(), second);
        extend(body.curve.back(), before);
        body.half_thickness = 0.5 * scene.plate_thickness;
        body.z0 = z_floor + scene.roughness;
        body.material = kWallMaterial;
        plates.push_back(engine.add_body(body));
    };
    if (scene.plate_thickness > 0 && partition) {
        add_plate(partition->points);
        if (!partition->second.empty()) add_plate(partition->second);
    }

    Settling settling{engine, scene, options};
    const double dt = engine.time_step();
    const long fall = static_cast<long>(std::sqrt(2 * 1.2 * wanted_height / scene.gravity) / dt);
    const long most = 12 * fall + 60000;
    bool settled = settling.settle(most, "pack");

    auto relabel = [&] {
        // Where both powders share sizes, a grain belongs to the side on which it came to rest; else it keeps
        // its powder. In a premix its powder is drawn anew, by a lot of its own.
        if (!partition || !(scene.powder[0].size == scene.powder[1].size)) return false;
        auto& s = engine.state();
        bool changed = false;
        for (std::size_t i = 0; i < s.size(); ++i) {
            if (s.fixed[i]) continue;
            double y = s.y[i];
            if (scene.sides == Sides::periodic) y -= scene.width * std::floor(y / scene.width);
            const std::uint8_t side = partition->on_side_a(s.x[i], y) ? 0 : 1;
            std::uint8_t& chamber = poured.chamber[static_cast<std::size_t>(s.id[i]) - first_poured];
            if (side == chamber) continue;
            chamber = side;
            Random lot(scene.seed ^ (0x9e3779b97f4a7c15ull * (static_cast<std::uint64_t>(s.id[i]) + 1)));
            const std::uint8_t powder = lot.uniform() < scene.share_a[side] ? 0 : 1;
            if (powder == s.material[i]) continue;
            changed = true;
            engine.set_material(i, powder);
        }
        return changed;
    };
    if (settled && !plates.empty()) {
        for (const int plate : plates) engine.remove_body(plate);  // withdrawn at once; the slot collapses
        settled = settling.settle(most, "withdraw");
    }
    if (settled && plates.empty() && relabel()) settled = settling.settle(most, "settle");

    if (!engine.failed().empty()) {
        health.status = "diverged";
        health.reason = fmt::format("packing diverged ({}); {}", engine.failed(),
                                    step_advice(scene.rayleigh_fraction, scene.interaction));
    } else if (options.stop && options.stop->load()) {
        health.status = "interrupted";
        health.reason = "stopped while packing";
    } else if (!settled) {
        health.status = "not_settled";
        health.reason = fmt::format(
            "the bed did not come to rest in {} steps (speed number {:.3g}, carried weight {:.3g}); lower "
            "the work "
            "of adhesion or the time step",
            most, settling.speed_number(), settling.carried());
    } else {
        health.status = "ok";
    }

    const State& s = engine.state();
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < s.size(); ++i)
        if (!s.fixed[i]) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return s.id[a] < s.id[b]; });
    std::vector<double> diameters;
    for (const std::size_t i : order) {
        bed.x.push_back(s.x[i]);
        double y = s.y[i];
        if (scene.sides == Sides::periodic) y -= scene.width * std::floor(y / scene.width);
        bed.y.push_back(y);
        bed.z.push_back(s.z[i]);
        bed.radius.push_back(s.radius[i]);
        bed.material.push_back(s.material[i]);
        diameters.push_back(2 * s.radius[i]);
    }
    auto& f = bed.facts;
    if (!bed.z.empty()) {
        // Between one grain above the floor and one below the fuzzy top.
        std::vector<double> sorted(bed.z);
        std::sort(sorted.begin(), sorted.end());
        const double low = z_floor + d50, high = std::max(sorted[sorted.size() * 97 / 100] - d50, low + d50);
        f.packing_fraction = solid_between(bed.z, bed.radius, low, high) / (area * (high - low));
        const auto q = volume_quantiles(diameters);
        f.made_d10_d50_d90 = {q.d10, q.d50, q.d90};
    }
    f.mean_coordination = engine.mean_coordination();
    f.max_overlap_ratio = engine.max_overlap_ratio();
    f.speed_number = settling.speed_number();
    f.carried_weight_ratio = settling.carried();
    f.steps = engine.steps();
    f.seconds = f.seconds_cold = options.machine_share * (omp_get_wtime() - start);
    return bed;
}

}  // namespace gradwright
