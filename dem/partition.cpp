// Plane geometry of a directed polyline continued straight at both ends.
#include "dem/partition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gradwright {
namespace {

PlanPoint operator-(PlanPoint a, PlanPoint b) {
    return {a.x - b.x, a.y - b.y};
}
PlanPoint operator+(PlanPoint a, PlanPoint b) {
    return {a.x + b.x, a.y + b.y};
}
PlanPoint operator*(double s, PlanPoint a) {
    return {s * a.x, s * a.y};
}
double dot(PlanPoint a, PlanPoint b) {
    return a.x * b.x + a.y * b.y;
}
/// > 0 when b lies to the left of a.
double cross(PlanPoint a, PlanPoint b) {
    return a.x * b.y - a.y * b.x;
}
double length_of(PlanPoint a) {
    return std::hypot(a.x, a.y);
}
PlanPoint unit(PlanPoint a) {
    const double l = length_of(a);
    return {a.x / l, a.y / l};
}
PlanPoint left_normal(PlanPoint direction) {
    return {-direction.y, direction.x};
}

/// Points with the two straight continuations cut off at `reach` beyond the ends.
std::vector<PlanPoint> continued(const std::vector<PlanPoint>& points, double reach) {
    std::vector<PlanPoint> all;
    all.reserve(points.size() + 2);
    all.push_back(points.front() - reach * unit(points[1] - points[0]));
    all.insert(all.end(), points.begin(), points.end());
    all.push_back(points.back() + reach * unit(points.back() - points[points.size() - 2]));
    return all;
}

/// The continued curve cut at the four lines of the rectangle and clamped to it: outside pieces hug the
/// walls, inside pieces stay where they are, so the area to the left is unchanged. `first`, `last`: the
/// stretch from the first entry to the last exit.
struct Clamped {
    std::vector<PlanPoint> points;
    bool inside = false;
};

Clamped clamp_to_rectangle(const std::vector<PlanPoint>& points, double length, double width) {
    double reach = length + width;
    for (PlanPoint p : points) reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
    // 4 x: far enough to pass the whole rectangle in any direction from any of the points
    const std::vector<PlanPoint> curve = continued(points, 4 * reach);
    std::vector<PlanPoint> path;
    std::vector<bool> piece_inside;  // piece k runs from path[k] to path[k+1]
    path.push_back(curve.front());
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        const PlanPoint a = curve[k], step = curve[k + 1] - curve[k];
        std::array<double, 5> cuts = {2, 2, 2, 2, 1};
        if (step.x != 0) {
            cuts[0] = (0 - a.x) / step.x;
            cuts[1] = (length - a.x) / step.x;
        }
        if (step.y != 0) {
            cuts[2] = (0 - a.y) / step.y;
            cuts[3] = (width - a.y) / step.y;
        }
        std::sort(cuts.begin(), cuts.end());
        double from = 0;
        for (double to : cuts) {
            if (to <= from || to > 1) continue;
            const PlanPoint middle = a + 0.5 * (from + to) * step;
            piece_inside.push_back(middle.x >= 0 && middle.x <= length && middle.y >= 0 && middle.y <= width);
            path.push_back(to == 1 ? curve[k + 1] : a + to * step);
            from = to;
        }
    }
    Clamped result;
    const auto first = std::find(piece_inside.begin(), piece_inside.end(), true);
    if (first == piece_inside.end()) return result;
    const auto last = std::find(piece_inside.rbegin(), piece_inside.rend(), true);
    const std::size_t begin = first - piece_inside.begin();
    const std::size_t end = piece_inside.rend() - last;  // index of the point after the last inside piece
    result.inside = true;
    for (std::size_t k = begin; k <= end; ++k) {
        PlanPoint p = {std::clamp(path[k].x, 0.0, length), std::clamp(path[k].y, 0.0, width)};
        // the ends lie on a wall: take away the rounding of the cut
        if (k == begin || k == end) {
            const double tolerance = 1e-12 * reach;
            if (std::abs(p.x) < tolerance) p.x = 0;
            if (std::abs(p.x - length) < tolerance) p.x = length;
            if (std::abs(p.y) < tolerance) p.y = 0;
            if (std::abs(p.y - width) < tolerance) p.y = width;
        }
        if (result.points.empty() || length_of(p - result.points.back()) > 1e-12 * reach)
            result.points.push_back(p);
    }
    return result;
}

/// Way along the rectangle's edge, counter-clockwise from (0, 0), of a point on it.
double way_along_edge(PlanPoint p, double length, double width) {
    const double tolerance = 1e-9 * (length + width);
    if (p.y <= tolerance && p.x < length - tolerance) return p.x;
    if (p.x >= length - tolerance && p.y < width - tolerance) return length + p.y;
    if (p.y >= width - tolerance && p.x > tolerance) return length + width + (length - p.x);
    return 2 * length + width + (width - p.y);
}

/// Do the closed segments a-b and c-d meet?
bool segments_meet(PlanPoint a, PlanPoint b, PlanPoint c, PlanPoint d) {
    const auto side = [](PlanPoint from, PlanPoint to, PlanPoint p) {
        const double value = cross(to - from, p - from);
        // zero within rounding of the products
        const double size = length_of(to - from) * (length_of(p - from) + length_of(to - from));
        return std::abs(value) <= 1e-14 * size ? 0 : (value > 0 ? 1 : -1);
    };
    const int c_side = side(a, b, c), d_side = side(a, b, d), a_side = side(c, d, a), b_side = side(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) return true;
    const auto within = [](PlanPoint from, PlanPoint to, PlanPoint p) {
        return p.x >= std::min(from.x, to.x) && p.x <= std::max(from.x, to.x) &&
               p.y >= std::min(from.y, to.y) && p.y <= std::max(from.y, to.y);
    };
    return (c_side == 0 && within(a, b, c)) || (d_side == 0 && within(a, b, d)) ||
           (a_side == 0 && within(c, d, a)) || (b_side == 0 && within(c, d, b));
}

// Nearest feature (segment, continuation or vertex) gives the distance; its normal gives the sign. At a
// vertex the sum of the two unit normals is taken (the plane case of the angle-weighted pseudo-normal,
// Baerentzen and Aanaes 2005): either segment's own normal alone gives the wrong sign in the wedge beyond a
// sharp corner.
double signed_distance_to(const std::vector<PlanPoint>& points, PlanPoint q) {
    const std::size_t segments = points.size() - 1;
    double best = std::numeric_limits<double>::infinity(), sign = 1;
    for (std::size_t k = 0; k < segments; ++k) {
        const PlanPoint a = points[k], step = points[k + 1] - a;
        double t = dot(q - a, step) / dot(step, step);
        if (k > 0) t = std::max(t, 0.0);
        if (k + 1 < segments) t = std::min(t, 1.0);
        const bool at_start = k > 0 && t == 0, at_end = k + 1 < segments && t == 1;
        PlanPoint normal = left_normal(unit(step));
        PlanPoint nearest = a + t * step;
        if (at_start) {
            normal = normal + left_normal(unit(a - points[k - 1]));
            nearest = a;
        } else if (at_end) {
            nearest = points[k + 1];
            normal = normal + left_normal(unit(points[k + 2] - points[k + 1]));
        }
        const PlanPoint away = q - nearest;
        // on a piece the height over the line is exact where |q - nearest| would carry the rounding of a long
        // continuation
        const double distance = at_start || at_end ? length_of(away) : std::abs(cross(unit(step), q - a));
        if (distance < best) {
            best = distance;
            sign = (at_start || at_end ? dot(away, normal) : cross(step, q - a)) > 0 ? 1 : -1;
        }
    }
    return sign * best;
}

}  // namespace

// A's region lies to the left of both curves (A between) or of either (B between): the smaller or the larger
// of the two distances. The nearest curve alone would do as well but beyond the ends, where the continuations
// may cross.
double PartitionCurve::signed_distance(double x, double y) const {
    const double first = signed_distance_to(points, {x, y});
    if (second.empty()) return first;
    const double other = signed_distance_to(second, {x, y});
    return a_between() ? std::min(first, other) : std::max(first, other);
}

bool PartitionCurve::a_between() const {
    return !second.empty() && signed_distance_to(points, second.front()) > 0;
}

std::vector<PlanPoint> PartitionCurve::clipped(double length, double width) const {
    return clamp_to_rectangle(points, length, width).points;
}

std::vector<PlanPoint> PartitionCurve::second_clipped(double length, double width) const {
    return second.empty() ? std::vector<PlanPoint>{} : clamp_to_rectangle(second, length, width).points;
}

namespace {

// Shoelace over the clamped curve closed counter-clockwise along the walls from its exit to its entry: the
// region to its left.
double area_left_of(const std::vector<PlanPoint>& points, double length, double width) {
    Clamped path = clamp_to_rectangle(points, length, width);
    const double whole = length * width;
    if (!path.inside || path.points.size() < 2)
        return signed_distance_to(points, {0.5 * length, 0.5 * width}) > 0 ? whole : 0;
    const double perimeter = 2 * (length + width);
    const double exit = way_along_edge(path.points.back(), length, width);
    double to_go = way_along_edge(path.points.front(), length, width) - exit;
    if (to_go < 0) to_go += perimeter;
    const std::array<PlanPoint, 4> corners = {PlanPoint{length, 0}, {length, width}, {0, width}, {0, 0}};
    const std::array<double, 4> corner_way = {length, length + width, 2 * length + width, perimeter};
    std::vector<PlanPoint> ring = path.points;
    for (int turn = 0; turn < 2; ++turn) {
        for (int c = 0; c < 4; ++c) {
            const double way = corner_way[c] + turn * perimeter;
            if (way > exit && way < exit + to_go) ring.push_back(corners[c]);
        }
    }
    double twice = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) twice += cross(ring[k], ring[(k + 1) % ring.size()]);
    double area = 0.5 * twice;
    // entry and exit at one point, curve running clockwise: A is all the rest (a mere rounding below zero is
    // an empty side A)
    if (area < -1e-9 * whole) area += whole;
    return std::clamp(area, 0.0, whole);
}

bool meets_itself(const std::vector<PlanPoint>& points) {
    double reach = 0;
    for (PlanPoint p : points) {
        for (PlanPoint q : points) reach = std::max(reach, length_of(p - q));
    }
    // continuations that would meet only beyond 1000 lengths of the curve count as parallel
    const std::vector<PlanPoint> curve = continued(points, 1000 * reach);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        if (i + 2 < curve.size()) {
            const PlanPoint a = curve[i + 1] - curve[i], b = curve[i + 2] - curve[i + 1];
            if (dot(a, b) < 0 && std::abs(cross(a, b)) <= 1e-12 * length_of(a) * length_of(b))
                return true;  // folds back
        }
        for (std::size_t j = i + 2; j + 1 < curve.size(); ++j) {
            if (segments_meet(curve[i], curve[i + 1], curve[j], curve[j + 1])) return true;
        }
    }
    return false;
}

}  // namespace

// The regions left of the two curves cover the rectangle together where A stands between them, and do not
// meet where B does.
double PartitionCurve::area_a(double length, double width) const {
    const double first = area_left_of(points, length, width);
    if (second.empty()) return first;
    const double sum = first + area_left_of(second, length, width);
    return std::clamp(a_between() ? sum - length * width : sum, 0.0, length * width);
}

bool PartitionCurve::self_intersects() const {
    return meets_itself(points) || (!second.empty() && meets_itself(second));
}

bool PartitionCurve::pair_disagrees() const {
    if (second.empty()) return false;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        for (std::size_t j = 0; j + 1 < second.size(); ++j) {
            if (segments_meet(points[i], points[i + 1], second[j], second[j + 1])) return true;
        }
    }
    return a_between() != (signed_distance_to(second, points.front()) > 0);
}

PartitionCurve straight_partition(double dispenser_length, double dispenser_width, double angle,
                                  double offset_y) {
    const double c = std::cos(angle), s = std::sin(angle);
    const PlanPoint pivot = {0.5 * dispenser_length, 0.5 * dispenser_width + offset_y};
    // half way to the nearer pair of walls as seen from the centre; the continuation does the rest
    const double half = std::min(0.5 * dispenser_length / std::max(std::abs(c), 1e-300),
                                 0.5 * dispenser_width / std::max(std::abs(s), 1e-300));
    const PlanPoint way = {half * c, half * s};
    return {{pivot - way, pivot + way}};
}

}  // namespace gradwright
