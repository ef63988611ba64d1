// From coupon to machine: the transport kernel of strips of several lengths and doses, in units of the
// dispenser's length, and what a machine too long to be spread can be promised from them.
//
// W(xi) = share of the footprint's volume with origin_x <= xi L_d is what a partition is designed with: a
// straight one lays GI = 1 - W where it stands at xi. The longest strip's layer, stretched to the machine, is
// the machine's map; how far W still changed from the next shorter strip to it is the error of that,
//   step = rms over xi of W(longest) - W(next shorter), both at the design's dose,
// and sqrt(doublings) of it are carried for a machine longer by that many doublings: further steps no larger
// than the last and independent. The same for the drift, W over the footprint's last third minus W over its
// first, but never less than the largest drift of any strip: it turns with length, so that its phase on the
// machine is not known.
//
// Beside it stands a reduced model of a heap that rolls. The order left in the layer is
//   profile order = sqrt(2) int (W - xi) sin(pi xi) dxi,
// the slowest mode as an rms over xi, > 0 when laid from the back of the dispenser; nothing left of it is
// every grain from anywhere, the kinematic picture. Profile rest is the rms of what W - xi has besides that
// mode, and drift order the rms over xi of the drift of W. With N turnovers the order would turn and fade,
//   profile order = A exp(-N / N_memory) cos(2 pi N / N_turn + phase),
//   N = L_d / sqrt(h L_d) = sqrt(L_d / h), the way in heap lengths, h the dose height.
// Its collapse error says how far strips of all lengths and doses lie from the one curve. It is fitted and
// told, and not used: docs/scale-up.md shows why. Source: our own measurements, docs/scale-up.md. The lateral
// way grows as in kinematic_evaluator.h.
#pragma once
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "dem/scene.h"
#include "optimise/evaluation.h"

namespace gradwright {

/// N = sqrt(L_d / h) of a scene [-].
double heap_turnovers(const Scene& scene);

/// One strip's order.
struct HeapOrder {
    double dispenser_length = 0;  ///< [m]
    double dosage_factor = 0;
    double turnovers = 0;                             ///< N [-]
    double profile = 0, profile_rest = 0, drift = 0;  ///< orders [-]
    std::vector<double> share, share_drift;           ///< W - xi and the drift of W, xi = 1/40 .. 39/40
    double lateral = 0;  ///< variance of the lateral way over D50^2 and turnovers [-]
    double capture_fraction = 0, coverage = 0;
    long grains = 0;
    double seconds_cold = 0;
    std::uint64_t seed = 0;
};

/// `footprint_low`, `footprint_high`: the footprint in x as shares of the platform's length, 0 <= low < high
/// <= 1. Throws std::invalid_argument when the footprint or a third of it holds no grain.
HeapOrder heap_order(const Layer& layer, const Scene& scene, double footprint_low, double footprint_high);

/// order(N) = amplitude exp(-N / memory) cos(2 pi N / turn + phase), with what speaks against it.
struct OrderLaw {
    double amplitude = 0, memory = 0, turn = 0, phase = 0;
    /// Root of the sum of squared residuals over (strips - 4 parameters): how far a strip lies from the law
    /// [-].
    double collapse_error = 0;
    /// What the law of the shorter strips says of the longest minus what that one measured, and that law's
    /// envelope there [-]. NaN without enough strips.
    double longest_miss = std::numeric_limits<double>::quiet_NaN(),
           longest_envelope = std::numeric_limits<double>::quiet_NaN();
    int strips = 0;
    bool fitted = false;
    double at(double turnovers) const;
    double envelope(double turnovers) const;
};

/// Least squares (Ceres) over `turnovers`, `order`; fewer than five points leave `fitted` false.
OrderLaw fit_order_law(std::span<const double> turnovers, std::span<const double> order);

/// Everything that scaling up has found.
struct ScaledHeap {
    RunHealth health;
    std::vector<HeapOrder> strips;            ///< by turnovers, rising
    OrderLaw law;                             ///< told, not used
    double turnovers = 0;                     ///< of the machine asked for
    double length = 0, longest = 0;           ///< its dispenser, and the longest one spread at its dose [m]
    double profile_step = 0, drift_step = 0;  ///< from the next shorter strip to the longest, a doubling [-]
    double dose_step = 0;  ///< largest rms of W between doses at one length [-]; 0: one dose
    double profile_error = 0, drift_error = 0;  ///< carried by the design, rms over a ramp [-]
    HeapOrder nearest;                          ///< the longest strip at the design's dose
    Layer kernel;                               ///< and its layer
    long steps = 0, grains = 0;
    double grain_steps = 0, seconds = 0, seconds_cold = 0;
    std::string state_hash;
    /// log2 of the machine's length over the longest strip's, at least one.
    double doublings() const;
    /// What the extrapolation rests on, one sentence each, for people.
    std::vector<std::string> rests_on;
};

/// Scene of a strip of the study at another dispenser length and dosage: platform and the design's land in
/// proportion.
Scene scaled_strip(const Study& study, const Design& design, double dispenser_length, double dosage_factor,
                   std::uint64_t seed);
/// The strips a study asks for: (length [m], dosage factor), all lengths at the design's dosage factor, then
/// the other dosage factors at the lower middle length.
std::vector<std::pair<double, double>> scale_up_plan(const Study& study, double dosage_factor);

/// Sets nearest, longest, steps and errors from strips and `length`. Throws std::invalid_argument when there
/// are not two lengths at that dosage factor.
void carry_errors(ScaledHeap& heap, double dosage_factor);

class SpreadRunner;
/// Spreads the plan and fits. `health` tells when a strip at the design's own dose failed; another dose that
/// fails is left out with a warning.
ScaledHeap scale_up(const Study& study, const Design& design, SpreadRunner& runner);

/// The longest strip's layer stretched to the study's machine: x by the lengths, y to the whole width,
/// lateral ways as a random walk by the root of the turnovers. Volumes are those of the machine's layer.
Layer stretched_layer(const Study& study, const Design& design, const ScaledHeap& heap);

/// Adds the errors of `heap` to those of `evaluation`, in quadrature, bin by bin: error x sqrt(2) sin(pi s),
/// s the share of the dispenser's length on A's side of the bin's middle: the shape of the slowest mode,
/// largest in the middle of the dispenser and nothing where no place of it could send another label. One
/// error then moves all bins (Evaluation::one_error); its size is known from the difference of two curves of
/// some three modes, which are its degrees of freedom.
void carry_extrapolation(const ScaledHeap& heap, Evaluation& evaluation);
/// Half width in standard errors of a band that holds all bins at once, 95 %, when one error moves them all.
double common_factor(double degrees);

}  // namespace gradwright
