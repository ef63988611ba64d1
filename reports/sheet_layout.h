// What every drawn sheet needs: a preferred scale, and dimension texts that do not overlap.
#pragma once
#include <string>
#include <vector>

namespace gradwright {

/// Largest preferred scale (ISO 5455 and its intermediates) that fits, drawn mm per mm.
double preferred_scale(double limit);

/// "5 : 1", "1 : 2.5".
std::string scale_text(double scale);

/// Texts at `wanted` positions pushed apart to `step`, kept in order and as near as may be.
std::vector<double> spread_apart(std::vector<double> wanted, double step);

}  // namespace gradwright
