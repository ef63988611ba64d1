// Random numbers that are the same bits on every machine and library: xoshiro256** (Blackman, Vigna 2018,
// public domain), seeded by splitmix64 so that neighbouring seeds give unrelated streams. The distributions
// of <random> are left to the library by the standard, so a seed would mean different beds elsewhere.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

namespace gradwright {

struct Random {
    explicit Random(std::uint64_t seed) {
        for (std::uint64_t& word : state_) {
            seed += 0x9e3779b97f4a7c15ULL;
            std::uint64_t z = seed;
            z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
            z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
            word = z ^ (z >> 31);
        }
    }

    std::uint64_t next() {
        const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
        const std::uint64_t shifted = state_[1] << 17;
        state_[2] ^= state_[0];
        state_[3] ^= state_[1];
        state_[1] ^= state_[2];
        state_[0] ^= state_[3];
        state_[2] ^= shifted;
        state_[3] = rotate(state_[3], 45);
        return result;
    }

    /// In [0, 1), 53 bits.
    double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

    /// Standard normal (Box and Muller; the second value is not kept, so that the state is the four words
    /// alone).
    double normal() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return radius * std::cos(2.0 * std::numbers::pi * uniform());
    }

    /// In 0 .. n-1 without bias; n > 0. Values of the last incomplete run of n are thrown away.
    std::uint64_t below(std::uint64_t n) {
        const std::uint64_t unusable = (0 - n) % n;  // 2^64 mod n
        std::uint64_t value = next();
        while (value < unusable) value = next();
        return value % n;
    }

  private:
    static std::uint64_t rotate(std::uint64_t value, int bits) {
        return (value << bits) | (value >> (64 - bits));
    }
    std::uint64_t state_[4];
};

}  // namespace gradwright
