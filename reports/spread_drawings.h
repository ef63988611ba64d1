// The pictures of spread_figures as SVG documents. Lengths in mm on the axes; A blue, B orange throughout.
#pragma once
#include <string>

#include "reports/spread_figures.h"

namespace gradwright {

/// GI of every cell of the platform, to scale; empty cells grey.
std::string gi_map_svg(const Study& study, const GradationMap& map);

/// The powder as seen from above, before in the dispenser and after on the platform (fig. 2).
std::string beds_svg(const Study& study, const Evaluation& evaluation, const SpreadResult& spread);

/// GI(y): the study's bins with their band, the fine bins, the straight line over the partition's extent and
/// the unmixed partition's own line.
std::string gi_line_svg(const Study& study, const Evaluation& evaluation, const SpreadFigures& figures);

/// Velocity ahead of the blade, twice: as it stands, colour = speed; seen from the blade, colour = rise and
/// fall.
std::string heap_velocity_svg(const SpreadFigures& figures);

/// The heap from above at the drawn instants, mixing over the blade's way, and GI across the heap.
std::string heap_mixing_svg(const Study& study, const Evaluation& evaluation, const SpreadResult& spread,
                            const SpreadFigures& figures);

/// wt% Fe and Ni over y with bands, powder and melted metal. Needs `powder`.
std::string composition_svg(const SpreadFigures& figures);

}  // namespace gradwright
