// Flat patterns as DXF R12 (AC1009), ASCII, lengths in mm. Layers: CUT the outline, BEND the middles of the
// bends, ETCH what is engraved on side B, DIM sizes and notes in plain lines and texts.
#pragma once
#include <string>
#include <vector>

#include "reports/flat_pattern.h"

namespace gradwright {

struct DxfNotes {
    std::string title;               ///< first line of the file, a comment
    std::vector<std::string> lines;  ///< on the layer DIM, under the patterns
};

std::string dxf_text(const std::vector<FlatPattern>& patterns, const DxfNotes& notes);

}  // namespace gradwright
