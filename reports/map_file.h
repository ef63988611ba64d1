// GI map for ParaView: VTKHDF 1.0 ImageData. Point data gi [-] (NaN where empty) and mass [kg] stand at the
// map's cell centres, the same on the layer's lower and upper face (image_file.h says why). x from the
// platform's near edge, y across [m].
#pragma once
#include <string>
#include <vector>

#include "dem/gradation.h"

namespace gradwright {

/// `thickness`: from the lower face to z = 0, the layer's gap [m], > 0. Throws std::runtime_error naming the
/// path; std::invalid_argument when the map is empty or its sizes disagree.
void write_map_file(const GradationMap& map, double thickness, const std::string& path);

/// Mean of several maps on the same cells: GI weighted by mass, NaN only where no map has powder. The first
/// map's grid counts; maps on other cells are left out.
GradationMap mean_map(const std::vector<const GradationMap*>& maps);

}  // namespace gradwright
