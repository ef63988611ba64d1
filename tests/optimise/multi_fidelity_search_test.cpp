#include "optimise/multi_fidelity_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "optimise/motion.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using namespace testing_heap;

constexpr double kWidth = 1.6e-3;

/// GI_b = target_b + sum_k c_bk slope (y_k - optimum_k) / W + bend (that)^2: the objective has its minimum 0
/// at the optimum. Two of them, full and map, that differ in a known way.
class Toy : public Evaluator {
  public:
    explicit Toy(const Study& study) : study_(study) {}
    std::vector<double> optimum = {0.75, 0.55, 0.2};
    double slope = 1, bend = 0, jam_from = 1e9;
    std::vector<double> objectives;
    std::vector<std::uint64_t> seeds;
    std::vector<std::vector<double>> points;

    Evaluation evaluate(const Design& design, std::uint64_t seed) override {
        Evaluation e;
        e.design = design;
        e.seed = seed;
        e.fidelity = Fidelity::kinematic;  // coverage is no concern of this test
        std::vector<double> y;
        for (const PlanPoint& point : design.partition.points) y.push_back(point.y / kWidth);
        const bool jammed = double(objectives.size()) >= jam_from;
        e.health.status = jammed ? "jammed" : "ok";
        const std::vector<double> target = bin_targets(study_);
        for (int b = 0; b < study_.bins.count; ++b) {
            double shift = 0;
            for (int k = 0; k < 3; ++k) {
                const double near = std::exp(-0.5 * std::pow((b - 1.5 - 2.0 * k) / 1.5, 2));
                shift += near * slope * (y[k] - optimum[k]);
            }
            e.profile.gi.push_back(target[b] + 0.5 * (shift + bend * shift * shift));
        }
        e.drift.difference.assign(study_.bins.count, 0.0);
        judge(study_, e);
        objectives.push_back(e.objective);
        seeds.push_back(seed);
        points.push_back(y);
        return e;
    }
    Fidelity fidelity() const override { return Fidelity::full; }

  private:
    const Study& study_;
};

struct Case {
    Study study = coupon();
    Toy full{study}, map{study};
    Case() {
        study.design_space.knots = 3;
        study.design_space.monotone = false;
        map.optimum = {0.6, 0.5, 0.35};  // 0.05 to 0.15 of the width beside the truth
    }
    MultiFidelitySearch search(int budget, MultiFidelityOptions options = {},
                               const std::function<bool()>& stop = {}) {
        const PartitionFamily family(study.design_space, 3.2e-3, kWidth, {});
        const SearchSpace space(study, family, start_design(study), {0.5, 0.5, 0.5, 0}, Moves::labels);
        return multi_fidelity_search(options, study, {full, space, 7, budget, stop}, map);
    }
};

TEST(MultiFidelity, a_map_that_is_only_shifted_is_mended_by_one_full_spread) {
    Case c;
    const MultiFidelitySearch found = c.search(10);
    ASSERT_GE(c.full.objectives.size(), 2u);
    EXPECT_GT(c.full.objectives[0], 0.02);  // the map's own optimum
    EXPECT_LT(c.full.objectives[1], 2e-3);
    EXPECT_EQ(found.termination, "converged") << found.native;
    EXPECT_LT(found.evaluations, 5);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(found.best.design.partition.points[k].y / kWidth, c.full.optimum[k], 0.01);
    for (const std::uint64_t seed : c.full.seeds) EXPECT_EQ(seed, 7u);
}

TEST(MultiFidelity, a_map_of_wrong_slope_and_bend_is_mended_in_a_few) {
    Case c;
    c.map.slope = 1.4;
    c.full.bend = 0.4;
    const MultiFidelitySearch found = c.search(12);
    EXPECT_LT(found.best.objective, 0.1 * c.full.objectives.front()) << found.native;
    EXPECT_LT(found.best.objective, 5e-3);
    EXPECT_GT(found.accepted, 0);
}

TEST(MultiFidelity, a_map_that_points_the_wrong_way_is_not_followed) {
    Case c;
    c.map.slope = -1;
    const MultiFidelitySearch found = c.search(40);
    EXPECT_EQ(found.best.objective, *std::min_element(c.full.objectives.begin(), c.full.objectives.end()));
    EXPECT_LE(found.best.objective, c.full.objectives.front());
    EXPECT_GT(found.rejected, 1);
    EXPECT_EQ(found.termination, "converged");
    EXPECT_LT(found.radius, MultiFidelityOptions{}.smallest_radius);
    EXPECT_NE(found.native.find("radius below its resolution"), std::string::npos) << found.native;
}

TEST(MultiFidelity, no_step_is_longer_than_the_trust_region) {
    Case c;
    c.map.optimum = {1.4, 1.3, -0.4};  // far away
    MultiFidelityOptions options;
    options.radius = 0.05;
    c.search(2, options);
    ASSERT_EQ(c.full.points.size(), 2u);
    for (int k = 0; k < 3; ++k)  // of the range [-0.5, 1.5]
        EXPECT_LE(std::fabs(c.full.points[1][k] - c.full.points[0][k]), 0.05 * 2 + 1e-12);
    EXPECT_NEAR(c.full.points[0][0], 1.4, 0.02);  // the first is the map's own, wherever that lies
}

TEST(MultiFidelity, keeps_its_budget) {
    for (const int budget : {0, 1, 2, 3}) {
        Case c;
        c.map.slope = 2;
        const MultiFidelitySearch found = c.search(budget);
        EXPECT_EQ(int(c.full.objectives.size()), budget);
        EXPECT_EQ(found.evaluations, budget);
        EXPECT_EQ(found.termination, "budget") << found.native;
        EXPECT_EQ(found.model_optimum.size(), 4 + kMotionVariables.size());
    }
}

TEST(MultiFidelity, a_spread_without_numbers_is_a_step_refused_and_the_first_is_a_failure) {
    Case c;
    c.full.jam_from = 1;
    const MultiFidelitySearch found = c.search(6);
    EXPECT_TRUE(found.best.health.ok());
    EXPECT_EQ(found.best.objective, c.full.objectives.front());
    EXPECT_EQ(found.accepted, 0);
    Case never;
    never.full.jam_from = 0;
    const MultiFidelitySearch nothing = never.search(6);
    EXPECT_EQ(nothing.termination, "failed");
    EXPECT_EQ(nothing.evaluations, 1);
    EXPECT_FALSE(nothing.best.health.ok());
}

TEST(MultiFidelity, a_stop_ends_it_with_the_best_so_far) {
    Case c;
    c.map.slope = 2;
    const MultiFidelitySearch found = c.search(20, {}, [&] { return c.full.objectives.size() >= 2; });
    EXPECT_EQ(found.termination, "interrupted");
    EXPECT_EQ(found.evaluations, 2);
    EXPECT_TRUE(found.best.health.ok());
}

TEST(MultiFidelity, the_same_task_gives_the_same_bits) {
    Case a, b;
    a.map.slope = b.map.slope = 1.4;
    EXPECT_EQ(a.search(6).native, b.search(6).native);
    EXPECT_EQ(a.full.points, b.full.points);
}

}  // namespace
}  // namespace gradwright
