// Targets over x and y from the cells to the verdict, on a heap whose transport kernel is known.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "optimise/ceres_fit.h"
#include "optimise/confirmation.h"
#include "optimise/journal.h"
#include "optimise/kinematic_evaluator.h"
#include "optimise/map_evaluator.h"
#include "optimise/strategies.h"
#include "tests/optimise/map_run.h"
#include "tests/optimise/synthetic_field.h"

namespace gradwright {
namespace {

using namespace testing_heap;

/// A heap that turns over: what is laid far comes from further back.
Heap turning() {
    Heap heap;
    heap.turn = -0.5;
    heap.mixing = 0.15;
    return heap;
}

/// Asks for what a known straight partition lays on the turning heap: half a ramp's width of shift along x.
Study reachable() {
    Study study = coupon();
    const Heap heap = turning();
    Study fine = study;
    fine.target.shape = TargetShape::field;  // only its columns are used
    Design known = start_design(study);
    known.partition = straight_partition(3.2e-3, 1.6e-3, -0.4, 0);
    std::vector<std::vector<double>> of_x;
    const int columns = 5, rows = 9;
    for (int i = 0; i < columns; ++i) {
        const double x = 1.6e-3 + 1.6e-3 * i / (columns - 1);
        fine.footprint.x_low = x - 1e-6;
        fine.footprint.x_high = x + 1e-6;
        fine.bins = {1.6e-3 / (rows - 1), rows};
        std::vector<double> column = truth(heap, fine, known, true).gi;  // bins about rows: shifted below
        of_x.push_back(column);
    }
    // value at a row's y: mean of the bins on both sides of it
    study.target = field_through(study, columns, rows, [&](double x, double y) {
        const int i = int(std::lround((x - 1.6e-3) / 1.6e-3 * (columns - 1)));
        const int j = int(std::lround(y / 1.6e-3 * (rows - 1)));
        return 0.5 * (of_x[i][std::max(0, j - 1)] + of_x[i][j]);
    });
    return study;
}

double rms(const std::vector<double>& values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                     double(values.size()));
}

TEST(Field, a_change_along_x_that_the_target_asks_for_is_met_and_no_drift) {
    const Study study = reachable();
    const Heap heap = turning();
    ASSERT_GT(rms(drift_targets(study)), 1.5 * study.objective.x_drift_tolerance);
    const StudyResult result = run(study, heap).result;
    EXPECT_EQ(result.verdict, Verdict::met) << result.message;
    EXPECT_LT(true_field_rmse(heap, study, result.design), study.objective.tolerance);
    EXPECT_LT(result.drift_misfit.value, study.objective.x_drift_tolerance);
    // the layer itself does drift
    EXPECT_GT(rms(result.confirmed_drift.difference), study.objective.x_drift_tolerance);
    ASSERT_EQ(result.confirmed_field.cells.gi.size(), 3u * 8u);
    ASSERT_EQ(result.field_target.size(), 3u * 8u);
    // the same wish without its change along x is the x drift that a target of y refuses
    Study flat = study;
    flat.target = Target{};
    flat.target.shape = TargetShape::table;
    flat.target.table_y = study.target.table_y;
    flat.target.table_gi = study.target.table_gi;
    flat.design_space.knots = 2;  // no folds to cancel it with
    EXPECT_NE(run(flat, heap).result.verdict, Verdict::met);
}

TEST(Field, cells_and_their_errors_agree_with_the_truth) {
    const Study study = reachable();
    const Heap heap = turning();
    const StudyResult result = run(study, heap).result;
    const std::vector<double> expected = true_cells(heap, study, result.design, true);
    const std::vector<double> weight = field_weights(study);
    double square = 0;
    int counting = 0;
    for (std::size_t c = 0; c < expected.size(); ++c) {
        if (!(weight[c] > 0)) continue;
        const GradationProfile &predicted = result.predicted.field.cells,
                               &confirmed = result.confirmed_field.cells;
        EXPECT_NEAR(predicted.gi[c], expected[c], 5 * predicted.standard_error[c]) << c;
        EXPECT_NEAR(confirmed.gi[c], expected[c], 5 * confirmed.standard_error[c]) << c;
        square += std::pow((confirmed.gi[c] - expected[c]) / confirmed.standard_error[c], 2);
        ++counting;
    }
    // errors are neither much too small nor much too large: this heap's beds share nothing, what is allowed
    // for them (kBedsOverBlocksMap) makes the quoted variance up to 1.83 times the real one
    EXPECT_LT(std::sqrt(square / counting), 1.4);
    EXPECT_GT(std::sqrt(square / counting), 0.3);
}

TEST(Field, what_no_partition_lays_is_not_met_and_the_message_says_what_limits) {
    Study study = coupon();
    // up, down and up again along x: a heap turns over in one direction
    study.target = field_through(study, 7, 2, [](double x, double y) {
        const double wave = std::cos(2 * std::numbers::pi * (x - 1.6e-3) / 1.0667e-3);
        return std::clamp(0.5 + 0.3 * wave + 0 * y, 0.0, 1.0);
    });
    const StudyResult result = run(study, turning()).result;
    EXPECT_EQ(result.verdict, Verdict::not_met) << result.message;
    EXPECT_NE(result.message.find("not met by its field"), std::string::npos) << result.message;
    EXPECT_NE(result.message.find("the transport limits it"), std::string::npos) << result.message;
}

TEST(Field, a_field_that_does_not_change_along_x_asks_for_what_its_profile_asks_for) {
    Study study = coupon();
    const std::vector<double> of_y = bin_targets(study);
    study.target = field_through(
        study, 2, 17, [&](double, double y) { return std::clamp((y - 0.4e-3) / 0.8e-3, 0.0, 1.0); });
    const std::vector<double> cells = field_targets(study), weights = field_weights(study),
                              weight = bin_weights(study);
    for (int c = 0; c < study.columns; ++c)
        for (int b = 0; b < 8; ++b) {
            EXPECT_NEAR(cells[c * 8 + b], of_y[b], 1e-12);
            EXPECT_EQ(weights[c * 8 + b], weight[b]);
        }
    for (int b = 0; b < 8; ++b) {
        EXPECT_NEAR(bin_targets(study)[b], of_y[b], 1e-12);
        EXPECT_EQ(drift_targets(study)[b], 0);
        EXPECT_EQ(drift_weights(study)[b], weight[b] > 0 ? 1 : 0);
    }
}

TEST(Field, kinematic_picture_is_off_by_just_the_change_along_x) {
    // g = profile + slope (x - middle): the fully mixed picture of the best profile misses every column by
    // slope times its distance from the middle, and the drift by the whole change between the thirds.
    Study study = coupon();
    const double slope = 100;  // 0.1 per mm: 0.107 between the outer thirds
    study.target = field_through(study, 2, 2, [&](double x, double) { return 0.5 + slope * (x - 2.4e-3); });
    study.footprint.y_low = 0.2e-3;
    study.footprint.y_high = 1.4e-3;
    Design design = start_design(study);
    // half of the dispenser at every y but for the curve's ends: GI 0.5
    design.partition.points = {{1.6e-3, -10e-3}, {1.6e-3, 10e-3}};
    const Evaluation evaluation = KinematicEvaluator(study).evaluate(design, 1);
    ASSERT_TRUE(evaluation.health.ok()) << evaluation.health.reason;
    const double column = 1.6e-3 / 3, off = slope * column;
    EXPECT_NEAR(evaluation.misfit.value, off * std::sqrt(2.0 / 3), 1e-9);
    EXPECT_NEAR(evaluation.drift_misfit.value, 2 * off, 1e-9);
    // |residuals|^2 = rmse^2 + x_drift_weight drift^2
    const double square = std::inner_product(evaluation.residuals.begin(), evaluation.residuals.end(),
                                             evaluation.residuals.begin(), 0.0);
    EXPECT_NEAR(square, off * off * 2 / 3 + study.objective.x_drift_weight * 4 * off * off, 1e-12);
}

TEST(Field, cells_that_nobody_cares_about_neither_count_nor_are_fitted) {
    Study study = reachable();
    const Heap heap = turning();
    // ask for the impossible in the last column, and for nobody to look
    for (std::size_t k = 0; k < study.target.field_gi.size(); ++k)
        if (study.target.field_x[k % 5] > 2.4e-3 + 1e-9) study.target.field_gi[k] = k % 2;
    study.target = study.target.over_x(1.6e-3, 3.2e-3);
    study.target.zones = {{-1, 1, 0, 2.4e-3, 1}};
    const std::vector<double> weight = field_weights(study);
    for (int b = 0; b < 8; ++b) {
        EXPECT_EQ(weight[16 + b], 0);
        EXPECT_NEAR(weight[8 + b], 0.5 * weight[b], 1e-12);  // half of the column is looked at
        EXPECT_NEAR(bin_weights(study)[b], 0.5 * weight[b], 1e-12);
        EXPECT_EQ(drift_weights(study)[b], 0);  // one end of it is not to be looked at
    }
    const StudyResult result = run(study, heap).result;
    EXPECT_NE(result.verdict, Verdict::not_met) << result.message;
    EXPECT_LT(result.misfit.value, 0.05);
}

TEST(Field, residuals_have_the_derivatives_of_central_differences_and_the_square_of_the_objective) {
    const Study study = reachable();
    const Heap heap = turning();
    Calls calls;
    const Design start = start_design(study);
    const std::vector<Layer> layers = {spread(heap, calls, scene_of(study, start, true, 3), nullptr).layer};
    FitProblem problem(study, start, layers);
    EXPECT_EQ(problem.columns.size(), 3u);
    const PartitionFamily family(study.design_space, 3.2e-3, 1.6e-3, {true, false});
    const std::vector<double> p = {0.8, 0.05, 0.1, 0.15, 0.1, 0.1, -0.2, 0.05};
    using Jet = ceres::Jet<double, 8>;
    std::vector<Jet> at, residual;
    for (int i = 0; i < 8; ++i) at.emplace_back(p[i], i);
    problem.residuals(family, at.data(), 100e-6, residual);
    ASSERT_EQ(int(residual.size()), problem.residual_count());
    double largest = 0;
    for (int i = 0; i < 8; ++i) {
        const double step = 1e-5;
        std::vector<double> up = p, down = p, high, low;
        up[i] += step;
        down[i] -= step;
        problem.residuals(family, up.data(), 100e-6, high);
        problem.residuals(family, down.data(), 100e-6, low);
        for (std::size_t r = 0; r < residual.size(); ++r) {
            const double numeric = (high[r] - low[r]) / (2 * step);
            EXPECT_NEAR(residual[r].v[i], numeric, 2e-3) << "residual " << r << " parameter " << i;
            largest = std::max(largest, std::abs(numeric));
        }
    }
    EXPECT_GT(largest, 0.5);
    // hard labels: the sum of squares is the square of what the evaluator's judge says
    std::vector<double> hard;
    problem.residuals(family, p.data(), 0.0, hard);
    const double square = std::inner_product(hard.begin(), hard.end(), hard.begin(), 0.0);
    EXPECT_NEAR(std::sqrt(square), problem.hard_objective(family, p), 1e-9);
    Study no_waste = study;
    no_waste.objective.waste_weight = 0;
    no_waste.objective.min_coverage = 0;
    RunOptions options;
    options.spread = engine(heap, std::make_shared<Calls>());
    SpreadRunner runner(options);
    MapEvaluator map(no_waste, runner, nullptr);
    Design design = start;
    design.partition = family.curve(p);
    OriginMap& origins = map.map_of(design);
    origins.layers = layers;
    EXPECT_NEAR(map.quick(design).objective, std::sqrt(square), 1e-9);
}

class FieldStrategies : public testing::TestWithParam<std::string> {};

TEST_P(FieldStrategies, search_the_cells_and_confirm_them) {
    Study study = reachable();
    study.design_space.knots = 3;
    study.max_spreads = 6;
    const Heap heap = turning();
    RunOptions options;
    options.spread = engine(heap, std::make_shared<Calls>());
    const StudyResult result = run_strategy(study, {GetParam(), Fidelity::map, 60}, options);
    ASSERT_FALSE(result.confirmations.empty()) << result.message;
    // The x-averaged start misses the cells; every search has to have seen them.
    EXPECT_LT(true_field_rmse(heap, study, result.design), 0.06);
    EXPECT_EQ(result.misfit.value, norm_of(
                                       Norm::rmse,
                                       [&] {
                                           std::vector<double> r = result.confirmed_field.cells.gi;
                                           for (std::size_t c = 0; c < r.size(); ++c)
                                               r[c] -= result.field_target[c];
                                           return r;
                                       }(),
                                       result.field_weight));
}

INSTANTIATE_TEST_SUITE_P(all, FieldStrategies, testing::Values("map", "mf", "bobyqa", "sbplx", "ceres"),
                         [](const auto& info) { return info.param; });

TEST(Field, smoothed_discrepancies_do_not_reach_into_the_next_column) {
    const std::vector<double> predicted(6, 0.5), weight(6, 1);
    std::vector<double> confirmed = predicted;
    confirmed[2] += 0.3;  // last bin of the first of two columns
    const std::vector<double> one = smoothed_discrepancy(confirmed, predicted, weight, 3);
    EXPECT_NEAR(one[1], 0.1, 1e-12);
    EXPECT_NEAR(one[2], 0.15, 1e-12);
    EXPECT_EQ(one[3], 0);
    EXPECT_NEAR(smoothed_discrepancy(confirmed, predicted, weight, 6)[3], 0.1, 1e-12);
}

TEST(Field, unlike_powders_are_corrected_cell_by_cell) {
    Study study = reachable();
    study.max_spreads = 6;
    study.scene.powder[1].material.density *= 0.54;
    Heap heap = turning();
    heap.light_shift = -0.16;  // beside each other they travel as A does alone
    const StudyResult result = run(study, heap).result;
    EXPECT_TRUE(std::any_of(result.history.begin(), result.history.end(),
                            [](const HistoryEntry& entry) { return entry.stage == "correct"; }));
    EXPECT_LT(true_field_rmse(heap, study, result.design), 0.06);
}

TEST(Field, journal_keeps_its_cells_and_a_target_of_y_has_none) {
    char name[] = "/tmp/gradwright_field_XXXXXX";
    const std::string folder = mkdtemp(name);
    Study study = coupon();
    study.target = field_through(study, 2, 2, [](double x, double) { return x / 3.2e-3; });
    const Evaluation field = KinematicEvaluator(study).evaluate(start_design(study), 1);
    const Evaluation plain = KinematicEvaluator(coupon()).evaluate(start_design(coupon()), 1);
    {
        Journal journal(folder);
        journal.append(field);
        journal.append(plain);
    }
    const std::vector<JournalEntry> read = Journal::read(folder);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].evaluation.field.x_m, field.field.x_m);
    EXPECT_EQ(read[0].evaluation.field.cells.gi, field.field.cells.gi);
    EXPECT_EQ(read[0].evaluation.field_target, field.field_target);
    EXPECT_EQ(read[0].evaluation.judged().gi.size(), 24u);
    EXPECT_TRUE(read[1].evaluation.field.x_m.empty());
    EXPECT_EQ(read[1].evaluation.judged().gi, plain.profile.gi);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace gradwright
