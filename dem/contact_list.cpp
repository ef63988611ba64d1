// Near pairs: the candidates close enough to touch before the next refresh, in tiles as wide as the law, with
// their history. Rejected: testing every candidate in every step and compressing the touching ones (the usual
// way). It needs a fresh index for the second grain of every contact in every step; here both indices live
// for many steps and the law sees some pairs that do not touch instead.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dem/kernel.h"

namespace gradwright {
namespace {

/// What becomes of a candidate: one that is only near, or one that touches; parked: it touches, but both
/// grains stand still, so that it keeps its history and is not computed.
constexpr std::uint8_t kApart = 1, kParked = 2, kTouching = 3;

}  // namespace

template <class T>
Engine::Kernel::Predicted Engine::KernelOf<T>::predicted(std::size_t i) const {
    if (i + 2 >= motion.size() || motion.size() != e.state_.size() + 2) return {};
    const Motion& m = motion[i];
    return {true, {m.vx, m.vy, m.vz}, {m.wx, m.wy, m.wz}};
}

template <class T>
void Engine::KernelOf<T>::scale_motion(double factor) {
    const S f = static_cast<S>(factor);
    for (Motion& m : motion) {
        m.vx *= f, m.vy *= f, m.vz *= f;
        m.wx *= f, m.wy *= f, m.wz *= f;
    }
}

template <class T>
void Engine::KernelOf<T>::restored() {
    if (e.lists_valid_) share_out();
}

template <class T>
void Engine::KernelOf<T>::write_records() {
    const auto& s = e.state_;
    const std::size_t n = s.size();
    const bool known = motion.size() == n + 2 && !e.first_kick_;
    motion.resize(n + 2);
    for (std::size_t i = 0; i < n; ++i) {
        const bool still =
            s.vx[i] == 0 && s.vy[i] == 0 && s.vz[i] == 0 && s.wx[i] == 0 && s.wy[i] == 0 && s.wz[i] == 0;
        if (!known || still)
            motion[i] = {S(s.vx[i]), S(s.vy[i]), S(s.vz[i]), S(s.radius[i]),
                         S(s.wx[i]), S(s.wy[i]), S(s.wz[i]), S(0)};
    }
    // two far dummies for padding lanes
    e.state_.place.resize(n);
    e.state_.place.push_back({0, 0, 1e3, 1e-6});
    e.state_.place.push_back({0, 0, -1e3, 1e-6});
    motion[n] = motion[n + 1] = {0, 0, 0, S(1e-6), 0, 0, 0, 0};
}

template <class T>
void Engine::KernelOf<T>::carry_history() {
    // Kept contacts move to the new candidate numbers. Slot code: s >= 0 same
    // orientation, -2 - s turned round, -1 none.
    const auto& new_index = e.new_index_;
    const std::size_t known = motion.empty() ? 0 : motion.size() - 2;
    AlignedVector<Motion> moved(e.state_.size() + 2);
    for (std::size_t i = 0; i < e.state_.size(); ++i) {
        const auto& s = e.state_;
        moved[i] = {S(s.vx[i]), S(s.vy[i]), S(s.vz[i]), S(s.radius[i]),
                    S(s.wx[i]), S(s.wy[i]), S(s.wz[i]), S(0)};
    }
    for (std::size_t i = 0; i < std::min(known, new_index.size()); ++i)
        if (new_index[i] >= 0) moved[new_index[i]] = motion[i];
    motion.swap(moved);
    e.candidate_slot_.assign(e.candidate_.size(), -1);
    auto carry = [&](std::size_t slot) {
        const PairTile& t = tiles[slot / W];
        const int lane = static_cast<int>(slot % W);
        if (t.i[lane] >= static_cast<std::int32_t>(new_index.size()) || !(t.touching[lane] > 0)) return;
        const std::int32_t a = new_index[t.i[lane]], b = new_index[t.j[lane]];
        if (a < 0 || b < 0) return;
        const std::int32_t lo = std::min(a, b), hi = std::max(a, b);
        for (std::int32_t c = e.candidate_first_[lo]; c < e.candidate_first_[lo + 1]; ++c) {
            if (e.candidate_[c] != hi) continue;
            e.candidate_slot_[c] =
                a < b ? static_cast<std::int32_t>(slot) : -2 - static_cast<std::int32_t>(slot);
            break;
        }
    };
    const std::size_t active_end = (active_slots + W - 1) / W * W;
    for (std::size_t slot = 0; slot < active_slots; ++slot) carry(slot);
    for (std::size_t slot = active_end; slot < active_end + parked_slots; ++slot) carry(slot);
    for (std::size_t slot = 0; slot < wall_slots; ++slot) {
        auto& g = walls[slot / W].i[slot % W];
        if (g < 0) continue;
        g = g < static_cast<std::int32_t>(new_index.size()) ? new_index[g] : -1;
    }
}

template <class T>
void Engine::KernelOf<T>::keep_springs() {
    // One list of pairs and no copy of it: the next one is written over it, and only what a contact remembers
    // is put aside, in the memory of the sums. Where pairs come and go the copy was a quarter of all memory.
    const int each = numbers_per_spring();
    const auto count = static_cast<std::int64_t>(tiles.size());
    tiles_before.resize(tiles.size());
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::int64_t k = 0; k < count; ++k) {
        std::uint32_t touched = 0;
        for (int lane = 0; lane < W; ++lane)
            touched |= static_cast<std::uint32_t>(tiles[k].touching[lane] > 0) << lane;
        tiles_before[k].touched = touched;
    }
    std::int32_t first = 0;
    for (TileBefore& tile : tiles_before) {
        tile.first = first;
        first += std::popcount(tile.touched);
    }
    const std::size_t room = sizeof(Record) / sizeof(S);
    sums.resize(std::max(sums.size(), (static_cast<std::size_t>(first) * each + room - 1) / room));
    S* const springs = reinterpret_cast<S*>(sums.data());
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::int64_t k = 0; k < count; ++k) {
        S* to = springs + static_cast<std::size_t>(tiles_before[k].first) * each;
        for (int lane = 0; lane < W; ++lane) {
            if (!(tiles_before[k].touched >> lane & 1)) continue;
            for (int x = 0; x < 3; ++x) *to++ = tiles[k].xi[x][lane];
            if (has_rolls)
                for (int x = 0; x < 3; ++x) *to++ = rolls[k].angle[x][lane];
        }
    }
}

template <class T>
void Engine::KernelOf<T>::rebuild_near() {
    const auto& s = e.state_;
    const std::size_t n = s.size();
    if (e.candidate_slot_.size() != e.candidate_.size()) e.candidate_slot_.assign(e.candidate_.size(), -1);
    keep_springs();
    keep.resize(e.candidate_.size());
    park_first.assign(n + 1, 0);
    const double period = e.options_.period_y;
    const double inv_period = period > 0 ? 1 / period : 0;
    const double inv_period_x = e.options_.period_x > 0 ? 1 / e.options_.period_x : 0;
    const double inv_period_z = e.options_.period_z > 0 ? 1 / e.options_.period_z : 0;
    const float* const reach = e.reach_.data();

    auto touching_before = [&](std::int32_t code) {
        if (code == -1) return false;
        const std::size_t slot = code >= 0 ? code : -2 - code;
        return (tiles_before[slot / W].touched >> slot % W & 1) != 0;
    };
    blocks.assign((n + kBlock - 1) / kBlock, Block{});
#pragma omp parallel for schedule(dynamic, 2) num_threads(e.threads_)
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        std::int32_t touching = 0, apart = 0;
        for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
            const bool still_i = s.fixed[i] || s.asleep[i];
            for (std::int32_t c = e.candidate_first_[i]; c < e.candidate_first_[i + 1]; ++c) {
                const std::int32_t j = e.candidate_[c];
                const bool still = still_i && (s.fixed[j] || s.asleep[j]);
                std::uint8_t kind = 0;
                if (touching_before(e.candidate_slot_[c])) {
                    kind = still ? kParked : kTouching;
                } else if (!still) {
                    double dy = s.y[i] - s.y[j];
                    dy -= period * std::nearbyint(dy * inv_period);
                    double dx = s.x[i] - s.x[j], dz = s.z[i] - s.z[j];
                    dx -= e.options_.period_x * std::nearbyint(dx * inv_period_x);
                    dz -= e.options_.period_z * std::nearbyint(dz * inv_period_z);
                    const double cut = s.radius[i] + s.radius[j] + reach[i] + reach[j];
                    kind = dx * dx + dy * dy + dz * dz < cut * cut ? kApart : 0;
                }
                keep[c] = kind;
                touching += kind == kTouching;
                apart += kind == kApart;
                park_first[i + 1] += kind == kParked;
            }
        }
        blocks[b].own_touching = touching;
        blocks[b].own_end = touching + apart;
    }
    std::partial_sum(park_first.begin(), park_first.end(), park_first.begin());
    // Slots of the active pairs; every block begins on a tile of its own. Those that touch come first: a tile
    // in which nothing touches costs a quarter (contact_pass.cpp).
    std::int32_t next = 0;
    for (Block& block : blocks) {
        next = (next + W - 1) / W * W;
        block.first_tile = next / W;
        next += block.own_end;
        block.own_end = next;
        block.end_tile = (next + W - 1) / W;
    }
    active_slots = next;
    parked_slots = park_first[n];
    const std::size_t active_tiles = (active_slots + W - 1) / W, parked_tiles = (parked_slots + W - 1) / W;
    tiles.resize(active_tiles + parked_tiles);
    if (has_rolls) rolls.resize(tiles.size());

    const int material_count = static_cast<int>(e.options_.materials.size());
    auto pad = [&](std::size_t from, std::size_t to) {
        for (std::size_t slot = from; slot < to; ++slot) {
            PairTile& t = tiles[slot / W];
            const int lane = static_cast<int>(slot % W);
            t.i[lane] = static_cast<std::int32_t>(n);
            t.j[lane] = static_cast<std::int32_t>(n + 1);
            t.radius[lane] = t.mass[lane] = t.e_star[lane] = t.g_star8[lane] = t.jkr_radius[lane] = 1;
            t.touching[lane] = 0;
            for (int k = 0; k < 3; ++k) t.xi[k][lane] = 0;
            if (has_rolls)
                for (int k = 0; k < 3; ++k) rolls[slot / W].angle[k][lane] = 0;
        }
    };
    const S* const springs = reinterpret_cast<const S*>(sums.data());
    const int each = numbers_per_spring();
    const auto fill = [&](std::size_t i, std::size_t& next_touching, std::size_t& next_apart) {
        std::int32_t& reach = blocks[i / kBlock].reach;
        std::size_t next_parked = active_tiles * W + park_first[i];
        for (std::int32_t c = e.candidate_first_[i]; c < e.candidate_first_[i + 1]; ++c) {
            if (keep[c] == 0) {
                e.candidate_slot_[c] = -1;
                continue;
            }
            const std::size_t slot = keep[c] == kTouching ? next_touching++
                                     : keep[c] == kApart  ? next_apart++
                                                          : next_parked++;
            PairTile& t = tiles[slot / W];
            const int lane = static_cast<int>(slot % W);
            const std::int32_t j = e.candidate_[c];
            t.i[lane] = static_cast<std::int32_t>(i);
            t.j[lane] = j;
            const std::int32_t code = e.candidate_slot_[c];
            const S* spring = nullptr;
            if (keep[c] != kApart) {
                const std::size_t old = code >= 0 ? code : -2 - code;
                const TileBefore& before = tiles_before[old / W];
                const std::uint32_t ahead = before.touched & ((std::uint32_t{1} << old % W) - 1);
                spring = springs + static_cast<std::size_t>(before.first + std::popcount(ahead)) * each;
            }
            const double ri = s.radius[i], rj = s.radius[j];
            const double r = ri * rj / (ri + rj);
            const double mi = s.mass[i], mj = s.mass[j];
            const auto& pair = e.pairs_[s.material[i] * material_count + s.material[j]];
            t.radius[lane] = S(r);
            t.mass[lane] = S(s.fixed[i] ? mj : s.fixed[j] ? mi : mi * mj / (mi + mj));
            t.e_star[lane] = S(pair.e_star);
            t.g_star8[lane] = S(pair.g_star8);
            t.jkr_radius[lane] = S(std::cbrt(2 * std::numbers::pi * e.adhesion_ * r * r / pair.e_star));
            t.touching[lane] = S(spring ? 1 : 0);
            const S turn = code >= 0 ? S(1) : S(-1);  // springs change sign with the pair's orientation
            for (int k = 0; k < 3; ++k) t.xi[k][lane] = spring ? turn * spring[k] : S(0);
            if (has_rolls)
                for (int k = 0; k < 3; ++k)
                    rolls[slot / W].angle[k][lane] = spring ? turn * spring[3 + k] : S(0);
            e.candidate_slot_[c] = static_cast<std::int32_t>(slot);
            if (keep[c] == kParked) continue;
            reach = std::max(reach, j);
            for (const std::size_t one : {i, static_cast<std::size_t>(j)})
                if (s.fixed[one] || s.asleep[one])
                    std::atomic_ref(blocks[one / kBlock].presses_still).store(1, std::memory_order_relaxed);
        }
    };
#pragma omp parallel for schedule(dynamic, 2) num_threads(e.threads_)
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        std::size_t next_touching = static_cast<std::size_t>(blocks[b].first_tile) * W,
                    next_apart = next_touching + static_cast<std::size_t>(blocks[b].own_touching);
        for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i)
            fill(i, next_touching, next_apart);
        pad(blocks[b].own_end, static_cast<std::size_t>(blocks[b].end_tile) * W);
    }
    pad(active_tiles * W + parked_slots, (active_tiles + parked_tiles) * W);

    rebuild_walls();
    for (std::size_t b = 0, k = 0; b < blocks.size(); ++b) {
        blocks[b].first_awake = static_cast<std::int32_t>(k);
        while (k < e.awake_.size() && static_cast<std::size_t>(e.awake_[k]) < (b + 1) * kBlock) ++k;
        blocks[b].end_awake = static_cast<std::int32_t>(k);
    }
    force_on_fixed_by_block.assign(blocks.size(), {});
    share_out();
}

template <class T>
void Engine::KernelOf<T>::rebuild_walls() {
    const auto& s = e.state_;
    const std::size_t n = s.size();
    const int body_count = static_cast<int>(e.bodies_.size());
    walls.swap(old_walls);
    // Old contacts by (grain, body): slots stand in ascending order of both unless the cell order changed
    // since.
    struct Old {
        std::int32_t grain, body, slot;
    };
    std::vector<Old> old;
    for (std::size_t slot = 0; slot < wall_slots; ++slot) {
        const WallTile& t = old_walls[slot / W];
        const int lane = static_cast<int>(slot % W);
        if (t.i[lane] >= 0 && t.touching[lane] > 0)
            old.push_back({t.i[lane], t.body[lane], static_cast<std::int32_t>(slot)});
    }
    auto before = [](const Old& a, const Old& b) {
        return a.grain != b.grain ? a.grain < b.grain : a.body < b.body;
    };
    if (!std::is_sorted(old.begin(), old.end(), before)) std::sort(old.begin(), old.end(), before);

    // Which grains can reach which body: one bit per body.
    std::vector<std::uint32_t> near(n, 0);
    wall_first.assign(n + 1, 0);
#pragma omp parallel for schedule(static, 256) num_threads(e.threads_)
    for (std::size_t i = 0; i < n; ++i) {
        for (int b = 0; e.reachable_[i] >> b; ++b) {
            if (!(e.reachable_[i] >> b & 1) || e.body_removed_[b]) continue;
            const auto p = nearest_point(e.bodies_[b], e.bodies_[b].speed_x * e.body_time_,
                                         e.bodies_[b].speed_z * e.body_time_, s.x[i], s.y[i], s.z[i]);
            if (p.distance < s.radius[i] + e.reach_[i] + e.body_reach_) near[i] |= 1u << b;
        }
    }
    std::int32_t next = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        next = (next + W - 1) / W * W;
        blocks[b].first_wall = next / W;
        for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
            wall_first[i] = next;
            next += __builtin_popcount(near[i]);
        }
        blocks[b].wall_end = next;
        blocks[b].end_wall = (next + W - 1) / W;
    }
    wall_slots = static_cast<std::size_t>((next + W - 1) / W) * W;
    walls.resize((wall_slots + W - 1) / W);
    const int material_count = static_cast<int>(e.options_.materials.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (near[i] == 0) continue;
        std::size_t slot = wall_first[i];
        for (int b = 0; b < body_count; ++b) {
            if (!(near[i] >> b & 1)) continue;
            WallTile& t = walls[slot / W];
            const int lane = static_cast<int>(slot % W);
            ++slot;
            const double r = s.radius[i];
            const auto& pair = e.pairs_[s.material[i] * material_count + e.bodies_[b].material];
            t.i[lane] = static_cast<std::int32_t>(i);
            t.body[lane] = b;
            t.radius[lane] = S(r);
            t.mass[lane] = S(s.mass[i]);
            t.e_star[lane] = S(pair.e_star);
            t.g_star8[lane] = S(pair.g_star8);
            // no adhesion: a thousand-millionth of it, which spares the tiles a second kernel
            const double adhesion = e.bodies_[b].adhesive ? e.adhesion_ : 1e-9 * e.adhesion_;
            t.jkr_radius[lane] = S(std::cbrt(2 * std::numbers::pi * adhesion * r * r / pair.e_star));
            t.touching[lane] = 0;
            for (int k = 0; k < 3; ++k) t.xi[k][lane] = t.roll[k][lane] = 0;
            for (int k = 0; k < 6; ++k) t.out[k][lane] = 0;
            const Old key{static_cast<std::int32_t>(i), b, 0};
            while (kept < old.size() && before(old[kept], key)) ++kept;
            if (kept < old.size() && !before(key, old[kept])) {
                const WallTile& o = old_walls[old[kept].slot / W];
                const int from = static_cast<int>(old[kept].slot % W);
                t.touching[lane] = o.touching[from];
                for (int k = 0; k < 3; ++k) {
                    t.xi[k][lane] = o.xi[k][from];
                    t.roll[k][lane] = o.roll[k][from];
                }
            }
        }
    }
    for (const Block& block : blocks)
        for (std::int32_t slot = block.wall_end; slot < block.end_wall * W; ++slot) {
            WallTile& t = walls[slot / W];
            const int lane = slot % W;
            t.i[lane] = -1;
            t.body[lane] = -1;
            t.radius[lane] = t.mass[lane] = t.e_star[lane] = t.g_star8[lane] = t.jkr_radius[lane] = 1;
            t.touching[lane] = 0;
            for (int k = 0; k < 3; ++k) t.xi[k][lane] = t.roll[k][lane] = 0;
            for (int k = 0; k < 6; ++k) t.out[k][lane] = 0;
        }
}

template <class T>
void Engine::KernelOf<T>::forget_body(int body) {
    for (std::size_t slot = 0; slot < wall_slots; ++slot)
        if (walls[slot / W].body[slot % W] == body) walls[slot / W].touching[slot % W] = 0;
}

template <class T>
BodyForce Engine::KernelOf<T>::force_on_body(int body) const {
    BodyForce sum;
    for (std::size_t slot = 0; slot < wall_slots; ++slot) {
        const WallTile& t = walls[slot / W];
        const int lane = static_cast<int>(slot % W);
        if (t.body[lane] != body) continue;
        sum.x -= t.out[0][lane];
        sum.y -= t.out[1][lane];
        sum.z -= t.out[2][lane];
    }
    return sum;
}

template <class T>
BodyForce Engine::KernelOf<T>::force_on_fixed() const {
    BodyForce sum;
    for (const auto& force : force_on_fixed_by_block) {
        sum.x += force[0];
        sum.y += force[1];
        sum.z += force[2];
    }
    return sum;
}

template <class T>
std::array<double, 3> Engine::KernelOf<T>::force_on_fixed_of(const Block& block) const {
    std::array<double, 3> sum{};
    if (!block.presses_still) return sum;
    const auto first = static_cast<std::int32_t>(&block - blocks.data());
    for (std::int32_t i = first_grain(first); i < first_grain(first + 1); ++i)
        if (e.state_.fixed[i])
            for (int k = 0; k < 3; ++k) sum[k] += double(sums[i].value[k]);
    return sum;
}

template <class T>
std::size_t Engine::KernelOf<T>::contacts() const {
    std::size_t count = 0;
    for (const PairTile& t : tiles)
        for (int lane = 0; lane < W; ++lane) count += t.touching[lane] > 0;
    return count;
}

template <class T>
std::size_t Engine::KernelOf<T>::near_pairs() const {
    std::size_t count = 0;
    for (const Block& block : blocks) count += block.own_end - block.first_tile * W;
    return count;
}

template <class T>
double Engine::KernelOf<T>::coordination_sum() const {
    double ends = 0;
    const auto n = static_cast<std::int32_t>(e.state_.size());
    for (const PairTile& t : tiles)
        for (int lane = 0; lane < W; ++lane)
            if (t.i[lane] < n && t.touching[lane] > 0)
                ends += !e.state_.fixed[t.i[lane]] + !e.state_.fixed[t.j[lane]];
    for (const WallTile& t : walls)
        for (int lane = 0; lane < W; ++lane) ends += t.touching[lane] > 0;
    return ends;
}

template <class T>
template <class Visitor>
void Engine::KernelOf<T>::for_each_overlap(Visitor&& visit) const {
    const auto& s = e.state_;
    const auto n = static_cast<std::int32_t>(s.size());
    const double period = e.options_.period_y, inv = period > 0 ? 1 / period : 0;
    const double inv_x = e.options_.period_x > 0 ? 1 / e.options_.period_x : 0;
    const double inv_z = e.options_.period_z > 0 ? 1 / e.options_.period_z : 0;
    for (const PairTile& t : tiles) {
        for (int lane = 0; lane < W; ++lane) {
            const std::int32_t i = t.i[lane], j = t.j[lane];
            if (i >= n) continue;
            double dy = s.y[i] - s.y[j];
            dy -= period * std::nearbyint(dy * inv);
            double dx = s.x[i] - s.x[j], dz = s.z[i] - s.z[j];
            dx -= e.options_.period_x * std::nearbyint(dx * inv_x);
            dz -= e.options_.period_z * std::nearbyint(dz * inv_z);
            const double sum = s.radius[i] + s.radius[j];
            const double d2 = dx * dx + dy * dy + dz * dz;
            if (d2 < sum * sum) visit((sum - std::sqrt(d2)) / std::min(s.radius[i], s.radius[j]));
        }
    }
    for (const WallTile& t : walls) {
        for (int lane = 0; lane < W; ++lane) {
            if (t.i[lane] < 0) continue;
            const std::int32_t i = t.i[lane];
            const auto& body = e.bodies_[t.body[lane]];
            if (body.yield_ratio > 0) continue;  // its overlaps are watched apart, by the jam rule
            const auto p = nearest_point(body, body.speed_x * e.body_time_, body.speed_z * e.body_time_,
                                         s.x[i], s.y[i], s.z[i]);
            visit((s.radius[i] - p.distance) / s.radius[i]);
        }
    }
}

template <class T>
double Engine::KernelOf<T>::max_overlap_ratio() const {
    double top = 0;
    for_each_overlap([&](double ratio) { top = std::max(top, ratio); });
    return top;
}

template <class T>
std::size_t Engine::KernelOf<T>::contacts_beyond(double limit) const {
    std::size_t count = 0;
    for_each_overlap([&](double ratio) { count += ratio > limit; });
    return count;
}

template <class T>
double Engine::KernelOf<T>::memory_bytes() const {
    auto bytes = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
    return bytes(motion) + bytes(tiles) + bytes(tiles_before) + bytes(rolls) + bytes(walls) +
           bytes(old_walls) + bytes(sums) + bytes(kept) + bytes(wall_first) + bytes(keep) +
           bytes(park_first) + bytes(blocks);
}

template struct Engine::KernelOf<double>;
template struct Engine::KernelOf<WideFloat>;

}  // namespace gradwright
