#include "reports/map_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "reports/image_file.h"

namespace gradwright {
namespace {

double spacing(const std::vector<double>& centres) {
    return centres.size() > 1 ? centres[1] - centres[0] : 2 * centres[0];  // one cell from 0
}

std::vector<double> twice(std::vector<double> values) {
    const std::size_t size = values.size();
    values.resize(2 * size);
    std::copy_n(values.begin(), size, values.begin() + static_cast<std::ptrdiff_t>(size));
    return values;
}

}  // namespace

void write_map_file(const GradationMap& map, double thickness, const std::string& path) {
    const std::size_t nx = map.x_m.size(), ny = map.y_m.size();
    if (nx == 0 || ny == 0 || map.gi.size() != nx * ny || map.mass_kg.size() != nx * ny)
        throw std::invalid_argument("GI map for " + path + " is empty or its sizes disagree");
    ImageData image;
    image.points = {nx, ny, 2};
    image.origin = {map.x_m[0], map.y_m[0], -thickness};
    image.spacing = {spacing(map.x_m), spacing(map.y_m), thickness};
    image.arrays = {{"gi", 1, twice(map.gi)}, {"mass", 1, twice(map.mass_kg)}};
    write_image_file(image, path);
}

GradationMap mean_map(const std::vector<const GradationMap*>& maps) {
    GradationMap mean;
    std::vector<double> mass_a;
    double used = 0;
    for (const GradationMap* map : maps) {
        const std::size_t cells = map->x_m.size() * map->y_m.size();
        if (cells == 0 || map->gi.size() != cells || map->mass_kg.size() != cells) continue;
        if (mean.gi.empty()) {
            mean.x_m = map->x_m;
            mean.y_m = map->y_m;
            mean.gi.assign(cells, 0);
            mean.mass_kg.assign(cells, 0);
            mass_a.assign(cells, 0);
        } else if (mean.x_m != map->x_m || mean.y_m != map->y_m) {
            continue;
        }
        ++used;
        for (std::size_t c = 0; c < cells; ++c) {
            if (!std::isfinite(map->gi[c]) || !(map->mass_kg[c] > 0)) continue;
            mean.mass_kg[c] += map->mass_kg[c];
            mass_a[c] += map->mass_kg[c] * map->gi[c];
        }
    }
    for (std::size_t c = 0; c < mean.gi.size(); ++c) {
        mean.gi[c] =
            mean.mass_kg[c] > 0 ? mass_a[c] / mean.mass_kg[c] : std::numeric_limits<double>::quiet_NaN();
        mean.mass_kg[c] /= used;
    }
    return mean;
}

}  // namespace gradwright
