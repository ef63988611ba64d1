// A regular grid of points for ParaView: VTKHDF 1.0 ImageData with point data. Flat grids are written as a
// slab of two equal layers of points: the reader of VTK 9.1 (ParaView 5.10) sizes cell data wrongly and newer
// ones reduce a flat image to two dimensions, while a slab of points reads alike in all of them.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace gradwright {

struct ImageArray {
    std::string name;
    int components = 1;
    std::vector<double> values;  ///< [z][y][x][component]
};

struct ImageData {
    std::array<std::size_t, 3> points = {0, 0, 0};                  ///< along x, y, z, each >= 2
    std::array<double, 3> origin = {0, 0, 0}, spacing = {1, 1, 1};  ///< [m]
    std::vector<ImageArray> arrays;
};

/// Throws std::runtime_error naming the path; std::invalid_argument when there are no points or the sizes
/// disagree.
void write_image_file(const ImageData& image, const std::string& path);

}  // namespace gradwright
