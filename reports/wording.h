// What a result says in words. Written once; the terminal summary, the report and result.json all speak these
// sentences.
#pragma once
#include <string>
#include <vector>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

struct Wording {
    std::string headline;               ///< "Target met" | "Target not met" | "Undecided" | "No result"
    std::string state;                  ///< met | not_met | undecided | failed: colours and marks hang on it
    std::string verdict;                ///< one sentence: what was asked, found, by how much
    std::string misfit;                 ///< misfit with interval, floor, tolerance
    std::string drift;                  ///< x drift with noise floor and tolerance
    std::string sure;                   ///< on what the numbers rest
    std::string build;                  ///< the partition in one line
    std::vector<std::string> fill;      ///< one line per chamber
    std::string dose;                   ///< dosage, rise of the floor, land, footprint
    std::string losses;                 ///< capture, waste, coverage
    std::vector<std::string> warnings;  ///< the study's, the result's, and what a reader must not overlook
};

Wording wording(const Study& study, const StudyResult& result);

/// One row per corner of the partition inside the dispenser, ends on the walls.
struct PartitionRow {
    int curve = 1;              ///< 2: of the second curve of a pair, listed after the first
    int number = 0;             ///< from 1, on each curve
    double x_mm = 0, y_mm = 0;  ///< from the dispenser's rear wall and from its y = 0 side [mm]
    double length_mm = 0;       ///< of the segment that starts here [mm], NaN on the last row
    double angle_deg =
        0;  ///< of that segment from the spreading direction, + towards +y [deg], NaN on the last row

    std::string name() const { return (curve == 1 ? "P" : "Q") + std::to_string(number); }
};
std::vector<PartitionRow> partition_rows(const Study& study, const Design& design);

/// Powder of chamber A (0) or B (1): "IN718", or "90 % IN718" of a premix.
std::string chamber_name(const Study& study, int chamber);

/// "polyline partition"; what its corners are where it is smooth, which powder stands between two curves.
std::string partition_name(const Design& design);

/// Part of a straight line name: a length in mm with three decimals (a workshop's micrometre).
std::string millimetres(double metres);
/// "1 min 05 s", "3.2 s", "2 h 05 min".
std::string duration(double seconds);

}  // namespace gradwright
