#include "reports/plate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gradwright {
namespace {

constexpr double kOnWall = 1e-9;    // of the dispenser's length and width together
constexpr double kNoTurn = 1e-6;    // [rad]: 0.1 um over 100 mm
constexpr double kSteepest = 1e-3;  // a plate that runs along a wall never reaches its slot's end

PlanPoint operator+(PlanPoint a, PlanPoint b) {
    return {a.x + b.x, a.y + b.y};
}
PlanPoint operator-(PlanPoint a, PlanPoint b) {
    return {a.x - b.x, a.y - b.y};
}
PlanPoint operator*(double s, PlanPoint a) {
    return {s * a.x, s * a.y};
}
double distance(PlanPoint a, PlanPoint b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}
PlanPoint direction(PlanPoint from, PlanPoint to) {
    return (1 / distance(from, to)) * (to - from);
}
PlanPoint left_of(PlanPoint d) {
    return {-d.y, d.x};
}
double turn_between(PlanPoint d0, PlanPoint d1) {
    return std::atan2(d0.x * d1.y - d0.y * d1.x, d0.x * d1.x + d0.y * d1.y);
}
PlanPoint turned(PlanPoint v, double angle) {
    return {v.x * std::cos(angle) - v.y * std::sin(angle), v.x * std::sin(angle) + v.y * std::cos(angle)};
}

PlanPoint normal_of(WallEnd::Wall wall) {
    switch (wall) {
        case WallEnd::Wall::rear:
            return {-1, 0};
        case WallEnd::Wall::platform:
            return {1, 0};
        case WallEnd::Wall::side_low:
            return {0, -1};
        case WallEnd::Wall::side_high:
            return {0, 1};
        case WallEnd::Wall::none:
            break;
    }
    return {0, 0};
}

/// Bits of the walls on which a point lies.
unsigned walls_of(PlanPoint p, double length, double width) {
    const double near = kOnWall * (length + width);
    return (std::abs(p.x) < near ? 1u : 0u) | (std::abs(p.x - length) < near ? 2u : 0u) |
           (std::abs(p.y) < near ? 4u : 0u) | (std::abs(p.y - width) < near ? 8u : 0u);
}

/// Chords of a bend whose outer face they stand off by `sagitta` [m] at most.
int chords_of(const Plate& plate, const PlatePiece& piece, double sagitta) {
    const double outer = plate.bend_radius + plate.thickness;
    const double step = 2 * std::acos(std::max(0.0, 1 - sagitta / outer));
    return std::max(1, static_cast<int>(std::ceil(std::abs(piece.turn) / step)));
}

/// The stretches of a clipped line that do not run along a wall: where the curve leaves the dispenser and
/// comes back, what clipping gives in between hugs the wall.
std::vector<std::vector<PlanPoint>> stretches(const std::vector<PlanPoint>& line, double length,
                                              double width) {
    std::vector<std::vector<PlanPoint>> all;
    bool open = false;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        if (distance(line[i], line[i + 1]) < kOnWall * (length + width)) continue;
        const bool along = (walls_of(line[i], length, width) & walls_of(line[i + 1], length, width)) != 0;
        if (along) {
            open = false;
            continue;
        }
        if (!open) all.push_back({line[i]});
        open = true;
        std::vector<PlanPoint>& run = all.back();
        const bool straight_on =
            run.size() >= 2 && std::abs(turn_between(direction(run[run.size() - 2], run.back()),
                                                     direction(run.back(), line[i + 1]))) < kNoTurn;
        if (straight_on)
            run.back() = line[i + 1];
        else
            run.push_back(line[i + 1]);
    }
    return all;
}

Plate plate_on(std::vector<PlanPoint> line, const std::string& name, const Study& study) {
    const PartitionBuild& build = study.build;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    Plate plate;
    plate.name = name;
    plate.thickness = build.thickness;
    plate.bend_radius = build.bend_radius;
    plate.k_factor = build.k_factor;
    plate.z_low = -study.scene.dispenser_depth + build.clearance;
    plate.z_high = build.grip;
    plate.z_seat = build.tabs ? -build.tab_depth : plate.z_low;
    const std::size_t last = line.size() - 1;
    for (const std::size_t e : {0u, 1u}) {
        PlanPoint& tip = e == 0 ? line[0] : line[last];
        const PlanPoint outward =
            e == 0 ? direction(line[1], line[0]) : direction(line[last - 1], line[last]);
        PlateEnd& end = plate.ends[e];
        end.at = wall_end(tip, outward, length, width);
        if (end.at.wall == WallEnd::Wall::none) continue;
        const PlanPoint normal = normal_of(end.at.wall);
        const double through = std::max(kSteepest, outward.x * normal.x + outward.y * normal.y);
        end.slant = std::acos(std::min(1.0, through));
        end.slot_along = (plate.thickness + 2 * build.slot_clearance) / through;
        // cut square: the corner that reaches deepest stays one clearance off the slot's bottom
        const double deepest =
            build.slot_depth - build.slot_clearance - 0.5 * plate.thickness * std::sin(end.slant);
        tip = tip + (std::max(0.0, deepest) / through) * outward;
        if (!build.tabs) continue;
        end.gap = (build.end_clearance + 0.5 * plate.thickness * std::sin(end.slant)) / through;
        end.cut = std::max(0.0, deepest) / through + end.gap;
        // cut square, one corner comes nearer to the wall: what lies beside the other belongs to its chamber
        const PlanPoint left = left_of(e == 0 ? -1 * outward : outward);
        const double leads = left.x * normal.x + left.y * normal.y;
        end.gap_side = std::abs(leads) < kNoTurn ? -1 : leads > 0 ? 1 : 0;
    }
    plate.corners = line;
    for (std::size_t k = 1; k < last; ++k)
        plate.turns.push_back(turn_between(direction(line[k - 1], line[k]), direction(line[k], line[k + 1])));
    plate.rounded = !build.printed;
    for (std::size_t k = 0; k < last; ++k) plate.rounded = plate.rounded && plate.straight_left(k) > 0;
    PlanPoint from = line[0];
    for (std::size_t k = 1; k <= last; ++k) {
        const bool bend = plate.rounded && k < last;
        const double back = bend ? plate.setback(plate.turns[k - 1]) : 0;
        const PlanPoint to = line[k] - back * direction(line[k - 1], line[k]);
        plate.pieces.push_back({from, to, 0});
        from = to;
        if (!bend) continue;
        from = line[k] + back * direction(line[k], line[k + 1]);
        plate.pieces.push_back({to, from, plate.turns[k - 1]});
    }
    return plate;
}

/// The line moved by `distance` to its left, corners mitred.
std::vector<PlanPoint> moved(const std::vector<PlanPoint>& line, double by) {
    std::vector<PlanPoint> out;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const PlanPoint before = i > 0 ? direction(line[i - 1], line[i]) : direction(line[0], line[1]);
        const PlanPoint after = i + 1 < line.size() ? direction(line[i], line[i + 1]) : before;
        const double half = 0.5 * turn_between(before, after);
        out.push_back(line[i] + (by / std::cos(half)) * left_of(turned(before, half)));
    }
    return out;
}

}  // namespace

std::string WallEnd::name() const {
    switch (wall) {
        case Wall::rear:
            return "rear (x = 0)";
        case Wall::platform:
            return "platform side (x = length)";
        case Wall::side_low:
            return "side y = 0";
        case Wall::side_high:
            return "side y = width";
        case Wall::none:
            break;
    }
    return "none";
}

WallEnd wall_end(PlanPoint p, PlanPoint outward, double length, double width) {
    const unsigned on = walls_of(p, length, width);
    constexpr std::array kWalls = {WallEnd::Wall::rear, WallEnd::Wall::platform, WallEnd::Wall::side_low,
                                   WallEnd::Wall::side_high};
    WallEnd end{WallEnd::Wall::none, std::numeric_limits<double>::quiet_NaN()};
    double best = -2;
    for (std::size_t w = 0; w < kWalls.size(); ++w) {
        if (!(on & (1u << w))) continue;
        const PlanPoint normal = normal_of(kWalls[w]);
        const double through = outward.x * normal.x + outward.y * normal.y;
        if (through <= best) continue;
        best = through;
        end = {kWalls[w], w < 2 ? p.y : p.x};
    }
    return end;
}

double Plate::setback(double turn) const {
    return (bend_radius + 0.5 * thickness) * std::tan(0.5 * std::abs(turn));
}

double Plate::straight_left(std::size_t segment) const {
    double left = distance(corners[segment], corners[segment + 1]);
    if (segment > 0) left -= setback(turns[segment - 1]);
    if (segment + 2 < corners.size()) left -= setback(turns[segment]);
    return left;
}

double Plate::middle_length() const {
    double sum = 0;
    for (const PlatePiece& piece : pieces)
        sum += piece.turn == 0 ? distance(piece.from, piece.to)
                               : std::abs(piece.turn) * (bend_radius + 0.5 * thickness);
    return sum;
}

double Plate::volume() const {
    double engraved = 0;
    for (const Mark& mark : marks) engraved += mark.area() * mark_depth;
    return thickness * (middle_length() * height() - (ends[0].cut + ends[1].cut) * (z_seat - z_low)) -
           engraved;
}

int Plate::faces() const {
    int tabs = 0;
    for (const PlateEnd& end : ends) tabs += end.cut > 0;
    const int engraved = mark_depth > 0 ? 5 * static_cast<int>(marks.size()) : 0;
    return 2 * static_cast<int>(pieces.size()) + 4 + 2 * tabs + engraved;
}

std::vector<Station> Plate::stations(double sagitta) const {
    std::vector<Station> all;
    const double half = 0.5 * thickness;
    const auto add = [&](PlanPoint middle, PlanPoint along, double stretch) {
        const PlanPoint out = (half * stretch) * left_of(along);
        all.push_back({middle + out, middle - out});
    };
    if (!rounded) {
        const std::vector<PlanPoint> left = moved(corners, half), right = moved(corners, -half);
        for (std::size_t i = 0; i < corners.size(); ++i) all.push_back({left[i], right[i]});
        return all;
    }
    for (const PlatePiece& piece : pieces) {
        if (piece.turn == 0) {
            const PlanPoint along = direction(piece.from, piece.to);
            if (all.empty()) add(piece.from, along, 1);
            add(piece.to, along, 1);
            continue;
        }
        // the tangent at the arc's start is its chord turned back by half the angle
        const PlanPoint along = turned(direction(piece.from, piece.to), -0.5 * piece.turn);
        const double sign = piece.turn > 0 ? 1 : -1, middle = bend_radius + half;
        const PlanPoint centre = piece.from + (sign * middle) * left_of(along);
        const int chords = chords_of(*this, piece, sagitta);
        for (int i = 1; i < chords; ++i) {
            const double angle = piece.turn * i / chords;
            const PlanPoint now = turned(along, angle);
            add(centre - (sign * middle) * left_of(now), now, 1);
        }
        // its end is the next straight piece's start
        add(piece.to, turned(along, piece.turn), 1);
    }
    return all;
}

std::vector<std::size_t> Plate::facet_pieces(double sagitta) const {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        all.insert(all.end(),
                   pieces[i].turn == 0 ? 1 : static_cast<std::size_t>(chords_of(*this, pieces[i], sagitta)),
                   i);
    return all;
}

std::array<PlanPoint, 2> Plate::box(double sagitta) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::array<PlanPoint, 2> box = {PlanPoint{kFar, kFar}, PlanPoint{-kFar, -kFar}};
    for (const Station& station : stations(sagitta))
        for (const PlanPoint& p : station)
            box = {PlanPoint{std::min(box[0].x, p.x), std::min(box[0].y, p.y)},
                   PlanPoint{std::max(box[1].x, p.x), std::max(box[1].y, p.y)}};
    return box;
}

std::vector<Plate> plates_of(const Study& study, const Design& design) {
    std::vector<Plate> plates;
    const PartitionCurve& curve = design.partition;
    if (curve.points.size() < 2) return plates;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const auto add = [&](const std::vector<PlanPoint>& line, const std::string& name) {
        int count = 0;
        for (const std::vector<PlanPoint>& run : stretches(line, length, width)) {
            ++count;
            plates.push_back(plate_on(run, count == 1 ? name : fmt::format("{}-{}", name, count), study));
        }
    };
    add(curve.clipped(length, width), "P");
    add(curve.second_clipped(length, width), "Q");
    return plates;
}

std::array<double, 2> ideal_areas(const Study& study, const Design& design) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const double a = design.partition.area_a(length, width);
    return {a, length * width - a};
}

std::array<double, 2> chamber_areas(const Study& study, const Design& design,
                                    const std::vector<Plate>& plates) {
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const double half = 0.5 * study.build.thickness;
    const auto curve_at = [&](double by) {
        PartitionCurve curve{moved(design.partition.points, by)};
        if (!design.partition.second.empty()) curve.second = moved(design.partition.second, by);
        return curve;
    };
    std::array<double, 2> area = {curve_at(half).area_a(length, width),
                                  length * width - curve_at(-half).area_a(length, width)};
    for (const Plate& plate : plates) {
        if (!plate.rounded) continue;
        const double inner = plate.bend_radius, outer = inner + plate.thickness;
        for (const double turn : plate.turns) {
            // a left bend rounds its corner off towards A: the inner face takes from A, the outer gives to B
            const double corner = std::tan(0.5 * std::abs(turn)) - 0.5 * std::abs(turn);
            area[turn > 0 ? 0 : 1] -= inner * inner * corner;
            area[turn > 0 ? 1 : 0] += outer * outer * corner;
        }
    }
    return area;
}

std::array<double, 2> chamber_volumes(const Study& study, const Design& design,
                                      const std::vector<Plate>& plates, const std::array<double, 2>& level) {
    std::array<double, 2> volume = chamber_areas(study, design, plates);
    const double depth = study.scene.dispenser_depth;
    for (const std::size_t k : {0u, 1u}) volume[k] *= depth - level[k];
    for (const Plate& plate : plates)
        for (const PlateEnd& end : plate.ends)
            for (const std::size_t k : {0u, 1u}) {
                const double share = end.gap_side < 0 ? 0.5 : end.gap_side == static_cast<int>(k) ? 1 : 0;
                volume[k] += share * plate.thickness * end.gap * (depth - std::max(level[k], -plate.z_seat));
            }
    return volume;
}

}  // namespace gradwright
