// The partition in plan view: a directed simple polyline whose ends are continued straight to infinity.
// A is the powder on its left (larger y when it runs in +x). Frame: dispenser, x = spreading direction, y =
// across.
#pragma once
#include <vector>

namespace gradwright {

struct PlanPoint {
    double x = 0, y = 0;  ///< [m]
};

struct PartitionCurve {
    std::vector<PlanPoint> points;  ///< >= 2, no two neighbours equal

    /// Signed distance to the curve [m], > 0 on A's side. Exact for a simple polyline.
    double signed_distance(double x, double y) const;
    bool on_side_a(double x, double y) const { return signed_distance(x, y) > 0; }
    /// The part inside 0 <= x <= length, 0 <= y <= width, ends on the walls [m]. Empty when it misses the
    /// rectangle.
    std::vector<PlanPoint> clipped(double length, double width) const;
    /// Area of the rectangle on A's side [m2].
    double area_a(double length, double width) const;
    bool self_intersects() const;
};

/// Straight partition: `angle` from +x, positive towards +y [rad], through the dispenser's centre plus
/// `offset_y`.
PartitionCurve straight_partition(double dispenser_length, double dispenser_width, double angle,
                                  double offset_y);

}  // namespace gradwright
