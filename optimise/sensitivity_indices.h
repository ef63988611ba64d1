// Which inputs move a model's outputs: Morris screening and Sobol indices of any function on the unit cube.
//
// Morris (Technometrics 33, 1991; mu* by Campolongo et al., Environ. Model. Softw. 22, 2007): along r random
// trajectories on a grid of `levels` values one input moves at a time by delta = levels / (2 (levels - 1)),
//   effect_i = (f(x + delta e_i) - f(x)) / delta;   mu = mean, mu* = mean of |effect|, sigma = its deviation.
// mu* ranks; sigma beside mu* tells an effect that is not linear or depends on other inputs.
// Sobol (Saltelli et al., Comput. Phys. Commun. 181, 2010, table 2; total by Jansen 1999): two independent
// samples A, B of n points and, for each input, A with its column from B,
//   S_i = <f(B) (f(AB_i) - f(A))> / V,   S_Ti = <(f(A) - f(AB_i))^2> / (2 V),
// with standard errors and 95 % intervals by resampling rows. Plain random numbers: the error falls as
// n^-1/2 and is known.
//
// A run that fails has no numbers: its effects, or its whole row, are left out, and counted.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace gradwright {

/// Inputs, each in [0, 1] -> outputs, always as many; nothing when the run failed.
using UnitModel = std::function<std::optional<std::vector<double>>(const std::vector<double>&)>;

struct MorrisEffect {
    double mean = 0, mean_absolute = 0, deviation = 0;  ///< mu, mu*, sigma, per full range of the input
    double standard_error = 0;                          ///< of mu*; NaN from fewer than two effects
    int effects = 0;                                    ///< they are made of
};
struct MorrisScreening {
    std::vector<std::vector<MorrisEffect>> effect;  ///< [input][output]
    int evaluations = 0, failed = 0;
};
/// inputs >= 1, trajectories >= 1, levels even and >= 2: (inputs + 1) trajectories evaluations.
MorrisScreening morris_screening(const UnitModel& model, int inputs, int trajectories, std::uint64_t seed,
                                 int levels = 4);

struct SobolIndex {
    double first = 0, total = 0;                                          ///< S_i, S_Ti [-]
    double first_error = 0, total_error = 0;                              ///< standard errors
    double first_low = 0, first_high = 0, total_low = 0, total_high = 0;  ///< 95 % intervals
};
struct SobolIndices {
    std::vector<std::vector<SobolIndex>> index;  ///< [input][output]; all 0 where the output does not vary
    std::vector<double> mean, variance;          ///< of the outputs
    int rows = 0;                                ///< complete ones
    int evaluations = 0, failed = 0;
};
/// (inputs + 2) n evaluations; n >= 2.
SobolIndices sobol_indices(const UnitModel& model, int inputs, int n, std::uint64_t seed);

}  // namespace gradwright
