// Walls as analytic bodies: plane, box in the x-z section (rounded corners optional), upright plate along a
// plan-view curve. One contact per grain and body, at the body's nearest point, normal from it to the centre:
// a grain that rolls from face to edge keeps its spring. Concave corners are two bodies, hence two contacts.
#pragma once
#include <vector>

#include "dem/partition.h"

namespace gradwright {

struct Body {
    enum class Kind { plane, box, plate };
    Kind kind = Kind::plane;
    // plane: {point : normal . point >= offset} is free; axis-aligned
    int axis = 2;       ///< 0 x, 1 y, 2 z
    double sign = 1;    ///< normal = sign * axis
    double offset = 0;  ///< coordinate of the plane [m]
    // box: solid x0..x1, z0..z1 for all y; corners rounded by `rounding`
    double x0 = 0, x1 = 0, z0 = 0, z1 = 0, rounding = 0;  ///< [m]
    // plate: solid within half_thickness of the curve, above z0
    std::vector<PlanPoint> curve;
    double half_thickness = 0;
    double speed_x = 0, speed_z = 0;  ///< [m/s]
    int material = 0;
    bool frictionless = false;
    bool adhesive = true;  ///< false: a plain Hertz wall, whatever the work of adhesion
    /// > 0: the body yields. The overlap that the law sees is at most this share of the radius, so a pinched
    /// grain is pressed with a limited force (a blade lip gives way or lifts) instead of with whatever the
    /// softened stiffness would reach.
    double yield_ratio = 0;
};

/// Nearest point of a body to a sphere centre, as seen from it.
struct NearestPoint {
    double nx = 0, ny = 0, nz = 1;  ///< unit normal, body to centre
    double distance = 0;            ///< centre to surface [m]; < 0 inside the body
};
/// `moved_x`, `moved_z`: how far the body has moved since its description [m].
NearestPoint nearest_point(const Body& body, double moved_x, double moved_z, double x, double y, double z);

}  // namespace gradwright
