// What the map strategy does at its rate: many studies each, so none of the fast tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "optimise/design_run.h"
#include "optimise/map_evaluator.h"
#include "tests/optimise/map_run.h"

namespace gradwright {
namespace {

using namespace testing_heap;

TEST(SearchStatistics, unlike_powders_that_move_alike_pass_the_gate_at_its_rate_and_like_ones_need_none) {
    int passed = 0;
    for (int seed = 1; seed <= 20; ++seed) {
        Study study = coupon();
        study.seed = seed;
        study.max_spreads = 4;
        study.design_space.knots = 2;  // the gate does not hang on the fit's skill
        study.scene.powder[1].material.density *= 0.54;
        Heap heap;
        heap.bed_shift = 0.02;
        const Outcome got = run(study, heap);
        ASSERT_TRUE(got.result.powder_gate);
        EXPECT_EQ(got.calls->map_seeds.size(), 2u);
        EXPECT_NE(got.calls->map_seeds[0], got.calls->map_seeds[1]);  // a bed of its own
        passed += got.result.powder_gate->passes;
    }
    EXPECT_GE(passed, 16);  // 19 expected; fewer than 16 has a chance of 3e-3
    EXPECT_FALSE(run(coupon(), Heap{}).result.powder_gate);
}

TEST(SearchStatistics,
     an_undecided_design_that_is_hardly_good_enough_is_made_anew_with_what_its_spread_taught) {
    // Beds that turn over a little sooner or later, one narrow strip and three full spreads: where the strip
    // was an odd one, a second look at its design would not help.
    int met = 0;
    double misfit2 = 0;
    for (int seed = 1; seed <= 12; ++seed) {
        Study study = coupon();
        study.scene.sides = Sides::periodic;
        study.seed = seed;
        study.map_spreads = 1;
        study.max_spreads = 4;
        study.objective.tolerance = 0.02;
        Heap heap;
        heap.bed_shift = 0.015;
        const StudyResult result = run(study, heap).result;
        met += result.verdict == Verdict::met;
        misfit2 += std::pow(true_rmse(study, truth(heap, study, result.design, true)), 2) / 12;
    }
    EXPECT_GE(met, 7);
    EXPECT_LT(std::sqrt(misfit2), 0.0125);  // 0.0137 where the second bed only looked again
}

}  // namespace
}  // namespace gradwright
