// Which inputs move the gradation of one design, and by how much: plate dimensions and chamber doses on the
// origin map, where a new value costs nothing; what moves grains on strips of its own, with a straight-line
// surrogate between them whose error is cross-validated.
//
// Labels: every plate dimension within its general tolerance (tolerance_budget.h), each chamber's dose and
// the part's place within a stated range; Morris screening and Sobol indices (sensitivity_indices.h) of GI of
// the bins that count, misfit and x drift. Motion: inputs z_i in [-1, 1] over their stated ranges, in a Latin
// hypercube of `strips` points on one and the same packing seed; each output y = a + sum_i b_i z_i by least
// squares. |b_i| is what the input does over half its range, with its standard error; S_i = b_i^2 / sum b^2,
// exact for a straight line. Error of the surrogate: rms of every strip's output minus what the line through
// all the others says (leave one out). A strip that ends without numbers is named with its inputs and its
// reason, and left out of the fit.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "optimise/design_run.h"
#include "optimise/sensitivity_indices.h"
#include "optimise/tolerance_budget.h"

namespace gradwright {

/// Something that may be other than the study says.
struct UncertainInput {
    std::string name;                     ///< as a key of the study, or a plate dimension
    std::string unit;                     ///< SI
    double value = 0, low = 0, high = 0;  ///< nominal and stated range
    std::string origin;       ///< of the value: "given", "default", ...; empty for plate dimensions
    bool unmeasured = false;  ///< a default, or a stand-in of a machine file
    std::function<void(Study&, Design&, double)> set;
};

/// Inputs of the process and the powders that move grains, with ranges: blade speed, layer, dosage and land
/// +-10 %, D50 (all sizes with it) +-10 %, friction, rolling friction and restitution +-25 %, work of
/// adhesion from half to twice. Those that are 0 stay out.
std::vector<UncertainInput> motion_inputs(const Study& study, const Design& design);
/// Plate dimensions within their tolerances, dose of one chamber over the other +-5 %, the part's place
/// +-0.1 mm.
std::vector<UncertainInput> label_inputs(const Study& study, const Design& design,
                                         ToleranceClass tolerance_class);

struct SensitivityOptions {
    RunOptions run;
    ToleranceClass tolerance_class = ToleranceClass::m;
    double gi_error = 0.02;  ///< that the tolerances are to keep [GI]
    int trajectories = 20;   ///< Morris
    int samples = 256;       ///< Sobol: (inputs + 2) times as many map answers
    int band_plates = 1000;  ///< plates on the map that check the budget's band
    int strips = 0;          ///< for the motion inputs; 0: they are listed and not varied
    int spread_plates = 0;   ///< plates that are spread with both powders, each on a bed of its own
};

/// Labels: one line an input, outputs in the order of `Sensitivity::outputs`.
struct MotionEffect {
    std::vector<double> half_range;      ///< b per output [output per half the range]
    std::vector<double> standard_error;  ///< of those
    double gi_rms = 0;                   ///< b over the bins that count, rms [GI]
    double gi_rms_error = 0;             ///< noise of that: rms of the standard errors [GI]
    double share = 0;                    ///< S_i of GI, all bins together [-]
};
struct FailedStrip {
    std::vector<double> inputs;  ///< in the order of `motion`
    std::string status, reason;
};
struct PlateSpread {
    std::uint64_t seed = 0;
    int inside = 0, bins = 0;  ///< counting bins inside the band with the bed's own noise in it
    double rms = 0;            ///< GI minus the ideal plate's on the map
};

struct Sensitivity {
    std::string status = "ok";  ///< | "interrupted" | why there is no map
    std::string reason;
    Design design;
    std::vector<std::string> outputs;  ///< "GI at y = 0.30 mm", ..., "misfit", "x drift"
    std::vector<double> nominal;       ///< of those, on the map
    std::vector<UncertainInput> labels, motion;
    MorrisScreening morris;  ///< of `labels`
    SobolIndices sobol;
    ToleranceBudget budget;
    BandCheck band;
    std::vector<MotionEffect> effects;    ///< of `motion`; empty without strips
    std::vector<double> surrogate_error;  ///< leave one out, per output
    double surrogate_gi_error = 0;        ///< over the bins that count [GI]
    std::vector<FailedStrip> failed;
    int strips = 0;
    std::vector<PlateSpread> plates;
    double noise_floor = 0;  ///< of the map
    int map_spreads = 0, full_spreads = 0;
    double seconds = 0, seconds_cold = 0;
};

/// `design`: with its partition. Throws std::invalid_argument when it has none.
Sensitivity run_sensitivity(const Study& study, const Design& design, const SensitivityOptions& options);

/// Straight-line surrogate of one output over z (n rows of d inputs): [a, b_1 .. b_d], their standard errors
/// and the leave-one-out error. Needs n >= d + 3 rows.
struct LineFit {
    std::vector<double> coefficient, standard_error;
    double leave_one_out = 0;
};
LineFit fit_line(const std::vector<std::vector<double>>& z, const std::vector<double>& y);
/// n points of a Latin hypercube in [-1, 1]^d: in every direction one in each of n equal slices.
std::vector<std::vector<double>> latin_hypercube(int n, int d, std::uint64_t seed);

}  // namespace gradwright
