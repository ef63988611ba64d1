// From coupon to machine: how much of the dispenser's order the laid powder still shows, measured on strips
// of several lengths and doses, fitted by a reduced heap model and carried to a length that nobody can
// simulate.
//
// A heap that is pushed over the dispenser takes up its powder in order of x. A short one gives it back
// nearly as it took it, last in, first out; a long one rolls over again and again, which turns the order
// round and wears it down. Where none is left every grain of the layer comes from anywhere in the dispenser
// with the same probability, and a partition lays the share of the dispenser's length that lies on A's side:
// the kinematic picture. What is left of the order is that picture's error. With W(xi) = share of the
// footprint's volume with origin_x <= xi L_d,
//   profile order = sqrt(2) int (W - xi) sin(pi xi) dxi: the slowest mode, with its sign (> 0: laid from the
//   back of the
//                   dispenser), as an rms over xi. A straight partition lays GI = 1 - W at the y where it
//                   stands at xi, so that W - xi is its error of GI along a linear ramp;
//   profile rest  = rms of what W - xi has besides that mode;
//   drift order   = rms over xi of W over the footprint's last third minus W over its first third.
// Reduced model of a heap that rolls: the order turns and fades with the turnovers N, the way in heap
// lengths,
//   profile order = A exp(-N / N_memory) cos(2 pi N / N_turn + phase),   N = L_d / sqrt(h L_d) = sqrt(L_d /
//   h),
// h the dose height; sqrt(h L_d) is the side of the square that the dose would make, the heap's length but
// for its slope. N alone stands for length and dose: the collapse error says how well. The phase at N far
// beyond the strips is not known, so a machine carries the whole envelope A exp(-N / N_memory); the drift's
// envelope fades with the same memory and lies above every strip. Strips keep the machine's ratios of land
// and platform to dispenser. Source: our own measurements, docs/scale-up.md. The lateral way grows as in
// kinematic_evaluator.h.
#pragma once
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
    double lateral = 0;  ///< variance of the lateral way over D50^2 and turnovers [-]
    double capture_fraction = 0, packing_fraction = 0, waste_fraction = 0, bed_packing = 0, coverage = 0;
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
    double longest_miss = 0, longest_envelope = 0;
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
    std::vector<HeapOrder> strips;              ///< by turnovers, rising
    OrderLaw law;                               ///< of the profile order
    double drift_amplitude = 0;                 ///< of the drift's envelope
    double turnovers = 0;                       ///< of the machine asked for
    double profile_error = 0, drift_error = 0;  ///< carried by the design, rms over a ramp [-]
    double lateral = 0;                         ///< mean over the strips
    double longest = 0;                         ///< longest dispenser spread [m]
    long steps = 0, grains = 0;
    double grain_steps = 0, seconds = 0, seconds_cold = 0;
    std::string state_hash;
    /// Of the strip with the most turnovers.
    const HeapOrder& nearest() const { return strips.back(); }
    /// What the extrapolation rests on, one sentence each, for people.
    std::vector<std::string> rests_on;
};

/// Scene of a strip of the study at another dispenser length and dosage: platform and land in proportion.
Scene scaled_strip(const Study& study, double dispenser_length, double dosage_factor, std::uint64_t seed);
/// The strips a study asks for: (length [m], dosage factor), all lengths at the design's dosage factor, then
/// the other dosage factors at the middle length.
std::vector<std::pair<double, double>> scale_up_plan(const Study& study, double dosage_factor);

/// Sets profile_error, drift_error and drift_amplitude from strips and law.
void carry_errors(ScaledHeap& heap);

class SpreadRunner;
/// Spreads the plan and fits. `health` tells when a strip failed.
ScaledHeap scale_up(const Study& study, const Design& design, SpreadRunner& runner);

/// The layer of a fully mixed heap on the study's machine: `grains` origins even over the dispenser, deposits
/// even over the platform, lateral ways normal with the variance the strips say. A map for every estimator;
/// its volumes are those of `grains` equal shares of what the machine lays.
Layer mixed_layer(const Study& study, const Design& design, const ScaledHeap& heap, int grains = 40000);

/// Adds the errors of `heap` to those of `evaluation`, in quadrature, bin by bin: error x sqrt(2) sin(pi GI),
/// the shape of the slowest mode of mixing, which is largest in the middle of the dispenser and nothing where
/// no grain could carry another label.
void carry_extrapolation(const ScaledHeap& heap, Evaluation& evaluation);
/// The carried error is one number for all bins, not one for each: what `judge` has made of it as if bins
/// were independent is widened to value -+ t noise_floor, t Student's one-sided 95 % point.
void judge_as_one(Evaluation& evaluation);
/// Half width in standard errors of a band that holds all bins at once, 95 %, when one error moves them all.
double common_factor(double degrees);

}  // namespace gradwright
