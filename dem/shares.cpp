// Which thread sweeps which blocks of grains, or which steps: cut so that all end together, whoever the other
// users of the cores are. What is computed does not depend on it, nor in which order it is added.
#include <algorithm>
#include <bit>
#include <numeric>

#include "dem/kernel.h"

namespace gradwright {

template <class T>
void Engine::KernelOf<T>::share_out() {
    const auto count = static_cast<std::int32_t>(blocks.size());
    // in tiles that touch, 120 ns: one in which nothing does takes 35 ns, a wall contact 15 ns and its tile
    // 120 ns, a grain 4 ns, handing a tile over beyond the share 40 ns
    const auto cost_of_pairs = [&](std::int32_t b) {
        const std::int32_t all = blocks[b].end_tile - blocks[b].first_tile,
                           live = (blocks[b].own_touching + W - 1) / W;
        return live + 0.3 * (all - live);
    };
    const auto weight = [&](std::int32_t b) {
        const Block& block = blocks[b];
        return cost_of_pairs(b) + (block.end_wall - block.first_wall) +
               0.125 * (block.wall_end - block.first_wall * W) +
               0.035 * (block.end_awake - block.first_awake);
    };
    double all = 0;
    for (std::int32_t b = 0; b < count; ++b) all += weight(b);
    const auto tiles_of = [&](std::int32_t from, std::int32_t to) {
        return from < to ? blocks[to - 1].end_tile - blocks[from].first_tile : 0;
    };
    const auto cost_of = [&](const Share& share) {
        double sum = 0;
        for (std::int32_t b = share.tail; b < share.end; ++b)
            sum += (blocks[b].reach >= first_grain(share.end) ? 1.35 : 1.0) * cost_of_pairs(b);
        return sum;
    };
    // False when a share's pairs reach beyond its neighbour: two would then add to the same sums at once.
    const auto cut = [&](std::int32_t threads) {
        shares.assign(threads, Share{});
        std::int32_t next = 0;
        double done = 0, wanted = 0, longest = 0;  // tail, in time
        if (static_cast<std::int32_t>(pace.size()) != threads) {
            pace.assign(threads, 1.0);
            tail_pace.assign(threads, 1.0);
        }
        for (std::int32_t t = 0; t < threads; ++t) {
            shares[t].first = next;
            wanted += all * pace[t] / std::accumulate(pace.begin(), pace.end(), 0.0);
            while (next < count && (t == threads - 1 || done + 0.5 * weight(next) < wanted))
                done += weight(next++);
            shares[t].end = next;
        }
        for (std::int32_t t = 0; t < threads; ++t) {
            Share& share = shares[t];
            share.tail = share.end;
            for (std::int32_t b = share.end; b-- > share.first;) {
                if (blocks[b].reach >= first_grain(share.end)) share.tail = b;
                if (t + 1 < threads && blocks[b].reach >= first_grain(shares[t + 1].end)) return false;
            }
            longest = std::max(longest, cost_of(share) / tail_pace[t]);
        }
        // While the longest tail is computed the others do not wait: theirs is made as long. A tail that
        // reaches into another thread's grains waits for them, one that was made longer does not.
        for (std::int32_t t = 0; t < threads; ++t) {
            Share& share = shares[t];
            while (share.tail > share.first &&
                   cost_of(share) + 0.5 * cost_of_pairs(share.tail - 1) < longest * tail_pace[t])
                --share.tail;
        }
        return true;
    };
    // fewer grains than this per thread cost more in waiting than they win
    auto threads = static_cast<std::int32_t>(std::clamp<std::size_t>(e.awake_.size() / 200, 1, e.threads_));
    choose_levels();
    if (levels > 0) threads = 1;
    while (!cut(threads)) --threads;
    // The energy account reads after the step what every pair did.
    if (e.options_.energy_account)
        for (Share& share : shares) share.tail = share.first;
    std::int32_t kept_tiles = 0;
    for (Share& share : shares) {
        share.kept = kept_tiles;
        kept_tiles += tiles_of(share.tail, share.end);
        share.tail_cost = cost_of(share);
        for (std::int32_t b = share.tail; b < share.end; ++b)
            share.reach = std::max(share.reach, blocks[b].reach);
        share.cost = 0;
        for (std::int32_t b = share.first; b < share.end; ++b) share.cost += weight(b);
    }
    kept.resize(kept_tiles);
    make_sums();
}

template <class T>
void Engine::KernelOf<T>::choose_levels() {
    // Steps at once, of all threads together. Two are enough where the bed is ten times the cache, not where
    // it is a little larger; eight are no better.
    constexpr int kAtOnce = 4;
    // Threads that have a share each also have the room of their own caches: 100 000 grains on two threads 86
    // million grain-steps/s by shares, 80 by levels, 300 000 grains 73 and 85.
    constexpr double kRoomOfShare = 1.5;
    levels = 0;
    // The list's first and last steps go alone: of more threads than steps at once most would mostly wait
    // (reckoned, not measured).
    if (!beyond_cache() || e.options_.energy_account || e.threads_ > kAtOnce) return;
    if (e.threads_ > 1 && static_cast<double>(e.awake_.size()) <=
                              kRoomOfShare * e.threads_ * static_cast<double>(e.options_.cached_grains))
        return;
    // Towards the end of a list few steps are sure to be left, and with fewer than steps at once some threads
    // have none: 300 000 flowing grains, 33 steps a list, two threads 58 million grain-steps/s by shares, 52
    // by levels.
    constexpr double kLongList = 100;
    if (e.threads_ > 1 && e.list_lasts_ < kLongList) return;
    const int each = kAtOnce / e.threads_;
    std::int32_t window = 1;
    for (std::int32_t b = 0; b < static_cast<std::int32_t>(blocks.size()); ++b)
        window = std::max(window, last_met(b) - b + 1);
    // threads of which the last can only begin when the first is half done win nothing
    if (e.threads_ == 1 ||
        static_cast<std::int64_t>(blocks.size()) >= std::int64_t{2} * e.threads_ * each * window)
        levels = each;
}

template <class T>
void Engine::KernelOf<T>::make_sums() {
    std::int32_t widest = 1;
    for (std::size_t t = 0; t < shares.size(); ++t) {
        // what lies beyond the share is summed in the next one's ring, from the first block on
        const std::int32_t end = first_grain(shares[t].end);
        std::int32_t furthest = t > 0 ? shares[t - 1].reach : -1;
        for (std::int32_t b = shares[t].first; b < shares[t].end; ++b) {
            furthest = std::max({furthest, std::min(blocks[b].reach, end - 1), first_grain(b + 1) - 1});
            widest = std::max(widest, furthest + 1 - first_grain(b));
        }
    }
    const std::size_t places = std::bit_ceil(static_cast<std::size_t>(widest));
    sums_mask = static_cast<std::int32_t>(places) - 1;
    const std::size_t rings = levels > 0 ? static_cast<std::size_t>(levels) * e.threads_ : shares.size();
    sums.assign(places * rings, Record{});
}

template <class T>
void Engine::KernelOf<T>::learn_pace(const std::vector<Busy>& busy) {
    const std::size_t count = shares.size();
    if (count < 2 || pace.size() != count) return;
    const auto learn = [count](std::vector<double>& known, const auto& cost, const auto& seconds) {
        double mean = 0;
        std::vector<double> rate(count);
        for (std::size_t k = 0; k < count; ++k) {
            rate[k] = cost(k) / seconds(k);
            if (!(seconds(k) > 0) || !(rate[k] > 0)) return;
            mean += rate[k] / static_cast<double>(count);
        }
        constexpr double kTrust = 0.25;  // of one list's steps, some milliseconds
        for (std::size_t k = 0; k < count; ++k)
            known[k] = std::clamp(known[k] + kTrust * (rate[k] / mean - known[k]), 0.25, 4.0);
    };
    learn(
        pace, [this](std::size_t k) { return shares[k].cost; },
        [&busy](std::size_t k) { return busy[k].tail + busy[k].sweep; });
    learn(
        tail_pace, [this](std::size_t k) { return shares[k].tail_cost; },
        [&busy](std::size_t k) { return busy[k].tail; });
}

template void Engine::KernelOf<double>::share_out();
template void Engine::KernelOf<WideFloat>::share_out();
template void Engine::KernelOf<double>::learn_pace(const std::vector<Busy>&);
template void Engine::KernelOf<WideFloat>::learn_pace(const std::vector<Busy>&);

}  // namespace gradwright
