// The scene that the gradation's tests share, and layers given grain by grain.
#pragma once
#include <array>
#include <vector>

#include "dem/gradation.h"
#include "tests/dem/synthetic_layer.h"

namespace gradwright {

inline const BinGrid kBins{0.2e-3, 8};
inline const Footprint kFootprint{1.6e-3, 3.2e-3, 0, 1.6e-3};
inline const PartitionCurve kCurve{
    {{0.3e-3, 1.25e-3}, {1.0e-3, 1.0e-3}, {1.6e-3, 0.8e-3}, {2.4e-3, 0.6e-3}, {3.0e-3, 0.35e-3}}};

/// Grains given one by one: x, y, volume; origins at the deposit.
inline Layer layer_of(const std::vector<std::array<double, 3>>& grains) {
    Layer layer;
    layer.width = 1.6e-3;
    layer.platform_length = 3.2e-3;
    layer.gap = 100e-6;
    for (const auto& [x, y, v] : grains) {
        layer.deposit_x.push_back(x);
        layer.deposit_y.push_back(y);
        layer.origin_x.push_back(x);
        layer.origin_y.push_back(y);
        layer.volume.push_back(v);
    }
    layer.is_a.assign(grains.size(), 0);
    return layer;
}

inline synthetic::Law correlated() {
    synthetic::Law law;
    law.grains = 4000;
    return law;
}

}  // namespace gradwright
