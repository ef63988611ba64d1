// Study: the whole question, in SI. Read from TOML by study_file; constant afterwards.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dem/gradation.h"
#include "dem/scene.h"
#include "dem/spread.h"
#include "optimise/constraint.h"
#include "targets/misfit.h"
#include "targets/target.h"

namespace gradwright {

/// One input as the user sees it: printed by `check` and every report.
struct InputEntry {
    std::string key;    ///< "process.layer_thickness"
    std::string value;  ///< as text with unit: "40 um"
    std::string unit;
    std::string origin;  ///< "given" | "default" | "machine file" | "assumed"
    std::string note;    ///< source or reason of a default
};

/// A number that is fixed or free between bounds.
struct Variable {
    std::string name;
    double value = 0;  ///< fixed value, or start (mid-range when not given) [SI]
    bool free = false;
    double low = 0, high = 0;
};

enum class Family { straight, polyline, sigmoid, spline, two_curves };
inline constexpr std::array<const char*, 5> kFamilies = {"straight", "polyline", "sigmoid", "spline",
                                                         "two_curves"};  ///< in the order of the enum
const char* to_string(Family family);
std::optional<Family> family_of(std::string_view name);

struct DesignSpace {
    Family family = Family::polyline;
    int knots = 5;                                            ///< polyline, spline, two_curves: >= 2
    bool monotone = true;                                     ///< polyline: y never turns back along x
    double minimum_segment = 0.1e-3;                          ///< [m]
    Variable angle_deg{"partition.angle", 5, true, -90, 90};  ///< straight [deg]
    Variable offset{"partition.offset", 0, true, 0,
                    0};  ///< straight, y offset of the pivot [m]; bounds (0,0) = from the width
    std::vector<PlanPoint>
        given_points;  ///< polyline fixed or started by the user; empty = closed-form start
    std::vector<PlanPoint> given_second;  ///< two_curves: the second curve, fixed with the first
    // sigmoid, free with bounds (0,0) = from the dispenser's size (partition_family.h)
    Variable centre{"partition.centre", 0, true, 0, 0};  ///< y midway between the plateaus [m]
    Variable height{"partition.height", 0, true, 0, 0};  ///< between the plateaus, + rises with x [m]
    Variable place{"partition.place", 0, true, 0, 0};    ///< x of the middle [m]
    Variable width_10_90{"partition.width_10_90", 0, true, 0,
                         0};              ///< way in x of 10 to 90 % of the height [m]
    double minimum_bend_radius = 0.3e-3;  ///< sigmoid, spline [m]; 0 = none
    double clearance = 0.24e-3;           ///< two_curves: least gap along y [m]
    bool partition_free = true;
    std::array<Variable, 2> fill_fraction = {Variable{"fill_fraction.A", 1}, Variable{"fill_fraction.B", 1}};
    // motion variables (motion.h): a new value needs a new spread, the footprint's place does not
    Variable dosage_factor{"dosage_factor", 2};
    /// Rise of each chamber's own piston over the common dose height [-]; {1, 1} = one floor under both.
    std::array<Variable, 2> dose = {Variable{"dose.A", 1}, Variable{"dose.B", 1}};
    Variable land{"land", 3.2e-3};
    Variable blade_speed{"blade_speed", -1};           ///< [m/s]; below 0: the process's
    Variable layer_thickness{"layer_thickness", -1};   ///< [m]; below 0: the process's
    Variable footprint_offset{"footprint_offset", 0};  ///< shift of the footprint in x [m]
};

struct Objective {
    Norm norm = Norm::rmse;
    double tolerance = 0.04;
    double x_drift_tolerance = 0.10;
    double x_drift_weight = 0.5;
    double waste_weight = 0.02;
    double min_coverage = 0.95;
    // limits: a design that breaks one is never met, however good its gradation
    double max_waste = std::numeric_limits<double>::infinity();  ///< of the dose [-]
    double min_supply_ratio = 0;                                 ///< [-]; 0 = none
};

/// [partition_build]: what the workshop and the operator need beyond the curve itself.
struct PartitionBuild {
    bool printed = false;              ///< a printed wall instead of cut and bent sheet
    double thickness = 0.3e-3;         ///< of sheet or wall [m]
    double grip = 20e-3;               ///< height above the rim [m]
    std::string material;              ///< of the plate, as it stands in the title block
    double bend_radius = 0.3e-3;       ///< inside a bend [m]
    double k_factor = 0.325;           ///< neutral line from the inside of a bend, in thicknesses [-]
    double clearance = 12.5e-6;        ///< between the plate's lower edge and the dispenser floor [m]
    bool tabs = false;                 ///< held by tabs in notches of the rim; false: by slots over its depth
    double slot_depth = 1e-3;          ///< how far slots or notches reach into the dispenser's walls [m]
    double tab_depth = 0.25e-3;        ///< of the notches below the rim: where the tabs sit [m]
    double end_clearance = 12.5e-6;    ///< below the tabs, between the plate's ends and the walls [m]
    double slot_clearance = 6e-6;      ///< on each side of the plate in its slot [m]
    double least_slot_width = 0.3e-3;  ///< narrowest slot the workshop can cut [m]
    double engraving = 60e-6;          ///< depth of number, sides and arrow [m]; 0 = marked on the surface
    double wall_thickness = 0;         ///< of the dispenser's walls [m]; 0 = not known
    double headroom = 0;               ///< free height above the rim [m]; 0 = not known
    std::array<double, 2> bulk_density = {0, 0};  ///< of what fills chamber A, B [kg/m3]; 0 = not measured
    double density_tolerance = 0.03;              ///< share by which a bulk density repeats [-]
    std::string owner, creator, approved, date;   ///< title block, as given; empty = to be filled in by hand
};

/// What may be left out of the physics, by name (numerics.reductions).
inline constexpr std::array<const char*, 6> kReductions = {
    "fines_cut",      // only sizes from D10 to D90
    "shallow_bed",    // 3 D50 of powder below the rim instead of 8
    "strip_map",      // the map is spread on a narrow periodic strip
    "coarse_map",     // the map is spread with larger grains (numerics.coarse_factor)
    "coarse_grains",  // every spread is
    "early_stop",     // the blade stops at the platform's end
};

/// reductions = "reduced": chosen from the rows of docs/speed-against-error.md, where the set stands as a
/// whole too.
inline constexpr std::array<const char*, 4> kReduced = {"fines_cut", "shallow_bed", "strip_map",
                                                        "early_stop"};
inline constexpr double kReducedRayleighFraction = 0.3;

/// Strips from which a machine too long to be spread is extrapolated (heap_order.h). Empty: spread as it is.
struct ScaleUp {
    std::vector<double> lengths;         ///< of the strips' dispensers [m], three or more
    std::vector<double> dosage_factors;  ///< also spread, at the middle length
    bool on() const { return !lengths.empty(); }
};

/// Which layer of several is judged (target.layer): a number from 1, or one of these.
inline constexpr int kLastLayer = 0, kAllLayers = -1;

struct Study {
    std::string name;  ///< file stem, or [study] name
    std::string file;  ///< path as given
    std::string text;  ///< verbatim TOML
    std::string machine_name;
    // machine and process, kept apart from the Scene because dosage, land and strip width change per
    // evaluation
    Scene scene;  ///< full-width scene at the fixed / start values of the motion variables
    double dispenser_width = 1.6e-3;      ///< W [m]
    double steady_packing = 0.28;         ///< used when gap = steady
    bool gap_steady = true;               ///< gap = layer_thickness / steady_packing
    bool gap_layer = false;               ///< gap = layer_thickness
    bool allow_starved = false;           ///< supply ratio < 1.05 allowed
    double strip_width = 0.4e-3;          ///< periodic strip of the map [m]
    std::vector<std::string> reductions;  ///< named: see kReductions
    double map_coarsening = 1;            ///< grains of the map's spreads, in real grains [-]
    double full_coarsening = 1;           ///< of every other spread
    int judged_layer = kLastLayer;        ///< what misfit, drift and verdict are about
    Target target;
    Footprint footprint;  ///< default: the whole platform
    BinGrid bins;         ///< default 0.2 mm over the width
    int columns = 3;      ///< a field is judged over this many equal parts of the footprint along x
    DesignSpace design_space;
    std::vector<LinearConstraint> constraints;  ///< [[constraint]]
    Objective objective;
    std::uint64_t seed = 1;
    int map_spreads = 1;                ///< strips pooled in the map
    int max_spreads = 4;                ///< budget: map + full
    ScaleUp scale_up;                   ///< [scale_up]
    PartitionBuild build;               ///< [partition_build]
    std::vector<InputEntry> inputs;     ///< every value, given or default
    std::vector<std::string> warnings;  ///< found while reading
};

/// What is to be built: one point of the design space.
struct Design {
    Family family = Family::polyline;
    PartitionCurve partition;
    std::array<double, 2> fill_fraction = {1, 1};
    double dosage_factor = 2;
    std::array<double, 2> dose = {1, 1};  ///< of each chamber's piston over the dose height
    double land = -1;                     ///< [m]; below 0: the study's
    double blade_speed = -1;              ///< [m/s]; below 0: the study's
    double layer_thickness = -1;          ///< [m]; below 0: the study's
    double footprint_offset = 0;          ///< [m]
    std::vector<std::pair<std::string, double>> parameters;  ///< named numbers of the family (deg, m)
};

/// The scene of a design: dose height = larger dose x dosage_factor x layer x (A_platform/A_dispenser), land,
/// headspaces, of which the chamber with the smaller dose has the difference; `strip`: the map's narrow
/// periodic strip. Seed is the packing seed.
Scene scene_of(const Study& study, const Design& design, bool strip, std::uint64_t seed);
/// Number of the judged layer, the last one's where that is asked for; 0 where all are.
int judged_number(const Study& study);
/// The layer that the study judges: one of the spread's, or all pooled.
Layer judged_layer(const Study& study, const SpreadResult& spread);
/// All layers of a spread, the first first.
std::vector<Layer> layers_of(const SpreadResult& spread);
/// h phi_bed A_dispenser / (g phi_layer A_platform), h less the chambers' mean headspace [-]
double supply_ratio(const Scene& scene, double bed_packing, double layer_packing);

}  // namespace gradwright
