// Wall contacts: the grains close enough to a body to touch it before the next refresh, in tiles as wide as
// the law, with their history.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/kernel.h"

namespace gradwright {

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
        if (s.asleep[i]) blocks[i / kBlock].presses_still = 1;
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

#define GRADWRIGHT_WALLS(T)                              \
    template void Engine::KernelOf<T>::rebuild_walls();  \
    template void Engine::KernelOf<T>::forget_body(int); \
    template BodyForce Engine::KernelOf<T>::force_on_body(int) const;
GRADWRIGHT_WALLS(double)
GRADWRIGHT_WALLS(WideFloat)

}  // namespace gradwright
