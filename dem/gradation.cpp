#include "dem/gradation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem/block_variance.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// y in [0, W) for periodic layers, as it is otherwise.
double wrapped(const Layer& layer, double y) {
    if (!layer.periodic || layer.width <= 0) return y;
    const double inside = y - layer.width * std::floor(y / layer.width);
    return inside < layer.width ? inside : 0;  // -1e-30 wraps to W itself by rounding
}

/// Bin of y, half-open; -1 outside the grid.
int bin_of(const BinGrid& bins, double y) {
    int bin = static_cast<int>(std::floor(y / bins.width));
    while (y < bins.low(bin)) --bin;
    while (y >= bins.low(bin + 1)) ++bin;
    return bin < bins.count && bin >= 0 ? bin : -1;
}

/// A bin counts when it lies wholly inside the footprint (to a millionth of its width).
bool counts(const BinGrid& bins, int bin, const Footprint& footprint) {
    const double slack = 1e-6 * bins.width;
    return bins.low(bin) >= footprint.y_low - slack && bins.low(bin + 1) <= footprint.y_high + slack;
}

/// Moments of every bin over deposit_x in [x_low, x_high), blocks cut over the same range.
std::vector<BinMoments> plain_moments(const Layer& layer, std::span<const double> label,
                                      const Footprint& footprint, const BinGrid& bins, double x_low,
                                      double x_high, int blocks) {
    std::vector<BinMoments> moments(bins.count, BinMoments(blocks));
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const double x = layer.deposit_x[i];
        if (!(x >= x_low && x < x_high)) continue;
        const int bin = bin_of(bins, wrapped(layer, layer.deposit_y[i]));
        if (bin < 0 || !counts(bins, bin, footprint)) continue;
        const int block = std::min(blocks - 1, static_cast<int>((x - x_low) / (x_high - x_low) * blocks));
        moments[bin].add(block, x, layer.volume[i], label[i]);
    }
    return moments;
}

}  // namespace

std::vector<double> hard_labels(const Layer& layer, const PartitionCurve& partition) {
    std::vector<double> label(layer.size());
    for (std::size_t i = 0; i < label.size(); ++i) {
        label[i] = partition.on_side_a(layer.origin_x[i], wrapped(layer, layer.origin_y[i])) ? 1 : 0;
    }
    return label;
}

std::vector<double> carried_labels(const Layer& layer) {
    return {layer.is_a.begin(), layer.is_a.end()};
}

GradationProfile plain_profile(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                               const BinGrid& bins, std::uint64_t /*seed*/, double block, int resamples) {
    const int blocks = block_count(footprint.x_low, footprint.x_high, block);
    const std::vector<BinMoments> moments =
        plain_moments(layer, label, footprint, bins, footprint.x_low, footprint.x_high, blocks);
    return profile_of(moments,
                      resamples > 0 ? bin_variances(moments, BlockTrend::linear, BinGrains::own)
                                    : unknown_variances(bins.count),
                      bins);
}

XDrift plain_drift(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                   const BinGrid& bins, std::uint64_t /*seed*/, double block, int resamples) {
    const double low = footprint.x_low, high = footprint.x_high, third = (high - low) / 3;
    const std::vector<BinMoments> whole =
        plain_moments(layer, label, footprint, bins, low, high, block_count(low, high, block));
    const BinVariances variance = resamples > 0 ? bin_variances(whole, BlockTrend::linear, BinGrains::own)
                                                : unknown_variances(bins.count);
    return drift_of(whole, variance, plain_moments(layer, label, footprint, bins, low, low + third, 1),
                    plain_moments(layer, label, footprint, bins, high - third, high, 1));
}

GradationField plain_field(const Layer& layer, std::span<const double> label, const Footprint& footprint,
                           const BinGrid& bins, int columns, double block) {
    const double low = footprint.x_low, width = (footprint.x_high - low) / columns;
    const std::vector<BinMoments> whole = plain_moments(layer, label, footprint, bins, low, footprint.x_high,
                                                        block_count(low, footprint.x_high, block));
    std::vector<std::vector<BinMoments>> of_column;
    for (int column = 0; column < columns; ++column)
        of_column.push_back(
            plain_moments(layer, label, footprint, bins, low + column * width,
                          column + 1 == columns ? footprint.x_high : low + (column + 1) * width, 1));
    return field_of(whole, bin_variances(whole, BlockTrend::linear, BinGrains::own), of_column, bins, low,
                    footprint.x_high);
}

GradationMap gradation_map(const Layer& layer, std::span<const double> label,
                           const std::vector<double>& density_kg_m3_a_b, double cell, double width) {
    if (width <= 0) width = layer.width;
    const int columns = std::max(1, static_cast<int>(std::ceil(layer.platform_length / cell - 1e-6)));
    const int rows = std::max(1, static_cast<int>(std::ceil(width / cell - 1e-6)));
    const BinGrid over_x{cell, columns}, over_y{cell, rows};
    GradationMap map;
    for (int column = 0; column < columns; ++column) map.x_m.push_back(over_x.centre(column));
    for (int row = 0; row < rows; ++row) map.y_m.push_back(over_y.centre(row));
    std::vector<double> volume(columns * rows, 0), volume_a(columns * rows, 0);
    map.gi.assign(columns * rows, kNan);
    map.mass_kg.assign(columns * rows, 0);
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const int column = bin_of(over_x, layer.deposit_x[i]);
        const int row = bin_of(over_y, wrapped(layer, layer.deposit_y[i]));
        if (column < 0 || row < 0) continue;
        const int at = row * columns + column;
        volume[at] += layer.volume[i];
        volume_a[at] += layer.volume[i] * label[i];
        map.mass_kg[at] +=
            layer.volume[i] * (label[i] * density_kg_m3_a_b[0] + (1 - label[i]) * density_kg_m3_a_b[1]);
    }
    for (int at = 0; at < columns * rows; ++at) {
        if (volume[at] > 0) map.gi[at] = volume_a[at] / volume[at];
    }
    return map;
}

double coverage(const Layer& layer, const Footprint& footprint, double cell) {
    // equal cells of about the size asked for, so that no part of the footprint is left out
    const double length = footprint.x_high - footprint.x_low, width = footprint.y_high - footprint.y_low;
    const int columns = std::max(1, static_cast<int>(std::lround(length / cell)));
    const int rows = std::max(1, static_cast<int>(std::lround(width / cell)));
    std::vector<double> volume(columns * rows, 0);
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const double x = layer.deposit_x[i], y = wrapped(layer, layer.deposit_y[i]);
        if (!(x >= footprint.x_low && x < footprint.x_high && y >= footprint.y_low && y < footprint.y_high))
            continue;
        const int column = std::min(columns - 1, static_cast<int>((x - footprint.x_low) / length * columns));
        const int row = std::min(rows - 1, static_cast<int>((y - footprint.y_low) / width * rows));
        volume[row * columns + column] += layer.volume[i];
    }
    // cells have one area, so depths compare as volumes do
    const double mean = std::accumulate(volume.begin(), volume.end(), 0.0) / (columns * rows);
    if (mean <= 0) return 0;
    const auto covered =
        std::count_if(volume.begin(), volume.end(), [&](double v) { return v > 0.5 * mean; });
    return static_cast<double>(covered) / (columns * rows);
}

double origin_x_quantile(std::span<const Layer> layers, double x_low, double x_high, double share) {
    std::vector<std::pair<double, double>> x_and_volume;
    double total = 0;
    for (const Layer& layer : layers) {
        for (std::size_t i = 0; i < layer.size(); ++i) {
            if (!(layer.deposit_x[i] >= x_low && layer.deposit_x[i] < x_high)) continue;
            x_and_volume.emplace_back(layer.origin_x[i], layer.volume[i]);
            total += layer.volume[i];
        }
    }
    if (x_and_volume.empty()) return kNan;
    std::sort(x_and_volume.begin(), x_and_volume.end());
    // each grain stands at the middle of its own share; linear between grains
    double below = 0, share_before = 0, x_before = x_and_volume.front().first;
    for (const auto& [x, volume] : x_and_volume) {
        const double here = (below + 0.5 * volume) / total;
        if (here >= share) {
            return x_before + (x - x_before) *
                                  (here > share_before ? (share - share_before) / (here - share_before) : 1);
        }
        below += volume;
        share_before = here;
        x_before = x;
    }
    return x_and_volume.back().first;
}

namespace {

/// Mean over the replicates that are defined, and its variance: between replicates when >= 3, else from
/// `variance` of each. The bins share what little 2 or 3 degrees say, in the shape of the replicates' own
/// variances (block_variance.h).
void average(std::span<const std::vector<double>> value, std::span<const std::vector<double>> variance,
             std::span<const double> own_degrees, std::vector<double>& mean, BinVariances& variance_of_mean) {
    const std::size_t bins = value.empty() ? 0 : value.front().size();
    mean.assign(bins, kNan);
    std::vector<double> between(bins, kNan), within(bins, kNan), degrees(bins, 0);
    for (std::size_t b = 0; b < bins; ++b) {
        double sum = 0, square = 0, own = 0;
        int n = 0;
        for (std::size_t r = 0; r < value.size(); ++r) {
            if (std::isnan(value[r][b])) continue;
            sum += value[r][b];
            own += variance[r][b];
            ++n;
        }
        if (n == 0) continue;
        mean[b] = sum / n;
        for (const std::vector<double>& v : value) {
            if (!std::isnan(v[b])) square += (v[b] - mean[b]) * (v[b] - mean[b]);
        }
        within[b] = own / (static_cast<double>(n) * n);
        degrees[b] = n - 1;
        between[b] = n > 1 ? square / (n - 1) / n : within[b];
    }
    // replicates that came without standard errors of their own have only what lies between them
    bool shape_known = true;
    for (std::size_t b = 0; b < bins; ++b) shape_known &= std::isnan(between[b]) || !std::isnan(within[b]);
    if (value.size() >= 3) {
        variance_of_mean = pooled_variances(between, shape_known ? within : between, degrees, BinGrains::own);
        return;
    }
    // degrees add up: each replicate brings its own estimate of the variances
    variance_of_mean = {within, std::accumulate(own_degrees.begin(), own_degrees.end(), 0.0)};
}

}  // namespace

GradationProfile mean_profile(std::span<const GradationProfile> replicates) {
    GradationProfile mean;
    if (replicates.empty()) return mean;
    std::vector<std::vector<double>> value, variance;
    std::vector<double> degrees;
    for (const GradationProfile& r : replicates) {
        value.push_back(r.gi);
        degrees.push_back(r.degrees);
        variance.push_back(r.standard_error);
        for (double& v : variance.back()) v *= v;
    }
    mean.y_m = replicates.front().y_m;
    BinVariances of_mean;
    average(value, variance, degrees, mean.gi, of_mean);
    mean.degrees = of_mean.degrees;
    mean.standard_error = of_mean.variance;
    mean.volume.assign(mean.gi.size(), 0);
    mean.n_eff.assign(mean.gi.size(), 0);
    for (std::size_t b = 0; b < mean.gi.size(); ++b) {
        for (const GradationProfile& r : replicates) {
            mean.volume[b] += r.volume[b];
            mean.n_eff[b] += r.n_eff[b];
        }
        mean.standard_error[b] = std::sqrt(std::max(mean.standard_error[b], plateau_variance(mean.n_eff[b])));
    }
    return mean;
}

GradationField mean_field(std::span<const GradationField> replicates) {
    GradationField mean;
    if (replicates.empty()) return mean;
    std::vector<GradationProfile> cells;
    for (const GradationField& replicate : replicates) cells.push_back(replicate.cells);
    mean = replicates.front();
    mean.cells = mean_profile(cells);
    return mean;
}

XDrift mean_drift(std::span<const XDrift> replicates) {
    XDrift mean;
    std::vector<std::vector<double>> value, variance;
    std::vector<double> degrees;
    for (const XDrift& r : replicates) {
        value.push_back(r.difference);
        degrees.push_back(r.degrees);
        variance.push_back(r.standard_error);
        for (double& v : variance.back()) v *= v;
    }
    BinVariances of_mean;
    average(value, variance, degrees, mean.difference, of_mean);
    mean.degrees = of_mean.degrees;
    for (double v : of_mean.variance) mean.standard_error.push_back(std::sqrt(v));
    summarise(mean);
    return mean;
}

}  // namespace gradwright
