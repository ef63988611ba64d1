#include "dem/homogeneous_estimator.h"

#include <limits>
#include <numeric>
#include <optional>

#include "dem/block_variance.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A curve that is a function of x, and on which side of it A stands.
struct SideOverX {
    bool over_x = false, a_above = true;
    CurveOverX<double> curve{{}, {}};

    explicit SideOverX(std::vector<PlanPoint> points) {
        const auto rises = [](PlanPoint a, PlanPoint b) {
            return a.x >= b.x;
        };  // adjacent_find: first that does not rise
        if (points.back().x < points.front().x) {
            std::reverse(points.begin(), points.end());
            a_above = false;
        }
        over_x = std::adjacent_find(points.begin(), points.end(), rises) == points.end();
        if (!over_x) return;
        std::vector<double> x, y;
        for (PlanPoint p : points) {
            x.push_back(p.x);
            y.push_back(p.y);
        }
        curve = CurveOverX<double>(x, y);
    }

    /// Share of every bin on A's side for a grain from origin_x that travelled `way` across.
    void of_grain(double origin_x, double way, const BinGrid& bins, double smoothing,
                  std::vector<double>& share) const {
        double yc = 0, widening = 1;
        curve.evaluate(origin_x, yc, widening);
        std::fill(share.begin(), share.end(), 0.0);
        const int filled = visit_bins<double>(bins, yc + way, smoothing * widening,
                                              [&](int bin, double part) { share[bin] = part; });
        std::fill(share.begin() + std::min(filled, bins.count), share.end(), 1.0);
        if (!a_above) {
            for (double& s : share) s = 1 - s;
        }
    }
};

/// Shares of a bin that lie on A's side for one grain at a time. A curve that is a function of x is a single
/// comparison in y and is averaged over the bin exactly; any other curve is sampled at `samples_per_bin`
/// points with its exact signed distance. Of a pair the shares add up as the areas do (partition.cpp).
class LabelShares {
  public:
    LabelShares(const PartitionCurve& partition, const BinGrid& bins, const HomogeneousOptions& options)
        : partition_(partition), bins_(bins), options_(options), first_(partition.points) {
        over_x_ = first_.over_x;
        if (partition.second.empty()) return;
        second_.emplace(partition.second);
        over_x_ = over_x_ && second_->over_x;
        of_second_.resize(bins.count);
        both_ = partition.a_between() ? 1 : 0;
    }

    /// share of every bin for grain i, and where they are mirrored half for its mirror image.
    void of_grain(const PooledGrains& grains, std::size_t i, std::vector<double>& share) {
        of_way(grains.origin_x[i], grains.way[i], share);
        if (!grains.mirrored) return;
        of_image_.resize(share.size());
        of_way(grains.origin_x[i], -grains.way[i], of_image_);
        for (std::size_t bin = 0; bin < share.size(); ++bin) share[bin] = 0.5 * (share[bin] + of_image_[bin]);
    }

  private:
    /// Of a grain from origin_x that travelled `way` across.
    void of_way(double origin_x, double way, std::vector<double>& share) {
        if (over_x_) {
            first_.of_grain(origin_x, way, bins_, options_.smoothing, share);
            if (!second_) return;
            second_->of_grain(origin_x, way, bins_, options_.smoothing, of_second_);
            for (std::size_t bin = 0; bin < share.size(); ++bin) share[bin] += of_second_[bin] - both_;
            return;
        }
        const int samples = std::max(1, options_.samples_per_bin);
        for (int bin = 0; bin < bins_.count; ++bin) {
            double sum = 0;
            for (int k = 0; k < samples; ++k) {
                const double y = bins_.low(bin) + bins_.width * (k + 0.5) / samples;
                sum += step(partition_.signed_distance(origin_x, y - way));
            }
            share[bin] = sum / samples;
        }
    }
    double step(double distance) const {
        if (options_.smoothing <= 0) return distance > 0 ? 1 : 0;
        const double s = std::clamp(0.5 * (1 + distance / options_.smoothing), 0.0, 1.0);
        return s * s * s * (10 + s * (6 * s - 15));
    }

    const PartitionCurve& partition_;
    const BinGrid& bins_;
    const HomogeneousOptions& options_;
    SideOverX first_;
    std::optional<SideOverX> second_;
    std::vector<double> of_second_, of_image_;
    double both_ = 0;  ///< counted twice where A stands between the curves
    bool over_x_ = false;
};

/// Moments of every bin; blocks are the layers when there are >= 3 (packing replicates), else blocks of x in
/// each layer.
std::vector<BinMoments> moments_of(const PooledGrains& grains, LabelShares& shares, const BinGrid& bins,
                                   double block) {
    const bool by_layer = grains.replicates();
    const int cuts = by_layer ? 1 : block_count(grains.x_low, grains.x_high, block);
    std::vector<BinMoments> moments(bins.count, BinMoments(grains.layers * cuts));
    std::vector<double> share(bins.count);
    for (std::size_t i = 0; i < grains.size(); ++i) {
        shares.of_grain(grains, i, share);
        const double along = (grains.deposit_x[i] - grains.x_low) / (grains.x_high - grains.x_low);
        const int cell = grains.layer[i] * cuts + std::min(cuts - 1, static_cast<int>(along * cuts));
        const double volume = grains.volume[i];
        for (int bin = 0; bin < bins.count; ++bin) {
            if (grains.carries_a.empty())
                moments[bin].add(cell, grains.deposit_x[i], volume, share[bin]);
            else if (grains.carries_a[i])
                moments[bin].add(cell, grains.deposit_x[i], volume * share[bin], 1);
            else
                moments[bin].add(cell, grains.deposit_x[i], volume * (1 - share[bin]), 0);
        }
    }
    return moments;
}

BlockTrend trend_of(const PooledGrains& grains) {
    return grains.replicates() ? BlockTrend::none : BlockTrend::linear;
}

/// Means of every bin without moments: the fast path of a search.
std::vector<double> means_of(const PooledGrains& grains, LabelShares& shares, const BinGrid& bins) {
    std::vector<double> mean(bins.count, 0), share(bins.count), of_b(bins.count, 0);
    const bool by_powder = !grains.carries_a.empty();
    for (std::size_t i = 0; i < grains.size(); ++i) {
        shares.of_grain(grains, i, share);
        if (!by_powder || grains.carries_a[i])
            for (int bin = 0; bin < bins.count; ++bin) mean[bin] += grains.volume[i] * share[bin];
        else
            for (int bin = 0; bin < bins.count; ++bin) of_b[bin] += grains.volume[i] * (1 - share[bin]);
    }
    const double all = grains.total_volume();
    for (int bin = 0; bin < bins.count; ++bin) {
        const double total = by_powder ? mean[bin] + of_b[bin] : all;
        mean[bin] = total > 0 ? mean[bin] / total : kNan;
    }
    return mean;
}

}  // namespace

bool PooledGrains::replicates() const {
    if (layers < 3) return false;
    std::vector<double> of_layer(layers, 0.0);
    for (std::size_t i = 0; i < size(); ++i) of_layer[layer[i]] += volume[i];
    const auto [least, most] = std::minmax_element(of_layer.begin(), of_layer.end());
    return *most < 2 * *least;
}

double PooledGrains::total_volume() const {
    return std::accumulate(volume.begin(), volume.end(), 0.0);
}

PooledGrains pool_grains(std::span<const Layer> layers, double x_low, double x_high,
                         std::span<const double> share) {
    PooledGrains pooled;
    pooled.x_low = x_low;
    pooled.x_high = x_high;
    pooled.layers = static_cast<int>(layers.size());
    for (int l = 0; l < pooled.layers; ++l) {
        const Layer& layer = layers[l];
        if (!share.empty() && !(share[l] > 0)) continue;
        const std::size_t first = pooled.size();
        for (std::size_t i = 0; i < layer.size(); ++i) {
            if (!(layer.deposit_x[i] >= x_low && layer.deposit_x[i] < x_high)) continue;
            pooled.origin_x.push_back(layer.origin_x[i]);
            pooled.way.push_back(layer.deposit_y[i] - layer.origin_y[i]);
            pooled.deposit_x.push_back(layer.deposit_x[i]);
            pooled.volume.push_back(layer.volume[i]);
            pooled.layer.push_back(l);
        }
        if (share.empty()) continue;
        const auto own = std::span(pooled.volume).subspan(first);
        const double sum = std::accumulate(own.begin(), own.end(), 0.0);
        for (double& volume : own) volume *= share[l] / sum;
    }
    return pooled;
}

namespace {

/// Share of the width on A's side of the dispenser's x, by a table over its length.
class SideShare {
  public:
    SideShare(const PartitionCurve& partition, double length, double width) : length_(length) {
        constexpr int kColumns = 256, kRows = 128;
        for (int column = 0; column <= kColumns; ++column) {
            int above = 0;
            for (int row = 0; row < kRows; ++row)
                above += partition.on_side_a(length * column / kColumns, width * (row + 0.5) / kRows);
            share_.push_back(static_cast<double>(above) / kRows);
        }
    }
    double at(double x) const {
        const auto last = static_cast<double>(share_.size() - 1);
        const double place = std::clamp(x / length_, 0.0, 1.0) * last;
        const double k = std::min(std::floor(place), last - 1);
        const auto left = static_cast<std::size_t>(k);
        return share_[left] + (place - k) * (share_[left + 1] - share_[left]);
    }

  private:
    double length_;
    std::vector<double> share_;
};

template <class Take>
PooledGrains only(const PooledGrains& grains, Take&& take) {
    PooledGrains part;
    part.x_low = grains.x_low;
    part.x_high = grains.x_high;
    part.layers = grains.layers;
    part.mirrored = grains.mirrored;
    for (std::size_t i = 0; i < grains.size(); ++i) {
        if (!take(i)) continue;
        part.origin_x.push_back(grains.origin_x[i]);
        part.way.push_back(grains.way[i]);
        part.deposit_x.push_back(grains.deposit_x[i]);
        part.volume.push_back(grains.volume[i]);
        part.layer.push_back(grains.layer[i]);
        if (!grains.carries_a.empty()) part.carries_a.push_back(grains.carries_a[i]);
    }
    return part;
}

}  // namespace

PooledGrains pool_powders(std::span<const Layer> layers, std::span<const BedPowders> beds, double x_low,
                          double x_high) {
    PooledGrains pooled = pool_grains(layers, x_low, x_high);
    double width[2] = {0, 0};  // of all beds in which B, A stood
    for (std::size_t l = 0; l < layers.size(); ++l)
        for (const bool a : {false, true})
            if (beds[l].both() || beds[l].a == a) width[a] += layers[l].width;
    std::size_t k = 0;
    for (std::size_t l = 0; l < layers.size(); ++l) {
        const Layer& layer = layers[l];
        std::optional<SideShare> side;
        if (beds[l].both()) side.emplace(beds[l].partition, layer.dispenser_length, layer.width);
        for (std::size_t i = 0; i < layer.size(); ++i) {
            if (!(layer.deposit_x[i] >= x_low && layer.deposit_x[i] < x_high)) continue;
            const bool a = side ? layer.is_a[i] != 0 : beds[l].a;
            double share = 1;
            if (side) {
                const double above = side->at(layer.origin_x[i]);
                share = std::max(a ? above : 1 - above, kLeastShare);
            }
            pooled.volume[k++] /= share * width[a];
            pooled.carries_a.push_back(a);
        }
    }
    return pooled;
}

PooledGrains pool_map(std::span<const Layer> layers, std::span<const double> share,
                      std::span<const BedPowders> beds, bool alike, double x_low, double x_high) {
    PooledGrains pooled =
        beds.empty() ? pool_grains(layers, x_low, x_high, share) : pool_powders(layers, beds, x_low, x_high);
    pooled.mirrored = alike && beds.empty();
    return pooled;
}

PooledGrains powder_of(const PooledGrains& grains, bool a) {
    PooledGrains part = only(grains, [&](std::size_t i) { return (grains.carries_a[i] != 0) == a; });
    part.carries_a.clear();
    return part;
}

PooledGrains part_of(const PooledGrains& grains, double x_low, double x_high) {
    PooledGrains part = only(
        grains, [&](std::size_t i) { return grains.deposit_x[i] >= x_low && grains.deposit_x[i] < x_high; });
    part.x_low = x_low;
    part.x_high = x_high;
    return part;
}

Thirds thirds_of(const PooledGrains& grains) {
    const double third = (grains.x_high - grains.x_low) / 3;
    return {part_of(grains, grains.x_low, grains.x_low + third),
            part_of(grains, grains.x_high - third, grains.x_high)};
}

GradationProfile homogeneous_profile(const PooledGrains& grains, const PartitionCurve& partition,
                                     const BinGrid& bins, const HomogeneousOptions& options) {
    LabelShares shares(partition, bins, options);
    if (options.resamples > 0) {
        const std::vector<BinMoments> moments = moments_of(grains, shares, bins, options.block);
        return profile_of(moments, bin_variances(moments, trend_of(grains), BinGrains::common), bins);
    }
    GradationProfile profile;
    profile.gi = means_of(grains, shares, bins);
    const double total = grains.total_volume();
    double square = 0;
    for (double v : grains.volume) square += v * v;
    for (int bin = 0; bin < bins.count; ++bin) profile.y_m.push_back(bins.centre(bin));
    profile.standard_error.assign(bins.count, kNan);
    profile.volume.assign(bins.count, total);
    profile.n_eff.assign(bins.count, square > 0 ? total * total / square : 0);
    return profile;
}

XDrift homogeneous_drift(const PooledGrains& grains, const PartitionCurve& partition, const BinGrid& bins,
                         const HomogeneousOptions& options) {
    LabelShares shares(partition, bins, options);
    const Thirds thirds = thirds_of(grains);
    if (options.resamples <= 0) {
        XDrift drift;
        const std::vector<double> first = means_of(thirds.first, shares, bins);
        drift.difference = means_of(thirds.last, shares, bins);
        for (int bin = 0; bin < bins.count; ++bin) drift.difference[bin] -= first[bin];
        drift.standard_error.assign(bins.count, kNan);
        summarise(drift);
        drift.noise_floor = kNan;
        return drift;
    }
    const std::vector<BinMoments> whole = moments_of(grains, shares, bins, options.block);
    return drift_of(whole, bin_variances(whole, trend_of(grains), BinGrains::common),
                    moments_of(thirds.first, shares, bins, options.block),
                    moments_of(thirds.last, shares, bins, options.block));
}

std::vector<PooledGrains> columns_of(const PooledGrains& grains, int columns) {
    std::vector<PooledGrains> parts;
    const double width = (grains.x_high - grains.x_low) / columns;
    for (int column = 0; column < columns; ++column)
        parts.push_back(part_of(grains, grains.x_low + column * width,
                                column + 1 == columns ? grains.x_high : grains.x_low + (column + 1) * width));
    return parts;
}

GradationField homogeneous_field(const PooledGrains& grains, const PartitionCurve& partition,
                                 const BinGrid& bins, int columns, const HomogeneousOptions& options) {
    LabelShares shares(partition, bins, options);
    const std::vector<PooledGrains> parts = columns_of(grains, columns);
    std::vector<std::vector<BinMoments>> of_column;
    if (options.resamples > 0) {
        for (const PooledGrains& part : parts)
            of_column.push_back(moments_of(part, shares, bins, options.block));
        if (grains.replicates() &&
            std::all_of(parts.begin(), parts.end(), [](const PooledGrains& p) { return p.replicates(); }))
            return field_of(of_column, bins, grains.x_low, grains.x_high);
        const std::vector<BinMoments> whole = moments_of(grains, shares, bins, options.block);
        return field_of(whole, bin_variances(whole, trend_of(grains), BinGrains::common), of_column, bins,
                        grains.x_low, grains.x_high);
    }
    GradationField field;
    for (std::size_t column = 0; column < parts.size(); ++column) {
        const GradationProfile profile = homogeneous_profile(parts[column], partition, bins, options);
        field.x_m.push_back(grains.x_low +
                            (static_cast<double>(column) + 0.5) * ((grains.x_high - grains.x_low) / columns));
        field.y_m = profile.y_m;
        const auto add = [](std::vector<double>& all, const std::vector<double>& more) {
            all.insert(all.end(), more.begin(), more.end());
        };
        add(field.cells.y_m, profile.y_m);
        add(field.cells.gi, profile.gi);
        add(field.cells.standard_error, profile.standard_error);
        add(field.cells.volume, profile.volume);
        add(field.cells.n_eff, profile.n_eff);
    }
    return field;
}

GradationProfile homogeneous_profile(std::span<const Layer> layers, const PartitionCurve& partition,
                                     double x_low, double x_high, const BinGrid& bins,
                                     const HomogeneousOptions& options) {
    return homogeneous_profile(pool_grains(layers, x_low, x_high), partition, bins, options);
}

XDrift homogeneous_drift(std::span<const Layer> layers, const PartitionCurve& partition, double x_low,
                         double x_high, const BinGrid& bins, const HomogeneousOptions& options) {
    return homogeneous_drift(pool_grains(layers, x_low, x_high), partition, bins, options);
}

}  // namespace gradwright
