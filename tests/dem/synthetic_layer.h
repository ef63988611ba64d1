// Layers with known statistics for the tests of the estimators: no physics, only a law for where a grain came
// from.
//   origin_x = L_d (start - turn x/L_b) + L_d wander(patch) + L_d local z,   patches of `patch_x` times
//   `patch_y` share one wander origin_y = deposit_y - lateral z
#pragma once
#include <cmath>
#include <vector>

#include "dem/layer.h"
#include "dem/random.h"
#include "dem/size_distribution.h"

namespace gradwright::synthetic {

struct Law {
    double dispenser_length = 3.2e-3, platform_length = 3.2e-3, width = 1.6e-3;
    int grains = 6000;
    double start = 0.7,
           turn = 0.3;  ///< mean origin / L_d at the platform's near edge, and how far it turns back along it
    double wander = 0.1, local = 0.2, lateral = 40e-6;
    double patch_x = 0.15e-3, patch_y = 0.3e-3;  ///< patch_y >= width: stripes across the whole width
};

inline Layer make_layer(const Law& law, std::uint64_t seed) {
    Random random(seed);
    Layer layer;
    layer.dispenser_length = law.dispenser_length;
    layer.platform_length = law.platform_length;
    layer.width = law.width;
    layer.gap = 143e-6;
    const std::vector<double> diameter = SizeDistribution{}.draw(law.grains, seed);
    const int columns = static_cast<int>(law.platform_length / law.patch_x) + 2;
    const int rows = static_cast<int>(law.width / law.patch_y) + 2;
    std::vector<double> wander(columns * rows);
    for (double& w : wander) w = law.wander * random.normal();
    const double shift_x = random.uniform() * law.patch_x, shift_y = random.uniform() * law.patch_y;
    for (int i = 0; i < law.grains; ++i) {
        const double x = random.uniform() * law.platform_length, y = random.uniform() * law.width;
        const int column = static_cast<int>((x + shift_x) / law.patch_x);
        const int row = law.patch_y >= law.width ? 0 : static_cast<int>((y + shift_y) / law.patch_y);
        const double origin = law.start - law.turn * x / law.platform_length + wander[column * rows + row] +
                              law.local * random.normal();
        layer.deposit_x.push_back(x);
        layer.deposit_y.push_back(y);
        layer.deposit_z.push_back(-50e-6);
        layer.origin_x.push_back(law.dispenser_length * origin);
        layer.origin_y.push_back(y - law.lateral * random.normal());
        layer.origin_z.push_back(0);
        layer.radius.push_back(0.5 * diameter[i]);
        layer.volume.push_back(std::acos(-1.0) / 6 * diameter[i] * diameter[i] * diameter[i]);
        layer.is_a.push_back(0);
    }
    return layer;
}

}  // namespace gradwright::synthetic
