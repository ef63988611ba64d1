#include "reports/image_file.h"

#include <stdexcept>

#include "reports/hdf5_file.h"
#include "reports/safe_write.h"

namespace gradwright {

void write_image_file(const ImageData& image, const std::string& path) {
    const auto [nx, ny, nz] = image.points;
    if (nx * ny * nz == 0) throw std::invalid_argument("image for " + path + " has no points");
    for (const ImageArray& array : image.arrays)
        if (array.values.size() != nx * ny * nz * static_cast<std::size_t>(array.components))
            throw std::invalid_argument("image for " + path + ": sizes of " + array.name + " disagree");
    const std::int64_t version[] = {1, 0};
    const std::int64_t extent[] = {0, static_cast<std::int64_t>(nx) - 1, 0, static_cast<std::int64_t>(ny) - 1,
                                   0, static_cast<std::int64_t>(nz) - 1};
    const double direction[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    write_aside(path, [&](const std::string& aside) {
        H5Writer file(aside);
        file.group("/VTKHDF");
        file.attribute("/VTKHDF", "Version", version);
        file.attribute("/VTKHDF", "Type", "ImageData", AttributeText::ascii);
        file.attribute("/VTKHDF", "WholeExtent", extent);
        file.attribute("/VTKHDF", "Origin", image.origin);
        file.attribute("/VTKHDF", "Spacing", image.spacing);
        file.attribute("/VTKHDF", "Direction", direction);
        file.group("/VTKHDF/PointData");
        for (const ImageArray& array : image.arrays) {
            H5Writer::Shape shape = {nz, ny, nx};
            if (array.components > 1) shape.push_back(static_cast<hsize_t>(array.components));
            file.write("/VTKHDF/PointData/" + array.name, array.values, shape);
        }
        file.flush();
    });
}

}  // namespace gradwright
