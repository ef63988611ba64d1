// How far each grain may go before a list is made anew.
//
// A pair must be on the near list before it touches. With one skin for all, the fastest grain of all decides
// when that is no longer sure: in a spread some grain always flies or falls, and the list would be made anew
// every few steps for it. So each grain has a reach of its own, in proportion to its speed against the frame:
// a pair is listed when its gap is below the sum of the two reaches, and the list ends when the first grain
// has used up its own. Fast grains carry a few more pairs, all others wait for longer.
//
// The same one level up: the candidates hold every pair whose gap was below the sum of the wide reaches S
// when they were found. A grain that has gone d since then (against the frame) has room S - d left for its
// near reach h: two grains whose gap is below h_i + h_j now had a gap below h_i + d_i + h_j + d_j <= S_i +
// S_j then.
#include <algorithm>
#include <cmath>

#include "dem/kernel.h"

namespace gradwright {
namespace {

// Tried on a strip of the first example with a heap before the blade and on a sliding bed, two threads, in
// million grain-steps/s of the strip: near skins of 0.12, 0.18, 0.24, 0.30 r gave 60, 63, 65, 65 (since tiles
// in which nothing touches are cheap, contact_pass.cpp, longer lists pay), candidate skins of 0.5, 0.8,
// 1, 1.3 times 0.45 r_min + 0.15 r_max 48, 56, 61, 63, longest plans of 32, 48, 64 steps 63, 63, 65 with a
// near skin of 0.2 r.
constexpr double kMargin = 1.2;      // of reach over way in the time the list is meant to last: speeds change
constexpr double kLeastRoom = 0.35;  // of the wide reach, before the candidates are found anew
constexpr double kLongestSteps = 48;  // that a reach is planned for: longer ones only add pairs

double length(double x, double y, double z) {
    return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

void Engine::choose_frame() {
    const State& s = state_;
    double sum[3] = {0, 0, 0}, square = 0;
    long count = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s.fixed[i] || s.asleep[i]) continue;
        sum[0] += s.vx[i];
        sum[1] += s.vy[i];
        sum[2] += s.vz[i];
        square += s.vx[i] * s.vx[i] + s.vy[i] * s.vy[i] + s.vz[i] * s.vz[i];
        ++count;
    }
    frame_ = {};
    typical_speed_ = 0;
    if (count == 0 || !std::isfinite(square)) return;
    double mean2 = 0;
    for (int k = 0; k < 3; ++k) {
        frame_[k] = sum[k] / double(count);
        mean2 += frame_[k] * frame_[k];
    }
    typical_speed_ = std::sqrt(std::max(0.0, square / double(count) - mean2));
}

double Engine::body_speed() const {
    double top = length(frame_[0], frame_[1], frame_[2]);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (bodies_move_ && !body_removed_[b])
            top = std::max(top,
                           length(bodies_[b].speed_x - frame_[0], frame_[1], bodies_[b].speed_z - frame_[2]));
    return top;
}

void Engine::choose_wide_reach() {
    const State& s = state_;
    const double typical = 0.5 * skin_, widest = 0.5 * kWidestReach * skin_;
    wide_reach_.resize(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double speed = length(s.vx[i] - frame_[0], s.vy[i] - frame_[1], s.vz[i] - frame_[2]);
        wide_reach_[i] = static_cast<float>(
            typical_speed_ > 0 ? std::clamp(typical * speed / typical_speed_, typical, widest) : typical);
    }
    wide_body_reach_ =
        typical_speed_ > 0 ? std::clamp(typical * body_speed() / typical_speed_, typical, widest) : typical;
}

bool Engine::choose_reach() {
    const State& s = state_;
    const double typical = 0.5 * near_skin_;
    const double longest = kLongestSteps * options_.time_step;
    const double time = typical_speed_ * longest > typical ? typical / typical_speed_ : longest;
    const auto wanted = [&](double speed) {
        return std::clamp(kMargin * speed * time, typical, kLongestReach * typical);
    };
    int lacking = 0;
    reach_.resize(s.size());
    inverse_reach2_.resize(s.size());
    double still_rate = 0, top_rate = 0;
    const double drift = length(frame_[0], frame_[1], frame_[2]);
#pragma omp parallel for schedule(static) num_threads(threads_) reduction(max : still_rate, top_rate, lacking)
    for (std::size_t i = 0; i < s.size(); ++i) {
        const bool still = s.fixed[i] || s.asleep[i];
        const double speed =
            still ? drift : length(s.vx[i] - frame_[0], s.vy[i] - frame_[1], s.vz[i] - frame_[2]);
        const double gone = built_error_ + length(s.x[i] - built_from_[0] - built_[i][0] - frame_shift_[0],
                                                  s.y[i] - built_from_[1] - built_[i][1] - frame_shift_[1],
                                                  s.z[i] - built_from_[2] - built_[i][2] - frame_shift_[2]);
        const double room = wide_reach_[i] - gone, want = wanted(speed);
        if (room < std::min(want, kLeastRoom * wide_reach_[i])) lacking = 1;
        const double reach = std::max(std::min(want, room), 1e-3 * typical);
        reach_[i] = static_cast<float>(reach);
        inverse_reach2_[i] = static_cast<float>(1 / (reach * reach));
        if (still) still_rate = std::max(still_rate, drift / reach);
        top_rate = std::max(top_rate, speed / reach);
    }
    const double room = wide_body_reach_ - body_way_, want = wanted(body_speed());
    if (room < std::min(want, kLeastRoom * wide_body_reach_)) lacking = 1;
    body_reach_ = std::max(std::min(want, room), 1e-3 * typical);
    still_rate_ = still_rate;
    list_lasts_ = 1 / (options_.time_step * std::max(top_rate, body_speed() / body_reach_));
    return lacking == 0;
}

}  // namespace gradwright
