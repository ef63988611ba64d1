#include "optimise/ceres_fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "dem/random.h"
#include "optimise/bounded_search.h"
#include "optimise/evaluation.h"
#include "optimise/map_evaluator.h"
#include "optimise/motion.h"

namespace gradwright {
namespace {

/// GI per width by which a constraint is broken: far above the slope of any misfit.
constexpr double kConstraintPrice = 30;

struct ResidualFunctor {
    const FitProblem* problem;
    const PartitionFamily* family;
    const std::vector<ConstraintRow>* rows;
    double smoothing;

    template <class T>
    bool operator()(const T* const* parameters, T* out) const {
        std::vector<T> residual;
        problem->residuals(*family, parameters[0], smoothing, residual);
        if (!rows->empty()) {
            std::vector<T> numbers;
            family->numbers_of(parameters[0], numbers);
            for (const ConstraintRow& row : *rows) {
                const T value = row_value(row, numbers, problem->motion);
                const T excess = value < row.low ? T(row.low - value) : T(value - row.high);
                residual.push_back(excess > 0.0 ? T(kConstraintPrice * excess) : T(0.0));
            }
        }
        std::copy(residual.begin(), residual.end(), out);
        return true;
    }
};

/// Derivatives are carried `Stride` at a time: the curve of five knots (8 parameters) in one pass, a straight
/// one in a short pass.
template <int Stride>
ceres::CostFunction* autodiff(const FitProblem& problem, const PartitionFamily& family,
                              const std::vector<ConstraintRow>& rows, double smoothing) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<ResidualFunctor, Stride>(
        new ResidualFunctor{&problem, &family, &rows, smoothing});
    cost->AddParameterBlock(int(family.size()));
    cost->SetNumResiduals(problem.residual_count() + family.bend_count() + int(rows.size()));
    return cost;
}

/// Levenberg-Marquardt at one kernel width, in place; returns the evaluations spent.
int descend(const FitProblem& problem, const PartitionFamily& family, const std::vector<ConstraintRow>& rows,
            double smoothing, int iterations, std::vector<double>& p) {
    ceres::CostFunction* cost = family.size() <= 4 ? autodiff<4>(problem, family, rows, smoothing)
                                                   : autodiff<8>(problem, family, rows, smoothing);
    ceres::Problem least_squares;
    least_squares.AddResidualBlock(cost, nullptr, p.data());
    std::vector<int> constant;
    for (std::size_t i = 0; i < family.size(); ++i) {
        if (family.high()[i] > family.low()[i]) {
            least_squares.SetParameterLowerBound(p.data(), int(i), family.low()[i]);
            least_squares.SetParameterUpperBound(p.data(), int(i), family.high()[i]);
        } else {
            constant.push_back(int(i));
        }
    }
    if (!constant.empty())
        least_squares.SetManifold(p.data(), new ceres::SubsetManifold(int(family.size()), constant));
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = iterations;
    options.function_tolerance = 1e-5;   // relative, of rmse^2: far below any noise floor
    options.parameter_tolerance = 1e-6;  // times 1.6 mm: far below a grain
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;  // same bits on any machine load
    ceres::Solver::Summary summary;
    ceres::Solve(options, &least_squares, &summary);
    family.clip(p);
    p = nearest_kept(rows, family, problem.motion, p);
    return summary.num_residual_evaluations + summary.num_jacobian_evaluations;
}

/// SBPLX on hard labels: for norms that are no sum of squares (max, mean absolute), whose kinks a quadratic
/// model would smear.
int polish(const FitProblem& problem, const PartitionFamily& family, const std::vector<ConstraintRow>& rows,
           const FitOptions& options, std::vector<double>& p) {
    BoundedSearch search;
    search.method = SearchMethod::sbplx;
    search.low = family.low();
    search.high = family.high();
    search.start = p;
    search.step.assign(family.size(), 0.02);  // 32 um on the coupon: a grain
    search.budget = options.polish_evaluations;
    search.stop = options.stop;
    const BoundedSearchResult found = minimise(
        [&](const std::vector<double>& trial) {
            const std::vector<double> kept = nearest_kept(rows, family, problem.motion, trial);
            return problem.hard_objective(family, kept) + detour(trial, kept);
        },
        search);
    if (found.evaluations > 0) p = nearest_kept(rows, family, problem.motion, found.best);
    return found.evaluations;
}

struct Start {
    Orientation orientation;
    std::vector<double> p;     ///< where it stands
    std::vector<double> best;  ///< best on hard labels so far
    double objective = kNotEvaluable;

    void keep_best(double hard) {
        if (hard < objective) {
            objective = hard;
            best = p;
        }
    }
};

std::vector<Start> starts_of(const Study& study, const DesignSpace& space, const FitProblem& problem,
                             const FitOptions& options) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    // W^-1 over the same pooled grains that the residuals see
    std::vector<std::pair<double, double>> origin;
    for (std::size_t i = 0; i < problem.grains.size(); ++i)
        origin.emplace_back(problem.grains.origin_x[i], problem.grains.volume[i]);
    std::sort(origin.begin(), origin.end());
    std::vector<double> cumulative;
    double sum = 0;
    for (const auto& grain : origin) cumulative.push_back(sum += grain.second);
    const auto quantile = [&](double share) {
        const auto at = std::lower_bound(cumulative.begin(), cumulative.end(), share * sum);
        return origin[std::min<std::size_t>(at - cumulative.begin(), origin.size() - 1)].first;
    };

    Random random(options.seed);
    std::vector<Start> starts;
    const auto add = [&](const PartitionFamily& family, const std::vector<double>& p) {
        starts.push_back({family.orientation(), p, {}});
        for (int i = 0; i < options.perturbed_starts; ++i) {
            std::vector<double> moved = p;
            for (double& number : moved) number += options.perturbation * (2 * random.uniform() - 1);
            family.clip(moved);
            starts.push_back({family.orientation(), moved, {}});
        }
    };
    const auto add_around = [&](std::vector<PlanPoint> given) {
        const bool runs_back = given.front().x > given.back().x;
        if (runs_back) std::reverse(given.begin(), given.end());
        const PartitionFamily family(space, length, width, {!runs_back, given.back().y > given.front().y});
        std::vector<PlanPoint> samples;
        for (std::size_t k = 0; k + 1 < given.size(); ++k)
            for (int i = 0; i < 50; ++i) {
                const double t = (i + 0.5) / 50;
                samples.push_back({given[k].x + t * (given[k + 1].x - given[k].x),
                                   given[k].y + t * (given[k + 1].y - given[k].y)});
            }
        add(family, family.fit_samples(samples));
    };
    if (options.near.size() >= 2) {
        add_around(options.near);
        return starts;
    }
    const bool above = stands_above(study, space);
    for (const bool rising :
         {!above, above}) {  // A on the platform side first, then on the dispenser's back side
        const PartitionFamily family(space, length, width, {above, rising});
        const std::vector<double> closed = closed_form_start(study, family, quantile);
        add(family, closed);
        if (space.family == Family::two_curves)
            add(family, closed_form_start(study, family, quantile, Fold::valley));
        const std::vector<double> users = family.users_start(space, closed);
        if (users != closed) add(family, users);
    }
    // Folded curves, where the family allows them: they trade grains from both ends of the dispenser against
    // each other, which is what cancels the drift of the heap's turnover.
    if (space.family == Family::polyline && !space.monotone && space.knots >= 3)
        for (const Fold fold : {Fold::valley, Fold::ridge}) {
            const PartitionFamily family(space, length, width, {above, !above});
            add(family, family.fit_samples(closed_form_curve(study, family.orientation(), quantile, fold)));
        }
    if (space.given_points.size() >= 2) add_around(space.given_points);
    return starts;
}

}  // namespace

FitProblem::FitProblem(const Study& study, const Design& design, std::span<const Layer> layers,
                       std::span<const double> share, std::span<const BedPowders> beds)
    : bins(study.bins),
      target(study.target.is_field() ? field_targets(study) : bin_targets(study)),
      weight(study.target.is_field() ? field_weights(study) : bin_weights(study)),
      drift_target(drift_targets(study)),
      drift_weight(drift_weights(study)),
      fill(chamber_fill(study, design)),
      norm(study.objective.norm),
      x_drift_weight(study.objective.x_drift_weight) {
    const Footprint footprint = footprint_of(study, design);
    motion = motion_values(study, design);
    grains = pool_map(layers, share, beds, moves_alike(study), footprint.x_low, footprint.x_high);
    thirds = thirds_of(grains);
    if (!beds.empty())
        for (const bool a : {true, false}) {
            const PooledGrains one = powder_of(grains, a);
            powders.push_back({study.target.is_field() ? columns_of(one, study.columns) : std::vector{one},
                               thirds_of(one)});
        }
    if (!study.target.is_field()) {
        columns = {grains};
        return;
    }
    columns = columns_of(grains, study.columns);
    for (std::size_t column = 0; column < columns.size(); ++column)
        if (columns[column].size() == 0)  // no grain, no residual; `judge` makes up for it
            for (int bin = 0; bin < bins.count; ++bin)
                weight[column * bins.count + static_cast<std::size_t>(bin)] = 0;
}

bool FitProblem::usable() const {
    return grains.size() > 0 && std::any_of(weight.begin(), weight.end(), [](double w) { return w > 0; });
}

int FitProblem::residual_count() const {
    const auto counts = [](double w) { return w > 0; };
    return int(std::count_if(weight.begin(), weight.end(), counts) +
               std::count_if(drift_weight.begin(), drift_weight.end(), counts));
}

std::pair<double, double> FitProblem::hard_misfit_and_drift(const PartitionFamily& family,
                                                            std::span<const double> p) const {
    std::vector<double> gi, difference;
    gradation<double>(family, p.data(), 0, gi, difference);
    std::vector<double> counts(drift_weight.size(), 0.0);
    for (std::size_t b = 0; b < weight.size(); ++b) gi[b] -= target[b];
    for (std::size_t b = 0; b < drift_weight.size(); ++b) {
        counts[b] = drift_weight[b] > 0;
        if (!difference.empty()) difference[b] -= drift_target[b];
    }
    const bool judged = std::any_of(counts.begin(), counts.end(), [](double c) { return c > 0; });
    const double drift = difference.empty() || !judged ? 0 : norm_of(Norm::rmse, difference, counts);
    return {norm_of(norm, gi, weight), drift};
}

double FitProblem::hard_objective(const PartitionFamily& family, std::span<const double> p) const {
    const auto [misfit, drift] = hard_misfit_and_drift(family, p);
    return std::sqrt(misfit * misfit + x_drift_weight * drift * drift + family.unsound(p));
}

FitResult fit_partition(const Study& study, const DesignSpace& space, const Design& design,
                        const FitProblem& problem, const FitOptions& options) {
    FitResult result;
    result.design = design;
    result.objective = kNotEvaluable;
    if (!problem.usable()) {
        result.message = problem.grains.size() == 0 ? "no laid grain in the footprint" : "no bin counts";
        return result;
    }
    if (!space.partition_free) {
        result.ok = true;
        result.message = "the partition is fixed";
        return result;
    }
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    // All starts at the widest kernel, the best of them down to the narrowest. A kernel's optimum is not the
    // hard labels', so each candidate keeps the best it has seen on hard labels and never ends worse than it
    // began.
    std::vector<Start> candidates = starts_of(study, space, problem, options);
    const auto stopped = [&options] { return options.stop && options.stop(); };
    // none for a family that has not the numbers they name: a comparison, not a design
    const auto rows_of = [&study](const PartitionFamily& family) { return constraint_rows(study, family); };
    const auto improve = [&](Start& candidate, double kernel, int iterations) {
        const PartitionFamily family(space, length, width, candidate.orientation);
        result.evaluations += descend(problem, family, rows_of(family), kernel, iterations, candidate.p);
        candidate.keep_best(problem.hard_objective(family, candidate.p));
    };
    for (Start& candidate : candidates) {
        const PartitionFamily family(space, length, width, candidate.orientation);
        candidate.p = nearest_kept(rows_of(family), family, problem.motion, candidate.p);
        candidate.keep_best(problem.hard_objective(family, candidate.p));
        if (&candidate == &candidates.front()) result.start_objective = candidate.objective;
        if (stopped()) break;
        ++result.starts;
        improve(candidate, options.kernels.front(), std::min(options.iterations, options.first_iterations));
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Start& a, const Start& b) { return a.objective < b.objective; });
    candidates.resize(std::min(candidates.size(), std::size_t(std::max(1, options.finalists))));
    for (Start& candidate : candidates) {
        if (candidate.best.empty()) continue;
        const PartitionFamily family(space, length, width, candidate.orientation);
        for (const double kernel : options.kernels)
            if (!stopped()) improve(candidate, kernel, options.iterations);
        if (problem.norm != Norm::rmse && options.polish_evaluations > 0 && !stopped()) {
            candidate.p = candidate.best;
            result.evaluations += polish(problem, family, rows_of(family), options, candidate.p);
            candidate.keep_best(problem.hard_objective(family, candidate.p));
        }
        Design finalist = design;
        finalist.family = space.family;
        finalist.partition = family.curve(candidate.best);
        finalist.parameters = family.named(candidate.best);
        if (family.unsound(candidate.best) == 0) result.finalists.push_back(std::move(finalist));
        if (candidate.objective < result.objective) {
            result.objective = candidate.objective;
            result.p = candidate.best;
            result.orientation = candidate.orientation;
        }
    }
    if (!result.p.empty() && result.finalists.empty()) {
        result.message =
            fmt::format("no partition found that can be bent with minimum_bend_radius = {:.3g} mm",
                        space.minimum_bend_radius * 1e3);
        return result;
    }
    if (result.p.empty()) {
        result.message = "stopped before the first start was finished";
        return result;
    }
    const PartitionFamily family(space, length, width, result.orientation);
    result.ok = true;
    result.design.family = space.family;
    result.design.partition = family.curve(result.p);
    result.design.parameters = family.named(result.p);
    std::tie(result.misfit, result.drift) = problem.hard_misfit_and_drift(family, result.p);
    result.message = fmt::format("{} starts, {} evaluations: objective {:.4f} from {:.4f} in closed form",
                                 result.starts, result.evaluations, result.objective, result.start_objective);
    return result;
}

}  // namespace gradwright
