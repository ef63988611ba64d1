#include "reports/flat_pattern.h"

#include <cmath>

namespace gradwright {

FlatPattern flat_pattern(const Plate& plate) {
    FlatPattern flat;
    flat.name = plate.name;
    flat.height = plate.height();
    flat.rim = -plate.z_low;
    for (const PlatePiece& piece : plate.pieces) {
        if (piece.turn == 0) {
            flat.length += std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
            continue;
        }
        const double allowance =
            std::abs(piece.turn) * (plate.bend_radius + plate.k_factor * plate.thickness);
        flat.bends.push_back({flat.length + 0.5 * allowance, piece.turn, allowance});
        flat.length += allowance;
    }
    const double along = plate.corners.back().x - plate.corners.front().x,
                 across = plate.corners.back().y - plate.corners.front().y;
    // steeper than 60 deg an arrow along the plate would mislead
    if (std::abs(along) > 0.5 * std::hypot(along, across)) flat.arrow = along > 0 ? 1 : -1;
    return flat;
}

}  // namespace gradwright
