// The lower views of the workshop's drawing: the plate standing in the dispenser seen from the side, and its
// flat patterns.
#pragma once
#include "reports/cairo_sheet.h"
#include "reports/hand_over.h"

namespace gradwright {

inline constexpr CairoSheet::Colour kSheetGrey{0.35, 0.35, 0.35}, kWallGrey{0.86, 0.86, 0.86},
    kPlateGrey{0.55, 0.55, 0.58};
inline const CairoSheet::Pen kThick{.width = 0.5}, kThin{.width = 0.25},
    kFine{.width = 0.13, .colour = kSheetGrey},
    kCentre{.width = 0.18, .colour = kSheetGrey, .dash = {5, 1, 0.8, 1}},
    kDashed{.width = 0.25, .dash = {2, 1}};

/// Room for a view on the sheet [mm].
struct ViewBox {
    double left, top, right, bottom;
};

/// The side view looks along y, from the side y = 0, unless a plate ends on the sides: then along x, from the
/// platform side.
bool seen_along_y(const HandOver& over);

/// Well, walls, floor, slots or notches and the plates in them. Named X: the plan's arrow shows its way.
void draw_side_view(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box);

/// One beside the other, seen from side B, with what is engraved there.
void draw_flat_patterns(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box);

}  // namespace gradwright
