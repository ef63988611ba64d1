#include "optimise/composition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "targets/misfit.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double share_of(const Material& alloy, const std::string& element) {
    for (const ElementShare& share : alloy.composition)
        if (share.element == element) return share.wt_percent;
    return 0;
}

/// m(y) with its band -> every element: linear, so a band's ends go to a band's ends.
Composition with_elements(std::vector<double> y, BandedProfile m, const std::array<Material, 2>& alloys) {
    Composition out;
    out.y_m = std::move(y);
    std::vector<std::string> names = {"Fe", "Ni"};
    for (const Material& alloy : alloys)
        for (const ElementShare& share : alloy.composition)
            if (std::find(names.begin(), names.end(), share.element) == names.end())
                names.push_back(share.element);
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
        return std::max(share_of(alloys[0], a), share_of(alloys[1], a)) >
               std::max(share_of(alloys[0], b), share_of(alloys[1], b));
    });
    for (const std::string& name : names) {
        const double a = share_of(alloys[0], name), b = share_of(alloys[1], name);
        ElementProfile profile{name, {}};
        for (std::size_t i = 0; i < m.value.size(); ++i) {
            const double one = m.low[i] * a + (1 - m.low[i]) * b, other = m.high[i] * a + (1 - m.high[i]) * b;
            profile.wt.value.push_back(m.value[i] * a + (1 - m.value[i]) * b);
            profile.wt.low.push_back(a >= b ? one : other);
            profile.wt.high.push_back(a >= b ? other : one);
        }
        out.elements.push_back(std::move(profile));
    }
    out.mass_fraction_a = std::move(m);
    return out;
}

void need_compositions(const std::array<Material, 2>& alloys) {
    for (const Material& alloy : alloys)
        if (alloy.composition.empty())
            throw std::invalid_argument(fmt::format(
                "the composition of {} is not known: give its material a composition", alloy.name));
}

double at(const std::vector<double>& values, std::size_t i) {
    return i < values.size() ? values[i] : kNan;
}

}  // namespace

double mass_fraction_a(double gi, double density_a, double density_b) {
    return density_a * gi / (density_a * gi + density_b * (1 - gi));
}

double MeltPool::base_share(int layer) const {
    return std::pow(1 - new_share(), layer);
}

double MeltPool::scatter_factor() const {
    return std::sqrt(new_share() / (2 - new_share()));
}

const BandedProfile& Composition::wt(const std::string& element) const {
    for (const ElementProfile& profile : elements)
        if (profile.element == element) return profile.wt;
    throw std::out_of_range("no element " + element);
}

double band_factor(const GradationProfile& profile) {
    return simultaneous_band(profile.gi, profile.standard_error, profile.degrees).factor;
}

Composition powder_composition(const GradationProfile& profile, const std::array<Material, 2>& alloys,
                               double factor) {
    need_compositions(alloys);
    BandedProfile m;
    for (std::size_t b = 0; b < profile.gi.size(); ++b) {
        const double g = profile.gi[b], half = factor * at(profile.standard_error, b);
        const auto mass = [&](double gi) {
            // clamping must not turn an undefined number into one: std::max(0, NaN) is 0
            return std::isnan(gi)
                       ? kNan
                       : mass_fraction_a(std::clamp(gi, 0.0, 1.0), alloys[0].density, alloys[1].density);
        };
        m.value.push_back(mass(g));
        m.low.push_back(mass(g - half));
        m.high.push_back(mass(g + half));
    }
    return with_elements(profile.y_m, std::move(m), alloys);
}

Composition melted_composition(const GradationProfile& profile, const std::array<Material, 2>& alloys,
                               double factor, const MeltPool& pool) {
    need_compositions(alloys);
    if (!(pool.layer_thickness > 0) || !(pool.width > 0) || !(pool.depth >= pool.layer_thickness))
        throw std::invalid_argument(
            "melt pool: width and layer thickness must be above 0, depth at least the layer thickness");
    const std::size_t bins = profile.gi.size();
    const double step = bins > 1 ? profile.y_m[1] - profile.y_m[0] : pool.width;
    const double density_a = alloys[0].density, density_b = alloys[1].density;
    std::vector<double> m(bins, kNan), half(bins, kNan), mass(bins, 0);
    for (std::size_t b = 0; b < bins; ++b) {
        const double g = profile.gi[b];
        if (std::isnan(g)) continue;
        m[b] = mass_fraction_a(g, density_a, density_b);
        const double density = density_a * g + density_b * (1 - g);
        // dm/dg = rA rB / (rA g + rB (1 - g))^2
        half[b] = factor * at(profile.standard_error, b) * density_a * density_b / (density * density);
        // a profile without volumes (a model, not a spread) counts as evenly deep
        mass[b] = density * (profile.volume.empty() ? 1 : at(profile.volume, b));
    }
    BandedProfile out;
    for (std::size_t b = 0; b < bins; ++b) {
        const double low = profile.y_m[b] - 0.5 * std::max(pool.width, step),
                     high = profile.y_m[b] + 0.5 * std::max(pool.width, step);
        double sum = 0, weight = 0, square = 0;
        for (std::size_t k = 0; k < bins; ++k) {
            const double overlap =
                std::min(high, profile.y_m[k] + 0.5 * step) - std::max(low, profile.y_m[k] - 0.5 * step);
            // rounding leaves 1e-20 m of a neighbour in a window that ends at its edge
            if (overlap <= 1e-9 * step || !(mass[k] > 0)) continue;
            const double w = overlap * mass[k];
            sum += w * m[k];
            weight += w;
            square += w * w * half[k] * half[k];
        }
        // a window over nothing but empty bins, or centred in one, says nothing
        const bool known = weight > 0 && !std::isnan(m[b]);
        const double value = known ? sum / weight : kNan, band = known ? std::sqrt(square) / weight : kNan;
        out.value.push_back(value);
        out.low.push_back(std::isnan(band) ? kNan : std::max(0.0, value - band));
        out.high.push_back(std::isnan(band) ? kNan : std::min(1.0, value + band));
    }
    return with_elements(profile.y_m, std::move(out), alloys);
}

}  // namespace gradwright
