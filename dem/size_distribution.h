// Grain size distribution: log-normal by volume, cut and renormalised by volume (physics.md 2).
//   sigma = ln(D90/D10)/2.5631 (2.5631 = 2 z_0.9); grains are drawn with weight 1/d^3, that is by number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace gradwright {

/// [m3] of a sphere of `radius` [m].
inline double sphere_volume(double radius) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

struct SizeDistribution {
    double d10 = 25e-6;       ///< asked for, by volume [m]
    double d50 = 40e-6;       ///< median by volume [m]
    double d90 = 62e-6;       ///< [m]
    double cut_low = 15e-6;   ///< smallest diameter kept [m]
    double cut_high = 80e-6;  ///< largest diameter kept [m]

    bool operator==(const SizeDistribution&) const = default;

    double sigma() const;  ///< log-normal width [-]
    /// Diameter below which the volume share p (0..1) lies, after the cut [m].
    double volume_quantile(double p) const;
    /// Diameter below which the number share p (0..1) lies, after the cut [m].
    double number_quantile(double p) const;
    /// Mean volume of one grain, by number, after the cut [m3].
    double mean_grain_volume() const;
    /// `count` diameters [m]: stratified draw over the number distribution (so that a small set already has
    /// the distribution's quantiles), in shuffled order; the same seed gives the same bits.
    std::vector<double> draw(std::size_t count, std::uint64_t seed) const;
};

struct Quantiles {
    double d10 = 0, d50 = 0, d90 = 0;
};
/// Volume quantiles of a made set of diameters [m].
Quantiles volume_quantiles(std::vector<double> diameters);

}  // namespace gradwright
