// Plan of the filled dispenser for the operator: chambers with powder and mass, plate, spreading direction.
#pragma once
#include "reports/cairo_sheet.h"
#include "reports/hand_over.h"
#include "reports/plate_views.h"

namespace gradwright {

void draw_fill_sketch(CairoSheet& sheet, const Study& study, const HandOver& over, const ViewBox& box);

}  // namespace gradwright
