#include "optimise/ceres_fit.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

Layer map_layer(const Study& study, std::uint64_t seed, const Heap& heap = {}) {
    Calls calls;
    return spread(heap, calls, scene_of(study, start_design(study), true, seed), nullptr).layer;
}

TEST(CeresFit, derivatives_agree_with_central_differences_at_every_kernel_and_orientation) {
    Study study = coupon();
    const std::vector<Layer> layers = {map_layer(study, 3)};
    const FitProblem problem(study, start_design(study), layers);
    using Jet = ceres::Jet<double, 8>;
    for (const Orientation orientation :
         {Orientation{true, false}, Orientation{true, true}, Orientation{false, true}})
        for (const double kernel : {100e-6, 20e-6}) {
            const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, orientation);
            const std::vector<double> p =
                orientation.rising ? std::vector<double>{0.2, 0.05, 0.1, 0.15, 0.1, 0.1, -0.2, 0.05}
                                   : std::vector<double>{0.8, 0.05, 0.1, 0.15, 0.1, 0.1, -0.2, 0.05};
            std::vector<Jet> at, residual;
            for (int i = 0; i < 8; ++i) at.emplace_back(p[i], i);
            problem.residuals(family, at.data(), kernel, residual);
            ASSERT_EQ(int(residual.size()), problem.residual_count());
            double largest = 0;
            for (int i = 0; i < 8; ++i) {
                // 1e-5 of 1.6 mm = 16 nm: a thousandth of the kernel, so that the kernel's curvature stays
                // below the tolerance
                const double step = 1e-5;
                std::vector<double> up = p, down = p, high, low;
                up[i] += step;
                down[i] -= step;
                problem.residuals(family, up.data(), kernel, high);
                problem.residuals(family, down.data(), kernel, low);
                for (std::size_t r = 0; r < residual.size(); ++r) {
                    const double numeric = (high[r] - low[r]) / (2 * step);
                    EXPECT_NEAR(residual[r].v[i], numeric, 2e-3) << "residual " << r << " parameter " << i;
                    largest = std::max(largest, std::abs(numeric));
                }
            }
            EXPECT_GT(largest, 0.5);  // the test looks at something
        }
}

TEST(CeresFit, beats_the_closed_form_on_the_truth_of_a_known_heap) {
    const Study study = coupon();
    const Heap heap;
    const std::vector<Layer> layers = {map_layer(study, 5, heap)};
    const Design start = start_design(study);
    const FitProblem problem(study, start, layers);
    const FitResult fit = fit_partition(study, study.design_space, start, problem, {});
    ASSERT_TRUE(fit.ok) << fit.message;
    EXPECT_LE(fit.objective, fit.start_objective);
    // closed form with this map's own distribution of origins
    const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, {true, false});
    Design closed = start;
    closed.partition =
        family.curve(family.fit_samples(closed_form_curve(study, {true, false}, [&](double share) {
            return origin_x_quantile(layers, 1.6e-3, 3.2e-3, share);
        })));
    const double fitted = true_rmse(study, truth(heap, study, fit.design, true));
    const double floor = true_rmse(study, truth(heap, study, closed, true));
    EXPECT_LE(fitted, floor + 0.005);  // one map's own noise, 3000 grains
    EXPECT_LT(fitted, 0.02);
}

TEST(CeresFit, a_falling_target_is_met_by_the_mirrored_curve) {
    Study study = coupon();
    study.target = linear_target(0.4e-3, 1, 1.2e-3, 0);
    const Heap heap;
    const std::vector<Layer> layers = {map_layer(study, 5, heap)};
    const FitProblem problem(study, start_design(study), layers);
    const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, {});
    ASSERT_TRUE(fit.ok);
    EXPECT_FALSE(fit.orientation.a_above);
    EXPECT_LT(true_rmse(study, truth(heap, study, fit.design, true)), 0.02);
}

TEST(CeresFit, drift_weight_trades_misfit_for_drift_and_zero_is_allowed) {
    Study study = coupon();
    Heap heap;
    heap.turn = -0.6;  // a heap that lays its origins in order: drift cannot be had for nothing
    const std::vector<Layer> layers = {map_layer(study, 5, heap)};
    double drift[2], misfit[2];
    for (const int weighed : {0, 1}) {
        study.objective.x_drift_weight = weighed ? 5 : 0;
        const FitProblem problem(study, start_design(study), layers);
        const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, {});
        ASSERT_TRUE(fit.ok);
        drift[weighed] = fit.drift;
        misfit[weighed] = fit.misfit;
    }
    EXPECT_LT(drift[1], 0.8 * drift[0]);
    EXPECT_GT(misfit[1], misfit[0]);
}

TEST(CeresFit, polish_lowers_the_norm_that_least_squares_do_not_know) {
    Study study = coupon();
    study.objective.norm = Norm::max;
    study.objective.x_drift_weight = 0;
    study.target =
        step_target(0.8e-3);  // cannot be met: the largest bin error is what the norms disagree about
    const std::vector<Layer> layers = {map_layer(study, 5)};
    const FitProblem problem(study, start_design(study), layers);
    FitOptions options;
    options.perturbed_starts = 1;
    const FitResult polished =
        fit_partition(study, study.design_space, start_design(study), problem, options);
    options.polish_evaluations = 0;
    const FitResult bare = fit_partition(study, study.design_space, start_design(study), problem, options);
    ASSERT_TRUE(polished.ok && bare.ok);
    EXPECT_LT(polished.objective, bare.objective);
}

TEST(CeresFit, the_same_seed_gives_the_same_bits) {
    const Study study = coupon();
    const std::vector<Layer> layers = {map_layer(study, 8)};
    const FitProblem problem(study, start_design(study), layers);
    const FitResult a = fit_partition(study, study.design_space, start_design(study), problem, {});
    const FitResult b = fit_partition(study, study.design_space, start_design(study), problem, {});
    EXPECT_EQ(a.p, b.p);
    EXPECT_EQ(a.objective, b.objective);
}

TEST(CeresFit, an_empty_map_is_told_and_not_fitted) {
    const Study study = coupon();
    const std::vector<Layer> layers(1);
    const FitProblem problem(study, start_design(study), layers);
    const FitResult fit = fit_partition(study, study.design_space, start_design(study), problem, {});
    EXPECT_FALSE(fit.ok);
    EXPECT_EQ(fit.message, "no laid grain in the footprint");
}

}  // namespace
}  // namespace gradwright
