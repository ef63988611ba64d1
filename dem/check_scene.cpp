// What can be said of a scene before anything runs: problems, warnings, cost.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "dem/bed.h"
#include "dem/stability.h"

namespace gradwright {

namespace {
constexpr double kBedPacking = 0.55;  // what these beds settle at, for estimates only
}

std::vector<SceneProblem> validate(const Scene& s) {
    std::vector<SceneProblem> out;
    auto fatal = [&](const std::string& text) { out.push_back({true, text}); };
    auto warn = [&](const std::string& text) { out.push_back({false, text}); };
    const double um = 1e6;
    double d_max = 0, d50 = 0, d90 = 0;
    for (const Powder& p : s.powder) {
        d_max = std::max(d_max, p.size.cut_high);
        d50 = std::max(d50, p.size.d50);
        d90 = std::max(d90, p.size.d90);
    }
    if (s.dispenser_length < 3 * d_max)
        fatal(
            fmt::format("dispenser length {:.0f} um is less than three of the largest grains ({:.0f} um): "
                        "raise machine.dispenser.length",
                        s.dispenser_length * um, d_max * um));
    if (s.width < 3 * d_max)
        fatal(
            fmt::format("modelled width {:.0f} um is less than three of the largest grains ({:.0f} um): "
                        "raise the dispenser's width or "
                        "numerics.strip_width",
                        s.width * um, d_max * um));
    if (s.sides == Sides::periodic && s.width < 4 * d_max)
        fatal(
            fmt::format("periodic width {:.0f} um is less than four of the largest grains ({:.0f} um), so "
                        "that a grain would meet its "
                        "own image's neighbours: raise numerics.strip_width",
                        s.width * um, d_max * um));
    if (!(s.blade_speed > 0)) fatal("the blade must move: process.blade_speed > 0");
    if (s.blade_speed > 1)
        warn(fmt::format("blade speed {:.2f} m/s: expect overlaps above 2 %, raise numerics.softening",
                         s.blade_speed));
    for (int k = 0; k < 2; ++k)
        if (!(s.headspace[k] >= 0 && s.headspace[k] < s.dose_height))
            fatal(
                fmt::format("chamber {} stands {:.0f} um below the rim but the floor rises only {:.0f} um, "
                            "so it is starved: raise "
                            "design_space.fill_fraction.{}, its dose or the dosage factor",
                            k == 0 ? 'A' : 'B', s.headspace[k] * um, s.dose_height * um, k == 0 ? 'A' : 'B'));
    if (s.gap < d_max)
        warn(fmt::format(
            "gap {:.0f} um is smaller than the largest grain ({:.0f} um): large grains are carried or jam",
            s.gap * um, d_max * um));
    if (s.gap < 1.5 * d90 && s.gap >= d_max)
        warn(fmt::format("gap {:.0f} um is below 1.5 D90 ({:.0f} um): the layer will be thin and patchy",
                         s.gap * um, 1.5 * d90 * um));
    if (const double edge = stability_edge_of(s.interaction); s.rayleigh_fraction > kStabilityEdge)
        fatal(step_advice(s.rayleigh_fraction, s.interaction));
    // at three quarters of it GI is what it is in half steps, within the noise: docs/speed-against-error.md
    else if (s.rayleigh_fraction > 0.75 * edge * (1 + 1e-9))
        warn(fmt::format(
            "time step {:.2g} of Rayleigh's is {:.2g} times the stability edge, {:.2g} (measured "
            "in a dense heap at "
            "3 % overlap at this restitution); half of it is safe: numerics.time_step.rayleigh_fraction",
            s.rayleigh_fraction, s.rayleigh_fraction / edge, edge));
    // Tops of a rough surface: its mean plane lies 0.395 r below them, and heights are jittered by r/5.
    const double tops = (0.5 * 0.395 + 0.1) * s.roughness;
    if (s.substrate == Substrate::fused && s.gap < tops)
        fatal(fmt::format(
            "gap {:.0f} um: the tops of the fused substrate stand {:.0f} um above its mean plane, so the "
            "blade would run into it: raise process.gap or lower process.roughness",
            s.gap * um, tops * um));
    else if (!(s.gap > 0))
        fatal(
            fmt::format("gap {:.0f} um: the blade would run into the plate: raise process.gap", s.gap * um));
    if (s.layers < 1) fatal("a spread lays one layer or more: process.layers >= 1");
    if (s.layers > 1 && s.floor_depth() > s.dispenser_depth * (1 + 1e-9))
        fatal(fmt::format(
            "{} doses of {:.0f} um above {:.0f} um of bed need a well of {:.2f} mm, it is {:.2f} mm "
            "deep: lower process.layers, the dosage factor or numerics.bed_depth",
            s.layers, s.dose_height * um, s.bed_depth * um, 1e3 * s.floor_depth(), 1e3 * s.dispenser_depth));
    if (!(s.substrate_share_a >= 0 && s.substrate_share_a <= 1))
        fatal("the powder under the layer holds a share of A between 0 and 1: process.substrate_share_a");
    if (s.bed_depth < tops)
        fatal(fmt::format(
            "only {:.0f} um of powder are modelled below the blade, the rough floor's tops stand {:.0f} um "
            "above its mean plane: the blade would run into it: raise numerics.bed_depth",
            s.bed_depth * um, tops * um));
    if (s.blade_tip_radius > 0.5 * s.blade_thickness)
        fatal("blade tip radius is more than half the blade's thickness: lower machine.blade.tip_radius");
    if (s.bed_depth < 8 * d50 && s.bed_depth < s.dispenser_depth)
        warn(
            fmt::format("modelled bed depth {:.0f} um is less than 8 D50 ({:.0f} um): a named reduction; the "
                        "run checks how far its floor "
                        "grains move",
                        s.bed_depth * um, 8 * d50 * um));
    if (s.plate_thickness > 0 && s.bed_depth < s.dispenser_depth)
        warn(
            fmt::format("the slot of a {:.2f} mm plate is {:.2f} mm deep but only {:.2f} mm are modelled: "
                        "its collapse is *not simulated* "
                        "at full depth; raise numerics.bed_depth",
                        s.plate_thickness * 1e3, s.dispenser_depth * 1e3, s.bed_depth * 1e3));
    if (std::none_of(out.begin(), out.end(), [](const SceneProblem& p) { return p.fatal; })) {
        const double needed = estimate_cost(s).memory_bytes;
        const double there = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
        if (needed > there)
            fatal(
                fmt::format("some {:.1e} grains need {:.0f} GB of memory, this computer has {:.0f}: shorten "
                            "the dispenser, or have "
                            "the machine extrapolated from strips, [scale_up] in the study",
                            estimate_cost(s).grains, needed / 1e9, there / 1e9));
    }
    return out;
}

SceneCost estimate_cost(const Scene& s) {
    SceneCost c;
    const double mean_volume =
        0.5 * (s.powder[0].size.mean_grain_volume() + s.powder[1].size.mean_grain_volume());
    const double area = s.dispenser_length * s.width;
    const double platform_area = s.platform_length * s.width;
    c.grains = kBedPacking *
               (area * (s.floor_depth() + s.dose_height) + platform_area * s.substrate_depth()) / mean_volume;
    const double rough_area = area + (s.substrate == Substrate::plate ? 0 : platform_area);
    c.fixed_grains = rough_area / (0.95 * 0.95 * std::sqrt(3.0) / 2 * s.roughness * s.roughness);
    const double dt = scene_time_step(s);
    const double way = s.dispenser_length + s.land + s.platform_length + 0.5 * s.second_land;
    const double pack = 1.6 * std::sqrt(2.4 * (s.floor_depth() + s.dose_height) / s.gravity);
    c.steps = (s.layers * way / s.blade_speed + pack) / dt;
    c.grain_steps = c.grains * c.steps;
    c.memory_bytes = (c.grains + c.fixed_grains) * 1000;
    return c;
}

}  // namespace gradwright
