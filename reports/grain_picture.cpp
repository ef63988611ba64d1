#include "reports/grain_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "dem/stage.h"

namespace gradwright {
namespace {

/// The highest grain of each cell of half a median grain, plus every grain that touches the plane y = W/2 or
/// lies in the outermost row of either side.
std::vector<std::size_t> visible(const Snapshot& s, const std::vector<float>& y,
                                 const std::vector<std::size_t>& kept, double width) {
    double radius = 0;
    for (std::size_t i : kept) radius += s.radius[i];
    radius /= static_cast<double>(kept.size());
    const double cell = radius;
    double x_high = 0, x_low = 0;
    for (std::size_t i : kept) {
        x_high = std::max(x_high, double(s.x[i]));
        x_low = std::min(x_low, double(s.x[i]));
    }
    const std::size_t nx = static_cast<std::size_t>((x_high - x_low) / cell) + 1,
                      ny = static_cast<std::size_t>(width / cell) + 1;
    std::vector<std::size_t> top(nx * ny, SIZE_MAX);
    std::vector<std::size_t> out;
    for (std::size_t i : kept) {
        if (std::abs(y[i] - width / 2) < s.radius[i] || std::min<double>(y[i], width - y[i]) < 2 * radius) {
            out.push_back(i);
            continue;
        }
        const std::size_t cx = std::min(nx - 1, static_cast<std::size_t>((s.x[i] - x_low) / cell));
        const std::size_t cy = std::min(ny - 1, static_cast<std::size_t>(std::max(0.0f, y[i]) / cell));
        std::size_t& highest = top[cy * nx + cx];
        if (highest == SIZE_MAX || s.z[i] > s.z[highest]) highest = i;
    }
    for (std::size_t i : top)
        if (i != SIZE_MAX) out.push_back(i);
    return out;
}

}  // namespace

std::string base64(const std::vector<std::uint8_t>& bytes) {
    static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const std::uint32_t group =
            bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
        out += kLetters[group >> 18 & 63];
        out += kLetters[group >> 12 & 63];
        out += left > 1 ? kLetters[group >> 6 & 63] : '=';
        out += left > 2 ? kLetters[group & 63] : '=';
    }
    return out;
}

nlohmann::json grain_picture(const Snapshot& s, const Scene& scene, std::size_t most, std::size_t limit) {
    const double end = scene.dispenser_length + scene.land + scene.platform_length + scene.second_land;
    const double floor = -1.5 * deepest_floor(scene) - 1e-4;
    std::vector<float> y(s.y);
    if (scene.sides == Sides::periodic && scene.width > 0)
        for (float& value : y) value -= static_cast<float>(std::floor(value / scene.width) * scene.width);
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < s.x.size(); ++i)
        if (std::isfinite(s.x[i]) && std::isfinite(s.z[i]) && std::isfinite(y[i]) && s.x[i] < end &&
            s.z[i] > floor)
            kept.push_back(i);
    if (kept.size() > most) kept = visible(s, y, kept, scene.width);
    std::sort(kept.begin(), kept.end(),
              [&](std::size_t a, std::size_t b) { return s.z[a] != s.z[b] ? s.z[a] < s.z[b] : a < b; });
    if (kept.size() > limit) {
        std::vector<std::size_t> some;
        for (std::size_t k = 0; k < limit; ++k) some.push_back(kept[k * kept.size() / limit]);
        kept = std::move(some);
    }

    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, radius_max = 0;
    const std::vector<float>* axes[3] = {&s.x, &y, &s.z};
    for (int a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < kept.size(); ++k) {
            const double value = (*axes[a])[kept[k]];
            low[a] = k ? std::min(low[a], value) : value;
            high[a] = k ? std::max(high[a], value) : value;
        }
    }
    for (std::size_t i : kept) radius_max = std::max(radius_max, double(s.radius[i]));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(kept.size() * 8);
    for (std::size_t i : kept) {
        for (int a = 0; a < 3; ++a) {
            const double extent = high[a] - low[a];
            const auto q = static_cast<unsigned>(
                std::lround(extent > 0 ? ((*axes[a])[i] - low[a]) / extent * 65535 : 0));
            bytes.push_back(q & 255);
            bytes.push_back(q >> 8 & 255);
        }
        bytes.push_back(
            static_cast<std::uint8_t>(std::lround(radius_max > 0 ? s.radius[i] / radius_max * 255 : 0)));
        bytes.push_back(i < s.is_a.size() && s.is_a[i] ? 1 : 0);
    }
    return {{"time", s.time},
            {"blade_x", s.blade_x},
            {"grains", s.x.size()},
            {"shown", kept.size()},
            {"origin", {low[0], low[1], low[2]}},
            {"extent", {high[0] - low[0], high[1] - low[1], high[2] - low[2]}},
            {"radius_max", radius_max},
            {"data", base64(bytes)}};
}

}  // namespace gradwright
