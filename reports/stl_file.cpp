#include "reports/stl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optimise/plan_curve.h"

namespace gradwright {

std::string stl_text(const std::vector<Plate>& plates, const std::string& name) {
    std::string line = name;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    std::string out = fmt::format("solid {}\n", line);
    for (const Plate& plate : plates)
        for (Triangle corners : plate_mesh(plate, kChordError)) {
            // as written: the normal of a sliver hangs on its last digit
            for (MeshPoint& p : corners)
                for (double& x : p) x = std::round(x * 1e6) / 1e6 + 0.0;
            const auto& [a, b, c] = corners;
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
