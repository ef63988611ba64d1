// Grains for ParaView: VTKHDF 1.0 UnstructuredGrid of vertices, one file per saved instant and a `.series`
// that strings them into time. Frame and units of the scene: m, x = spreading direction, z = 0 the blade's
// edge.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "dem/layer.h"

namespace gradwright {

/// One instant. Point data: radius [m], is_a [-], velocity (3) and speed [m/s]. Throws std::runtime_error
/// naming the path.
void write_particle_file(const Snapshot& snapshot, const std::string& path);

/// All instants as FOLDER/particles_0000.vtkhdf ... and FOLDER/particles.vtkhdf.series. Returns the names
/// written, relative to `folder`.
std::vector<std::string> write_particle_series(std::span<const Snapshot> snapshots,
                                               const std::string& folder);

}  // namespace gradwright
