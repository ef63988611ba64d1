// Grains of one instant, small enough for a web page: 8 bytes a grain, drawn by the report's script as views,
// and in 3-D.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "dem/layer.h"
#include "dem/scene.h"

namespace gradwright {

/// {time, blade_x, grains, shown, origin[3], extent[3], radius_max, data}: `data` is base64 of `shown`
/// records of 8 bytes, little endian: u16 x, y, z (position = origin + value/65535 extent), u8
/// radius/radius_max x 255, u8 flags (bit 0: A), ordered by rising z. Grains fallen into the overflow are
/// left out; y is wrapped when the sides are periodic. More than `most` grains: only those seen from above or
/// from the sides, or cut by the middle slice, are kept; of those at most `limit`, evenly over their heights.
nlohmann::json grain_picture(const Snapshot& snapshot, const Scene& scene, std::size_t most = 60000,
                             std::size_t limit = 60000);

std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace gradwright
