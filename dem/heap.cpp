#include "dem/heap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "dem/size_distribution.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Sum over the loops through four neighbouring cell centres, anticlockwise.
struct Loops {
    double circulation = 0, area = 0;
};

Loops loops_of(const HeapField& field) {
    Loops sum;
    for (int k = 0; k + 1 < field.rows; ++k)
        for (int i = 0; i + 1 < field.columns; ++i) {
            const std::size_t corner[] = {field.at(i, k), field.at(i + 1, k), field.at(i + 1, k + 1),
                                          field.at(i, k + 1)};
            double circulation = 0, area = 0;
            for (int n = 0; n < 4; ++n) {
                const std::size_t p = corner[n], q = corner[(n + 1) % 4];
                circulation += 0.5 * ((field.vx[p] + field.vx[q]) * (field.mean_x[q] - field.mean_x[p]) +
                                      (field.vz[p] + field.vz[q]) * (field.mean_z[q] - field.mean_z[p]));
                area += 0.5 * (field.mean_x[p] * field.mean_z[q] - field.mean_x[q] * field.mean_z[p]);
            }
            if (std::isnan(circulation)) continue;  // a corner without powder
            sum.circulation += circulation;
            sum.area += area;
        }
    return sum;
}

HeapField empty_field(std::span<const Snapshot> instants, const HeapFieldOptions& options) {
    if (!(options.cell > 0) || !(options.width > 0))
        throw std::invalid_argument("heap field: cell and width must be above 0");
    HeapField field;
    field.cell = options.cell;
    field.z_low = options.z_low;
    field.width = options.width;
    field.instants = static_cast<int>(instants.size());
    if (!instants.empty()) {
        field.blade_low = instants.front().blade_x;
        field.blade_high = instants.back().blade_x;
    }
    return field;
}

}  // namespace

HeapField heap_field(std::span<const Snapshot> instants, const HeapFieldOptions& options) {
    HeapField field = empty_field(instants, options);
    double x_high = 0, z_high = options.z_low;
    for (const Snapshot& s : instants)
        for (std::size_t n = 0; n < s.x.size(); ++n) {
            if (s.x[n] <= s.blade_x) continue;
            x_high = std::max(x_high, s.x[n] - s.blade_x);
            z_high = std::max(z_high, double(s.z[n]));
        }
    if (!(x_high > 0) || !(z_high > options.z_low)) return field;
    field.columns = static_cast<int>(x_high / field.cell) + 1;
    field.rows = static_cast<int>((z_high - field.z_low) / field.cell) + 1;
    const std::size_t cells = static_cast<std::size_t>(field.columns) * field.rows;
    std::vector<double> volume(cells, 0), volume_a(cells, 0), grains(cells, 0);
    for (auto* numbers : {&field.vx, &field.vz, &field.mean_x, &field.mean_z}) numbers->assign(cells, 0);
    for (const Snapshot& s : instants)
        for (std::size_t n = 0; n < s.x.size(); ++n) {
            const double x = s.x[n] - s.blade_x;
            if (!(x > 0) || s.z[n] < field.z_low) continue;
            const std::size_t at = field.at(static_cast<int>(x / field.cell),
                                            static_cast<int>((s.z[n] - field.z_low) / field.cell));
            const double v = sphere_volume(s.radius[n]);
            volume[at] += v;
            if (s.is_a[n]) volume_a[at] += v;
            field.vx[at] += v * s.vx[n];
            field.vz[at] += v * s.vz[n];
            field.mean_x[at] += v * x;
            field.mean_z[at] += v * s.z[n];
            ++grains[at];
        }
    const double room = field.cell * field.cell * field.width * field.instants;
    const int least = options.least_grains > 0 ? options.least_grains : std::max(5, field.instants / 2);
    field.gi.assign(cells, kNan);
    field.solid_fraction.assign(cells, 0);
    int columns = 0, rows = 0;
    for (std::size_t at = 0; at < cells; ++at) {
        field.solid_fraction[at] = volume[at] / room;
        const bool enough = grains[at] >= least && field.solid_fraction[at] >= options.least_solid;
        for (auto* sums : {&field.vx, &field.vz, &field.mean_x, &field.mean_z})
            (*sums)[at] = enough ? (*sums)[at] / volume[at] : kNan;
        if (!enough) continue;
        field.gi[at] = volume_a[at] / volume[at];
        columns = std::max(columns, static_cast<int>(at % field.columns) + 1);
        rows = std::max(rows, static_cast<int>(at / field.columns) + 1);
    }
    // one grain thrown far ahead must not make the field long: cut behind the last defined cell
    HeapField cut = field;
    cut.columns = columns;
    cut.rows = rows;
    const auto cut_out = [&](const std::vector<double>& from, std::vector<double>& to) {
        to.clear();
        for (int k = 0; k < rows; ++k)
            to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(field.at(0, k)),
                      from.begin() + static_cast<std::ptrdiff_t>(field.at(0, k)) + columns);
    };
    cut_out(field.vx, cut.vx);
    cut_out(field.vz, cut.vz);
    cut_out(field.mean_x, cut.mean_x);
    cut_out(field.mean_z, cut.mean_z);
    cut_out(field.gi, cut.gi);
    cut_out(field.solid_fraction, cut.solid_fraction);
    return cut;
}

double HeapRotation::turn_length(double blade_speed) const {
    return 4 * std::numbers::pi * blade_speed / std::abs(vorticity);
}

HeapRotation heap_rotation(const HeapField& mean, std::span<const Snapshot> instants,
                           const HeapFieldOptions& options) {
    HeapRotation rotation;
    const Loops all = loops_of(mean);
    rotation.circulation = all.circulation;
    rotation.area = all.area;
    rotation.vorticity = all.area > 0 ? all.circulation / all.area : kNan;
    // A single instant has few grains a cell; two are enough, for the noise of single cells cancels within
    // the loops.
    HeapFieldOptions single = options;
    single.least_grains = 2;
    double sum = 0, square = 0;
    int n = 0;
    for (std::size_t k = 0; k < instants.size(); ++k) {
        const Loops one = loops_of(heap_field(instants.subspan(k, 1), single));
        if (!(one.area > 0)) continue;
        const double w = one.circulation / one.area;
        sum += w;
        square += w * w;
        ++n;
    }
    rotation.deviation = n > 1 ? std::sqrt(std::max(0.0, (square - sum * sum / n) / (n - 1))) : kNan;
    return rotation;
}

void LaceyIndex::add(std::size_t cell, double volume, double share) {
    volume_[cell] += volume;
    volume_a_[cell] += volume * share;
    square_[cell] += volume * volume;
    total_ += volume;
    total_a_ += volume * share;
    total_square_ += volume * volume;
}

double LaceyIndex::gi() const {
    return total_ > 0 ? total_a_ / total_ : kNan;
}

double LaceyIndex::excess() const {
    const double g = gi();
    double variance = 0;
    for (std::size_t c = 0; c < volume_.size(); ++c)
        if (volume_[c] > 0) variance += volume_[c] * std::pow(volume_a_[c] / volume_[c] - g, 2);
    return g * (1 - g) - variance / total_;
}

double LaceyIndex::mixable() const {
    const double g = gi(), one = total_square_ / (total_ * total_);  // 1/N of equal grains
    double random = -one;
    for (std::size_t c = 0; c < volume_.size(); ++c)
        if (volume_[c] > 0) random += square_[c] / (total_ * volume_[c]);
    return g * (1 - g) * (1 - random / (1 - one));
}

double LaceyIndex::value() const {
    if (!(total_ > 0)) return kNan;
    const double room = mixable();
    return room > 0 ? excess() / room : kNan;
}

std::vector<std::size_t> heap_grains(const Snapshot& s, double least_speed) {
    std::vector<std::size_t> members;
    for (std::size_t n = 0; n < s.x.size(); ++n)
        if (s.x[n] > s.blade_x && s.z[n] > 0 && s.vx[n] >= least_speed) members.push_back(n);
    return members;
}

HeapMixing heap_mixing(const Snapshot& s, const HeapMixingOptions& options) {
    if (!(options.cell > 0) || !(options.width > 0))
        throw std::invalid_argument("heap mixing: cell and width must be above 0");
    HeapMixing out;
    out.time = s.time;
    out.blade_x = s.blade_x;
    const std::vector<std::size_t> members = heap_grains(s, options.least_speed);
    out.grains = static_cast<long>(members.size());
    const int slices = std::max(1, static_cast<int>(std::ceil(options.width / options.cell - 1e-6)));
    double x_high = 0, z_high = 0;
    for (const std::size_t n : members) {
        x_high = std::max(x_high, s.x[n] - s.blade_x);
        z_high = std::max(z_high, double(s.z[n]));
    }
    const std::size_t columns = static_cast<std::size_t>(x_high / options.cell) + 1,
                      rows = static_cast<std::size_t>(z_high / options.cell) + 1;
    LaceyIndex cubes(columns * rows * slices);
    std::vector<LaceyIndex> slice(slices, LaceyIndex(columns * rows));
    for (const std::size_t n : members) {
        double y = s.y[n];
        if (options.periodic) y -= options.width * std::floor(y / options.width);
        const int b = std::clamp(static_cast<int>(std::floor(y / options.cell)), 0, slices - 1);
        const std::size_t cell = static_cast<std::size_t>(s.z[n] / options.cell) * columns +
                                 static_cast<std::size_t>((s.x[n] - s.blade_x) / options.cell);
        const double volume = sphere_volume(s.radius[n]), share = s.is_a[n] ? 1 : 0;
        cubes.add(cell * slices + b, volume, share);
        slice[b].add(cell, volume, share);
    }
    out.solid_volume = cubes.volume();
    out.gi = cubes.gi();
    out.lacey = cubes.value();
    double removed = 0, removable = 0;
    for (int b = 0; b < slices; ++b) {
        const LaceyIndex& one = slice[b];
        const double slice_end =
            b + 1 < slices ? (b + 1) * options.cell : options.width;  // the last takes the rest
        out.y_m.push_back(0.5 * (b * options.cell + slice_end));
        out.slice_gi.push_back(one.gi());
        // below 5 % of the other powder chance alone moves the index by its whole range
        const bool mixed_powder = one.volume() > 0 && std::min(one.gi(), 1 - one.gi()) > 0.05;
        out.slice_lacey.push_back(mixed_powder ? one.value() : kNan);
        if (!(one.volume() > 0)) continue;
        removed += one.volume() * one.excess();
        removable += one.volume() * std::max(0.0, one.mixable());
    }
    out.lacey_in_slices = removable > 0 ? removed / removable : kNan;
    return out;
}

}  // namespace gradwright
