// Can the plate be made, does it fit the machine, can it be drawn out again; how well a workshop's general
// tolerances hold it; what it leaves behind in the powder.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

/// Permissible deviation of a length [m], ISO 2768-1 class m: 0.5-3 and 3-6 mm 0.1, 6-30 0.2, 30-120 0.3,
/// 120-400 0.5, 400-1000 0.8, above 1.2 mm. Below 0.5 mm the standard gives none: 0.1 mm, to be stated at the
/// dimension.
double linear_tolerance(double length);

struct PlateCheck {
    std::string id;  ///< bends | bend_radius | outline | plates_apart | in_the_well | slot_angle | ...
    bool passed = true;
    double value = 0, limit = 0;  ///< in `unit`; NaN where there is nothing to measure
    std::string unit;             ///< "m" | "deg" | "-"
    std::string text;             ///< one sentence: what was looked at and found
};
/// Every check, passed or not, in a fixed order.
std::vector<PlateCheck> plate_checks(const Study& study, const std::vector<Plate>& plates);

/// What the drawn plate leaves: a slot of its thickness that collapses into a trough.
struct SlotEffect {
    bool simulated = false;       ///< the spreads packed the bed with this plate at full depth
    double volume = 0;            ///< of all plates inside the dispenser [m3]
    double share = 0;             ///< of the dispenser's volume [-]
    double depth = 0, width = 0;  ///< of the trough before topping up [m]
    std::string text;             ///< one sentence
};
/// A slot of thickness t and depth D has the area t D; collapsed at the angle of repose a it is a triangle of
/// depth sqrt(t D tan a). a = 30 deg, an assumption.
SlotEffect slot_effect(const Study& study, const Design& design, const std::vector<Plate>& plates);

/// What a reader must know before cutting metal; no refusals.
std::vector<std::string> plate_warnings(const Study& study, const std::vector<Plate>& plates);

}  // namespace gradwright
