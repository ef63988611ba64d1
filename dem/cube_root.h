// Cube roots of a vector's width, for the pull-off radius of JKR contacts. Private to dem/.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

namespace gradwright {

/// v >= 0 becomes its cube root.
inline void cube_roots(double (&v)[1]) {
    v[0] = std::cbrt(v[0]);
}
/// The same of a vector's width at once, v >= 0: a third of the exponent, good to 5 %, and three of Halley's
/// steps, each of which leaves 2/3 of the error's cube. What std::cbrt takes, one after the other, was a
/// twentieth of a spread.
template <int kCount>
inline void cube_roots(double (&v)[kCount]) {
    for (int lane = 0; lane < kCount; ++lane) {
        const double x = v[lane];
        const auto high = std::bit_cast<std::uint64_t>(x) >> 32;
        // high / 3 by a product; 715094163 is 2/3 of the exponent's bias, less what makes the error smallest
        double y = std::bit_cast<double>(((high * 0xAAAAAAABull >> 33) + 715094163u) << 32);
        for (int step = 0; step < 3; ++step) {
            const double y3 = y * y * y;
            y *= (y3 + 2 * x) / (2 * y3 + x);
        }
        v[lane] = x > 0 ? y : 0;
    }
}

}  // namespace gradwright
