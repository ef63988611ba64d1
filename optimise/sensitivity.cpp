#include "optimise/sensitivity.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "dem/random.h"
#include "optimise/confirmation.h"
#include "optimise/dem_evaluator.h"
#include "optimise/map_evaluator.h"
#include "optimise/spread_runner.h"

namespace gradwright {
namespace {

constexpr double kPlace = 0.1e-3, kDose = 0.05;

/// Output vector of an evaluation: GI of the counting bins, misfit, x drift.
std::vector<double> outputs_of(const Evaluation& evaluation, const std::vector<double>& weight) {
    std::vector<double> out;
    for (std::size_t b = 0; b < weight.size(); ++b)
        if (weight[b] > 0) out.push_back(evaluation.profile.gi[b]);
    out.push_back(evaluation.misfit.value);
    out.push_back(evaluation.drift_misfit.value);
    return out;
}

bool all_finite(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

UncertainInput around(const Study& study, std::string name, std::string unit, double value, double down,
                      double up, std::function<void(Study&, Design&, double)> set) {
    UncertainInput input{std::move(name), std::move(unit), value, value * down, value * up, {},
                         false,           std::move(set)};
    for (const InputEntry& entry : study.inputs)
        if (entry.key == input.name) {
            input.origin = entry.origin;
            input.unmeasured =
                entry.origin == "default" || entry.note.find("measure this") != std::string::npos;
        }
    return input;
}

}  // namespace

std::vector<std::vector<double>> latin_hypercube(int n, int d, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::vector<double>> points(static_cast<std::size_t>(n), std::vector<double>(std::size_t(d)));
    for (std::size_t i = 0; i < std::size_t(d); ++i) {
        std::vector<std::size_t> slice(points.size());
        for (std::size_t k = 0; k < slice.size(); ++k) slice[k] = k;
        for (std::size_t k = slice.size() - 1; k > 0; --k) std::swap(slice[k], slice[random.below(k + 1)]);
        for (std::size_t k = 0; k < slice.size(); ++k)
            points[k][i] = 2 * (double(slice[k]) + random.uniform()) / n - 1;
    }
    return points;
}

LineFit fit_line(const std::vector<std::vector<double>>& z, const std::vector<double>& y) {
    const Eigen::Index n = Eigen::Index(z.size()), d = Eigen::Index(z.front().size()) + 1;
    if (n < d + 2)
        throw std::invalid_argument(
            fmt::format("{} strips are too few for {} inputs: it takes {}", n, d - 1, d + 2));
    Eigen::MatrixXd a(n, d);
    Eigen::VectorXd values(n);
    for (Eigen::Index r = 0; r < n; ++r) {
        a(r, 0) = 1;
        for (Eigen::Index i = 1; i < d; ++i) a(r, i) = z[std::size_t(r)][std::size_t(i - 1)];
        values(r) = y[std::size_t(r)];
    }
    const Eigen::MatrixXd inverse = (a.transpose() * a).completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::VectorXd found = inverse * a.transpose() * values, residual = values - a * found;
    const double variance = residual.squaredNorm() / double(n - d);
    LineFit fit;
    double left_out = 0;
    for (Eigen::Index r = 0; r < n; ++r) {
        // a left-out row is missed by its residual over 1 - leverage (Allen's PRESS)
        const double leverage = a.row(r) * inverse * a.row(r).transpose();
        left_out += std::pow(residual(r) / std::max(1e-9, 1 - leverage), 2) / double(n);
    }
    fit.leave_one_out = std::sqrt(left_out);
    for (Eigen::Index i = 0; i < d; ++i) {
        fit.coefficient.push_back(found(i));
        fit.standard_error.push_back(std::sqrt(variance * inverse(i, i)));
    }
    return fit;
}

std::vector<UncertainInput> motion_inputs(const Study& study, const Design& design) {
    const Scene& scene = study.scene;
    const Interaction& contact = scene.interaction;
    const double speed = design.blade_speed > 0 ? design.blade_speed : scene.blade_speed,
                 layer = design.layer_thickness > 0 ? design.layer_thickness : scene.layer_thickness;
    std::vector<UncertainInput> all = {
        around(study, "process.blade_speed", "m/s", speed, 0.9, 1.1,
               [](Study&, Design& d, double v) { d.blade_speed = v; }),
        around(study, "process.layer_thickness", "m", layer, 0.9, 1.1,
               [](Study&, Design& d, double v) { d.layer_thickness = v; }),
        around(study, "design_space.dosage_factor", "1", design.dosage_factor, 0.9, 1.1,
               [](Study&, Design& d, double v) { d.dosage_factor = v; }),
        around(study, "machine.land", "m", design.land >= 0 ? design.land : scene.land, 0.9, 1.1,
               [](Study&, Design& d, double v) { d.land = v; }),
        around(study, "interaction.static_friction", "1", contact.static_friction, 0.75, 1.25,
               [](Study& s, Design&, double v) { s.scene.interaction.static_friction = v; }),
        around(study, "interaction.rolling_friction", "1", contact.rolling_friction, 0.75, 1.25,
               [](Study& s, Design&, double v) { s.scene.interaction.rolling_friction = v; }),
        around(study, "interaction.restitution", "1", contact.coefficient_of_restitution, 0.75,
               std::min(1.25, 0.95 / std::max(1e-9, contact.coefficient_of_restitution)),
               [](Study& s, Design&, double v) { s.scene.interaction.coefficient_of_restitution = v; }),
        around(study, "interaction.work_of_adhesion", "J/m2", contact.work_of_adhesion, 0.5, 2,
               [](Study& s, Design&, double v) { s.scene.interaction.work_of_adhesion = v; }),
        around(study, "powder.A.size.D50", "m", scene.powder[0].size.d50, 0.9, 1.1,
               [](Study& s, Design&, double v) {
                   const double factor = v / s.scene.powder[0].size.d50;
                   for (Powder& powder : s.scene.powder)
                       for (double* size : {&powder.size.d10, &powder.size.d50, &powder.size.d90,
                                            &powder.size.cut_low, &powder.size.cut_high})
                           *size *= factor;
               }),
    };
    std::erase_if(all, [](const UncertainInput& input) { return !(input.value > 0); });
    return all;
}

std::vector<UncertainInput> label_inputs(const Study& study, const Design& design,
                                         ToleranceClass tolerance_class) {
    std::vector<UncertainInput> all;
    for (const BuildDimension& d : build_dimensions(study, design, tolerance_class))
        all.push_back({d.name, "m", d.nominal, d.nominal - d.tolerance, d.nominal + d.tolerance, "", false,
                       [d](Study&, Design& moved, double v) { moved = d.moved(moved, v - d.nominal); }});
    // one chamber more and the other less by as much: their mean, which moves grains, stays
    const double dose = design.dose[0], other = design.dose[1];
    all.push_back({"dose of A over B", "1", 0, -kDose, kDose, "", false,
                   [dose, other](Study&, Design& moved, double v) {
                       moved.dose = {dose + v, other - v};
                   }});
    const double place = design.footprint_offset;
    all.push_back({"place of the part in x", "m", place, place - kPlace, place + kPlace, "", false,
                   [](Study&, Design& moved, double v) { moved.footprint_offset = v; }});
    return all;
}

namespace {

class SensitivityRun {
  public:
    SensitivityRun(const Study& study, const SensitivityOptions& options)
        : study_(study), options_(options), runner_(options.run), map_(study_, runner_, nullptr) {}

    Sensitivity run(const Design& design) {
        const auto begun = std::chrono::steady_clock::now();
        out_.design = design;
        weight_ = bin_weights(study_);
        for (std::size_t b = 0; b < weight_.size(); ++b)
            if (weight_[b] > 0)
                out_.outputs.push_back(fmt::format("GI at y = {:.2f} mm", study_.bins.centre(int(b)) * 1e3));
        gi_outputs_ = out_.outputs.size();
        out_.outputs.push_back("misfit");
        out_.outputs.push_back("x drift");
        out_.labels = label_inputs(study_, design, options_.tolerance_class);
        out_.motion = motion_inputs(study_, design);
        const Evaluation nominal = map_.quoted(design);
        if (nominal.health.ok()) {
            out_.nominal = outputs_of(nominal, weight_);
            out_.noise_floor = nominal.misfit.noise_floor;
            labels();
            if (!runner_.stopped() && options_.strips > 0) motion();
            if (!runner_.stopped()) plates(nominal);
            if (runner_.stopped()) out_.status = "interrupted";
        } else {
            out_.status = nominal.health.status;
            out_.reason = nominal.health.reason;
        }
        out_.map_spreads = runner_.map_spreads;
        out_.full_spreads = runner_.full_spreads;
        out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        out_.seconds_cold = out_.seconds + runner_.seconds_saved;
        return std::move(out_);
    }

  private:
    void tell(const std::string& stage, double fraction) {
        if (options_.run.progress) options_.run.progress(stage, fraction);
    }

    void labels() {
        const int k = int(out_.labels.size());
        const long total = long(options_.trajectories) * (k + 1) + long(options_.samples) * (k + 2);
        long done = 0;
        const UnitModel model = [&](const std::vector<double>& u) -> std::optional<std::vector<double>> {
            if (++done % 64 == 0) tell("indices on the map", double(done) / double(total));
            if (runner_.stopped()) return {};
            Study unused;
            Design moved = out_.design;
            for (std::size_t i = 0; i < u.size(); ++i) {
                const UncertainInput& input = out_.labels[i];
                input.set(unused, moved, input.low + u[i] * (input.high - input.low));
            }
            std::vector<double> values = outputs_of(map_.quick(moved), weight_);
            if (!all_finite(values)) return {};
            return values;
        };
        out_.morris = morris_screening(model, k, options_.trajectories, study_.seed);
        out_.sobol = sobol_indices(model, k, options_.samples, study_.seed + 1);
        const Profile profile = [&](const Design& d) { return map_.quick(d).profile.gi; };
        out_.budget = tolerance_budget(study_, out_.design, profile, options_.tolerance_class,
                                       options_.gi_error, out_.noise_floor);
        tell("plates on the map", 0);
        out_.band = check_band(study_, out_.design, profile, out_.budget, options_.band_plates,
                               study_.seed + 1000000);
    }

    /// Strips of the motion inputs: one packing seed for all, so that what differs is the input and not the
    /// bed.
    void motion() {
        const int d = int(out_.motion.size());
        std::vector<std::vector<double>> z;
        std::vector<std::vector<double>> rows;
        for (const auto& point : latin_hypercube(options_.strips, d, study_.seed)) {
            if (runner_.stopped()) break;  // what is there is fitted
            Study changed = study_;
            changed.map_spreads = 1;
            Design moved = out_.design;
            std::vector<double> values;
            for (std::size_t i = 0; i < point.size(); ++i) {
                const UncertainInput& input = out_.motion[i];
                values.push_back(input.low + 0.5 * (point[i] + 1) * (input.high - input.low));
                input.set(changed, moved, values.back());
            }
            MapEvaluator strip(changed, runner_, nullptr);
            const Evaluation evaluation = strip.quick(moved);
            const std::vector<double> found =
                evaluation.health.ok() ? outputs_of(evaluation, weight_) : std::vector<double>();
            if (evaluation.health.status == "interrupted") break;
            if (found.empty() || !all_finite(found)) {
                out_.failed.push_back({values, evaluation.health.status, evaluation.health.reason});
                continue;
            }
            z.push_back(point);
            rows.push_back(found);
        }
        out_.strips = int(rows.size());
        if (out_.strips < d + 3) {
            out_.reason =
                fmt::format("{} strips gave numbers, {} inputs need {}: no surrogate", out_.strips, d, d + 3);
            return;
        }
        out_.effects.assign(std::size_t(d), {});
        double total = 0;
        for (std::size_t o = 0; o < out_.outputs.size(); ++o) {
            std::vector<double> y;
            for (const auto& row : rows) y.push_back(row[o]);
            const LineFit fit = fit_line(z, y);
            out_.surrogate_error.push_back(fit.leave_one_out);
            for (std::size_t i = 0; i < out_.effects.size(); ++i) {
                MotionEffect& effect = out_.effects[i];
                const double b = fit.coefficient[i + 1], error = fit.standard_error[i + 1];
                effect.half_range.push_back(b);
                effect.standard_error.push_back(error);
                if (o >= gi_outputs_) continue;
                effect.gi_rms += b * b / double(gi_outputs_);
                effect.gi_rms_error += error * error / double(gi_outputs_);
                total += b * b / double(gi_outputs_);
            }
            if (o < gi_outputs_)
                out_.surrogate_gi_error += std::pow(fit.leave_one_out, 2) / double(gi_outputs_);
        }
        out_.surrogate_gi_error = std::sqrt(out_.surrogate_gi_error);
        for (MotionEffect& effect : out_.effects) {
            effect.share = total > 0 ? effect.gi_rms / total : 0;
            effect.gi_rms = std::sqrt(effect.gi_rms);
            effect.gi_rms_error = std::sqrt(effect.gi_rms_error);
        }
    }

    /// Plates as a workshop may make them, spread with both powders; a bin is inside when it lies no further
    /// from the ideal plate's map than the band and the noise of bed and map allow.
    void plates(const Evaluation& nominal) {
        const auto dimensions = build_dimensions(study_, out_.design, options_.tolerance_class);
        DemEvaluator full(study_, runner_, nullptr);
        for (int k = 0; k < options_.spread_plates && !runner_.stopped(); ++k) {
            const Design plate = drawn_plate(dimensions, out_.design, study_.seed + 1000 + std::uint64_t(k));
            const std::uint64_t seed = confirmation_seed(study_.seed, 1000 + k);
            const Evaluation found = full.evaluate(plate, seed);
            if (found.health.status == "interrupted") return;
            if (!found.health.ok()) {
                out_.failed.push_back(
                    {{}, found.health.status, fmt::format("plate {}: {}", k + 1, found.health.reason)});
                continue;
            }
            PlateSpread spread{seed, 0, 0, 0};
            for (std::size_t b = 0; b < weight_.size(); ++b) {
                if (!(weight_[b] > 0)) continue;
                const double off = found.profile.gi[b] - nominal.profile.gi[b],
                             noise = 1.96 * std::hypot(found.profile.standard_error[b],
                                                       nominal.profile.standard_error[b]);
                spread.inside += std::fabs(off) <= std::hypot(out_.budget.band[b], noise);
                spread.rms += off * off;
                ++spread.bins;
            }
            spread.rms = std::sqrt(spread.rms / std::max(1, spread.bins));
            out_.plates.push_back(spread);
        }
    }

    const Study& study_;
    const SensitivityOptions& options_;
    SpreadRunner runner_;
    MapEvaluator map_;
    Sensitivity out_;
    std::vector<double> weight_;
    std::size_t gi_outputs_ = 0;
};

}  // namespace

Sensitivity run_sensitivity(const Study& study, const Design& design, const SensitivityOptions& options) {
    if (design.partition.points.size() < 2) throw std::invalid_argument("the design has no partition");
    return SensitivityRun(study, options).run(design);
}

}  // namespace gradwright
