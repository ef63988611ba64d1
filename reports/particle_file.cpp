#include "reports/particle_file.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "reports/hdf5_file.h"
#include "reports/safe_write.h"

namespace gradwright {
namespace {

constexpr std::uint8_t kVtkVertex = 1;  // VTK_VERTEX of vtkCellType.h

}  // namespace

void write_particle_file(const Snapshot& snapshot, const std::string& path) {
    const std::size_t n = snapshot.x.size();
    std::vector<float> points;
    points.reserve(3 * n);
    for (std::size_t i = 0; i < n; ++i)
        points.insert(points.end(), {snapshot.x[i], snapshot.y[i], snapshot.z[i]});
    std::vector<std::int64_t> connectivity(n), offsets(n + 1);
    std::iota(connectivity.begin(), connectivity.end(), 0);
    std::iota(offsets.begin(), offsets.end(), 0);
    const std::vector<std::uint8_t> types(n, kVtkVertex);
    const std::int64_t count[] = {static_cast<std::int64_t>(n)};
    const std::int64_t version[] = {1, 0};
    write_aside(path, [&](const std::string& aside) {
        H5Writer file(aside);
        file.group("/VTKHDF");
        file.attribute("/VTKHDF", "Version", version);
        file.attribute("/VTKHDF", "Type", "UnstructuredGrid", AttributeText::ascii);
        for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
            file.write(std::string("/VTKHDF/") + name, count, {1});
        file.write("/VTKHDF/Points", points, {n, 3});
        file.write("/VTKHDF/Connectivity", connectivity, {n});
        file.write("/VTKHDF/Offsets", offsets, {n + 1});
        file.write("/VTKHDF/Types", types, {n});
        file.group("/VTKHDF/PointData");
        file.write("/VTKHDF/PointData/radius", snapshot.radius, {n});
        if (snapshot.is_a.size() == n) file.write("/VTKHDF/PointData/is_a", snapshot.is_a, {n});
        if (snapshot.vx.size() == n && snapshot.vy.size() == n && snapshot.vz.size() == n) {
            std::vector<float> velocity, speed;
            for (std::size_t i = 0; i < n; ++i) {
                const float v[] = {snapshot.vx[i], snapshot.vy[i], snapshot.vz[i]};
                velocity.insert(velocity.end(), v, v + 3);
                speed.push_back(std::hypot(v[0], v[1], v[2]));
            }
            file.write("/VTKHDF/PointData/velocity", velocity, {n, 3});
            file.write("/VTKHDF/PointData/speed", speed, {n});
        }
        file.flush();
    });
}

std::vector<std::string> write_particle_series(std::span<const Snapshot> snapshots,
                                               const std::string& folder) {
    std::vector<std::string> names;
    auto files = nlohmann::json::array();
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
        names.push_back(fmt::format("particles_{:04}.vtkhdf", i));
        write_particle_file(snapshots[i], folder + "/" + names.back());
        files.push_back({{"name", names.back()}, {"time", snapshots[i].time}});
    }
    if (names.empty()) return names;
    names.push_back("particles.vtkhdf.series");
    const nlohmann::json series = {{"file-series-version", "1.0"}, {"files", files}};
    write_file(folder + "/" + names.back(), series.dump(2) + "\n");
    return names;
}

}  // namespace gradwright
