// A STEP file read back by OpenCASCADE, apart from what wrote it.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "dem/partition.h"

namespace gradwright {

struct ReadSolid {
    std::string name, description;  ///< of its product
    bool valid = false;
    double volume = 0;  ///< [mm3]
    int faces = 0;
    std::array<double, 6> box{};  ///< least x y z, largest x y z [mm]
};
std::vector<ReadSolid> read_step(const std::string& path);

/// A part of a box that the solids of a STEP file leave, SI.
struct WellPart {
    double volume = 0;
    PlanPoint centre;
};
std::vector<WellPart> read_well(const std::string& path, const std::array<double, 3>& low,
                                const std::array<double, 3>& high);

}  // namespace gradwright
