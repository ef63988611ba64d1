// Near pairs: the candidates close enough to touch before the next refresh, in tiles as wide as the law, with
// their history. Rejected: testing every candidate in every step and compressing the touching ones (the usual
// way). It needs a fresh index for the second grain of every contact in every step; here both indices live
// for many steps and the law sees some pairs that do not touch instead.
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include "dem/cube_root.h"
#include "dem/kernel.h"
#include "dem/lane_rows.h"

namespace gradwright {
namespace {

/// Slot codes of candidates: none, or near without having touched. Else the slot where the contact's history
/// stands: s >= 0 same orientation, -2 - s turned round.
constexpr std::int32_t kNone = -1, kApart = std::numeric_limits<std::int32_t>::min();
constexpr std::size_t slot_of(std::int32_t code) {
    return static_cast<std::size_t>(code >= 0 ? code : -2 - code);
}

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
    // Kept contacts move to the new candidate numbers.
    const auto& new_index = e.new_index_;
    const std::size_t known = motion.empty() ? 0 : motion.size() - 2;
    AlignedVector<Motion> moved(e.state_.size() + 2);
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::size_t i = 0; i < e.state_.size(); ++i) {
        const auto& s = e.state_;
        moved[i] = {S(s.vx[i]), S(s.vy[i]), S(s.vz[i]), S(s.radius[i]),
                    S(s.wx[i]), S(s.wy[i]), S(s.wz[i]), S(0)};
    }
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::size_t i = 0; i < std::min(known, new_index.size()); ++i)
        if (new_index[i] >= 0) moved[new_index[i]] = motion[i];
    motion.swap(moved);
    e.candidate_slot_.assign(e.candidate_.size(), kNone);
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
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::size_t slot = 0; slot < active_slots; ++slot) carry(slot);
#pragma omp parallel for schedule(static) num_threads(e.threads_)
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
    // is put aside. Where pairs come and go the copy was a quarter of all memory.
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
    springs.resize(static_cast<std::size_t>(first) * each);
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::int64_t k = 0; k < count; ++k) {
        S* to = springs.data() + static_cast<std::size_t>(tiles_before[k].first) * each;
        for (int lane = 0; lane < W; ++lane) {
            if (!(tiles_before[k].touched >> lane & 1)) continue;
            for (int x = 0; x < 3; ++x) *to++ = tiles[k].xi[x][lane];
            if (has_rolls)
                for (int x = 0; x < 3; ++x) *to++ = rolls[k].angle[x][lane];
        }
    }
}

template <class T>
template <class Work>
void Engine::KernelOf<T>::on_own_thread(Work&& work) {
    // by the shares of the list before: near enough
    struct alignas(64) Queue {
        std::vector<std::int32_t> blocks;
        std::atomic<std::size_t> next{0};
    };
    const std::size_t threads = std::max<std::size_t>(shares.size(), 1);
    std::vector<Queue> queue(threads + 1);
    for (std::int32_t b = 0, t = 0; b < static_cast<std::int32_t>(blocks.size()); ++b) {
        while (t + 1 < static_cast<std::int32_t>(shares.size()) && b >= shares[t].end) ++t;
        const auto* const asleep = e.state_.asleep.data();
        const bool any =
            std::find(asleep + first_grain(b), asleep + first_grain(b + 1), 0) != asleep + first_grain(b + 1);
        queue[any ? t : threads].blocks.push_back(b);
    }
#pragma omp parallel num_threads(e.threads_)
    {
        const auto take_all = [&](Queue& from) {
            for (std::size_t k; (k = from.next.fetch_add(1, std::memory_order_relaxed)) < from.blocks.size();)
                work(static_cast<std::size_t>(from.blocks[k]));
        };
        const auto me = static_cast<std::size_t>(omp_get_thread_num()) % threads;
        take_all(queue[me]);
        take_all(queue[threads]);
        for (std::size_t k = 1; k < threads; ++k) take_all(queue[(me + k) % threads]);
    }
}

template <class T>
const std::uint8_t* Engine::KernelOf<T>::owners(std::size_t b) const {
    thread_local std::vector<std::uint8_t> owner;
    constexpr std::int32_t kAtOnce = 16;  // one store for nearly every grain; the next grain's lies over it
    const std::int32_t* const first = e.candidate_first_.data() + b * kBlock;
    const auto count = static_cast<std::int32_t>(std::min(e.state_.size() - b * kBlock, kBlock));
    owner.resize(static_cast<std::size_t>(first[count] - first[0] + kAtOnce));
    for (std::int32_t k = 0; k < count; ++k) {
        std::uint8_t* const at = owner.data() + (first[k] - first[0]);
        std::memset(at, k, kAtOnce);
        if (first[k + 1] - first[k] > kAtOnce)
            std::memset(at, k, static_cast<std::size_t>(first[k + 1] - first[k]));
    }
    return owner.data();
}

template <class T>
void Engine::KernelOf<T>::write_constants(PairTile& t, int lanes) {
    const auto& s = e.state_;
    const int material_count = static_cast<int>(e.options_.materials.size());
    double r[W], m[W], cube[W], e_star[W];
    for (int lane = 0; lane < W; ++lane) r[lane] = m[lane] = cube[lane] = e_star[lane] = 1;
    for (int lane = 0; lane < lanes; ++lane) {
        const std::int32_t i = t.i[lane], j = t.j[lane];
        const double ri = s.place[i].radius, rj = s.place[j].radius, mi = s.mass[i], mj = s.mass[j];
        const auto& pair = e.pairs_[s.material[i] * material_count + s.material[j]];
        r[lane] = ri * rj / (ri + rj);
        m[lane] = s.fixed[i] ? mj : s.fixed[j] ? mi : mi * mj / (mi + mj);
        e_star[lane] = pair.e_star;
        t.g_star8[lane] = S(pair.g_star8);
    }
    const double factor = 2 * std::numbers::pi * e.adhesion_;
    for (int lane = 0; lane < W; ++lane) cube[lane] = factor * r[lane] * r[lane] / e_star[lane];
    cube_roots(cube);
    for (int lane = 0; lane < W; ++lane) {
        t.radius[lane] = S(r[lane]);
        t.mass[lane] = S(m[lane]);
        t.e_star[lane] = S(e_star[lane]);
        t.jkr_radius[lane] = S(cube[lane]);
    }
}

// What becomes of a candidate: its code is that of none, of one that is only near, or stays as it was of
// one that touches. Such a pair of which both stand still is parked: it keeps its history and is not
// computed. Over the candidates of a block one after the other, whoever's they are: a grain has four, and
// a loop as short as that, or a jump on what becomes of one, is not foreseen by the processor.
template <class T>
void Engine::KernelOf<T>::sort_candidates(const std::vector<float>& signed_reach) {
    const auto& s = e.state_;
    const std::size_t n = s.size();
    const double period = e.options_.period_y, inv_period = period > 0 ? 1 / period : 0;
    const double period_x = e.options_.period_x, inv_period_x = period_x > 0 ? 1 / period_x : 0;
    const double period_z = e.options_.period_z, inv_period_z = period_z > 0 ? 1 / period_z : 0;
    const bool small_gas = inv_period_x != 0 || inv_period_z != 0;
    blocks.assign((n + kBlock - 1) / kBlock, Block{});
    on_own_thread([&](std::size_t b) {
        constexpr int kLanes = 8;
        const Place* const place = s.place.data();
        const float* const reach = signed_reach.data();
        const TileBefore* const before = tiles_before.data();
        const std::int32_t* const candidate = e.candidate_.data();
        std::int32_t* const slots = e.candidate_slot_.data();
        const auto first_i = static_cast<std::int32_t>(b * kBlock);
        const std::int32_t from = e.candidate_first_[first_i],
                           end = e.candidate_first_[std::min(n, (b + 1) * kBlock)];
        const std::uint8_t* const owner = owners(b);
        std::int32_t touching = 0, apart = 0, parked = 0;
        for (std::int32_t c = from; c < end; c += kLanes) {
            const int count = std::min(kLanes, end - c);
            std::int32_t i[kLanes], j[kLanes];
            I8 codes = I8{} + kNone;
            F8 reach_i, reach_j;
            std::memcpy(&codes, &slots[c], static_cast<std::size_t>(count) * sizeof slots[c]);
            for (int lane = 0; lane < kLanes; ++lane) {
                const std::int32_t at = std::min(c + lane, end - 1);
                i[lane] = first_i + owner[at - from];
                j[lane] = candidate[at];
                reach_i[lane] = reach[i[lane]];
                reach_j[lane] = reach[j[lane]];
            }
            D8 d[4];
            gather4(d, 0, [&](int lane) {
                const D4 turn = {-1, -1, -1, 1};
                return *reinterpret_cast<const D4*>(&place[i[lane]]) +
                       turn * *reinterpret_cast<const D4*>(&place[j[lane]]);
            });
            d[1] -= period * nearest_whole(d[1] * inv_period);
            if (small_gas) {
                d[0] -= period_x * nearest_whole(d[0] * inv_period_x);
                d[2] -= period_z * nearest_whole(d[2] * inv_period_z);
            }
            const D8 cut = d[3] + __builtin_convertvector(magnitude(reach_i), D8) +
                           __builtin_convertvector(magnitude(reach_j), D8);
            const std::uint32_t real = (1u << count) - 1,
                                still = bits_where_less(reach_i, F8{}) & bits_where_less(reach_j, F8{}),
                                within = bits_where_less(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], cut * cut);
            std::uint32_t touched = 0;
            for (std::uint32_t known = bits_of((codes != kNone) & (codes != kApart)) & real; known != 0;
                 known &= known - 1) {
                const int lane = std::countr_zero(known);
                const std::size_t old = slot_of(slots[c + lane]);
                touched |= (before[old / W].touched >> old % W & 1) << lane;
            }
            const std::uint32_t near = within & real & ~still & ~touched;
            const I8 kept = lanes_of(touched) ? codes : lanes_of(near) ? I8{} + kApart : I8{} + kNone;
            std::memcpy(&slots[c], &kept, static_cast<std::size_t>(count) * sizeof slots[c]);
            apart += std::popcount(near);
            parked += std::popcount(touched & still);
            touching += std::popcount(touched & ~still);
        }
        blocks[b].own_touching = touching;
        blocks[b].own_end = touching + apart;
        blocks[b].own_parked = parked;
    });
}

template <class T>
void Engine::KernelOf<T>::fill_tiles(const std::vector<float>& signed_reach) {
    const std::size_t n = e.state_.size(), active_tiles = (active_slots + W - 1) / W;
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
    const int each = numbers_per_spring();
    // Only who is the first to find it writes: the flags of many blocks share a line of the cache.
    const auto note_still = [&](std::size_t grain) {
        const std::atomic_ref<std::uint8_t> flag(blocks[grain / kBlock].presses_still);
        if (!flag.load(std::memory_order_relaxed)) flag.store(1, std::memory_order_relaxed);
    };
    on_own_thread([&](std::size_t b) {
        const float* const reach = signed_reach.data();
        const TileBefore* const before = tiles_before.data();
        PairTile* const to = tiles.data();
        RollTile* const roll_to = rolls.data();
        const std::int32_t* const candidate = e.candidate_.data();
        std::int32_t* const slots = e.candidate_slot_.data();
        Block& block = blocks[b];
        const auto first_i = static_cast<std::int32_t>(b * kBlock);
        const std::int32_t begin = e.candidate_first_[first_i],
                           end = e.candidate_first_[std::min(n, (b + 1) * kBlock)];
        const std::uint8_t* const owner = owners(b);
        std::size_t next_touching = static_cast<std::size_t>(block.first_tile) * W,
                    next_apart = next_touching + static_cast<std::size_t>(block.own_touching),
                    next_parked = active_tiles * W + static_cast<std::size_t>(block.own_parked);
        std::int32_t highest = -1;
        for (std::int32_t from = begin; from < end; from += 32) {
            std::uint32_t kept = 0;
            for (std::int32_t k = 0; k < std::min(32, end - from); ++k)
                kept |= static_cast<std::uint32_t>(slots[from + k] != kNone) << k;
            for (; kept != 0; kept &= kept - 1) {
                const std::int32_t c = from + std::countr_zero(kept), j = candidate[c], code = slots[c],
                                   i = first_i + owner[c - begin];
                const bool apart = code == kApart, still_i = reach[i] < 0, still_j = reach[j] < 0,
                           parked = still_i & still_j;
                std::size_t& next = apart ? next_apart : parked ? next_parked : next_touching;
                const std::size_t slot = next++;
                PairTile& t = to[slot / W];
                const int lane = static_cast<int>(slot % W);
                t.i[lane] = i;
                t.j[lane] = j;
                t.touching[lane] = S(!apart);
                slots[c] = static_cast<std::int32_t>(slot);
                // springs change sign with the pair's orientation; one that is only near has none
                const std::size_t old = apart ? 0 : slot_of(code);
                const S turn = code >= 0 ? S(1) : S(-1);
                const std::uint32_t ahead = before[old / W].touched & ((std::uint32_t{1} << old % W) - 1);
                const S* const spring =
                    springs.data() +
                    (apart ? 0
                           : static_cast<std::size_t>(before[old / W].first + std::popcount(ahead)) * each);
                for (int k = 0; k < 3; ++k) t.xi[k][lane] = apart ? S(0) : turn * spring[k];
                if (has_rolls)
                    for (int k = 0; k < 3; ++k)
                        roll_to[slot / W].angle[k][lane] = apart ? S(0) : turn * spring[3 + k];
                if (parked) continue;
                highest = std::max(highest, j);
                if (still_i) note_still(static_cast<std::size_t>(i));
                if (still_j) note_still(static_cast<std::size_t>(j));
            }
        }
        block.reach = highest;
        for (std::int32_t k = block.first_tile; k < block.end_tile; ++k)
            write_constants(tiles[k], std::min<std::int32_t>(W, block.own_end - k * W));
        pad(block.own_end, static_cast<std::size_t>(block.end_tile) * W);
    });
    pad(active_tiles * W + parked_slots, tiles.size() * W);
}

template <class T>
void Engine::KernelOf<T>::rebuild_near() {
    const auto& s = e.state_;
    const std::size_t n = s.size();
    if (e.candidate_slot_.size() != e.candidate_.size()) e.candidate_slot_.assign(e.candidate_.size(), kNone);
    keep_springs();
    if (tiles_before.empty()) tiles_before.push_back({0, 0});  // what a candidate without history looks up
    std::vector<float> signed_reach(n);                        // < 0: it stands still
#pragma omp parallel for schedule(static) num_threads(e.threads_)
    for (std::size_t i = 0; i < n; ++i)
        signed_reach[i] = s.fixed[i] | s.asleep[i] ? -e.reach_[i] : e.reach_[i];
    sort_candidates(signed_reach);
    // Slots of the active pairs; every block begins on a tile of its own. Those that touch come first: a tile
    // in which nothing touches costs a quarter (contact_pass.cpp).
    std::int32_t next = 0, next_parked = 0;
    for (Block& block : blocks) {
        next = (next + W - 1) / W * W;
        block.first_tile = next / W;
        next += block.own_end;
        block.own_end = next;
        block.end_tile = (next + W - 1) / W;
        next_parked += std::exchange(block.own_parked, next_parked);
    }
    active_slots = next;
    parked_slots = next_parked;
    const std::size_t active_tiles = (active_slots + W - 1) / W, parked_tiles = (parked_slots + W - 1) / W;
    tiles.resize(active_tiles + parked_tiles);
    if (has_rolls) rolls.resize(tiles.size());
    fill_tiles(signed_reach);
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
std::array<double, 3> Engine::KernelOf<T>::force_on_fixed_of(const Block& block, const Sums& from) const {
    std::array<double, 3> sum{};
    if (!block.presses_still) return sum;
    const auto first = static_cast<std::int32_t>(&block - blocks.data());
    for (std::int32_t i = first_grain(first); i < first_grain(first + 1); ++i)
        if (e.state_.fixed[i])
            for (int k = 0; k < 3; ++k) sum[k] += double(from[i].value[k]);
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
Engine::Overlaps Engine::KernelOf<T>::overlaps(double rule) const {
    Overlaps seen;
    for_each_overlap([&](double ratio) {
        seen.largest = std::max(seen.largest, ratio);
        seen.contacts += ratio > 0;
        seen.beyond += ratio > rule;
    });
    return seen;
}

template <class T>
double Engine::KernelOf<T>::memory_bytes() const {
    auto bytes = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
    return bytes(motion) + bytes(tiles) + bytes(tiles_before) + bytes(rolls) + bytes(walls) +
           bytes(old_walls) + bytes(sums) + bytes(springs) + bytes(kept) + bytes(wall_first) + bytes(blocks);
}

template struct Engine::KernelOf<double>;
template struct Engine::KernelOf<WideFloat>;

}  // namespace gradwright
