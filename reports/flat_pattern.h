// The plate laid flat, seen from side B: u along the plate from its first end, v upwards from its lower edge.
// [m]
//
// A bend of the angle q with inside radius r in sheet of thickness t uses the length q (r + k t) of its
// neutral line, the bend allowance; k is the K-factor (DIN 6935: k = (0.65 + lg(r/t)/2)/2, at most 1/2). The
// flat length is the straight lengths and the allowances, summed.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

struct FlatBend {
    double at = 0;         ///< u of the middle of the bend: where the brake's edge goes [m]
    double turn = 0;       ///< [rad], + towards side A, away from whoever looks
    double allowance = 0;  ///< [m]
};

struct FlatMark {
    double u0 = 0, v0 = 0, u1 = 0, v1 = 0;  ///< lower left and upper right corner [m]
};

struct FlatPattern {
    std::string name;
    double length = 0, height = 0;  ///< of the blank [m]
    std::vector<FlatBend> bends;    ///< in the order of u; none on a printed wall
    double rim = 0;                 ///< v of the dispenser's rim [m]
    double seat = 0;                ///< v of the tabs' undersides [m]; 0 with slots
    std::array<double, 2> cut{};    ///< off the first and the last end below them [m]
    std::vector<FlatMark> marks;    ///< engraved on side B
    int arrow = 0;                  ///< spreading direction along +u (1), -u (-1) or across the plate (0)

    std::vector<PlanPoint> outline() const;  ///< (u, v) from the lower left corner, counter-clockwise [m]
};

/// Spreading direction along a plate, as in FlatPattern.
int arrow_along(const Plate& plate);

/// Printed walls have a flat pattern too, for the length to check, but no bends.
FlatPattern flat_pattern(const Plate& plate);

}  // namespace gradwright
