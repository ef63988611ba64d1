// What lies on the platform before the first layer, and what stands there again after a layer was melted.
//
// Fused metal is a rough fixed surface whose mean plane lies one gap below the blade's edge. Melted metal has
// no memory of the grains it was: every layer finds another draw of the same roughness.
//
// Unfused powder is a bed settled like the dispenser's, cut so that no grain of it stands above the plane one
// gap below the blade's edge, which is what a pass of the blade and a platform that sank by one gap leave.
// (Cut where its solid ends, as a dose is, its tops would stand in the blade's way at a gap of one layer.)
// Its grains move, and are never counted as the layer.
#pragma once
#include <vector>

#include "dem/bed.h"

namespace gradwright {

/// Fused surface under layer `layer`, from 1.
std::vector<GrainSpec> fused_surface(const Scene& scene, int layer);

/// Rough floor that the powder substrate lies on, substrate_depth() below its surface.
std::vector<GrainSpec> powder_floor(const Scene& scene);

/// The settled powder over the platform, in the scene's frame, each grain with its own material also in a run
/// without labels. `health` says why when it cannot be packed.
Bed settled_substrate(const Scene& scene, const SpreadOptions& options, RunHealth& health);

/// The scene of a dispenser that is the platform, for packing the substrate: its z = 0 is the plane under the
/// first layer, its x = 0 the platform's near edge.
Scene substrate_scene(const Scene& scene);

}  // namespace gradwright
