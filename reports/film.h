// A film of the spread, because people want to see it move: dispenser, land and platform cut along x at half
// the width, and the same from above; the partition stands while the chambers are filled, it is drawn out,
// the floor rises by the dose, the blade sweeps the powder over the land onto the platform.
//
// What is simulated: everything from the raised bed on, at the instants that the spread kept. The rise before
// it is the same bed, moved as a whole: the engine packs the bed where it stands when the blade comes. With
// several layers the bed before the first pass is followed by the last pass.
#pragma once
#include <span>
#include <string>

#include "dem/layer.h"
#include "dem/partition.h"
#include "dem/scene.h"

namespace gradwright {

/// Instants that a spread keeps for a film, between its first and its last: at 16 a second, four seconds.
inline constexpr int kFilmInstants = 62;

/// Animated WebP, at most 1200 x 900 px and 4 MB where the powder can be told at that size. `scene` and
/// `partition`: what was spread; `instants`: of the spread, first and last included. The same input gives the
/// same bytes. Throws std::invalid_argument with fewer than two instants, std::runtime_error when it cannot
/// be drawn.
std::string film_webp(const Scene& scene, const PartitionCurve& partition,
                      std::span<const Snapshot> instants);

}  // namespace gradwright
