#include "reports/plate_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace gradwright {
namespace {

constexpr std::size_t kLeft = 0, kRight = 1;

/// A rectangle of a face: u along it, v = z. `mark`: whose floor it is, -1 the face itself.
struct Cell {
    double u0, u1, v0, v1;
    int mark = -1;
};
struct Spot {
    double u, v;
    auto operator<=>(const Spot&) const = default;
};

/// Cuts a rectangle until each part is plain or the floor of one mark. Lines that cross no mark are taken
/// first, those near the middle before others.
void cut(const Cell& room, const std::vector<Cell>& marks, std::vector<Cell>& cells) {
    std::vector<Cell> inside;
    for (const Cell& m : marks) {
        const Cell part{std::max(m.u0, room.u0), std::min(m.u1, room.u1), std::max(m.v0, room.v0),
                        std::min(m.v1, room.v1), m.mark};
        if (part.u0 < part.u1 && part.v0 < part.v1) inside.push_back(part);
    }
    if (inside.empty()) {
        cells.push_back(room);
        return;
    }
    double best = 0, at = 0;
    bool across = false, found = false;
    const auto consider = [&](bool along_u, double line, double low, double high) {
        if (!(line > low && line < high)) return;
        double cost = std::abs((line - low) / (high - low) - 0.5);
        for (const Cell& m : inside)
            cost += along_u ? (m.u0 < line && line < m.u1) : (m.v0 < line && line < m.v1);
        if (found && !(cost < best)) return;
        found = true;
        best = cost;
        at = line;
        across = along_u;
    };
    for (const Cell& m : inside) {
        for (const double line : {m.u0, m.u1}) consider(true, line, room.u0, room.u1);
        for (const double line : {m.v0, m.v1}) consider(false, line, room.v0, room.v1);
    }
    if (!found) {  // one mark fills it
        cells.push_back(inside.front());
        return;
    }
    Cell first = room, second = room;
    (across ? first.u1 : first.v1) = at;
    (across ? second.u0 : second.v0) = at;
    cut(first, inside, cells);
    cut(second, inside, cells);
}

/// One face between two stations on one side.
struct Face {
    std::size_t facet, side;
    double u0 = 0, u1 = 1;
    PlanPoint origin, along;  ///< of u = 0, and the way u runs; unused on a chord
    std::vector<Cell> marks, cells;
    std::set<Spot> corners;  ///< of the cells that are the face itself
};

class Mesh {
  public:
    Mesh(const Plate& plate, double sagitta) : plate_(plate), stations_(plate.stations(sagitta)) {
        const std::vector<std::size_t> pieces = plate.facet_pieces(sagitta);
        const std::size_t facets = stations_.size() - 1;
        edges_.resize(2 * stations_.size());
        for (std::size_t f = 0; f < facets; ++f)
            for (const std::size_t side : {kLeft, kRight}) faces_.push_back(face(f, side, pieces[f]));
    }

    std::vector<Triangle> triangles() {
        for (const Face& one : faces_) {
            for (const Cell& cell : one.cells) surface(one, cell);
            for (const Cell& mark : one.marks) walls(one, mark);
        }
        for (std::size_t f = 0; f + 1 < stations_.size(); ++f) lids(f);
        ends();
        return mesh_;
    }

  private:
    Face face(std::size_t f, std::size_t side, std::size_t piece_index) {
        Face one{f, side, 0, 1, {}, {}, {}, {}, {}};
        const PlatePiece& piece = plate_.pieces[piece_index];
        const std::size_t last = stations_.size() - 2;
        if (piece.turn == 0) {
            const double length = std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
            one.along = {(piece.to.x - piece.from.x) / length, (piece.to.y - piece.from.y) / length};
            const double off = (side == kLeft ? 0.5 : -0.5) * plate_.thickness;
            one.origin = {piece.from.x - off * one.along.y, piece.from.y + off * one.along.x};
            const auto u_of = [&](PlanPoint p) {
                return (p.x - one.origin.x) * one.along.x + (p.y - one.origin.y) * one.along.y;
            };
            one.u0 = u_of(stations_[f][side]);
            one.u1 = u_of(stations_[f + 1][side]);
            for (std::size_t m = 0; plate_.mark_depth > 0 && m < plate_.marks.size(); ++m) {
                const Mark& mark = plate_.marks[m];
                if (mark.piece == piece_index && static_cast<std::size_t>(mark.side) == side)
                    one.marks.push_back({mark.from, mark.to, mark.low, mark.high, static_cast<int>(m)});
            }
        }
        Cell room{one.u0, one.u1, plate_.z_low, plate_.z_high};
        if (plate_.tabs()) {
            Cell below = room;
            below.v1 = room.v0 = plate_.z_seat;
            if (f == 0) below.u0 += plate_.ends[0].cut;
            if (f == last) below.u1 -= plate_.ends[1].cut;
            one.cells.push_back(below);
        }
        std::vector<Cell> cells;
        cut(room, one.marks, cells);
        one.cells.insert(one.cells.end(), cells.begin(), cells.end());
        for (const Cell& cell : one.cells)
            for (const double u : {cell.u0, cell.u1})
                for (const double v : {cell.v0, cell.v1}) {
                    if (cell.mark < 0) one.corners.insert({u, v});
                    if (u == one.u0) edges_[2 * f + side].insert(v);
                    if (u == one.u1) edges_[2 * (f + 1) + side].insert(v);
                }
        return one;
    }

    MeshPoint at(const Face& one, double u, double v, double depth = 0) const {
        PlanPoint p;
        if (u == one.u0 && depth == 0) {
            p = stations_[one.facet][one.side];
        } else if (u == one.u1 && depth == 0) {
            p = stations_[one.facet + 1][one.side];
        } else {
            const double in = one.side == kLeft ? -depth : depth;
            p = {one.origin.x + u * one.along.x - in * one.along.y,
                 one.origin.y + u * one.along.y + in * one.along.x};
        }
        return {1e3 * p.x, 1e3 * p.y, 1e3 * v};
    }

    void polygon(std::vector<MeshPoint> points, bool flip) {
        if (flip) std::reverse(points.begin(), points.end());
        const std::size_t n = points.size();
        if (n == 4) {
            mesh_.push_back({points[0], points[1], points[2]});
            mesh_.push_back({points[0], points[2], points[3]});
            return;
        }
        MeshPoint middle{};
        for (const MeshPoint& p : points)
            for (std::size_t k = 0; k < 3; ++k) middle[k] += p[k] / static_cast<double>(n);
        for (std::size_t i = 0; i < n; ++i) mesh_.push_back({points[i], points[(i + 1) % n], middle});
    }

    /// Corners of `of` on the stretch from (u, v) to (u2, v2), one of which stays the same; the last one not.
    static std::vector<Spot> along(const std::set<Spot>& of, Spot from, Spot to) {
        std::vector<Spot> found = {from};
        for (const Spot& s : of) {
            const bool on =
                from.v == to.v
                    ? s.v == from.v && s.u > std::min(from.u, to.u) && s.u < std::max(from.u, to.u)
                    : s.u == from.u && s.v > std::min(from.v, to.v) && s.v < std::max(from.v, to.v);
            if (on) found.push_back(s);
        }
        std::sort(found.begin() + 1, found.end());
        if (from.u > to.u || from.v > to.v) std::reverse(found.begin() + 1, found.end());
        return found;
    }

    /// Corners of the face, and of its neighbour's face where they share an edge.
    std::set<Spot> corners_with_edges(const Face& one) const {
        std::set<Spot> all = one.corners;
        for (const double v : edges_[2 * one.facet + one.side]) all.insert({one.u0, v});
        for (const double v : edges_[2 * (one.facet + 1) + one.side]) all.insert({one.u1, v});
        return all;
    }

    static std::set<Spot> floor_corners(const Face& one, int mark) {
        std::set<Spot> all;
        for (const Cell& cell : one.cells)
            if (cell.mark == mark)
                for (const double u : {cell.u0, cell.u1})
                    for (const double v : {cell.v0, cell.v1}) all.insert({u, v});
        return all;
    }

    static std::array<Spot, 4> around(const Cell& cell) {
        return {Spot{cell.u0, cell.v0}, {cell.u1, cell.v0}, {cell.u1, cell.v1}, {cell.u0, cell.v1}};
    }

    void surface(const Face& one, const Cell& cell) {
        const std::set<Spot> corners =
            cell.mark < 0 ? corners_with_edges(one) : floor_corners(one, cell.mark);
        const double depth = cell.mark < 0 ? 0 : plate_.mark_depth;
        std::vector<MeshPoint> points;
        const auto ring = around(cell);
        for (std::size_t i = 0; i < 4; ++i)
            for (const Spot& s : along(corners, ring[i], ring[(i + 1) % 4]))
                points.push_back(at(one, s.u, s.v, depth));
        polygon(points, one.side == kLeft);
    }

    void walls(const Face& one, const Cell& mark) {
        const std::set<Spot> floor = floor_corners(one, mark.mark);
        const auto ring = around(mark);
        for (std::size_t i = 0; i < 4; ++i) {
            const Spot p = ring[i], q = ring[(i + 1) % 4];
            std::vector<MeshPoint> points;
            for (const Spot& s : along(one.corners, p, q)) points.push_back(at(one, s.u, s.v));
            points.push_back(at(one, q.u, q.v));
            for (const Spot& s : along(floor, q, p)) points.push_back(at(one, s.u, s.v, plate_.mark_depth));
            points.push_back(at(one, p.u, p.v, plate_.mark_depth));
            polygon(points, one.side == kLeft);
        }
    }

    /// Top, bottom and undersides of tabs between two stations, from edges of both faces at height v.
    void lid(std::size_t f, double v, std::array<double, 2> from, std::array<double, 2> to, bool up) {
        const Face &left = faces_[2 * f + kLeft], &right = faces_[2 * f + kRight];
        std::vector<MeshPoint> points;
        for (const Spot& s : along(right.corners, {from[kRight], v}, {to[kRight], v}))
            points.push_back(at(right, s.u, v));
        points.push_back(at(right, to[kRight], v));
        for (const Spot& s : along(left.corners, {to[kLeft], v}, {from[kLeft], v}))
            points.push_back(at(left, s.u, v));
        points.push_back(at(left, from[kLeft], v));
        polygon(points, !up);
    }

    void lids(std::size_t f) {
        const Face &left = faces_[2 * f + kLeft], &right = faces_[2 * f + kRight];
        const std::array<double, 2> from = {left.u0, right.u0}, to = {left.u1, right.u1};
        lid(f, plate_.z_high, from, to, true);
        std::array<double, 2> low_from = from, low_to = to;
        if (plate_.tabs() && f == 0)
            for (double& u : low_from) u += plate_.ends[0].cut;
        if (plate_.tabs() && f + 2 == stations_.size())
            for (double& u : low_to) u -= plate_.ends[1].cut;
        lid(f, plate_.z_low, low_from, low_to, false);
        if (low_from != from) lid(f, plate_.z_seat, from, low_from, false);
        if (low_to != to) lid(f, plate_.z_seat, low_to, to, false);
    }

    /// End faces, below the seats and above them.
    void ends() {
        for (const bool first : {true, false}) {
            const std::size_t f = first ? 0 : stations_.size() - 2;
            const Face &left = faces_[2 * f + kLeft], &right = faces_[2 * f + kRight];
            const double by = plate_.ends[first ? 0 : 1].cut;
            const auto upright = [&](double from_left, double from_right, double low, double high) {
                std::vector<MeshPoint> points;
                for (const Spot& s : along(left.corners, {from_left, high}, {from_left, low}))
                    points.push_back(at(left, s.u, s.v));
                points.push_back(at(left, from_left, low));
                for (const Spot& s : along(right.corners, {from_right, low}, {from_right, high}))
                    points.push_back(at(right, s.u, s.v));
                points.push_back(at(right, from_right, high));
                polygon(points, !first);
            };
            const double ul = first ? left.u0 : left.u1, ur = first ? right.u0 : right.u1;
            if (!plate_.tabs()) {
                upright(ul, ur, plate_.z_low, plate_.z_high);
                continue;
            }
            upright(ul, ur, plate_.z_seat, plate_.z_high);
            const double sign = first ? 1 : -1;
            upright(ul + sign * by, ur + sign * by, plate_.z_low, plate_.z_seat);
        }
    }

    const Plate& plate_;
    std::vector<Station> stations_;
    std::vector<Face> faces_;
    std::vector<std::set<double>> edges_;  ///< heights of corners on a station's edge, left and right
    std::vector<Triangle> mesh_;
};

}  // namespace

std::vector<Triangle> plate_mesh(const Plate& plate, double sagitta) {
    return Mesh(plate, sagitta).triangles();
}

}  // namespace gradwright
