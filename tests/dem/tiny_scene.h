// The smallest machine that spreads a layer: some three hundred grains, a second or two.
#pragma once
#include "dem/scene.h"

namespace gradwright {

/// The paper's powders without fines on a machine half a millimetre long.
inline Scene tiny_scene(std::uint64_t seed = 3) {
    Scene s;
    s.dispenser_length = 0.5e-3;
    s.width = 0.26e-3;
    s.bed_depth = 40e-6;
    s.dose_height = 80e-6;
    s.land = 0.4e-3;
    s.platform_length = 0.7e-3;
    s.second_land = 0.5e-3;
    s.gap = 140e-6;
    s.blade_speed = 0.1;
    s.blade_thickness = 0.2e-3;
    s.powder[0].material = {"A", 7980, 210e9, 0.3, ""};
    s.powder[1].material = {"B", 8200, 195e9, 0.3, ""};
    for (auto& p : s.powder) p.size.cut_low = 25e-6, p.size.cut_high = 62e-6;
    s.wall = s.powder[0].material;
    s.rayleigh_fraction = 0.2;
    s.seed = seed;
    return s;
}

}  // namespace gradwright
