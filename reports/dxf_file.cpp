#include "reports/dxf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gradwright {
namespace {

/// One line of ASCII: R12 knows no other encoding.
std::string plain(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte < 0x7f)
            out += c;
        else if ((byte & 0xc0) != 0x80)
            out += '?';  // one for each character, not for each byte
    }
    return out;
}

class Dxf {
  public:
    explicit Dxf(const std::string& title) {
        pair(999, plain(title));
        section("HEADER");
        pair(9, "$ACADVER");
        pair(1, "AC1009");
        pair(9, "$INSUNITS");
        pair(70, "4");  // mm
        end_section();
        section("TABLES");
        table("LTYPE", {{"CONTINUOUS", ""}});
        layers();
        table("STYLE", {{"STANDARD", ""}});
        end_section();
        section("ENTITIES");
    }
    std::string text() {
        end_section();
        pair(0, "EOF");
        return out_;
    }
    void line(const char* layer, double x1, double y1, double x2, double y2) {
        entity("LINE", layer);
        point(0, x1, y1);
        point(1, x2, y2);
    }
    void closed(const char* layer, const std::vector<PlanPoint>& points) {
        entity("POLYLINE", layer);
        pair(66, "1");
        point(0, 0, 0);
        pair(70, "1");
        for (const PlanPoint& p : points) {
            entity("VERTEX", layer);
            point(0, p.x, p.y);
        }
        entity("SEQEND", layer);
    }
    void words(const char* layer, double x, double y, double height, const std::string& text) {
        entity("TEXT", layer);
        point(0, x, y);
        pair(40, fmt::format("{:.6f}", height));
        pair(1, plain(text));
    }

  private:
    void pair(int code, const std::string& value) { out_ += fmt::format("{:3}\n{}\n", code, value); }
    void section(const char* name) {
        pair(0, "SECTION");
        pair(2, name);
    }
    void end_section() { pair(0, "ENDSEC"); }
    void entity(const char* kind, const char* layer) {
        pair(0, kind);
        pair(8, layer);
    }
    void point(int which, double x, double y) {
        pair(10 + which, fmt::format("{:.6f}", x));
        pair(20 + which, fmt::format("{:.6f}", y));
        pair(30 + which, "0.000000");
    }
    void table(const char* kind, const std::vector<std::pair<std::string, std::string>>& entries) {
        pair(0, "TABLE");
        pair(2, kind);
        pair(70, fmt::format("{}", entries.size()));
        for (const auto& [name, description] : entries) {
            pair(0, kind);
            pair(2, name);
            pair(70, "0");
            if (std::string(kind) == "LTYPE") {
                pair(3, description);
                pair(72, "65");
                pair(73, "0");
                pair(40, "0.0");
            } else {  // a text style: fixed height none, width 1, upright
                pair(40, "0.0");
                pair(41, "1.0");
                pair(50, "0.0");
                pair(71, "0");
                pair(42, "2.5");
                pair(3, "txt");
                pair(4, "");
            }
        }
        pair(0, "ENDTAB");
    }
    void layers() {
        pair(0, "TABLE");
        pair(2, "LAYER");
        pair(70, "5");
        // colours: white, white, red, green, grey
        for (const auto& [name, colour] :
             {std::pair{"0", 7}, {"CUT", 7}, {"BEND", 1}, {"ETCH", 3}, {"DIM", 8}}) {
            pair(0, "LAYER");
            pair(2, name);
            pair(70, "0");
            pair(62, fmt::format("{}", colour));
            pair(6, "CONTINUOUS");
        }
        pair(0, "ENDTAB");
    }

    std::string out_;
};

}  // namespace

std::string dxf_text(const std::vector<FlatPattern>& patterns, const DxfNotes& notes) {
    Dxf dxf(notes.title);
    double base = 0;
    for (const FlatPattern& flat : patterns) {
        const double length = flat.length * 1e3, height = flat.height * 1e3, rim = flat.rim * 1e3;
        const double letter = std::clamp(std::min(0.08 * length, 0.1 * (height - rim)), 0.2, 3.5);
        const auto closed = [&](const char* layer, std::vector<PlanPoint> points) {
            for (PlanPoint& p : points) p = {1e3 * p.x, 1e3 * p.y + base};
            dxf.closed(layer, points);
        };
        closed("CUT", flat.outline());
        for (const FlatBend& bend : flat.bends)
            dxf.line("BEND", bend.at * 1e3, base, bend.at * 1e3, base + height);
        // as outlines: no font of the workshop's machine comes between
        for (const FlatMark& mark : flat.marks)
            closed("ETCH", {{mark.u0, mark.v0}, {mark.u1, mark.v0}, {mark.u1, mark.v1}, {mark.u0, mark.v1}});
        const double right = length + letter;
        double line = base + height - letter;
        const auto note = [&](const std::string& words) {
            dxf.words("DIM", right, line, letter, words);
            line -= 1.6 * letter;
        };
        note(fmt::format("{}: {:.3f} x {:.3f} mm, seen from side B", flat.name, length, height));
        for (const FlatBend& bend : flat.bends)
            note(fmt::format("bend at {:.3f}: {:.2f} deg towards {}, allowance {:.4f}", bend.at * 1e3,
                             std::abs(bend.turn) * 180 / std::numbers::pi, bend.turn > 0 ? "A" : "B",
                             bend.allowance * 1e3));
        if (flat.seat > 0)
            note(fmt::format("tabs {:.3f} and {:.3f} long, {:.3f} above the lower edge", flat.cut[0] * 1e3,
                             flat.cut[1] * 1e3, flat.seat * 1e3));
        dxf.line("DIM", -letter, base + rim, 0, base + rim);
        dxf.words("DIM", -letter, base + rim + 0.2 * letter, 0.6 * letter, "rim");
        dxf.line("DIM", 0, base - letter, length, base - letter);
        for (const double u : {0.0, length}) dxf.line("DIM", u, base - 1.5 * letter, u, base);
        base += height + std::max(6 * letter, 0.2 * height);
    }
    const double letter = 2;
    double line = -3 * letter;
    for (const std::string& words : notes.lines) {
        dxf.words("DIM", 0, line, letter, words);
        line -= 1.6 * letter;
    }
    return dxf.text();
}

}  // namespace gradwright
