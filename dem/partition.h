// The partition in plan view: a directed simple polyline whose ends are continued straight to infinity.
// A is the powder on its left (larger y when it runs in +x). Frame: dispenser, x = spreading direction, y =
// across.
//
// A-B-A and B-A-B need two such curves, which must not cross inside the dispenser. Each has A on its left, so
// the pair's directions say which powder stands between them: A where each lies on the other's left, else B.
#pragma once
#include <vector>

namespace gradwright {

struct PlanPoint {
    double x = 0, y = 0;  ///< [m]
};

struct PartitionCurve {
    std::vector<PlanPoint> points;       ///< >= 2, no two neighbours equal
    std::vector<PlanPoint> second = {};  ///< empty, or the other curve of a pair, >= 2

    /// Signed distance to the partition [m], > 0 on A's side. Exact for a simple polyline.
    double signed_distance(double x, double y) const;
    bool on_side_a(double x, double y) const { return signed_distance(x, y) > 0; }
    /// The part inside 0 <= x <= length, 0 <= y <= width, ends on the walls [m]. Empty when it misses the
    /// rectangle.
    std::vector<PlanPoint> clipped(double length, double width) const;
    /// The same of the second curve; empty where there is none.
    std::vector<PlanPoint> second_clipped(double length, double width) const;
    /// Area of the rectangle on A's side [m2].
    double area_a(double length, double width) const;
    /// Does a curve meet itself, its straight continuations included?
    bool self_intersects() const;
    /// Of a pair: do the curves meet between their ends, or does one call A what the other calls B?
    bool pair_disagrees() const;
    /// Of a pair: does A stand between the curves?
    bool a_between() const;
};

/// Straight partition: `angle` from +x, positive towards +y [rad], through the dispenser's centre plus
/// `offset_y`.
PartitionCurve straight_partition(double dispenser_length, double dispenser_width, double angle,
                                  double offset_y);

}  // namespace gradwright
