// Picture of an extrapolation: the order of every strip against its turnovers, the fitted law and its
// envelope, out to the machine.
#pragma once
#include <string>

#include "optimise/heap_order.h"

namespace gradwright {

/// SVG document. Without a fitted law: the strips alone.
std::string heap_order_svg(const ScaledHeap& heap);

}  // namespace gradwright
