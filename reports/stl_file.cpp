#include "reports/stl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimise/plan_curve.h"

namespace gradwright {

std::vector<Triangle> plate_mesh(const Plate& plate, double sagitta) {
    const std::vector<Station> stations = plate.stations(sagitta);
    const auto at = [&](std::size_t station, int side, bool top) {
        const PlanPoint p = stations[station][static_cast<std::size_t>(side)];
        return MeshPoint{p.x * 1e3, p.y * 1e3, (top ? plate.z_high : plate.z_low) * 1e3};
    };
    std::vector<Triangle> mesh;
    const auto quad = [&mesh](const MeshPoint& a, const MeshPoint& b, const MeshPoint& c,
                              const MeshPoint& d) {
        mesh.push_back({a, b, c});
        mesh.push_back({a, c, d});
    };
    constexpr int kLeft = 0, kRight = 1;
    const std::size_t last = stations.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
        quad(at(i, kRight, false), at(i + 1, kRight, false), at(i + 1, kRight, true), at(i, kRight, true));
        quad(at(i + 1, kLeft, false), at(i, kLeft, false), at(i, kLeft, true), at(i + 1, kLeft, true));
        quad(at(i, kRight, true), at(i + 1, kRight, true), at(i + 1, kLeft, true), at(i, kLeft, true));
        quad(at(i, kLeft, false), at(i + 1, kLeft, false), at(i + 1, kRight, false), at(i, kRight, false));
    }
    quad(at(0, kLeft, false), at(0, kRight, false), at(0, kRight, true), at(0, kLeft, true));
    quad(at(last, kRight, false), at(last, kLeft, false), at(last, kLeft, true), at(last, kRight, true));
    return mesh;
}

std::string stl_text(const std::vector<Plate>& plates, const std::string& name) {
    std::string line = name;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    std::string out = fmt::format("solid {}\n", line);
    for (const Plate& plate : plates)
        for (const auto& [a, b, c] : plate_mesh(plate, kChordError)) {
            const MeshPoint u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                            v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
            MeshPoint n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
            const double size = std::hypot(n[0], n[1], n[2]);
            for (double& component : n) component = size > 0 ? component / size + 0.0 : 0;
            out += fmt::format("facet normal {:.7g} {:.7g} {:.7g}\nouter loop\n", n[0], n[1], n[2]);
            for (const MeshPoint& p : {a, b, c})
                out += fmt::format("vertex {:.6f} {:.6f} {:.6f}\n", p[0], p[1], p[2]);
            out += "endloop\nendfacet\n";
        }
    return out + fmt::format("endsolid {}\n", line);
}

}  // namespace gradwright
