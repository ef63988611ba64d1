// The operator's sheet: what to fill, in which order, how to check it and what to do when a check fails. One
// page layout for HTML and one for PDF, both from the same blocks.
#pragma once
#include <string>
#include <vector>

#include "reports/cairo_sheet.h"
#include "reports/hand_over.h"

namespace gradwright {

struct SheetBlock {
    std::string heading;
    std::vector<std::string> head;               ///< of a table; empty: no table
    std::vector<std::vector<std::string>> rows;  ///< of the table, or of one cell each: a numbered list
    std::string note;                            ///< below
    bool numbered = false;
};

/// What both forms show, in order.
std::vector<SheetBlock> fill_blocks(const Study& study, const HandOver& over);

/// One self-contained page; works offline and prints on A4.
std::string fill_html(const Study& study, const HandOver& over);

inline constexpr double kFillWidth = 210, kFillHeight = 297;  ///< A4 [mm]
/// As many A4 pages as the blocks need.
std::string fill_pdf(const Study& study, const HandOver& over);

}  // namespace gradwright
