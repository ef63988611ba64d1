#include "optimise/least_squares_strategy.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>

namespace gradwright {
namespace {

class DifferencedResiduals : public ceres::CostFunction {
  public:
    using Residuals = std::optional<std::vector<double>>;

    DifferencedResiduals(const LeastSquaresOptions& options, const SearchTask& task)
        : options_(options), task_(task), free_(task.space.free_count()) {
        mutable_parameter_block_sizes()->push_back(int(task.space.size()));
        if (const Residuals start = at(task.space.start())) set_num_residuals(int(start->size()));
    }
    bool usable() const { return num_residuals() > 0; }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const std::vector<double> x(parameters[0], parameters[0] + task_.space.size());
        const Residuals here = at(x);
        if (!here) return false;
        std::copy(here->begin(), here->end(), residuals);
        if (jacobians && jacobians[0]) differentiate(x, *here, jacobians[0]);
        return true;
    }

    // Ceres holds its cost functions constant; the account of the search is not part of the function.
    mutable EvaluatorSearch search;
    mutable std::exception_ptr thrown;
    mutable bool stopped = false, spent = false;

  private:
    bool ended() const { return thrown || stopped || spent; }
    int left() const { return task_.budget - search.evaluations; }

    /// Nothing when the point gave no numbers or may not be evaluated any more. Each point is paid for once:
    /// Ceres asks for a step's end in its line search and again afterwards.
    Residuals at(const std::vector<double>& x) const {
        if (const auto known = known_.find(x); known != known_.end()) return known->second;
        if (ended()) return std::nullopt;
        stopped = task_.stop && task_.stop();
        spent = left() < 1;
        if (stopped || spent) return std::nullopt;
        try {
            const Evaluation evaluation = evaluate(task_, x, search);
            // A bin that has become empty leaves the residuals: such a point cannot be compared with the
            // rest.
            const bool comparable =
                evaluation.health.ok() && !evaluation.residuals.empty() &&
                (num_residuals() == 0 || int(evaluation.residuals.size()) == num_residuals());
            return known_[x] = comparable ? Residuals(evaluation.residuals) : std::nullopt;
        } catch (...) {
            thrown = std::current_exception();
            return std::nullopt;
        }
    }

    void differentiate(const std::vector<double>& x, const std::vector<double>& here,
                       double* jacobian) const {
        const std::size_t n = x.size();
        const auto flat = [&] { std::fill(jacobian, jacobian + here.size() * n, 0.0); };
        flat();
        const bool central = left() >= 2 * free_ + 1;
        spent = spent || (!central && left() < free_ + 1);
        for (std::size_t i = 0; i < n && !ended(); ++i) {
            const double low = task_.space.low()[i], high = task_.space.high()[i];
            const double h = options_.difference_step * (high - low);
            if (!(h > 0)) continue;
            std::vector<double> point = x;
            Residuals above, below;
            if (x[i] + h <= high) {
                point[i] = x[i] + h;
                above = at(point);
            }
            if (x[i] - h >= low && (central || !above)) {
                point[i] = x[i] - h;
                below = at(point);
            }
            if (!above && !below) continue;
            const std::vector<double>&to = above ? *above : here, &from = below ? *below : here;
            const double distance = (above && below ? 2 : 1) * h;
            for (std::size_t r = 0; r < here.size(); ++r) jacobian[r * n + i] = (to[r] - from[r]) / distance;
        }
        // To Ceres an end of ours is a point without slope, where it stops in peace: a refused Jacobian it
        // would report on stderr.
        if (ended()) flat();
    }

    const LeastSquaresOptions& options_;
    const SearchTask& task_;
    const int free_;
    mutable std::map<std::vector<double>, Residuals> known_;
};

}  // namespace

EvaluatorSearch least_squares_with(const LeastSquaresOptions& options, const SearchTask& task) {
    if (!(options.difference_step >= 0.03 && options.difference_step <= 0.10))
        throw std::invalid_argument(
            fmt::format("least squares: a difference step of {} of the range lies outside 0.03 to 0.10",
                        options.difference_step));
    if (task.space.free_count() == 0) throw std::invalid_argument("least squares: no variable is free");
    DifferencedResiduals residuals(options, task);
    ceres::Solver::Summary summary;
    if (residuals.usable()) {
        std::vector<double> x = task.space.start();
        ceres::Problem::Options ownership;
        ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        ceres::Problem problem(ownership);
        problem.AddResidualBlock(&residuals, nullptr, x.data());
        std::vector<int> constant;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (task.space.high()[i] > task.space.low()[i]) {
                problem.SetParameterLowerBound(x.data(), int(i), task.space.low()[i]);
                problem.SetParameterUpperBound(x.data(), int(i), task.space.high()[i]);
            } else {
                constant.push_back(int(i));
            }
        }
        if (!constant.empty())
            problem.SetManifold(x.data(), new ceres::SubsetManifold(int(x.size()), constant));
        ceres::Solver::Options solver;
        solver.linear_solver_type = ceres::DENSE_QR;
        solver.max_num_iterations = options.iterations;
        // A differenced Jacobian is no licence for the full Gauss-Newton step that Ceres begins with (1e4).
        solver.initial_trust_region_radius = 10;
        solver.function_tolerance = 1e-4;   // relative, of rmse^2: far below any noise floor
        solver.parameter_tolerance = 1e-4;  // of the variables' length: far below a grain
        // The cubic one would ask for a Jacobian at every point of the line search.
        solver.line_search_interpolation_type = ceres::QUADRATIC;
        solver.max_num_line_search_step_size_iterations = 3;
        solver.logging_type = ceres::SILENT;
        solver.num_threads = 1;
        ceres::Solve(solver, &problem, &summary);
    }
    if (residuals.thrown) std::rethrow_exception(residuals.thrown);
    EvaluatorSearch result = std::move(residuals.search);
    const bool converged = residuals.usable() && summary.termination_type == ceres::CONVERGENCE;
    const bool failed = !residuals.usable() || summary.termination_type == ceres::FAILURE;
    result.termination = residuals.stopped ? "interrupted"
                         : residuals.spent ? "budget"
                         : converged       ? "converged"
                         : failed          ? "failed"
                                           : "budget";
    const std::string native = residuals.stopped ? "stopped"
                               : residuals.spent ? "budget spent"
                               : !residuals.usable()
                                   ? "the start gave no residuals"
                                   : ceres::TerminationTypeToString(summary.termination_type);
    result.native = "Ceres LEVENBERG_MARQUARDT: " + native;
    return result;
}

}  // namespace gradwright
