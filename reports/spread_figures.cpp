#include "reports/spread_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/composition_json.h"
#include "reports/image_file.h"
#include "reports/json_support.h"
#include "reports/map_file.h"
#include "reports/particle_file.h"
#include "reports/result_json.h"
#include "reports/safe_write.h"
#include "reports/spread_drawings.h"

namespace gradwright {
namespace {

using nlohmann::json;

constexpr int kFineBins = 8;          // over the partition's extent
constexpr double kMovingShare = 0.1;  // of the blade's speed: slower powder is not pushed
constexpr long kLeastHeap = 100;      // grains below which nothing can be said about mixing

std::vector<double> within(const std::vector<double>& y, const std::vector<double>& values, double low,
                           double high) {
    std::vector<double> kept;
    for (std::size_t b = 0; b < y.size(); ++b)
        if (y[b] >= low && y[b] <= high) kept.push_back(values[b]);
    return kept;
}

void measure_line(const Study& study, const Design& design, const Layer& layer,
                  const std::optional<CompositionRequest>& composition, SpreadFigures& out) {
    const std::vector<PlanPoint> inside =
        design.partition.clipped(study.scene.dispenser_length, study.dispenser_width);
    if (inside.size() < 2) return;
    const auto [low, high] = std::minmax_element(
        inside.begin(), inside.end(), [](const PlanPoint& a, const PlanPoint& b) { return a.y < b.y; });
    out.y_low = low->y;
    out.y_high = high->y;
    const double extent = out.y_high - out.y_low, d50 = study.scene.powder[0].size.d50;
    const double middle = 0.5 * study.scene.dispenser_length;
    // of two curves the line is the first one's
    const bool rises = PartitionCurve{design.partition.points}.on_side_a(middle, out.y_high + extent + d50);
    // a level partition has no slope, only a step
    out.unmixed_slope = extent > 0 ? (rises ? 1 : -1) / extent : std::numeric_limits<double>::quiet_NaN();
    const double bin =
        std::clamp(extent / kFineBins, std::min(0.5 * d50, study.bins.width), study.bins.width);
    const BinGrid grid{bin, static_cast<int>(std::floor(study.dispenser_width / bin + 1e-9))};
    out.fine = plain_profile(layer, carried_labels(layer), footprint_of(study, design), grid, study.seed);
    for (double& s : out.fine.standard_error)
        s *= std::sqrt(kBedsOverBlocksPlain.profile);  // one bed, as in its bins
    const std::array<Material, 2> alloys = {study.scene.powder[0].material, study.scene.powder[1].material};
    if (composition) {
        const double factor = band_factor(out.fine);
        out.powder = powder_composition(out.fine, alloys, factor);
        if (composition->pool) out.melted = melted_composition(out.fine, alloys, factor, *composition->pool);
    }
    if (extent < 4 * bin) return;  // a step: no line to speak of
    const std::vector<double> y = within(out.fine.y_m, out.fine.y_m, out.y_low, out.y_high);
    const std::vector<double> error = within(out.fine.y_m, out.fine.standard_error, out.y_low, out.y_high);
    const auto fit = [&](const char* quantity, const std::vector<double>& value,
                         std::span<const double> errors) {
        out.fits.push_back(
            {quantity, value, linear_fit(y, within(out.fine.y_m, value, out.y_low, out.y_high), errors)});
    };
    fit("gi", out.fine.gi, error);
    if (out.powder) fit("mass_fraction_a", out.powder->mass_fraction_a.value, {});
    if (out.melted) fit("mass_fraction_a_melted", out.melted->mass_fraction_a.value, {});
}

/// The snapshot whose blade stands nearest to `blade_x`; the bed before and the layer after are left out.
std::size_t nearest(const std::vector<Snapshot>& shots, double blade_x) {
    std::size_t best = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k + 1 < shots.size(); ++k)
        if (std::abs(shots[k].blade_x - blade_x) < distance) {
            distance = std::abs(shots[k].blade_x - blade_x);
            best = k;
        }
    return best;
}

void measure_heap(const Study& study, const Design& design, const SpreadResult& spread, SpreadFigures& out) {
    const Scene& scene = study.scene;
    const std::vector<Snapshot>& shots = spread.snapshots;
    const double platform = scene.dispenser_length + design.land,
                 half = platform + 0.5 * scene.platform_length;
    out.blade_speed = scene.blade_speed;

    // The first half of the platform: the heap is laid from, and still large.
    std::vector<Snapshot> over;
    for (std::size_t k = 1; k + 1 < shots.size(); ++k)
        if (shots[k].blade_x >= platform && shots[k].blade_x <= half) over.push_back(shots[k]);
    HeapFieldOptions options;
    options.cell = scene.powder[0].size.d50;
    options.width = study.dispenser_width;
    options.z_low = -spread.layer.gap;
    out.field = heap_field(over, options);
    out.rotation = heap_rotation(out.field, over, options);

    out.mixing_options.width = study.dispenser_width;
    out.mixing_options.periodic = scene.sides == Sides::periodic;
    out.mixing_options.cell = 2.5 * scene.powder[0].size.d50;
    out.mixing_options.least_speed = kMovingShare * scene.blade_speed;
    for (std::size_t k = 1; k + 1 < shots.size(); ++k) {
        if (shots[k].blade_x > platform + scene.platform_length) continue;
        HeapMixing one = heap_mixing(shots[k], out.mixing_options);
        if (one.grains >= kLeastHeap) out.mixing.push_back(std::move(one));
    }
    if (shots.size() < 3) return;
    for (const double x :
         {0.5 * scene.dispenser_length, scene.dispenser_length, half, platform + scene.platform_length}) {
        const std::size_t k = nearest(shots, x);
        if (!out.shown.empty() && out.shown.back() == k) continue;
        out.shown.push_back(k);
        out.shown_mixing.push_back(heap_mixing(shots[k], out.mixing_options));
    }
}

json fit_json(const ProfileFit& fit) {
    return {{"quantity", fit.quantity},
            {"slope_per_m", number(fit.line.slope)},
            {"slope_standard_error_per_m", number(fit.line.slope_standard_error)},
            {"intercept", number(fit.line.intercept)},
            {"r_squared", number(fit.line.r_squared)},
            {"bins", fit.line.points}};
}

json mixing_json(const HeapMixing& row, bool slices) {
    json object = {{"time_s", number(row.time)},
                   {"blade_x_m", number(row.blade_x)},
                   {"grains", row.grains},
                   {"solid_volume_m3", number(row.solid_volume)},
                   {"gi", number(row.gi)},
                   {"lacey", number(row.lacey)},
                   {"lacey_in_slices", number(row.lacey_in_slices)}};
    if (slices)
        object["slices"] = {
            {"y_m", numbers(row.y_m)}, {"gi", numbers(row.slice_gi)}, {"lacey", numbers(row.slice_lacey)}};
    return object;
}

void write_field_file(const HeapField& field, const std::string& path) {
    const std::size_t nx = static_cast<std::size_t>(field.columns), nz = static_cast<std::size_t>(field.rows);
    ImageData image;
    image.points = {nx, 2, nz};
    image.origin = {field.x(0), 0, field.z(0)};
    image.spacing = {field.cell, field.width, field.cell};
    ImageArray velocity{"velocity", 3, {}}, solid{"solid_fraction", 1, {}}, gi{"gi", 1, {}};
    for (std::size_t k = 0; k < nz; ++k)
        for (int side = 0; side < 2; ++side)
            for (std::size_t i = 0; i < nx; ++i) {
                const std::size_t at = k * nx + i;
                velocity.values.insert(velocity.values.end(), {field.vx[at], 0, field.vz[at]});
                solid.values.push_back(field.solid_fraction[at]);
                gi.values.push_back(field.gi[at]);
            }
    image.arrays = {velocity, solid, gi};
    write_image_file(image, path);
}

}  // namespace

SpreadFigures spread_figures(const Study& study, const Design& design, const SpreadResult& spread,
                             const std::optional<CompositionRequest>& composition) {
    SpreadFigures figures;
    figures.made_d10_d50_d90 = spread.bed.made_d10_d50_d90;
    figures.bed_packing = spread.bed.packing_fraction;
    figures.bond_number = spread.bond_number;
    measure_line(study, design, judged_layer(study, spread), composition, figures);
    measure_heap(study, design, spread, figures);
    return figures;
}

json figures_json(const Study& study, const SpreadFigures& figures,
                  const std::optional<CompositionRequest>& composition) {
    json fits = json::array(), rows = json::array(), shown = json::array();
    for (const ProfileFit& fit : figures.fits) fits.push_back(fit_json(fit));
    for (const HeapMixing& row : figures.mixing) rows.push_back(mixing_json(row, false));
    for (const HeapMixing& row : figures.shown_mixing) shown.push_back(mixing_json(row, true));
    const HeapField& field = figures.field;
    const HeapRotation& turn = figures.rotation;
    double fastest = 0;
    for (std::size_t at = 0; at < field.vx.size(); ++at)
        if (std::isfinite(field.vx[at])) fastest = std::max(fastest, std::hypot(field.vx[at], field.vz[at]));
    json object = {
        {"bed",
         {{"made_d10_d50_d90_m", numbers(figures.made_d10_d50_d90)},
          {"packing_fraction", number(figures.bed_packing)},
          {"bond_number", number(figures.bond_number)}}},
        {"line",
         {{"y_m", numbers(figures.fine.y_m)},
          {"gi", numbers(figures.fine.gi)},
          {"standard_error", numbers(figures.fine.standard_error)},
          {"partition_y_low_m", number(figures.y_low)},
          {"partition_y_high_m", number(figures.y_high)},
          {"unmixed_slope_per_m", number(figures.unmixed_slope)},
          {"fits", fits},
          {"method", "ordinary least squares over the bins centred within the partition's extent in y"}}},
        {"velocity",
         {{"instants", field.instants},
          {"blade_low_m", number(field.blade_low)},
          {"blade_high_m", number(field.blade_high)},
          {"blade_speed_m_s", number(figures.blade_speed)},
          {"cell_m", number(field.cell)},
          {"columns", field.columns},
          {"rows", field.rows},
          {"fastest_m_s", number(fastest)},
          {"circulation_m2_s", number(turn.area > 0 ? turn.circulation : std::nan(""))},
          {"area_m2", number(turn.area)},
          {"vorticity_per_s", number(turn.vorticity)},
          {"vorticity_deviation_per_s", number(turn.deviation)},
          {"turn_length_m", number(turn.turn_length(figures.blade_speed))},
          {"sign", "anticlockwise positive with x, the blade's way, to the right and z up"}}},
        {"mixing",
         {{"rows", rows},
          {"shown", shown},
          {"cell_m", number(figures.mixing_options.cell)},
          {"least_speed_m_s", number(figures.mixing_options.least_speed)},
          {"measure",
           "Lacey index (S0^2 - S^2)/(S0^2 - SR^2) of the cells' GI: 0 unmixed, 1 random; in slices: within "
           "slices "
           "of equal y"}}}};
    object["composition"] = nullptr;
    if (composition && figures.powder) {
        const std::array<Material, 2> alloys = {study.scene.powder[0].material,
                                                study.scene.powder[1].material};
        object["composition"] =
            composition_json(figures.fine, alloys, band_factor(figures.fine), composition->pool);
    }
    return object;
}

std::string figures_text(const SpreadFigures& figures) {
    std::string text;
    for (const ProfileFit& fit : figures.fits)
        text += fmt::format(
            "  line      {}: slope {:.2f} per mm (unmixed {:.2f}), R2 {:.3f}, over y {:.3f}-{:.3f} mm\n",
            fit.quantity, fit.line.slope * 1e-3, figures.unmixed_slope * 1e-3, fit.line.r_squared,
            figures.y_low * 1e3, figures.y_high * 1e3);
    const HeapRotation& turn = figures.rotation;
    if (turn.area > 0)
        text += fmt::format(
            "  heap      circulation {:.3g} mm2/s over {:.3f} mm2, vorticity {:.0f} +- {:.0f} 1/s: one turn "
            "in {:.2f} mm "
            "of blade travel\n",
            turn.circulation * 1e6, turn.area * 1e6, turn.vorticity, turn.deviation,
            turn.turn_length(figures.blade_speed) * 1e3);
    for (const HeapMixing& row : figures.shown_mixing)
        text += fmt::format(
            "  mixing    blade at {:.2f} mm: {} grains, Lacey index {:.2f}, within slices of y {:.2f}\n",
            row.blade_x * 1e3, row.grains, row.lacey, row.lacey_in_slices);
    return text;
}

std::vector<std::string> write_figures(const Study& study, const Evaluation& evaluation,
                                       const SpreadResult& spread, const SpreadFigures& figures,
                                       const std::string& folder) {
    std::vector<std::string> files;
    const auto write = [&](const std::string& name, const std::string& content) {
        write_file(folder + "/" + name, content);
        files.push_back(name);
    };
    if (spread.snapshots.size() > 1) write("beds.svg", beds_svg(study, evaluation, spread));
    if (!evaluation.map.gi.empty()) {
        write("gi_map.svg", gi_map_svg(study, evaluation.map));
        write_map_file(evaluation.map, spread.layer.gap, folder + "/gi_map.vtkhdf");
        files.push_back("gi_map.vtkhdf");
    }
    if (!figures.fine.gi.empty()) write("gi_line.svg", gi_line_svg(study, evaluation, figures));
    if (figures.field.columns > 0 && figures.field.rows > 0) {
        write("heap_velocity.svg", heap_velocity_svg(figures));
        write_field_file(figures.field, folder + "/heap_velocity.vtkhdf");
        files.push_back("heap_velocity.vtkhdf");
    }
    if (!figures.mixing.empty())
        write("heap_mixing.svg", heap_mixing_svg(study, evaluation, spread, figures));
    if (figures.powder) write("composition.svg", composition_svg(figures));
    std::vector<Snapshot> shown;
    for (const std::size_t k : figures.shown) shown.push_back(spread.snapshots[k]);
    for (const std::string& name : write_particle_series(shown, folder)) files.push_back(name);
    return files;
}

}  // namespace gradwright
