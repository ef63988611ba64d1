// The surface of a plate as triangles: faces, ends, tabs and what is engraved, closed.
//
// A face of the plate is cut into rectangles, plain ones and floors of marks, by lines across it; where a
// corner of one lies on a side of another, that side takes it in, and what has more than four points is
// fanned from its middle. So every edge has one neighbour, and no point is computed twice.
#pragma once
#include <array>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

using MeshPoint = std::array<double, 3>;    ///< [mm]
using Triangle = std::array<MeshPoint, 3>;  ///< counter-clockwise seen from outside

/// Closed surface of a plate: every edge in exactly two triangles, once each way. Arcs as chords within
/// `sagitta` [m].
std::vector<Triangle> plate_mesh(const Plate& plate, double sagitta);

}  // namespace gradwright
