#include "reports/results_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "optimise/motion.h"
#include "reports/hdf5_file.h"
#include "reports/layers_json.h"
#include "reports/map_file.h"
#include "reports/provenance.h"
#include "reports/result_json.h"
#include "reports/safe_write.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
using Shape = H5Writer::Shape;

/// Writes datasets that cannot lack their unit or name.
class Table {
  public:
    explicit Table(H5Writer& file) : file_(file) {}

    void scalar(const std::string& path, double value, const char* units, const char* name) {
        file_.write(path, std::span<const double>(&value, 1), {});
        label(path, units, name);
    }
    void scalar(const std::string& path, std::int64_t value, const char* units, const char* name) {
        file_.write(path, std::span<const std::int64_t>(&value, 1), {});
        label(path, units, name);
    }
    void text(const std::string& path, const std::string& value, const char* name) {
        file_.write_texts(path, {value}, {});
        label(path, "text", name);
    }
    void texts(const std::string& path, const std::vector<std::string>& values, const char* name) {
        file_.write_texts(path, values, {values.size()});
        label(path, "text", name);
    }
    void numbers(const std::string& path, const std::vector<double>& values, const char* units,
                 const char* name) {
        file_.write(path, std::span<const double>(values), {values.size()});
        label(path, units, name);
    }
    void integers(const std::string& path, const std::vector<std::int64_t>& values, const char* units,
                  const char* name) {
        file_.write(path, std::span<const std::int64_t>(values), {values.size()});
        label(path, units, name);
    }
    void grid(const std::string& path, const std::vector<double>& values, const Shape& shape,
              const char* units, const char* name) {
        file_.write(path, std::span<const double>(values), shape);
        label(path, units, name);
    }

  private:
    void label(const std::string& path, const char* units, const char* name) {
        file_.attribute(path, "units", std::string(units));
        file_.attribute(path, "long_name", std::string(name));
    }
    H5Writer& file_;
};

std::vector<double> padded(const std::vector<double>& values, std::size_t size) {
    std::vector<double> out(size, kUndefined);
    std::copy_n(values.begin(), std::min(size, values.size()), out.begin());
    return out;
}

/// Every number that defines a design, by name.
std::vector<std::pair<std::string, double>> design_vector(const Design& design) {
    auto vector = design.parameters;
    Design copy = design;
    for (const MotionVariable& motion : kMotionVariables) vector.emplace_back(motion.name, motion.of(copy));
    return vector;
}

struct Axis {
    std::vector<std::string> names;
    std::vector<double> row(const Design& design) const {
        std::vector<double> values(names.size(), kUndefined);
        for (const auto& [name, value] : design_vector(design)) {
            const auto found = std::find(names.begin(), names.end(), name);
            if (found != names.end()) values[static_cast<std::size_t>(found - names.begin())] = value;
        }
        return values;
    }
};

/// Union over all designs met, in order of appearance: `straight` and `polyline` have different parameters.
Axis variable_axis(const StudyResult& result) {
    Axis axis;
    const auto add = [&](const Design& design) {
        for (const auto& [name, value] : design_vector(design))
            if (std::find(axis.names.begin(), axis.names.end(), name) == axis.names.end())
                axis.names.push_back(name);
    };
    add(result.design);
    if (result.straight) add(result.straight->design);
    for (const HistoryEntry& entry : result.history) add(entry.design);
    return axis;
}

/// Angles keep degrees because the study file and the workshop do; everything else is SI.
std::string variable_unit(const std::string& name) {
    if (name.find("angle") != std::string::npos) return "deg";
    for (const MotionVariable& motion : kMotionVariables)
        if (name == motion.name) return motion.unit;
    if (name == "a_below" || name == "b_between") return "1";  // 1 where it is so
    return "m";
}

void write_variables(Table& table, H5Writer& file, const Study& study, const StudyResult& result,
                     const Axis& axis) {
    const DesignSpace& space = study.design_space;
    std::vector<std::string> units;
    std::vector<double> low, high;
    std::vector<std::int64_t> free;
    for (const std::string& name : axis.names) {
        units.push_back(variable_unit(name));
        const Variable* bounds = nullptr;
        for (const Variable* candidate : {&space.angle_deg, &space.offset})
            if (candidate->name == name) bounds = candidate;
        for (const MotionVariable& motion : kMotionVariables)
            if (motion.name == name) bounds = &motion.in(space);
        low.push_back(bounds && bounds->free ? bounds->low : kUndefined);
        high.push_back(bounds && bounds->free ? bounds->high : kUndefined);
        const bool follows = name == "least_bend_radius_m";  // from the others
        free.push_back(bounds ? bounds->free : space.partition_free && !follows);
    }
    table.texts("/variables/name", axis.names, "design variable");
    file.make_scale("/variables/name", "variable");
    table.texts("/variables/unit", units, "unit of the design variable");
    table.numbers("/variables/value", axis.row(result.design), "see /variables/unit", "value of the result");
    table.numbers("/variables/low", low, "see /variables/unit",
                  "lower bound, NaN when fixed or from the dispenser's size");
    table.numbers("/variables/high", high, "see /variables/unit",
                  "upper bound, NaN when fixed or from the dispenser's size");
    table.integers("/variables/free", free, "1", "1 when the search was free to change it");
    for (const char* set : {"unit", "value", "low", "high", "free"})
        file.attach_scale(std::string("/variables/") + set, "/variables/name", 0);
}

/// The kinematic picture lays nothing, and a spread that failed was not measured.
double laid(const Evaluation& evaluation, double value) {
    return evaluation.health.ok() && evaluation.fidelity != Fidelity::kinematic ? value : kUndefined;
}

void write_evaluations(Table& table, H5Writer& file, const StudyResult& result, const Axis& axis,
                       std::size_t bins) {
    std::vector<std::pair<std::string, const Evaluation*>> rows;
    if (result.kinematic) rows.emplace_back("kinematic", &*result.kinematic);
    if (result.straight) rows.emplace_back("straight", &*result.straight);
    if (!result.predicted.profile.gi.empty()) rows.emplace_back("predicted", &result.predicted);
    for (const Evaluation& evaluation : result.confirmations) rows.emplace_back("confirmation", &evaluation);
    for (const Evaluation& evaluation : result.superseded) rows.emplace_back("superseded", &evaluation);

    const std::string root = "/evaluations/";
    std::vector<std::string> role, fidelity, status, reason, hash;
    std::vector<double> x, profile, error, low, high, drift, drift_error;
    std::vector<std::int64_t> seed;
    for (const auto& [name, evaluation] : rows) {
        role.push_back(name);
        fidelity.push_back(to_string(evaluation->fidelity));
        status.push_back(evaluation->health.status);
        reason.push_back(evaluation->health.reason);
        hash.push_back(evaluation->state_hash);
        seed.push_back(static_cast<std::int64_t>(evaluation->seed));
        const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(x, axis.row(evaluation->design));
        const auto gi = padded(evaluation->profile.gi, bins),
                   s = padded(evaluation->profile.standard_error, bins);
        append(profile, gi);
        append(error, s);
        const Band band = simultaneous_band(gi, s, evaluation->profile.degrees);
        append(low, band.low);
        append(high, band.high);
        append(drift, padded(evaluation->drift.difference, bins));
        append(drift_error, padded(evaluation->drift.standard_error, bins));
    }
    const hsize_t n = rows.size();
    table.texts(root + "role", role, "what the evaluation was for");
    table.texts(root + "fidelity", fidelity, "fidelity");
    table.texts(root + "status", status, "health of the run");
    table.texts(root + "reason", reason, "why there are no numbers");
    table.texts(root + "state_hash", hash, "hash of positions and velocities at the end");
    table.integers(root + "seed", seed, "1", "packing seed");
    table.grid(root + "x", x, {n, axis.names.size()}, "see /variables/unit", "design variables");
    table.grid(root + "profile", profile, {n, bins}, "1", "gradation index GI(y)");
    table.grid(root + "standard_error", error, {n, bins}, "1", "standard error of GI(y)");
    table.grid(root + "band_low", low, {n, bins}, "1", "simultaneous 95 % band, lower");
    table.grid(root + "band_high", high, {n, bins}, "1", "simultaneous 95 % band, upper");
    table.grid(root + "x_drift_profile", drift, {n, bins}, "1",
               "GI in the last third minus the first third, per bin");
    table.grid(root + "x_drift_standard_error", drift_error, {n, bins}, "1",
               "standard error of the x drift per bin");
    file.attach_scale(root + "x", "/variables/name", 1);
    for (const char* set :
         {"profile", "standard_error", "band_low", "band_high", "x_drift_profile", "x_drift_standard_error"})
        file.attach_scale(root + set, "/bins/y_m", 1);

    struct Column {
        const char *name, *units, *long_name;
        std::function<double(const Evaluation&)> value;
    };
    const Column columns[] = {
        {"objective", "1", "what the search minimises", [](const Evaluation& e) { return e.objective; }},
        {"misfit", "1", "misfit to the target", [](const Evaluation& e) { return e.misfit.value; }},
        {"misfit_noise_floor", "1", "noise floor of the misfit",
         [](const Evaluation& e) { return e.misfit.noise_floor; }},
        {"x_drift", "1", "x drift, rms over bins", [](const Evaluation& e) { return e.drift.value; }},
        {"capture_fraction", "1", "solid laid over solid dosed",
         [](const Evaluation& e) { return laid(e, e.capture_fraction); }},
        {"supply_ratio", "1", "supply ratio", [](const Evaluation& e) { return laid(e, e.supply_ratio); }},
        {"coverage", "1", "coverage", [](const Evaluation& e) { return laid(e, e.coverage); }},
        {"waste_fraction", "1", "overflow over dosed solid",
         [](const Evaluation& e) { return laid(e, e.waste_fraction); }},
        {"packing_fraction", "1", "packing of the layer",
         [](const Evaluation& e) { return laid(e, e.packing_fraction); }},
        {"grains", "1", "mobile grains", [](const Evaluation& e) { return double(e.grains); }},
        {"steps", "1", "time steps", [](const Evaluation& e) { return double(e.steps); }},
        {"grain_steps", "1", "awake grain-steps", [](const Evaluation& e) { return e.grain_steps; }},
        {"seconds", "s", "wall time", [](const Evaluation& e) { return e.seconds; }},
        {"seconds_cold", "s", "wall time with an empty cache",
         [](const Evaluation& e) { return e.seconds_cold; }},
    };
    for (const Column& column : columns) {
        std::vector<double> values;
        for (const auto& [name, evaluation] : rows)
            values.push_back(evaluation->health.ok() ? column.value(*evaluation) : kUndefined);
        table.numbers(root + column.name, values, column.units, column.long_name);
    }
}

void write_history(Table& table, H5Writer& file, const StudyResult& result, const Axis& axis) {
    std::vector<std::string> stage, fidelity, note;
    std::vector<double> objective, misfit, drift, seconds, x;
    std::vector<std::int64_t> iteration, spreads;
    for (const HistoryEntry& entry : result.history) {
        stage.push_back(entry.stage);
        fidelity.push_back(to_string(entry.fidelity));
        note.push_back(entry.note);
        objective.push_back(entry.objective);
        misfit.push_back(entry.misfit);
        drift.push_back(entry.drift);
        seconds.push_back(entry.seconds);
        iteration.push_back(entry.iteration);
        spreads.push_back(entry.spreads);
        const auto row = axis.row(entry.design);
        x.insert(x.end(), row.begin(), row.end());
    }
    table.integers("/history/iteration", iteration, "1", "step of its stage");
    table.texts("/history/stage", stage, "stage of the search");
    table.texts("/history/fidelity", fidelity, "fidelity");
    table.texts("/history/note", note, "remark");
    table.numbers("/history/objective", objective, "1", "what the search minimises");
    table.numbers("/history/misfit", misfit, "1", "misfit to the target");
    table.numbers("/history/x_drift", drift, "1", "x drift");
    table.numbers("/history/seconds", seconds, "s", "time since the start");
    table.integers("/history/spreads", spreads, "1", "spreads spent so far");
    table.grid("/history/x", x, {result.history.size(), axis.names.size()}, "see /variables/unit",
               "design variables");
    file.attach_scale("/history/x", "/variables/name", 1);
}

/// /field: cells of a target over x and y, [x][y]; nothing for a target of y alone.
void write_field(Table& table, H5Writer& file, const StudyResult& result) {
    const GradationField& predicted = result.predicted.field;
    if (result.field_target.empty() || predicted.x_m.empty()) return;
    const std::size_t columns = predicted.x_m.size(), rows = predicted.y_m.size();
    table.numbers("/field/x_m", predicted.x_m, "m", "centres of the columns, from the platform's near edge");
    table.numbers("/field/y_m", predicted.y_m, "m", "centres of the bins");
    const struct {
        const char *name, *long_name;
        const std::vector<double>& values;
    } grids[] = {{"target", "GI(x, y) asked for, cell mean", result.field_target},
                 {"weight", "weight of the cell in the misfit", result.field_weight},
                 {"predicted", "GI(x, y) on the origin map, hard labels", predicted.cells.gi},
                 {"predicted_standard_error", "standard error of it", predicted.cells.standard_error},
                 {"confirmed", "GI(x, y), mean of the confirming spreads", result.confirmed_field.cells.gi},
                 {"standard_error", "standard error of it", result.confirmed_field.cells.standard_error}};
    for (const auto& grid : grids) {
        const std::string name = std::string("/field/") + grid.name;
        table.grid(name, padded(grid.values, columns * rows), {columns, rows}, "1", grid.long_name);
        file.attach_scale(name, "/field/x_m", 0);
        file.attach_scale(name, "/field/y_m", 1);
    }
}

/// /layers: one row a layer, means over the confirmations; nothing where the study lays one.
void write_layers(Table& table, H5Writer& file, const Study& study, const StudyResult& result,
                  std::size_t bins) {
    const std::vector<LaidLayer> layers = mean_layers(study, result);
    if (layers.empty()) return;
    const auto column = [&](const char* name, const char* units, const char* long_name, auto of) {
        std::vector<double> values;
        for (const LaidLayer& layer : layers) values.push_back(of(layer));
        table.numbers(std::string("/layers/") + name, values, units, long_name);
    };
    const auto rows = [&](const char* name, const char* long_name, auto of) {
        std::vector<double> values;
        for (const LaidLayer& layer : layers) {
            const std::vector<double> row = padded(of(layer), bins);
            values.insert(values.end(), row.begin(), row.end());
        }
        const std::string path = std::string("/layers/") + name;
        table.grid(path, values, {layers.size(), bins}, "1", long_name);
        file.attach_scale(path, "/bins/y_m", 1);
    };
    std::vector<std::int64_t> number, judged;
    for (const LaidLayer& layer : layers) {
        number.push_back(layer.number);
        judged.push_back(judged_number(study) == 0 || judged_number(study) == layer.number);
    }
    table.integers("/layers/number", number, "1", "layer, from 1");
    table.integers("/layers/judged", judged, "1", "1: the verdict is about it");
    rows("gi", "GI(y)", [](const LaidLayer& l) { return l.profile.gi; });
    rows("standard_error", "standard error of it",
         [](const LaidLayer& l) { return l.profile.standard_error; });
    rows("x_drift", "GI in the last third minus the first third",
         [](const LaidLayer& l) { return l.drift.difference; });
    column("misfit", "1", "misfit", [](const LaidLayer& l) { return l.misfit.value; });
    column("misfit_noise_floor", "1", "its noise floor",
           [](const LaidLayer& l) { return l.misfit.noise_floor; });
    column("drift_misfit", "1", "x drift over the bins",
           [](const LaidLayer& l) { return l.drift_misfit.value; });
    column("gap", "m", "gap under the blade", [](const LaidLayer& l) { return l.gap; });
    column("dosed_solid", "m3", "solid volume of a dose",
           [](const LaidLayer& l) { return l.dosed_solid_volume; });
    column("raised_solid", "m3", "solid volume over the rim before the pass",
           [](const LaidLayer& l) { return l.raised_solid_volume; });
    column("laid_solid", "m3", "solid volume laid", [](const LaidLayer& l) { return l.laid_solid_volume; });
    column("carried_off_solid", "m3", "solid volume carried off layers below",
           [](const LaidLayer& l) { return l.carried_off_solid_volume; });
    column("capture_fraction", "1", "solid laid over solid dosed",
           [](const LaidLayer& l) { return l.capture_fraction; });
    column("coverage", "1", "share of cells deeper than half the mean",
           [](const LaidLayer& l) { return l.coverage; });
    column("waste_fraction", "1", "overflow over dosed solid",
           [](const LaidLayer& l) { return l.waste_fraction; });
    column("packing_fraction", "1", "packing of the layer",
           [](const LaidLayer& l) { return l.packing_fraction; });
}

/// /extrapolated: the strips that a larger machine's design rests on, one row each; nothing for a design that
/// was spread itself.
void write_extrapolated(Table& table, const StudyResult& result) {
    if (!result.extrapolated) return;
    const ScaledHeap& heap = *result.extrapolated;
    const auto column = [&](const char* name, const char* units, const char* long_name, auto of) {
        std::vector<double> values;
        for (const HeapOrder& strip : heap.strips) values.push_back(of(strip));
        table.numbers(std::string("/extrapolated/") + name, values, units, long_name);
    };
    column("dispenser_length", "m", "dispenser of the strip",
           [](const HeapOrder& s) { return s.dispenser_length; });
    column("dosage_factor", "1", "dosage factor of the strip",
           [](const HeapOrder& s) { return s.dosage_factor; });
    column("strip_turnovers", "1", "turnovers of its heap on the way to the part",
           [](const HeapOrder& s) { return s.turnovers; });
    column("profile_order", "1", "order of W, the share of a label laid",
           [](const HeapOrder& s) { return s.profile; });
    column("profile_rest", "1", "what one mode leaves of it",
           [](const HeapOrder& s) { return s.profile_rest; });
    column("drift_order", "1", "order of the drift of W", [](const HeapOrder& s) { return s.drift; });
    column("lateral", "1", "variance of the lateral way over D50^2 and turnovers",
           [](const HeapOrder& s) { return s.lateral; });
    column("capture_fraction", "1", "solid laid over solid dosed",
           [](const HeapOrder& s) { return s.capture_fraction; });
    std::vector<std::int64_t> seeds;
    std::vector<double> share, drift;
    for (const HeapOrder& strip : heap.strips) {
        seeds.push_back(static_cast<std::int64_t>(strip.seed));
        share.insert(share.end(), strip.share.begin(), strip.share.end());
        drift.insert(drift.end(), strip.share_drift.begin(), strip.share_drift.end());
    }
    table.integers("/extrapolated/seed", seeds, "1", "seed of the strip");
    const std::size_t places = heap.strips.empty() ? 0 : share.size() / heap.strips.size();
    if (places > 0) {
        table.grid("/extrapolated/share", share, {heap.strips.size(), places}, "1",
                   "W(xi) - xi, xi = 1/40 .. 39/40");
        table.grid("/extrapolated/share_drift", drift,
                   {heap.strips.size(), drift.size() / heap.strips.size()}, "1", "its change along the part");
    }
    const struct {
        const char *name, *units, *long_name;
        double value;
    } scalars[] = {
        {"turnovers", "1", "turnovers of the machine's heap", heap.turnovers},
        {"length", "m", "the machine's dispenser", heap.length},
        {"longest", "m", "longest dispenser that was spread", heap.longest},
        {"profile_step", "1", "W's rms change over the last step in length", heap.profile_step},
        {"drift_step", "1", "its drift's", heap.drift_step},
        {"dose_step", "1", "W's largest rms difference between doses", heap.dose_step},
        {"profile_error", "1", "carried by the design's GI(y), rms over a ramp", heap.profile_error},
        {"drift_error", "1", "carried by its x drift", heap.drift_error}};
    for (const auto& scalar : scalars)
        table.scalar(std::string("/extrapolated/") + scalar.name, scalar.value, scalar.units,
                     scalar.long_name);
    table.texts("/extrapolated/rests_on", heap.rests_on, "what the extrapolation rests on");
}

void write_result(Table& table, H5Writer& file, const Study& study, const StudyResult& result,
                  std::size_t bins) {
    const std::string root = "/result/";
    const struct {
        const char *name, *long_name;
        const std::vector<double>& values;
    } profiles[] = {
        {"target", "GI(y) asked for, bin mean", result.target},
        {"weight", "weight of the bin in the misfit", result.weight},
        {"predicted", "GI(y) on the origin map, hard labels", result.predicted.profile.gi},
        {"confirmed", "GI(y), mean of the confirming spreads", result.confirmed.gi},
        {"standard_error", "standard error of the confirmed GI(y)", result.confirmed.standard_error},
        {"band_low", "simultaneous 95 % band of the confirmed GI(y), lower", result.band_low},
        {"band_high", "simultaneous 95 % band of the confirmed GI(y), upper", result.band_high},
        {"x_drift_profile", "GI in the last third minus the first third, confirmed",
         result.confirmed_drift.difference},
        {"x_drift_standard_error", "standard error of the x drift per bin",
         result.confirmed_drift.standard_error}};
    for (const auto& profile : profiles) {
        table.numbers(root + profile.name, padded(profile.values, bins), "1", profile.long_name);
        file.attach_scale(root + profile.name, "/bins/y_m", 0);
    }
    write_field(table, file, result);
    std::vector<double> points, inside, points2;
    for (const PlanPoint& p : result.design.partition.points) points.insert(points.end(), {p.x, p.y});
    for (const PlanPoint& p : result.design.partition.second) points2.insert(points2.end(), {p.x, p.y});
    for (const PartitionRow& row : partition_rows(study, result.design))
        if (row.curve == 1) inside.insert(inside.end(), {row.x_mm * 1e-3, row.y_mm * 1e-3});
    table.grid(root + "partition_points", points, {points.size() / 2, 2}, "m",
               "corners (x, y) of the partition, A on the left");
    table.grid(root + "partition_points_in_dispenser", inside, {inside.size() / 2, 2}, "m",
               "corners (x, y) of the partition, ends on the dispenser's walls");
    if (!points2.empty())
        table.grid(root + "partition_points2", points2, {points2.size() / 2, 2}, "m",
                   "corners (x, y) of the second curve, A on the left");
    std::vector<const GradationMap*> maps;
    for (const Evaluation& confirmation : result.confirmations) maps.push_back(&confirmation.map);
    if (maps.empty()) maps.push_back(&result.predicted.map);
    const GradationMap map = mean_map(maps);
    if (!map.gi.empty() && map.gi.size() == map.x_m.size() * map.y_m.size()) {
        table.numbers(root + "map_x", map.x_m, "m", "cell centre along the platform");
        table.numbers(root + "map_y", map.y_m, "m", "cell centre across the platform");
        file.make_scale(root + "map_x", "x");
        file.make_scale(root + "map_y", "y");
        table.grid(root + "map_gi", map.gi, {map.y_m.size(), map.x_m.size()}, "1", "GI over the platform");
        std::vector<const char*> sets = {"map_gi"};
        if (map.mass_kg.size() == map.gi.size()) {
            table.grid(root + "map_mass", map.mass_kg, {map.y_m.size(), map.x_m.size()}, "kg",
                       "mass per cell");
            sets.push_back("map_mass");
        }
        for (const char* set : sets) {
            file.attach_scale(root + set, root + "map_y", 0);
            file.attach_scale(root + set, root + "map_x", 1);
        }
    }
    const bool measured = !result.confirmed.gi.empty() || !result.predicted.profile.gi.empty();
    const auto misfit = [&](const std::string& name, const Misfit& m, const char* text) {
        const auto value = [&](double v) { return measured ? v : kUndefined; };
        table.scalar(root + name, value(m.value), "1", text);
        table.scalar(root + name + "_debiased", value(m.debiased), "1",
                     "the same after the noise is taken off");
        table.scalar(root + name + "_interval_low", value(m.interval_low), "1", "lower bound, 95 %");
        table.scalar(root + name + "_interval_high", value(m.interval_high), "1", "upper bound, 95 %");
        table.scalar(root + name + "_noise_floor", value(m.noise_floor), "1", "noise floor");
        table.scalar(root + name + "_tolerance", m.tolerance, "1", "tolerance");
    };
    misfit("misfit", result.misfit, "misfit of the confirmed profile");
    misfit("x_drift", result.drift_misfit, "x drift of the confirmed profile");
    table.scalar(root + "capture_fraction", result.capture_fraction, "1", "solid laid over solid dosed");
    table.scalar(root + "supply_ratio", result.supply_ratio, "1", "supply ratio");
    table.scalar(root + "coverage", result.coverage, "1", "share of cells deeper than half the mean");
    table.scalar(root + "waste_fraction", result.waste_fraction, "1", "overflow over dosed solid");
    table.scalar(root + "waste_a_share", result.confirmations.empty() ? kUndefined : result.waste_a_share,
                 "1", "share of A in the overflow");
    table.scalar(root + "packing_fraction", result.packing_fraction, "1", "packing of the layer");
    table.scalar(root + "spreads_map", std::int64_t(result.spreads_map), "1",
                 "spreads spent on the origin map");
    table.scalar(root + "spreads_full", std::int64_t(result.spreads_full), "1",
                 "labelled spreads of the full width");
    table.scalar(root + "seconds", result.seconds, "s", "wall time");
    table.scalar(root + "seconds_cold", result.seconds_cold, "s", "wall time with an empty cache");
    table.text(root + "verdict", to_string(result.verdict), "met, not_met or undecided");
    table.text(root + "verdict_text", wording(study, result).verdict, "verdict in words");
    table.text(root + "termination", result.termination, "how the search ended");
    table.text(root + "message", result.message, "remark of the search");
}

void write_provenance(Table& table, const StudyResult& result) {
    const nlohmann::json provenance = provenance_json();
    for (const auto& [key, value] : provenance.items())
        table.text("/provenance/" + key, value.get<std::string>(), key.c_str());
    table.text("/provenance/host_isa", result.host_isa, "instruction set of the host");
    table.scalar("/provenance/host_cores", std::int64_t(result.host_cores), "1", "cores of the host");
    table.scalar("/provenance/threads", std::int64_t(result.threads), "1", "threads used");
    table.scalar("/provenance/seed", static_cast<std::int64_t>(result.seed), "1", "seed of the study");
    std::vector<std::string> stage;
    std::vector<double> seconds;
    for (const auto& [name, value] : result.stage_seconds) {
        stage.push_back(name);
        seconds.push_back(value);
    }
    table.texts("/provenance/stage", stage, "stage");
    table.numbers("/provenance/stage_seconds", seconds, "s", "wall time of the stage");
}

std::string resolved(const Study& study) {
    std::string text;
    for (const InputEntry& input : study.inputs)
        text += fmt::format("{} = {}  # {}{}{}\n", input.key, input.value, input.origin,
                            input.note.empty() ? "" : ": ", input.note);
    return text;
}

}  // namespace

void write_results_file(const Study& study, const StudyResult& result, const std::string& path) {
    write_aside(path, [&](const std::string& aside) {
        H5Writer file(aside);
        Table table(file);
        const auto& y = result.confirmed.y_m.empty() ? result.predicted.profile.y_m : result.confirmed.y_m;
        table.text("/config/verbatim", study.text, "study file as written");
        table.text("/config/resolved", resolved(study), "every input used, with its origin");
        table.numbers("/bins/y_m", y, "m", "bin centre across the spreading direction");
        file.make_scale("/bins/y_m", "y");
        const Axis axis = variable_axis(result);
        write_variables(table, file, study, result, axis);
        write_evaluations(table, file, result, axis, y.size());
        write_history(table, file, result, axis);
        write_result(table, file, study, result, y.size());
        write_layers(table, file, study, result, y.size());
        write_extrapolated(table, result);
        write_provenance(table, result);
        file.flush();
    });
}

}  // namespace gradwright
