// The partition as a workshop wants it: plan view to scale on an A4 sheet, every corner dimensioned from one
// datum (rear wall, y = 0 side), sides A and B, spreading direction, table of corners, title block. One SVG,
// text as text.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// Complete SVG document, 297 x 210 mm.
std::string partition_svg(const Study& study, const StudyResult& result);

/// Outlines of chamber A and chamber B in the dispenser's rectangle [m], counter-clockwise. Without a
/// partition inside the dispenser one of them is the whole rectangle and the other empty. Of two curves the
/// outer powder's two chambers come as one outline, joined by a seam of no width.
std::array<std::vector<PlanPoint>, 2> chamber_outlines(const PartitionCurve& partition, double length,
                                                       double width);

/// The point of each chamber that is farthest from partition and walls: where its letter stands. {NaN, NaN}
/// for an empty chamber.
std::array<PlanPoint, 2> chamber_centres(const PartitionCurve& partition, double length, double width);

/// A letter of the plan: 0 = A, 1 = B.
struct ChamberLetter {
    std::size_t side = 0;
    PlanPoint at;
};
/// The two of chamber_centres, and one more where the outer powder of two curves fills a second chamber.
std::vector<ChamberLetter> chamber_letters(const PartitionCurve& partition, double length, double width);

/// & < > " ' as entities, for text and attributes of HTML and XML. Control characters, which XML forbids,
/// become spaces.
std::string escaped(std::string_view text);

}  // namespace gradwright
