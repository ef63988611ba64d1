#include "reports/flat_pattern.h"

#include <cmath>

namespace gradwright {

int arrow_along(const Plate& plate) {
    const double along = plate.corners.back().x - plate.corners.front().x,
                 across = plate.corners.back().y - plate.corners.front().y;
    // steeper than 60 deg an arrow along the plate would mislead
    if (!(std::abs(along) > 0.5 * std::hypot(along, across))) return 0;
    return along > 0 ? 1 : -1;
}

std::vector<PlanPoint> FlatPattern::outline() const {
    if (!(seat > 0)) return {{0, 0}, {length, 0}, {length, height}, {0, height}};
    const double left = cut[0], right = length - cut[1];
    return {{left, 0},        {right, 0},  {right, seat}, {length, seat},
            {length, height}, {0, height}, {0, seat},     {left, seat}};
}

FlatPattern flat_pattern(const Plate& plate) {
    FlatPattern flat;
    flat.name = plate.name;
    flat.height = plate.height();
    flat.rim = -plate.z_low;
    flat.seat = plate.z_seat - plate.z_low;
    flat.cut = {plate.ends[0].cut, plate.ends[1].cut};
    for (std::size_t i = 0; i < plate.pieces.size(); ++i) {
        const PlatePiece& piece = plate.pieces[i];
        for (const Mark& mark : plate.marks)
            if (mark.side == 1 && mark.piece == i)
                flat.marks.push_back({flat.length + mark.from, mark.low - plate.z_low, flat.length + mark.to,
                                      mark.high - plate.z_low});
        if (piece.turn == 0) {
            flat.length += std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
            continue;
        }
        const double allowance =
            std::abs(piece.turn) * (plate.bend_radius + plate.k_factor * plate.thickness);
        flat.bends.push_back({flat.length + 0.5 * allowance, piece.turn, allowance});
        flat.length += allowance;
    }
    flat.arrow = arrow_along(plate);
    return flat;
}

}  // namespace gradwright
