// Cell order and candidate pairs: all pairs with a gap below the skin, found through a grid of cells; and who
// sleeps.
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "dem/kernel.h"

namespace gradwright {
namespace {

constexpr std::size_t kBlock =
    256;  // grains per work block: fixed, so that results never depend on the thread count

template <class V>
void permute(V& values, const std::vector<std::int32_t>& order, int threads) {
    V sorted(order.size());
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = values[order[k]];
    values.swap(sorted);
}

constexpr double kWakes = 3;  // radii from a grain's centre: a moving body that comes so near wakes it

bool moves(const Body& body) {
    return body.speed_x != 0 || body.speed_z != 0;
}

}  // namespace

void Engine::remove_grains(const std::function<bool(std::size_t)>& predicate) {
    std::vector<std::uint8_t> drop(state_.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < state_.size(); ++i) {
        drop[i] = !state_.fixed[i] && predicate(i);
        any = any || drop[i];
    }
    if (!any) return;
    // Marked by an x beyond the end; rebuild_candidates takes them out and carries the remaining contacts
    // over.
    for (std::size_t i = 0; i < state_.size(); ++i)
        if (drop[i]) state_.x[i] = 2e9;
    wake_all();
    rebuild_candidates();
    kernel_->carry_history();
    update_sleep();  // who is awake, in the new order
    choose_reach();
    kernel_->rebuild_near();
    kernel_->write_records();
    travel_ = 0;
    lists_valid_ = true;
}

void Engine::rebuild_candidates() {
    auto& s = state_;
    skin_ = options_.skin > 0 ? options_.skin : 0.54 * smallest_radius_ + 0.18 * largest_radius_;
    near_skin_ = options_.near_skin > 0 ? options_.near_skin : 0.2 * smallest_radius_;
    const double cell = 2 * largest_radius_ + kWidestReach * skin_;

    double lo_x = 1e30, hi_x = -1e30, lo_z = 1e30, hi_z = -1e30, lo_y = 1e30, hi_y = -1e30;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.x[i] > options_.remove_beyond_x && !s.fixed[i]) continue;
        lo_x = std::min(lo_x, s.x[i]);
        hi_x = std::max(hi_x, s.x[i]);
        lo_y = std::min(lo_y, s.y[i]);
        hi_y = std::max(hi_y, s.y[i]);
        lo_z = std::min(lo_z, s.z[i]);
        hi_z = std::max(hi_z, s.z[i]);
    }
    const bool periodic = options_.period_y > 0;
    const double span_y = periodic ? options_.period_y : std::max(hi_y - lo_y, cell);
    auto cells_of = [&](double span) {
        return static_cast<int>(std::clamp(std::floor(span / cell), 1.0, 4000.0));
    };
    // a period along x or z is for small gases only: one cell, so that no row has to wrap round
    const double period_x = options_.period_x, period_z = options_.period_z;
    const int nx = period_x > 0 ? 1 : cells_of(std::max(hi_x - lo_x, 0.0) + cell),
              ny = periodic ? cells_of(span_y) : cells_of(span_y + cell);
    const int nz = period_z > 0 ? 1 : std::min(cells_of(std::max(hi_z - lo_z, 0.0) + cell), 512);
    const double inv_y = ny / (periodic ? span_y : span_y + cell);

    // A row is the cells above each other, a layer the rows beside each other. Where the periodic side's two
    // ends are neighbours its rows or layers are folded, 0, n - 1, 1, n - 2, ..., or they would stand at the
    // two ends of the order. What a sweep has at hand (kernel.h) is then a layer across y or two folded ones
    // across x, whichever is less: a hundred thousand grains, wide along y, 17 million grain-steps/s with two
    // layers across the longer side, 24 across the shorter one.
    const bool along_y = span_y > (periodic ? 2 : 1) * (hi_x - lo_x);
    const auto folded = [&](int k) { return !periodic ? k : k % 2 == 0 ? k / 2 : ny - 1 - k / 2; };
    struct Row {
        std::int32_t x, y;
    };
    std::vector<Row> rows_in_order;
    std::vector<std::int32_t> rank(static_cast<std::size_t>(nx) * ny);
    rows_in_order.reserve(rank.size());
    const auto add_row = [&](int ix, int iy) {
        rank[static_cast<std::size_t>(ix) * ny + iy] = static_cast<std::int32_t>(rows_in_order.size());
        rows_in_order.push_back({ix, iy});
    };
    if (along_y)
        for (int k = 0; k < ny; ++k)
            for (int ix = 0; ix < nx; ++ix) add_row(ix, folded(k));
    else
        for (int ix = 0; ix < nx; ++ix)
            for (int k = 0; k < ny; ++k) add_row(ix, folded(k));

    auto cell_of = [&](std::size_t i) {
        const int cx = std::clamp(static_cast<int>((s.x[i] - lo_x) / cell), 0, nx - 1);
        double y = s.y[i] - (periodic ? 0 : lo_y);
        if (periodic) y -= span_y * std::floor(y / span_y);
        const int cy = std::clamp(static_cast<int>(y * inv_y), 0, ny - 1);
        const int cz = std::clamp(static_cast<int>((s.z[i] - lo_z) / cell), 0, nz - 1);
        return rank[static_cast<std::size_t>(cx) * ny + cy] * nz + cz;
    };

    // Counting sort into cell order; stable, so the order is a function of the state alone.
    const std::size_t old_count = s.size();
    std::vector<std::int32_t> cell_index(old_count), first(static_cast<std::size_t>(nx) * ny * nz + 2, 0);
    for (std::size_t i = 0; i < old_count; ++i) {
        if (s.x[i] > options_.remove_beyond_x && !s.fixed[i]) {
            cell_index[i] = -1;
            continue;
        }
        cell_index[i] = cell_of(i);
        ++first[cell_index[i] + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::int32_t> order(first.back()), sorted_cell(first.back()),
        cursor(first.begin(), first.end() - 1);
    new_index_.assign(old_count, -1);
    for (std::size_t i = 0; i < old_count; ++i) {
        if (cell_index[i] < 0) continue;
        const std::int32_t at = cursor[cell_index[i]]++;
        order[at] = static_cast<std::int32_t>(i);
        sorted_cell[at] = cell_index[i];
        new_index_[i] = at;
    }
    s.for_each_array([&](auto& array) { permute(array, order, threads_); });
    const std::size_t n = s.size();
    built_from_ = {lo_x, lo_y, lo_z};
    built_error_ = 2 * 0x1p-24 * std::max({hi_x - lo_x, hi_y - lo_y, hi_z - lo_z, 0.0});
    built_.resize(n);
    for (std::size_t i = 0; i < n; ++i)
        built_[i] = {static_cast<float>(s.x[i] - lo_x), static_cast<float>(s.y[i] - lo_y),
                     static_cast<float>(s.z[i] - lo_z)};
    choose_wide_reach();

    // Candidates j > i of every grain, block by block: the grains of a row of cells stand one after the
    // other, so that a vector's width of them is tested at once. In float, from the lowest corner and within
    // one period; the cut is longer by what that can be wrong, two roundings a coordinate and one a sum.
    using F = WideFloat;
    constexpr int kLanes = Lane<F>::kWidth;
    const double extent = std::max({hi_x - lo_x, periodic ? span_y : hi_y - lo_y, hi_z - lo_z, cell});
    const float margin = static_cast<float>(6 * 0x1p-24 * extent + 1e-6 * cell);
    struct Near {
        AlignedVector<float> x, y, z, cut;
    } place;
    for (auto* array : {&place.x, &place.y, &place.z, &place.cut}) array->resize(n + kLanes);
    const std::size_t blocks = (n + kBlock - 1) / kBlock;
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::size_t i = 0; i < n; ++i) {
        double y = s.y[i] - (periodic ? 0 : lo_y);
        if (periodic) y -= span_y * std::floor(y / span_y);
        place.x[i] = static_cast<float>(s.x[i] - lo_x);
        place.y[i] = static_cast<float>(y);
        place.z[i] = static_cast<float>(s.z[i] - lo_z);
        place.cut[i] = static_cast<float>(s.radius[i] + wide_reach_[i]) + 0.5f * margin;
    }
    std::vector<std::vector<std::int32_t>> found(blocks);
    candidate_first_.assign(n + 1, 0);
    const float wrap_y = periodic ? static_cast<float>(span_y) : 0, wrap_x = static_cast<float>(period_x),
                wrap_z = static_cast<float>(period_z);
    const float inverse_y = periodic ? 1 / wrap_y : 0, inverse_x = period_x > 0 ? 1 / wrap_x : 0,
                inverse_z = period_z > 0 ? 1 / wrap_z : 0;
    const bool small_gas = period_x > 0 || period_z > 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads_)
    for (std::size_t block = 0; block < blocks; ++block) {
        auto& list = found[block];
        std::size_t count = 0;
        int rows[9], row_count = 0, row = -1;
        for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
            const std::size_t before = count;
            const std::int32_t cell_number = sorted_cell[i];
            const int cz = cell_number % nz;
            if (cell_number / nz != row) {
                // neighbouring rows from its own on, each once
                row = cell_number / nz;
                row_count = 0;
                const auto [cx, cy] = rows_in_order[row];
                for (int ix = std::max(cx - 1, 0); ix <= std::min(cx + 1, nx - 1); ++ix)
                    for (int dy = -1; dy <= 1; ++dy) {
                        int iy = cy + dy;
                        if (periodic) iy = (iy + ny) % ny;
                        if (iy < 0 || iy >= ny) continue;
                        const int other = rank[static_cast<std::size_t>(ix) * ny + iy];
                        if (other >= row && std::find(rows, rows + row_count, other) == rows + row_count)
                            rows[row_count++] = other;
                    }
            }
            const bool fixed = s.fixed[i];
            const F xi = F{} + place.x[i], yi = F{} + place.y[i], zi = F{} + place.z[i],
                    cut_i = F{} + place.cut[i];
            for (int k = 0; k < row_count; ++k) {
                const std::size_t base = static_cast<std::size_t>(rows[k]) * nz;
                const std::int32_t from = std::max<std::int32_t>(first[base + std::max(cz - 1, 0)],
                                                                 static_cast<std::int32_t>(i) + 1),
                                   to = first[base + std::min(cz + 1, nz - 1) + 1];
                if (from >= to) continue;
                if (list.size() < count + static_cast<std::size_t>(to - from))
                    list.resize(2 * list.size() + static_cast<std::size_t>(to - from) + kBlock * 10);
                for (std::int32_t j = from; j < to; j += kLanes) {
                    F dx = xi - load_unaligned<F>(&place.x[j]), dz = zi - load_unaligned<F>(&place.z[j]);
                    F dy = yi - load_unaligned<F>(&place.y[j]);
                    dy -= wrap_y * nearest_whole(dy * inverse_y);
                    if (small_gas) {
                        dx -= wrap_x * nearest_whole(dx * inverse_x);
                        dz -= wrap_z * nearest_whole(dz * inverse_z);
                    }
                    const F cut = cut_i + load_unaligned<F>(&place.cut[j]);
                    std::uint32_t bits = bits_where_less(dx * dx + dy * dy + dz * dz, cut * cut);
                    if (to - j < kLanes) bits &= (1u << (to - j)) - 1;
                    for (; bits != 0; bits &= bits - 1) {
                        const std::int32_t other = j + __builtin_ctz(bits);
                        list[count] = other;
                        count += !(fixed && s.fixed[other]);
                    }
                }
            }
            candidate_first_[i + 1] = static_cast<std::int32_t>(count - before);
        }
        list.resize(count);
    }
    std::partial_sum(candidate_first_.begin(), candidate_first_.end(), candidate_first_.begin());
    candidate_.resize(candidate_first_[n]);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::size_t block = 0; block < blocks; ++block) {
        std::copy(found[block].begin(), found[block].end(),
                  candidate_.begin() + candidate_first_[block * kBlock]);
    }

    find_reachable_bodies();
    frame_shift_ = {};
    body_way_ = 0;
}

void Engine::find_reachable_bodies() {
    const auto& s = state_;
    reachable_.assign(s.size(), 0);
    wakeable_.assign(s.size(), 0);
#pragma omp parallel for schedule(static, 256) num_threads(threads_)
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.fixed[i]) continue;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (body_removed_[b]) continue;
            const auto p = nearest_point(bodies_[b], bodies_[b].speed_x * body_time_,
                                         bodies_[b].speed_z * body_time_, s.x[i], s.y[i], s.z[i]);
            const double reach = wide_reach_[i] + wide_body_reach_;
            if (p.distance < s.radius[i] + reach) reachable_[i] |= 1u << b;
            if (moves(bodies_[b]) && p.distance < kWakes * s.radius[i] + reach) wakeable_[i] = 1;
        }
    }
}

// A grain sleeps when it and every near neighbour have been slower than sleep_speed for sleep_time; it wakes
// when an awake near neighbour is faster than wake_speed or a moving body comes within its diameter. The wake
// front runs one neighbour per refresh of the near list, which comes the sooner the faster anything moves;
// what sleep costs in GI is a level of its own in docs/speed-against-error.md ("without sleep").
void Engine::update_sleep() {
    auto& s = state_;
    const std::size_t n = s.size();
    if (options_.sleep) {
        const std::int32_t needed = static_cast<std::int32_t>(options_.sleep_time / options_.time_step);
        // What a grain does to its neighbours and what would disturb it, two bits each: an awake one stirs
        // those about to fall asleep unless it has been quiet for half the time, and everybody when it is
        // fast.
        constexpr std::uint8_t kRestless = 1, kFast = 2, kSleeper = kFast << 2,
                               kDrowsy = (kRestless | kFast) << 2;
        std::vector<std::uint8_t> manner(n, 0), disturbed(n, 0);
#pragma omp parallel for schedule(static) num_threads(threads_)
        for (std::size_t i = 0; i < n; ++i) {
            if (s.fixed[i]) continue;
            if (s.asleep[i]) {
                manner[i] = kSleeper;
                continue;
            }
            // Not the spin: a grain that rolls also moves, and one that only twists about a contact normal
            // would do so for ever, because the law has no twisting resistance.
            const Moving& m = s.moving[i];
            const auto speed = static_cast<float>(std::sqrt(m.vx * m.vx + m.vy * m.vy + m.vz * m.vz));
            s.quiet[i] =
                speed < options_.sleep_speed ? s.quiet[i] + static_cast<std::int32_t>(steps_since_near_) : 0;
            manner[i] = static_cast<std::uint8_t>((s.quiet[i] >= needed ? kDrowsy : 0) |
                                                  (s.quiet[i] < needed / 2 ? kRestless : 0) |
                                                  (speed > options_.wake_speed ? kFast : 0));
        }
        const auto disturb = [&](std::size_t i) {
            std::atomic_ref(disturbed[i]).store(1, std::memory_order_relaxed);
        };
#pragma omp parallel for schedule(static, 256) num_threads(threads_)
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint8_t mine = manner[i];
            for (std::int32_t c = candidate_first_[i]; c < candidate_first_[i + 1]; ++c) {
                const auto j = static_cast<std::size_t>(candidate_[c]);
                const bool to_i = (mine >> 2 & manner[j] & 3) != 0, to_j = (manner[j] >> 2 & mine & 3) != 0;
                if (!(to_i | to_j)) continue;
                double dy = s.y[i] - s.y[j];
                if (options_.period_y > 0) dy -= options_.period_y * std::nearbyint(dy / options_.period_y);
                const double dx = s.x[i] - s.x[j], dz = s.z[i] - s.z[j];
                const double cut = s.radius[i] + s.radius[j] + near_skin_;
                if (dx * dx + dy * dy + dz * dz > cut * cut) continue;
                if (to_i) disturb(i);
                if (to_j) disturb(j);
            }
            if (!bodies_move_ || !wakeable_[i] || !(mine & kSleeper)) continue;
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                if (body_removed_[b] || !moves(bodies_[b])) continue;
                const auto near = nearest_point(bodies_[b], bodies_[b].speed_x * body_time_,
                                                bodies_[b].speed_z * body_time_, s.x[i], s.y[i], s.z[i]);
                if (near.distance < kWakes * s.radius[i]) disturb(i);
            }
        }
        for (std::size_t i = 0; i < n; ++i) {
            // a drowsy one has that bit too
            if (!(manner[i] & kSleeper) || s.asleep[i] == !disturbed[i]) continue;
            s.asleep[i] = !disturbed[i];
            s.quiet[i] = 0;
            s.vx[i] = s.vy[i] = s.vz[i] = s.wx[i] = s.wy[i] = s.wz[i] = 0;
            lists_valid_ = false;  // records must be written anew
        }
    }
    awake_.clear();
    for (std::size_t i = 0; i < n; ++i)
        if (!s.fixed[i] && !s.asleep[i]) awake_.push_back(static_cast<std::int32_t>(i));
}

}  // namespace gradwright
