#include "dem/bulk.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dem/bed.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Height of the powder in bins along x: solid in the bin over the bed's packing and the bin's plan area.
void read_surface(const Engine& engine, const ReposeSetup& setup, double packing, double bin,
                  ReposeResult& out) {
    const int bins = std::max(1, static_cast<int>(setup.length / bin));
    const double width = setup.length / bins;
    std::vector<double> solid(bins, 0);
    const State& s = engine.state();
    for (std::size_t i = 0; i < s.size(); ++i)
        if (!s.fixed[i] && s.x[i] >= 0 && s.x[i] < setup.length)
            solid[std::min(bins - 1, static_cast<int>(s.x[i] / width))] += sphere_volume(s.radius[i]);
    for (int k = 0; k < bins; ++k) {
        out.x.push_back((k + 0.5) * width);
        out.surface.push_back(solid[k] / (packing * width * setup.width));
    }
    out.gate_height = out.surface.back();
    out.back_height = out.surface.front();
}

/// Least squares over the slope alone: from where the surface falls below nine tenths of its height (a bed
/// that drains only near the gate keeps a level back) to `margin` before the edge, where more than `least` of
/// powder lies.
void fit_slope(ReposeResult& out, double length, double margin, double least) {
    const double top = *std::max_element(out.surface.begin(), out.surface.end());
    std::size_t first = 0;
    for (std::size_t k = 0; k < out.x.size(); ++k)
        if (out.surface[k] >= 0.9 * top) first = k + 1;
    std::vector<double> x, z;
    for (std::size_t k = first; k < out.x.size(); ++k)
        if (out.x[k] < length - margin && out.surface[k] > least) {
            x.push_back(out.x[k]);
            z.push_back(out.surface[k]);
        }
    out.angle_deg = out.fit_error_deg = kNan;
    const double n = static_cast<double>(x.size());
    if (x.size() < 4) return;
    double mx = 0, mz = 0, sxx = 0, sxz = 0, residual = 0;
    for (std::size_t k = 0; k < x.size(); ++k) mx += x[k] / n, mz += z[k] / n;
    for (std::size_t k = 0; k < x.size(); ++k)
        sxx += (x[k] - mx) * (x[k] - mx), sxz += (x[k] - mx) * (z[k] - mz);
    const double slope = sxz / sxx;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double e = z[k] - mz - slope * (x[k] - mx);
        residual += e * e;
    }
    const double error = std::sqrt(residual / (n - 2) / sxx), degree = 180 / std::numbers::pi;
    out.angle_deg = std::atan(-slope) * degree;
    out.fit_error_deg = error / (1 + slope * slope) * degree;
}

}  // namespace

ReposeResult drain(const Scene& scene, const ReposeSetup& setup, const SpreadOptions& options) {
    const double start = omp_get_wtime();
    ReposeResult out;
    Scene s = scene;
    s.dispenser_length = setup.length;
    s.width = setup.width;
    s.sides = Sides::periodic;
    s.headspace = {0, 0};
    s.plate_thickness = 0;
    // the bed's own datum z = 0 has no meaning here; all of it is powder
    s.bed_depth = s.powder[0].size.d50;
    s.dose_height = setup.height - s.bed_depth;
    Bed bed = cached_bed(s, nullptr, options, out.health);
    out.bed = bed.facts;
    if (!out.health.ok()) return out;

    EngineOptions eo = engine_options(s, options.threads);
    eo.sleep = s.sleep;
    eo.remove_beyond_x = setup.length + 2 * s.powder[0].size.cut_high;
    Engine engine(eo);
    for (const auto& g :
         rough_surface(0, s.dispenser_length, s.width, -s.bed_depth, s.roughness, s.seed ^ 0xf100f))
        engine.add_grain(g);
    // level: what was poured above the height asked for goes
    Bed kept;
    for (std::size_t k = 0; k < bed.x.size(); ++k) {
        if (bed.z[k] > s.dose_height) continue;
        kept.x.push_back(bed.x[k]), kept.y.push_back(bed.y[k]), kept.z.push_back(bed.z[k]);
        kept.radius.push_back(bed.radius[k]), kept.material.push_back(bed.material[k]);
    }
    add_bed(engine, kept, false);
    Body back;
    back.axis = 0;
    back.material = kWallMaterial;
    engine.add_body(back);
    out.grains = static_cast<long>(kept.x.size());
    const double d = s.powder[0].size.number_quantile(0.5);
    out.bond_number = 1.5 * std::numbers::pi * 0.25 * d * engine.work_of_adhesion() /
                      (s.powder[0].material.density * sphere_volume(0.5 * d) * s.gravity);
    double solid = 0;
    for (const double r : kept.radius) solid += sphere_volume(r);

    // Quiet: mean kinetic energy per grain below 1e-4 m g d, seen twice a fall over one grain apart.
    const double quiet = 1e-4 * s.powder[0].material.density * s.powder[0].size.mean_grain_volume() *
                         s.gravity * s.powder[0].size.d50;
    const double fall = std::sqrt(2 * s.powder[0].size.d50 / s.gravity);
    const long burst = std::max(200L, std::lround(fall / engine.time_step()));
    int calm = 0;
    while (engine.time() < setup.longest && engine.failed().empty() && calm < 2) {
        if (options.stop && options.stop->load()) break;
        engine.advance(burst);
        const double grains = static_cast<double>(std::max<std::size_t>(1, engine.mobile()));
        calm = engine.kinetic_energy() < quiet * grains ? calm + 1 : 0;
        if (options.progress) options.progress({"drain", std::min(0.99, engine.time() / setup.longest)});
    }
    out.at_rest = calm >= 2;
    out.flow_time = engine.time();
    out.health.max_overlap_ratio = engine.max_overlap_ratio_seen();
    if (!engine.failed().empty()) {
        out.health.status = "diverged";
        out.health.reason = "the draining heap diverged (" + engine.failed() +
                            "); lower numerics.time_step.rayleigh_fraction";
    } else if (options.stop && options.stop->load()) {
        out.health.status = "interrupted";
    }
    const State& state = engine.state();
    double left = 0;
    for (std::size_t i = 0; i < state.size(); ++i)
        if (!state.fixed[i] && state.x[i] < setup.length) {
            left += sphere_volume(state.radius[i]);
            ++out.left;
        }
    out.left_fraction = solid > 0 ? left / solid : 0;
    const double d50 = s.powder[0].size.d50;
    read_surface(engine, setup, std::max(out.bed.packing_fraction, 0.3), d50, out);
    fit_slope(out, setup.length, 2 * d50, 1.5 * d50);
    out.seconds = omp_get_wtime() - start;
    return out;
}

std::vector<double> coverage_along(const Layer& layer, int parts) {
    std::vector<double> out(std::max(parts, 1), 0);
    const int nx = std::max(1, static_cast<int>(std::lround(layer.platform_length / kCoverageCell))),
              ny = std::max(1, static_cast<int>(std::lround(layer.width / kCoverageCell)));
    if (!(layer.width > 0) || layer.size() == 0) return out;
    std::vector<double> solid(static_cast<std::size_t>(nx) * ny, 0);
    for (std::size_t k = 0; k < layer.size(); ++k) {
        double y = layer.deposit_y[k];
        if (layer.periodic) y -= layer.width * std::floor(y / layer.width);
        const int i = std::clamp(static_cast<int>(layer.deposit_x[k] / layer.platform_length * nx), 0,
                                 nx - 1),
                  j = std::clamp(static_cast<int>(y / layer.width * ny), 0, ny - 1);
        solid[static_cast<std::size_t>(i) * ny + j] += layer.volume[k];
    }
    const double mean = layer.solid_volume() / static_cast<double>(solid.size());
    std::vector<double> cells(out.size(), 0);
    for (int i = 0; i < nx; ++i) {
        const auto part =
            static_cast<std::size_t>(static_cast<double>(i) / nx * static_cast<double>(out.size()));
        for (int j = 0; j < ny; ++j) {
            cells[part] += 1;
            out[part] += solid[static_cast<std::size_t>(i) * ny + j] > 0.5 * mean;
        }
    }
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = cells[k] > 0 ? out[k] / cells[k] : kNan;
    return out;
}

}  // namespace gradwright
