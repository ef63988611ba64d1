// Plane geometry of the partition against closed forms, brute force and chance.
#include "dem/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kLength = 3.2e-3, kWidth = 1.6e-3;

PartitionCurve reversed(PartitionCurve curve) {
    std::reverse(curve.points.begin(), curve.points.end());
    return curve;
}

/// A wavy curve monotone in x.
PartitionCurve random_curve(Random& random) {
    PartitionCurve curve;
    const int knots = 2 + static_cast<int>(random.below(6));
    for (int k = 0; k < knots; ++k) {
        curve.points.push_back({kLength * (k + 0.6 * random.uniform()) / knots, kWidth * random.uniform()});
    }
    return curve;
}

TEST(partition, straight_line_is_the_half_plane_of_its_closed_form_at_any_angle) {
    Random random(11);
    for (int trial = 0; trial < 2000; ++trial) {
        const double angle = trial < 4 ? (trial % 2 ? 1 : -1) * std::numbers::pi / 2
                                       : (random.uniform() - 0.5) * std::numbers::pi;
        const double offset = (random.uniform() - 0.5) * kWidth;
        const PartitionCurve curve = straight_partition(kLength, kWidth, angle, offset);
        const double x = (3 * random.uniform() - 1) * kLength, y = (3 * random.uniform() - 1) * kWidth;
        const double expected =
            -std::sin(angle) * (x - 0.5 * kLength) + std::cos(angle) * (y - 0.5 * kWidth - offset);
        EXPECT_NEAR(curve.signed_distance(x, y), expected, 1e-15);
    }
}

TEST(partition, a_lies_on_the_left_that_is_at_larger_y_when_the_curve_runs_along_x) {
    const PartitionCurve curve = straight_partition(kLength, kWidth, 0, 0);
    EXPECT_TRUE(curve.on_side_a(1e-3, 0.9e-3));
    EXPECT_FALSE(curve.on_side_a(1e-3, 0.7e-3));
    // at +90 degrees it runs in +y: left is smaller x
    EXPECT_TRUE(straight_partition(kLength, kWidth, std::numbers::pi / 2, 0).on_side_a(1e-3, 0.1e-3));
    EXPECT_FALSE(straight_partition(kLength, kWidth, std::numbers::pi / 2, 0).on_side_a(2e-3, 0.1e-3));
}

TEST(partition, reversing_the_curve_swaps_the_sides) {
    Random random(12);
    for (int trial = 0; trial < 500; ++trial) {
        const PartitionCurve curve = random_curve(random);
        const double x = kLength * (2 * random.uniform() - 0.5), y = kWidth * (2 * random.uniform() - 0.5);
        EXPECT_NEAR(reversed(curve).signed_distance(x, y), -curve.signed_distance(x, y), 1e-15);
        EXPECT_NEAR(reversed(curve).area_a(kLength, kWidth) + curve.area_a(kLength, kWidth), kLength * kWidth,
                    1e-9 * kLength * kWidth);
    }
}

TEST(partition, sign_of_a_curve_over_x_is_that_of_y_minus_the_curve) {
    Random random(13);
    for (int trial = 0; trial < 2000; ++trial) {
        const PartitionCurve curve = random_curve(random);
        const double x = kLength * (2 * random.uniform() - 0.5), y = kWidth * (2 * random.uniform() - 0.5);
        std::size_t k = 0;
        while (k + 2 < curve.points.size() && x >= curve.points[k + 1].x) ++k;
        const PlanPoint a = curve.points[k], b = curve.points[k + 1];
        const double over = y - (a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x));
        if (std::abs(over) < 1e-12) continue;
        EXPECT_EQ(curve.on_side_a(x, y), over > 0) << "x " << x << " y " << y;
    }
}

TEST(partition, sign_is_right_in_the_wedge_beyond_a_sharp_corner) {
    // a spike: the nearest feature is the tip, and one of its two segments alone would give the wrong side
    const PartitionCurve spike{{{0, 0}, {1, 5}, {1.2, 0}, {3, 0}}};
    EXPECT_LT(spike.signed_distance(1.0, 4.0), 0);  // inside the spike, under the tip: right of the curve
    EXPECT_GT(spike.signed_distance(1.0, 6.0), 0);
    EXPECT_GT(spike.signed_distance(1.4, 5.2), 0);
    EXPECT_GT(spike.signed_distance(0.5, 5.4), 0);
    EXPECT_DOUBLE_EQ(spike.signed_distance(1.0, 6.0), 1.0);
    EXPECT_LT(spike.signed_distance(1.3, -0.3), 0);
}

TEST(partition, distance_is_that_to_the_nearest_point_of_the_curve) {
    Random random(14);
    for (int trial = 0; trial < 30; ++trial) {
        const PartitionCurve curve = random_curve(random);
        const double x = kLength * random.uniform(), y = kWidth * random.uniform();
        double nearest = 1;
        for (std::size_t k = 0; k + 1 < curve.points.size(); ++k) {
            const PlanPoint a = curve.points[k], b = curve.points[k + 1];
            const double from = k == 0 ? -5 : 0, to = k + 2 == curve.points.size() ? 6 : 1;
            for (int i = 0; i <= 20000; ++i) {
                const double t = from + (to - from) * i / 20000;
                nearest = std::min(nearest, std::hypot(a.x + t * (b.x - a.x) - x, a.y + t * (b.y - a.y) - y));
            }
        }
        EXPECT_NEAR(std::abs(curve.signed_distance(x, y)), nearest, 2e-6);  // spacing of the brute force
    }
}

TEST(partition, area_on_side_a_agrees_with_a_count_of_points) {
    Random random(15);
    for (int trial = 0; trial < 40; ++trial) {
        PartitionCurve curve =
            trial % 2 ? random_curve(random)
                      : straight_partition(kLength, kWidth, std::numbers::pi * (random.uniform() - 0.5),
                                           kWidth * (random.uniform() - 0.5));
        if (trial % 4 == 3) {
            for (PlanPoint& p : curve.points) p.y = 3 * p.y - kWidth;  // leaves and re-enters the rectangle
        }
        const int n = 20000;
        int inside = 0;
        for (int i = 0; i < n; ++i)
            inside += curve.on_side_a(kLength * random.uniform(), kWidth * random.uniform());
        const double share = curve.area_a(kLength, kWidth) / (kLength * kWidth);
        EXPECT_NEAR(static_cast<double>(inside) / n, share, 4.5 * std::sqrt(share * (1 - share) / n) + 1e-3);
    }
}

TEST(partition, area_of_lines_that_miss_or_follow_a_wall) {
    const double whole = kLength * kWidth;
    EXPECT_DOUBLE_EQ((PartitionCurve{{{0, -1e-3}, {1e-3, -1e-3}}}.area_a(kLength, kWidth)), whole);
    EXPECT_DOUBLE_EQ((PartitionCurve{{{0, 2e-3}, {1e-3, 2e-3}}}.area_a(kLength, kWidth)), 0);
    EXPECT_NEAR((PartitionCurve{{{0, 0}, {kLength, 0}}}.area_a(kLength, kWidth)), whole, 1e-12 * whole);
    EXPECT_NEAR((PartitionCurve{{{kLength, 0}, {0, 0}}}.area_a(kLength, kWidth)), 0, 1e-12 * whole);
    EXPECT_NEAR((PartitionCurve{{{0, 0}, {kLength, kWidth}}}.area_a(kLength, kWidth)), 0.5 * whole,
                1e-12 * whole);
    EXPECT_NEAR(straight_partition(kLength, kWidth, std::numbers::pi / 2, 0).area_a(kLength, kWidth),
                0.5 * whole, 1e-12 * whole);
    EXPECT_NEAR(straight_partition(kLength, kWidth, -std::numbers::pi / 2, 0).area_a(kLength, kWidth),
                0.5 * whole, 1e-12 * whole);
}

TEST(partition, a_pocket_from_one_wall_has_its_area_inside_or_outside_by_direction) {
    // down from the wall y = W, along, and up again: a U that is closed by the wall
    const PartitionCurve pocket{{{1e-3, 1.6e-3}, {1e-3, 1e-3}, {2e-3, 1e-3}, {2e-3, 1.6e-3}}};
    const double area = 1e-3 * 0.6e-3;
    EXPECT_NEAR(pocket.area_a(kLength, kWidth), area,
                1e-9 * area);  // left of the way down and round is the inside
    EXPECT_NEAR(reversed(pocket).area_a(kLength, kWidth), kLength * kWidth - area, 1e-9 * area);
    EXPECT_TRUE(pocket.on_side_a(1.5e-3, 1.5e-3));
    EXPECT_FALSE(pocket.on_side_a(0.5e-3, 1.5e-3));
}

TEST(partition, clipped_curve_ends_on_the_walls_and_keeps_its_inner_knots) {
    const PartitionCurve curve{{{0.5e-3, 0.4e-3}, {1.5e-3, 0.8e-3}, {2.5e-3, 0.9e-3}}};
    const std::vector<PlanPoint> path = curve.clipped(kLength, kWidth);
    ASSERT_EQ(path.size(), 5u);
    EXPECT_EQ(path.front().x, 0);
    EXPECT_NEAR(path.front().y, 0.2e-3, 1e-15);
    EXPECT_EQ(path.back().x, kLength);
    EXPECT_NEAR(path.back().y, 0.97e-3, 1e-15);
    EXPECT_NEAR(path[2].x, 1.5e-3, 1e-15);
    EXPECT_TRUE((PartitionCurve{{{0, 2e-3}, {1e-3, 2e-3}}}.clipped(kLength, kWidth).empty()));
    const std::vector<PlanPoint> upright =
        straight_partition(kLength, kWidth, std::numbers::pi / 2, 0).clipped(kLength, kWidth);
    ASSERT_GE(upright.size(), 2u);
    EXPECT_EQ(upright.front().y, 0);
    EXPECT_EQ(upright.back().y, kWidth);
}

TEST(partition, crossing_touching_and_folding_back_are_found) {
    EXPECT_FALSE((PartitionCurve{{{0, 0}, {1, 1}, {2, 0}, {3, 1}}}.self_intersects()));
    EXPECT_TRUE((PartitionCurve{{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}.self_intersects()));
    EXPECT_TRUE(
        (PartitionCurve{{{0, 0}, {2, 0}, {1, 0}, {1, 1}}}.self_intersects()));  // folds back on itself
    EXPECT_TRUE((PartitionCurve{{{0, 0}, {2, 0}, {2, 1}, {1, 0}}}.self_intersects()));  // end touches
    EXPECT_TRUE((
        PartitionCurve{{{0, 0}, {1, 0}, {1, 1}, {0.5, 0.5}}}.self_intersects()));  // its continuation crosses
    Random random(16);
    for (int trial = 0; trial < 200; ++trial) EXPECT_FALSE(random_curve(random).self_intersects());
}

/// Lower and upper curve, each wavy and monotone in x, A between them or outside.
PartitionCurve random_pair(Random& random, bool a_between) {
    PartitionCurve pair;
    for (const double x : {0.0, 1.0e-3, 2.3e-3, kLength}) {
        const double y = kWidth * random.uniform();
        pair.points.push_back({x, y});
        pair.second.push_back({x, y + 0.1e-3 + 0.5 * kWidth * random.uniform()});
    }
    std::reverse(a_between ? pair.second.begin() : pair.points.begin(),
                 a_between ? pair.second.end() : pair.points.end());
    return pair;
}

TEST(partition_pair, sides_are_those_of_a_count_of_heights_and_the_distance_is_the_nearer_curves) {
    Random random(17);
    for (int trial = 0; trial < 60; ++trial) {
        const bool a_between = trial % 2 == 0;
        const PartitionCurve pair = random_pair(random, a_between);
        EXPECT_FALSE(pair.pair_disagrees());
        EXPECT_EQ(pair.a_between(), a_between);
        const PartitionCurve first{pair.points}, second{pair.second};
        for (int i = 0; i < 200; ++i) {
            const double x = kLength * random.uniform(), y = kWidth * (2 * random.uniform() - 0.5);
            // above the lower and below the upper, each told by its own curve
            const bool inside = first.on_side_a(x, y) == a_between && second.on_side_a(x, y) == a_between;
            EXPECT_EQ(pair.on_side_a(x, y), inside == a_between) << x << " " << y;
            const double distance = std::abs(pair.signed_distance(x, y));
            EXPECT_TRUE(distance == std::abs(first.signed_distance(x, y)) ||
                        distance == std::abs(second.signed_distance(x, y)));
        }
    }
}

TEST(partition_pair, area_agrees_with_a_count_of_points) {
    Random random(23);
    for (int trial = 0; trial < 6; ++trial) {
        const PartitionCurve pair = random_pair(random, trial % 2 == 0);
        int inside = 0;
        const int points = 20000;
        for (int i = 0; i < points; ++i)
            inside += pair.on_side_a(kLength * random.uniform(), kWidth * random.uniform());
        // four standard errors of the count
        EXPECT_NEAR(pair.area_a(kLength, kWidth) / (kLength * kWidth), double(inside) / points,
                    4 * 0.5 / std::sqrt(points));
    }
}

TEST(partition_pair, curves_that_meet_or_name_different_sides_are_told) {
    const std::vector<PlanPoint> lower = {{0, 0.4e-3}, {kLength, 0.6e-3}},
                                 upper = {{kLength, 1.2e-3}, {0, 1.0e-3}};
    EXPECT_FALSE((PartitionCurve{lower, upper}.pair_disagrees()));
    EXPECT_TRUE((PartitionCurve{lower, {upper.rbegin(), upper.rend()}}.pair_disagrees()));
    EXPECT_TRUE((PartitionCurve{lower, {{kLength, 0.5e-3}, {0, 0.5e-3}}}.pair_disagrees()));
    EXPECT_TRUE((PartitionCurve{lower, {}}.second_clipped(kLength, kWidth).empty()));
    EXPECT_EQ((PartitionCurve{lower, upper}.second_clipped(kLength, kWidth).size()), 2u);
}

}  // namespace
}  // namespace gradwright
