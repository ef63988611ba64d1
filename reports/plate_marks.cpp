#include "reports/plate_marks.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace gradwright {
namespace {

constexpr int kColumns = 5, kRows = 7, kPitch = 6, kLine = 10;  // [points]: letter, its advance, a line's
constexpr double kInset = 0.2;       // of a point, on each side: neighbours never touch
constexpr double kLargest = 0.5e-3;  // a point [m]: letters of 3.5 mm
constexpr double kMargin = 0.05;     // of the room, on each side

/// Bars and points of a text, in points from its upper left corner: [left, right) x [top, bottom).
struct Spot {
    double left, right, top, bottom;
};

std::vector<std::string> raster(const std::vector<std::string>& lines) {
    std::size_t longest = 0;
    for (const std::string& line : lines) longest = std::max(longest, line.size());
    std::vector<std::string> rows(lines.size() * kLine - (kLine - kRows), std::string(longest * kPitch, ' '));
    for (std::size_t l = 0; l < lines.size(); ++l) {
        const std::size_t indent = (longest - lines[l].size()) * kPitch / 2;
        for (std::size_t c = 0; c < lines[l].size(); ++c) {
            const std::vector<std::string> letter = letter_points(lines[l][c]);
            for (std::size_t r = 0; r < letter.size(); ++r)
                rows[l * kLine + r].replace(indent + c * kPitch, kColumns, letter[r]);
        }
    }
    return rows;
}

/// Columns of two points and more first, then what is left of the rows where `across`, else single points.
std::vector<Spot> spots_of(std::vector<std::string> rows, bool across) {
    std::vector<Spot> spots;
    const std::size_t height = rows.size(), width = rows.front().size();
    const auto take = [&](std::size_t r, std::size_t c, std::size_t dr, std::size_t dc) {
        for (std::size_t i = r; i < r + dr; ++i)
            for (std::size_t k = c; k < c + dc; ++k) rows[i][k] = ' ';
        const auto n = [](std::size_t value) { return static_cast<double>(value); };
        spots.push_back({n(c) + kInset, n(c + dc) - kInset, n(r) + kInset, n(r + dr) - kInset});
    };
    for (std::size_t c = 0; c < width; ++c)
        for (std::size_t r = 0; r < height; ++r) {
            std::size_t run = 0;
            while (r + run < height && rows[r + run][c] == '#') ++run;
            if (run > 1) take(r, c, run, 1);
            r += run;
        }
    for (std::size_t r = 0; r < height; ++r)
        for (std::size_t c = 0; c < width; ++c) {
            std::size_t run = 0;
            while (c + run < width && rows[r][c + run] == '#' && (across || run < 1)) ++run;
            if (run > 0) take(r, c, 1, run);
        }
    return spots;
}

/// What a plane face offers: its piece and its stretch of the middle line [m].
struct Room {
    std::size_t piece;
    double start;     ///< of the piece, along the middle line
    double from, to;  ///< that both faces have, from the middle line's start
};

std::vector<Room> rooms_of(const Plate& plate) {
    std::vector<Room> rooms;
    double at = 0;
    for (std::size_t i = 0; i < plate.pieces.size(); ++i) {
        const PlatePiece& piece = plate.pieces[i];
        const double length = piece.turn == 0
                                  ? std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y)
                                  : std::abs(piece.turn) * (plate.bend_radius + 0.5 * plate.thickness);
        // a mitre takes from the inner face
        const auto mitre = [&](std::size_t corner) {
            return plate.rounded || corner == 0 || corner > plate.turns.size()
                       ? 0.0
                       : 0.5 * plate.thickness * std::tan(0.5 * std::abs(plate.turns[corner - 1]));
        };
        const double from = at + mitre(i), to = at + length - mitre(i + 1);
        if (piece.turn == 0 && to > from) rooms.push_back({i, at, from, to});
        at += length;
    }
    return rooms;
}

std::vector<std::vector<std::string>> layouts(const std::string& id, const std::string& name,
                                              const std::string& side, const std::string& arrow) {
    const std::string first = id.substr(0, id.find('-') + 1), digits = id.substr(first.size());
    const std::size_t half = digits.size() / 2;
    std::vector<std::vector<std::string>> all = {
        {id + " " + name, "SIDE " + side},
        {id, name + " SIDE " + side},
        {first, digits, name, "SIDE " + side},
        {first, digits.substr(0, half), digits.substr(half), name, "SIDE", side}};
    if (!arrow.empty())
        for (auto& lines : all) lines.push_back(arrow);
    return all;
}

bool touch(const Mark& a, const Mark& b) {
    return a.side == b.side && a.piece == b.piece && a.from <= b.to && b.from <= a.to && a.low <= b.high &&
           b.low <= a.high;
}

/// Puts a spot into the face that needs the least push; into a narrower one cut to it.
std::pair<const Room*, std::array<double, 2>> placed(const std::vector<Room>& rooms, double from, double to) {
    const Room* best = nullptr;
    std::array<double, 2> at{};
    double least = 0;
    const double slack = 0.1 * (to - from);  // off the face's edges
    for (const Room& room : rooms) {
        const double low = room.from + slack, high = room.to - slack;
        if (!(high > low)) continue;
        if (from >= low && to <= high) return {&room, {from, to}};  // as it is, to the last bit
        const double size = std::min(to - from, high - low);
        const double middle = std::clamp(0.5 * (from + to), low + 0.5 * size, high - 0.5 * size);
        const double cost = std::abs(middle - 0.5 * (from + to)) + 0.5 * (to - from - size);
        if (best && !(cost < least)) continue;
        best = &room;
        least = cost;
        at = {middle - 0.5 * size, middle + 0.5 * size};
    }
    return {best, at};
}

}  // namespace

std::array<MarkText, 2> engrave(Plate& plate, const std::string& id, int arrow, double depth) {
    std::array<MarkText, 2> texts;
    plate.marks.clear();
    plate.mark_depth = depth;
    const std::vector<Room> rooms = rooms_of(plate);
    if (rooms.empty()) return texts;
    // one plane face, or where a curve has none that is wide the faces side by side
    const auto widest = std::max_element(rooms.begin(), rooms.end(), [](const Room& a, const Room& b) {
        return a.to - a.from < b.to - b.from;
    });
    double from = widest->from, to = widest->to;
    const bool across = plate.rounded || to - from > 0.5 * plate.middle_length();
    if (!across) {
        from = rooms.front().from;
        to = rooms.back().to;
    }
    const double high = plate.z_high * (1 - kMargin), low = plate.z_high * kMargin;
    for (const std::size_t side : {0u, 1u}) {
        // read on side B u runs to the right, on side A to the left
        const double sense = side == 0 ? -1 : 1;
        const std::string tip = arrow == 0 ? "" : arrow * sense > 0 ? "--->" : "<---";
        double point = 0;
        for (const auto& lines : layouts(id, plate.name, side == 0 ? "A" : "B", tip)) {
            std::size_t longest = 0;
            for (const std::string& line : lines) longest = std::max(longest, line.size());
            const double width = static_cast<double>(longest * kPitch),
                         height = static_cast<double>(lines.size() * kLine - (kLine - kRows));
            const double fits =
                std::min({kLargest, (1 - 2 * kMargin) * (to - from) / width, (high - low) / height});
            if (!(fits > point * (1 + 1e-9))) continue;
            point = fits;
            texts[side] = {lines, kRows * fits};
        }
        const std::vector<std::string> rows = raster(texts[side].lines);
        const double middle = 0.5 * (from + to), half = 0.5 * static_cast<double>(rows.front().size() - 1);
        // towards the top: hands and powder are below
        for (const Spot& spot : spots_of(rows, across)) {
            double a = middle + sense * (spot.left - half) * point,
                   b = middle + sense * (spot.right - half) * point;
            if (a > b) std::swap(a, b);
            const auto [room, at] = placed(rooms, a, b);
            if (!room) continue;
            const Mark mark{static_cast<int>(side),     room->piece,
                            at[0] - room->start,        at[1] - room->start,
                            high - spot.bottom * point, high - spot.top * point};
            // faces narrower than a point may push two together: one of them says enough
            if (std::none_of(plate.marks.begin(), plate.marks.end(),
                             [&](const Mark& other) { return touch(mark, other); }))
                plate.marks.push_back(mark);
        }
    }
    return texts;
}

std::vector<std::string> letter_points(char letter) {
    static const std::map<char, std::vector<std::string>> kLetters = {
        {'0', {" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "}},
        {'1', {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
        {'2', {" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"}},
        {'3', {"#####", "   # ", "  #  ", "   # ", "    #", "#   #", " ### "}},
        {'4', {"   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "}},
        {'5', {"#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "}},
        {'6', {"  ## ", " #   ", "#    ", "#### ", "#   #", "#   #", " ### "}},
        {'7', {"#####", "    #", "   # ", "  #  ", " #   ", " #   ", " #   "}},
        {'8', {" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "}},
        {'9', {" ### ", "#   #", "#   #", " ####", "    #", "   # ", " ##  "}},
        {'A', {" ### ", "#   #", "#   #", "#####", "#   #", "#   #", "#   #"}},
        {'B', {"#### ", "#   #", "#   #", "#### ", "#   #", "#   #", "#### "}},
        {'C', {" ### ", "#   #", "#    ", "#    ", "#    ", "#   #", " ### "}},
        {'D', {"#### ", "#   #", "#   #", "#   #", "#   #", "#   #", "#### "}},
        {'E', {"#####", "#    ", "#    ", "#### ", "#    ", "#    ", "#####"}},
        {'F', {"#####", "#    ", "#    ", "#### ", "#    ", "#    ", "#    "}},
        {'G', {" ### ", "#   #", "#    ", "# ###", "#   #", "#   #", " ### "}},
        {'I', {" ### ", "  #  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
        {'P', {"#### ", "#   #", "#   #", "#### ", "#    ", "#    ", "#    "}},
        {'Q', {" ### ", "#   #", "#   #", "#   #", "# # #", "#  # ", " ## #"}},
        {'S', {" ####", "#    ", "#    ", " ### ", "    #", "    #", "#### "}},
        {'W', {"#   #", "#   #", "#   #", "# # #", "# # #", "## ##", "#   #"}},
        {'-', {"     ", "     ", "     ", "#####", "     ", "     ", "     "}},
        {'>', {" #   ", "  #  ", "   # ", "#####", "   # ", "  #  ", " #   "}},
        {'<', {"   # ", "  #  ", " #   ", "#####", " #   ", "  #  ", "   # "}}};
    const auto found = kLetters.find(letter);
    return found == kLetters.end() ? std::vector<std::string>{} : found->second;
}

}  // namespace gradwright
