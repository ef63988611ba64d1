// The partition as a solid: a sheet or printed wall of some thickness that stands in the dispenser, its ends
// in slots of the walls, and is drawn out upwards. In plan view it is a strip around the partition's line:
// bent sheet of straight pieces and arcs, or straight pieces mitred at their corners (a smooth curve as
// printed).
//
// Bends: inside radius r, thickness t, middle radius m = r + t/2, turn q. The arc leaves its corner's two
// segments m tan(|q|/2) before and after it. A strip's area in plan is t times the length of its middle line,
// mitred or rounded: what the outer side of a corner gains the inner side loses.
//
// Held by slots, it reaches into the walls at every height. Held by tabs it does so only above their seats,
// in notches of the rim; below, its ends are cut off beside the walls.
//
// Frame: dispenser, x = spreading direction from the rear wall, y = across, z = up from the rim. [m]
#pragma once
#include <array>
#include <string>
#include <vector>

#include "dem/partition.h"
#include "optimise/study.h"

namespace gradwright {

/// Where a partition leaves the dispenser.
struct WallEnd {
    enum class Wall { none, rear, platform, side_low, side_high };
    Wall wall = Wall::none;
    double offset = 0;         ///< along the wall from the datum corner x = 0, y = 0 [m]; NaN without a wall
    std::string name() const;  ///< "rear (x = 0)" ...
};
/// The wall on which `p` lies; in a corner the one that `outward` points through more. Any one unit.
WallEnd wall_end(PlanPoint p, PlanPoint outward, double length, double width);

/// One piece of the middle line.
struct PlatePiece {
    PlanPoint from, to;
    double turn = 0;  ///< 0: straight; else an arc through this angle, + to the left [rad]
};

/// Left and right face of the strip at one place of its middle line. Left is side A.
using Station = std::array<PlanPoint, 2>;

struct PlateEnd {
    WallEnd at;             ///< of the middle line
    double slant = 0;       ///< between plate and the wall's normal [rad], >= 0
    double slot_along = 0;  ///< width of the slot or notch along the wall [m]
    double cut = 0;         ///< off this end below the seat of its tab, along the plate [m]; 0 with slots
    double gap = 0;         ///< of that between the wall and the plate's middle line [m]
    int gap_side = -1;      ///< chamber (0 A, 1 B) beside which the square cut stands back; -1: both alike
};

/// A rectangle engraved into one plane face.
struct Mark {
    int side = 0;              ///< 0 = A, left; 1 = B, right
    std::size_t piece = 0;     ///< of the plate, a straight one
    double from = 0, to = 0;   ///< along the piece from its start [m]
    double low = 0, high = 0;  ///< z [m]
    double area() const { return (to - from) * (high - low); }
};

struct Plate {
    std::string name;                ///< "P", "Q"; "P-2" where one line crosses the dispenser twice
    double thickness = 0;            ///< t [m]
    double bend_radius = 0;          ///< r, inside [m]
    double k_factor = 0;             ///< of the bend allowance [-]
    double z_low = 0, z_high = 0;    ///< lower edge and top, the rim is 0 [m]
    double z_seat = 0;               ///< undersides of the tabs; z_low with slots [m]
    std::vector<PlanPoint> corners;  ///< of the middle line, from end to end, the ends in their slots
    std::vector<double> turns;       ///< at the inner corners [rad], + to the left
    bool rounded = false;            ///< bends are arcs; false: mitred
    std::vector<PlatePiece> pieces;
    std::array<PlateEnd, 2> ends;
    std::vector<Mark> marks;  ///< plate_marks.h
    double mark_depth = 0;    ///< [m]; 0: the marks are on the surface, the solid has none

    double height() const { return z_high - z_low; }
    double middle_length() const;  ///< [m]
    bool tabs() const { return z_seat > z_low; }
    double volume() const;  ///< [m3]
    /// Faces of the exact solid: two a piece, two ends, top and bottom; a tab adds its underside and the end
    /// below it, a mark its floor and four sides.
    int faces() const;
    /// What a bend takes from each of its two segments [m].
    double setback(double turn) const;
    /// Straight length left of segment k between its bends [m]; negative where they overlap.
    double straight_left(std::size_t segment) const;
    /// Both faces from end to end; arcs as chords that stand off by `sagitta` [m] at most.
    std::vector<Station> stations(double sagitta) const;
    /// For each two neighbours of `stations` the piece they belong to.
    std::vector<std::size_t> facet_pieces(double sagitta) const;
    /// Least and largest coordinate of the strip in plan, arcs exact to `sagitta` [m].
    std::array<PlanPoint, 2> box(double sagitta) const;
};

/// Strips of a design, one for each way of the partition through the dispenser; empty when it misses it.
std::vector<Plate> plates_of(const Study& study, const Design& design);

/// Area of chamber A, B in plan beside the plate [m2]: the dispenser less the strip, bends rounded.
std::array<double, 2> chamber_areas(const Study& study, const Design& design,
                                    const std::vector<Plate>& plates);
/// Volume of chamber A, B filled from the floor to `level` below the rim [m3]: area times height and, of a
/// plate with tabs, the gaps at its ends.
std::array<double, 2> chamber_volumes(const Study& study, const Design& design,
                                      const std::vector<Plate>& plates, const std::array<double, 2>& level);
/// The areas for a plate of no thickness.
std::array<double, 2> ideal_areas(const Study& study, const Design& design);

}  // namespace gradwright
