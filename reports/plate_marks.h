// What is engraved into a plate above the rim: its number and letter, SIDE A and SIDE B, an arrow in the
// spreading direction. Letters of 5 x 7 points; points in a row run together to bars. Points and bars are
// rectangles that touch nowhere, each within one plane face: the solid stays exact and its volume and number
// of faces have closed forms.
#pragma once
#include <string>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

/// What stands on a side of the plate, line by line, as it is read there: "-->" is the arrow. Broken into the
/// fewest lines that keep the letters largest. Empty where nothing is engraved.
struct MarkText {
    std::vector<std::string> lines;
    double letter = 0;  ///< height of a letter [m]
};

/// Engraves `depth` deep [m] on both sides; 0 only lays the marks out. `arrow`: +1 where the spreading
/// direction runs from the plate's first end to its last, -1 the other way, 0 across it (then no arrow).
/// Returns what stands on side A and side B.
std::array<MarkText, 2> engrave(Plate& plate, const std::string& id, int arrow, double depth);

/// Points of a letter, 7 rows from the top of 5 columns, '#' set; empty for a character that is not known.
std::vector<std::string> letter_points(char letter);

}  // namespace gradwright
