// The workshop's drawing on one A3 sheet: plan view in the dispenser with the ends dimensioned along the
// walls, flat patterns, tables, notes, title block after ISO 7200. PDF and SVG from the same strokes.
//
// Ends are dimensioned by offset, not by angle: ISO 2768-1 m leaves an angle +-20', which is 0.58 mm at the
// end of 100 mm, and holds an offset of that size to 0.3 mm.
#pragma once
#include <string>

#include "reports/cairo_sheet.h"
#include "reports/hand_over.h"

namespace gradwright {

inline constexpr double kDrawingWidth = 420, kDrawingHeight = 297;  ///< A3 [mm]

/// Draws the sheet. `study`, `finished`, `over` must outlive the call of what is returned.
DrawPage plate_drawing(const Study& study, const FinishedDesign& finished, const HandOver& over);

}  // namespace gradwright
