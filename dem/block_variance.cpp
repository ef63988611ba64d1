#include "dem/block_variance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gradwright {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPriorDegrees = 12;  // d0

struct Raw {
    double variance = 0, degrees = 0;
};

Raw raw_variance(const BinMoments& bin, BlockTrend trend) {
    const double total = bin.total(), p = bin.mean();
    const double x_mean = std::accumulate(bin.volume_x.begin(), bin.volume_x.end(), 0.0) / total;
    double sxx = 0, sxl = 0;
    int used = 0;
    for (std::size_t j = 0; j < bin.volume.size(); ++j) {
        if (bin.volume[j] <= 0) continue;
        ++used;
        const double dx = bin.volume_x[j] / bin.volume[j] - x_mean,
                     dl = bin.volume_label[j] / bin.volume[j] - p;
        sxx += bin.volume[j] * dx * dx;
        sxl += bin.volume[j] * dx * dl;
    }
    const double slope = trend == BlockTrend::linear && sxx > 0 ? sxl / sxx : 0;
    const int lost = trend == BlockTrend::linear ? 2 : 1;
    if (used <= lost) return {0, 0};
    double sum = 0;
    for (std::size_t j = 0; j < bin.volume.size(); ++j) {
        const double e =
            bin.volume_label[j] - p * bin.volume[j] - slope * (bin.volume_x[j] - x_mean * bin.volume[j]);
        sum += e * e;
    }
    return {sum / (total * total) * used / (used - lost), static_cast<double>(used - lost)};
}
}  // namespace

double BinMoments::total() const {
    return std::accumulate(volume.begin(), volume.end(), 0.0);
}

double BinMoments::mean() const {
    const double sum = total();
    return sum > 0 ? std::accumulate(volume_label.begin(), volume_label.end(), 0.0) / sum : kNan;
}

double BinMoments::n_eff() const {
    const double sum = total();
    return v2 > 0 ? sum * sum / v2 : 0;
}

double BinMoments::iid_variance() const {
    const double sum = total(), n = n_eff();
    if (sum <= 0) return 0;
    const double p = mean();
    const double seen = std::max(0.0, v2_label2 - 2 * p * v2_label + p * p * v2) / (sum * sum);
    if (p <= 0 || p >= 1) return seen;
    const double centred = (n * p + 2) / (n + 4);
    return seen * centred * (1 - centred) / (p * (1 - p)) * n / (n + 4);
}

double BinMoments::floor_variance() const {
    return plateau_variance(n_eff());
}

double plateau_variance(double n_eff) {
    if (n_eff <= 0) return kNan;
    const double p0 = 1 / (n_eff + 2);
    return p0 * (1 - p0) / n_eff;
}

BinVariances pooled_variances(const std::vector<double>& raw, const std::vector<double>& reference,
                              const std::vector<double>& degrees, BinGrains grains) {
    double raw_sum = 0, reference_sum = 0, reference_square = 0;
    for (std::size_t b = 0; b < raw.size(); ++b) {
        if (std::isnan(raw[b]) || std::isnan(reference[b]) || degrees[b] <= 0) continue;
        raw_sum += raw[b];
        reference_sum += reference[b];
        reference_square += reference[b] * reference[b];
    }
    const double design_effect = reference_sum > 0 ? raw_sum / reference_sum : 1;
    // as many bins of equal weight stand behind the design effect
    const double bins = grains == BinGrains::own && reference_square > 0
                            ? reference_sum * reference_sum / reference_square
                            : 1;
    BinVariances result{std::vector<double>(raw.size(), kNan), 0};
    double degrees_sum = 0;
    int defined = 0;
    for (std::size_t b = 0; b < raw.size(); ++b) {
        if (std::isnan(raw[b]) || std::isnan(reference[b])) continue;
        const double d = degrees[b], own = d / (d + kPriorDegrees);
        result.variance[b] = own * raw[b] + (1 - own) * design_effect * reference[b];
        // relative variance 2/degrees of the mix of raw_b (2/d) and the design effect (2/(d bins)), which
        // contains raw_b
        degrees_sum += d / (own * own + (1 - own) * (1 - own) / bins + 2 * own * (1 - own) / bins);
        ++defined;
    }
    result.degrees = defined > 0 ? degrees_sum / defined : 0;
    return result;
}

BinVariances bin_variances(const std::vector<BinMoments>& bins, BlockTrend trend, BinGrains grains) {
    std::vector<double> raw(bins.size(), kNan), reference(bins.size(), kNan), degrees(bins.size(), 0);
    for (std::size_t b = 0; b < bins.size(); ++b) {
        if (bins[b].total() <= 0) continue;
        const Raw r = raw_variance(bins[b], trend);
        raw[b] = r.variance;
        degrees[b] = r.degrees;
        reference[b] = bins[b].iid_variance();
    }
    BinVariances result = pooled_variances(raw, reference, degrees, grains);
    for (std::size_t b = 0; b < bins.size(); ++b) {
        if (!std::isnan(result.variance[b])) {
            result.variance[b] = std::max(result.variance[b], bins[b].floor_variance());
        }
    }
    return result;
}

BinVariances unknown_variances(int bins) {
    return {std::vector<double>(bins, kNan), 0};
}

int block_count(double x_low, double x_high, double block) {
    return std::max(5, static_cast<int>((x_high - x_low) / block + 1e-9));
}

GradationProfile profile_of(const std::vector<BinMoments>& moments, const BinVariances& variances,
                            const BinGrid& bins) {
    GradationProfile profile;
    profile.degrees = variances.degrees;
    for (int bin = 0; bin < bins.count; ++bin) {
        profile.y_m.push_back(bins.centre(bin));
        profile.gi.push_back(moments[bin].mean());
        profile.standard_error.push_back(std::sqrt(variances.variance[bin]));
        profile.volume.push_back(moments[bin].total());
        profile.n_eff.push_back(moments[bin].n_eff());
    }
    return profile;
}

namespace {
GradationField field_with(const std::vector<std::vector<BinMoments>>& columns, const BinVariances& variances,
                          const BinGrid& bins, double x_low, double x_high) {
    GradationField field;
    for (int bin = 0; bin < bins.count; ++bin) field.y_m.push_back(bins.centre(bin));
    field.cells.degrees = variances.degrees;
    const double width = (x_high - x_low) / static_cast<double>(columns.size());
    for (std::size_t column = 0; column < columns.size(); ++column) {
        field.x_m.push_back(x_low + (static_cast<double>(column) + 0.5) * width);
        for (int bin = 0; bin < bins.count; ++bin) {
            const BinMoments& cell = columns[column][bin];
            field.cells.y_m.push_back(bins.centre(bin));
            field.cells.gi.push_back(cell.mean());
            field.cells.standard_error.push_back(
                std::sqrt(variances.variance[column * bins.count + static_cast<std::size_t>(bin)]));
            field.cells.volume.push_back(cell.total());
            field.cells.n_eff.push_back(cell.n_eff());
        }
    }
    return field;
}
}  // namespace

GradationField field_of(const std::vector<BinMoments>& whole, const BinVariances& whole_variances,
                        const std::vector<std::vector<BinMoments>>& columns, const BinGrid& bins,
                        double x_low, double x_high) {
    BinVariances variances{{}, whole_variances.degrees};
    for (const std::vector<BinMoments>& column : columns)
        for (std::size_t b = 0; b < column.size(); ++b) {
            const double iid = whole[b].iid_variance();
            const double design_effect = iid > 0 ? whole_variances.variance[b] / iid : 1;
            variances.variance.push_back(
                column[b].total() > 0
                    ? std::max(design_effect * column[b].iid_variance(), column[b].floor_variance())
                    : kNan);
        }
    return field_with(columns, variances, bins, x_low, x_high);
}

GradationField field_of(const std::vector<std::vector<BinMoments>>& columns, const BinGrid& bins,
                        double x_low, double x_high) {
    std::vector<BinMoments> cells;
    for (const std::vector<BinMoments>& column : columns)
        cells.insert(cells.end(), column.begin(), column.end());
    return field_with(columns, bin_variances(cells, BlockTrend::none, BinGrains::common), bins, x_low,
                      x_high);
}

void summarise(XDrift& drift) {
    double square = 0, noise = 0;
    int bins = 0;
    for (std::size_t b = 0; b < drift.difference.size(); ++b) {
        if (std::isnan(drift.difference[b])) continue;
        square += drift.difference[b] * drift.difference[b];
        if (!std::isnan(drift.standard_error[b])) noise += drift.standard_error[b] * drift.standard_error[b];
        ++bins;
    }
    drift.value = bins > 0 ? std::sqrt(square / bins) : kNan;
    drift.noise_floor = bins > 0 ? std::sqrt(noise / bins) : kNan;
}

XDrift drift_of(const std::vector<BinMoments>& whole, const BinVariances& whole_variances,
                const std::vector<BinMoments>& first, const std::vector<BinMoments>& last) {
    XDrift drift;
    drift.degrees = whole_variances.degrees;
    for (std::size_t b = 0; b < whole.size(); ++b) {
        drift.difference.push_back(last[b].mean() - first[b].mean());
        const double iid = whole[b].iid_variance();
        const double design_effect = iid > 0 ? whole_variances.variance[b] / iid : 1;
        const double variance = std::max(design_effect * first[b].iid_variance(), first[b].floor_variance()) +
                                std::max(design_effect * last[b].iid_variance(), last[b].floor_variance());
        drift.standard_error.push_back(std::sqrt(variance));
    }
    summarise(drift);
    return drift;
}

}  // namespace gradwright
