// Everything the files of a hand-over say, worked out once: plates, checks, what to fill and in which order.
// The files (STEP, DXF, drawing, fill sheet, spec.json) only write it down.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "optimise/study.h"
#include "reports/flat_pattern.h"
#include "reports/plate.h"
#include "reports/plate_checks.h"
#include "reports/plate_marks.h"

namespace gradwright {

/// What a finished design says that a hand-over rests on: read from its result.json.
struct FinishedDesign {
    Design design;
    std::string verdict = "undecided";      ///< met | not_met | undecided
    std::string termination = "converged";  ///< converged | budget | failed | interrupted | not_run
    std::string verdict_text;               ///< one sentence with the misfit
    bool extrapolated = false;              ///< from strips ([scale_up])
    double bed_packing = 0.55;              ///< solid share of the bed before it was spread [-]
    bool packing_simulated = false;         ///< false: assumed
    std::optional<double> waste_fraction;   ///< overflow over dosed solid [-]
    std::optional<double> waste_a_share;    ///< of powder A in the overflow's solid [-]
};

struct ChamberPlan {
    std::string powder;         ///< "IN718", or the premix
    double ideal_area = 0;      ///< in plan, beside a partition of no thickness [m2]
    double area = 0;            ///< beside the plate, mean over the height [m2]
    double level = 0;           ///< of the powder below the rim [m]
    double rise = 0;            ///< of its piston for each layer [m]; the same for both with one floor
    double volume = 0;          ///< from the floor to the level, beside the plate [m3]
    double bulk_density = 0;    ///< [kg/m3]
    bool measured = false;      ///< false: solid density x simulated packing
    double mass = 0;            ///< [kg]
    double mass_tolerance = 0;  ///< +- [kg]: the density's, and the end offsets' on the area
    double top_up = 0;          ///< into what the plate took, slots or notches with it, once it is out [kg]
};

struct FillPlan {
    std::array<ChamberPlan, 2> chambers;  ///< A, B
    bool one_floor() const { return chambers[0].rise == chambers[1].rise; }
    double piston_start = 0;           ///< floor below the rim while filling [m]
    double rise = 0;                   ///< of the floor, of the faster piston, for each layer [m]
    double area_ratio = 1;             ///< platform / dispenser [-]
    int layers = 0;                    ///< until less powder is left below the rim than was spread
    double left_over = 0;              ///< floor below the rim then [m]
    double dosed = 0;                  ///< mass lifted above the rim for each layer [kg]
    std::optional<double> overflow;    ///< of it into the overflow [kg]
    std::optional<double> overflow_a;  ///< share of powder A in the overflow by mass [-]
};

struct Acceptance {
    std::string check, limit, if_failed;
};

struct HandOver {
    std::string id;  ///< "GW-1A2B3C4D": engraved; the same for the same plates in the same machine
    std::string
        mark;  ///< "NOT VERIFIED: verdict undecided"; empty when the target is met and all checks pass
    std::string first_line;  ///< mark, or what the simulation says; opens each file
    std::string make;        ///< "straight sheet" | "bent sheet" | "printed wall"
    PartitionCurve partition;
    double dosage_factor = 2;
    std::vector<Plate> plates;
    std::vector<FlatPattern> flats;
    std::vector<std::array<MarkText, 2>> marks;  ///< of each plate, on side A and side B
    std::vector<PlateCheck> checks;
    SlotEffect slot;
    FillPlan fill;
    std::vector<std::string> steps;  ///< loading, withdrawal, levelling, in order
    std::vector<Acceptance> acceptance;
    std::vector<std::string> warnings;
    bool buildable() const;
};

/// Throws std::invalid_argument when the partition misses the dispenser: there is nothing to build.
HandOver hand_over(const Study& study, const FinishedDesign& finished);

/// "12.3 mg", "4.56 g", "1.23 kg".
std::string mass_text(double kilograms);
/// "2.23 +- 0.08 kg": both in one unit, as many decimals as the tolerance has two digits of.
std::string mass_text(double kilograms, double tolerance);
/// "4.285 g/cm3".
std::string density_text(double kilograms_per_cubic_metre);
/// "+-0.1" of a dimension in mm.
std::string tolerance_text(double length);

}  // namespace gradwright
