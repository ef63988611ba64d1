// With F the standard normal distribution, mu_v = ln D50, sigma = ln(D90/D10)/2.5631 (physics.md 2):
//   volume share below d   (F(z_v(d)) - F(z_v(low))) / (F(z_v(high)) - F(z_v(low))),  z_v(d) = (ln d -
//   mu_v)/sigma number density         ~ volume density / d^3: again log-normal with the same sigma, mu_n =
//   mu_v - 3 sigma^2, same cuts mean grain volume      pi/6 E_n[d^3] = pi/6 exp(3 mu_n + 9/2 sigma^2) (volume
//   share kept) / (number share kept)
#include "dem/size_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dem/random.h"

namespace gradwright {
namespace {

double normal_cdf(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Inverse of normal_cdf: start within 4.5e-4 (Abramowitz and Stegun 26.2.23), then two Halley steps, each of
/// third order, which leaves rounding only.
double normal_quantile(double p) {
    if (p <= 0) return -40;
    if (p >= 1) return 40;
    const double t = std::sqrt(-2 * std::log(std::min(p, 1 - p)));
    double z =
        t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    if (p < 0.5) z = -z;
    for (int step = 0; step < 2; ++step) {
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        const double newton = (normal_cdf(z) - p) / density;
        z -= newton / (1 + 0.5 * z * newton);
    }
    return z;
}

/// Share kept by the cuts below and above for a log-normal with this log-median.
struct CutNormal {
    double log_median, sigma, share_low, share_high;
    CutNormal(const SizeDistribution& size, double log_median_)
        : log_median(log_median_),
          sigma(size.sigma()),
          share_low(normal_cdf((std::log(size.cut_low) - log_median) / sigma)),
          share_high(normal_cdf((std::log(size.cut_high) - log_median) / sigma)) {}
    double kept() const { return share_high - share_low; }
    double quantile(double p) const {
        return std::exp(log_median + sigma * normal_quantile(share_low + p * (share_high - share_low)));
    }
};

CutNormal by_volume(const SizeDistribution& size) {
    return {size, std::log(size.d50)};
}
CutNormal by_number(const SizeDistribution& size) {
    return {size, std::log(size.d50) - 3 * size.sigma() * size.sigma()};
}

}  // namespace

double SizeDistribution::sigma() const {
    return std::log(d90 / d10) / 2.5631031310892007;
}

double SizeDistribution::volume_quantile(double p) const {
    if (sigma() <= 0) return std::clamp(d50, cut_low, cut_high);  // one size
    return std::clamp(by_volume(*this).quantile(p), cut_low, cut_high);
}

double SizeDistribution::number_quantile(double p) const {
    if (sigma() <= 0) return std::clamp(d50, cut_low, cut_high);
    return std::clamp(by_number(*this).quantile(p), cut_low, cut_high);
}

double SizeDistribution::mean_grain_volume() const {
    const double s = sigma();
    if (s <= 0) return std::numbers::pi / 6 * std::pow(std::clamp(d50, cut_low, cut_high), 3);
    const CutNormal number = by_number(*this);
    return std::numbers::pi / 6 * std::exp(3 * number.log_median + 4.5 * s * s) * by_volume(*this).kept() /
           number.kept();
}

std::vector<double> SizeDistribution::draw(std::size_t count, std::uint64_t seed) const {
    Random random(seed);
    std::vector<double> diameters(count);
    for (std::size_t k = 0; k < count; ++k) {
        diameters[k] =
            number_quantile((static_cast<double>(k) + random.uniform()) / static_cast<double>(count));
    }
    for (std::size_t k = count; k > 1; --k) std::swap(diameters[k - 1], diameters[random.below(k)]);
    return diameters;
}

Quantiles volume_quantiles(std::vector<double> diameters) {
    if (diameters.empty()) return {};
    std::sort(diameters.begin(), diameters.end());
    double total = 0;
    for (double d : diameters) total += d * d * d;
    // each grain stands at the middle of its own share of the volume; linear between grains
    const auto quantile = [&](double p) {
        double below = 0, share_before = 0, d_before = diameters.front();
        for (double d : diameters) {
            const double share = (below + 0.5 * d * d * d) / total;
            if (share >= p) {
                const double span = share - share_before;
                return d_before + (d - d_before) * (span > 0 ? (p - share_before) / span : 1.0);
            }
            below += d * d * d;
            share_before = share;
            d_before = d;
        }
        return diameters.back();
    };
    return {quantile(0.1), quantile(0.5), quantile(0.9)};
}

}  // namespace gradwright
