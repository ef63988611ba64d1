#include "dem/boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradwright {
namespace {

NearestPoint nearest_on_box(const Body& body, double px, double pz) {
    const double x0 = body.x0 + body.rounding, x1 = body.x1 - body.rounding;
    const double z0 = body.z0 + body.rounding, z1 = body.z1 - body.rounding;
    const double qx = std::clamp(px, x0, x1), qz = std::clamp(pz, z0, z1);
    const double dx = px - qx, dz = pz - qz;
    const double d = std::hypot(dx, dz);
    NearestPoint out;
    if (d > 0) {
        out.nx = dx / d;
        out.nz = dz / d;
        out.distance = d - body.rounding;
        return out;
    }
    // Centre inside: leave through the nearest face.
    const double left = px - x0, right = x1 - px, down = pz - z0, up = z1 - pz;
    const double least = std::min({left, right, down, up});
    out.nx = least == left ? -1 : least == right ? 1 : 0;
    out.nz = out.nx != 0 ? 0 : least == up ? 1 : -1;
    out.distance = -least - body.rounding;
    return out;
}

NearestPoint nearest_on_plate(const Body& body, double px, double py, double pz) {
    double best = std::numeric_limits<double>::max(), bx = 0, by = 0;
    for (std::size_t k = 0; k + 1 < body.curve.size(); ++k) {
        const PlanPoint a = body.curve[k], b = body.curve[k + 1];
        const double ex = b.x - a.x, ey = b.y - a.y;
        const double t = std::clamp(((px - a.x) * ex + (py - a.y) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
        const double dx = px - (a.x + t * ex), dy = py - (a.y + t * ey);
        if (dx * dx + dy * dy < best) {
            best = dx * dx + dy * dy;
            bx = dx;
            by = dy;
        }
    }
    NearestPoint out;
    const double plan = std::sqrt(best);
    const double below = body.z0 - pz;  // > 0: centre under the lower edge of the plate
    if (plan > body.half_thickness && below <= 0) {
        out.nx = bx / plan;
        out.ny = by / plan;
        out.nz = 0;
        out.distance = plan - body.half_thickness;
    } else if (below > 0) {
        const double side = std::max(plan - body.half_thickness, 0.0);
        const double d = std::hypot(side, below);
        out.nx = plan > 0 ? bx / plan * side / d : 0;
        out.ny = plan > 0 ? by / plan * side / d : 0;
        out.nz = -below / d;
        out.distance = d;
    } else {  // centre inside the plate
        out.nx = plan > 0 ? bx / plan : 1;
        out.ny = plan > 0 ? by / plan : 0;
        out.nz = 0;
        out.distance = plan - body.half_thickness;
    }
    return out;
}

}  // namespace

NearestPoint nearest_point(const Body& body, double moved_x, double moved_z, double x, double y, double z) {
    const double px = x - moved_x, pz = z - moved_z;
    if (body.kind == Body::Kind::box) return nearest_on_box(body, px, pz);
    if (body.kind == Body::Kind::plate) return nearest_on_plate(body, px, y, pz);
    NearestPoint out;
    out.nx = body.axis == 0 ? body.sign : 0;
    out.ny = body.axis == 1 ? body.sign : 0;
    out.nz = body.axis == 2 ? body.sign : 0;
    const double coordinate = body.axis == 0 ? px : body.axis == 1 ? y : pz;
    out.distance = body.sign * (coordinate - body.offset);
    return out;
}

}  // namespace gradwright
