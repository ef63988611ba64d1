// Number types of the contact law: `double` (one contact at a time, the reference) and `F8` (eight contacts
// in float). The law is one text over either (contact_law.h). Plain GCC vector extensions: the compiler maps
// F8 to one AVX register or two SSE ones, so the same source serves any x86-64 or Arm machine;
// std::experimental::simd would add nothing here but compile time.
#pragma once
#include <cmath>
#include <cstdint>

namespace gradwright {

using F8 = float __attribute__((vector_size(32)));
using F4 = float __attribute__((vector_size(16)));
using I8 = std::int32_t __attribute__((vector_size(32)));
using D4 = double __attribute__((vector_size(32)));
using D8 = double __attribute__((vector_size(64)));

template <class T>
struct Lane;
template <>
struct Lane<double> {
    static constexpr int kWidth = 1;
    using Scalar = double;
    using Sum = D8;  ///< one grain's force and torque, two spare
};
template <>
struct Lane<F8> {
    static constexpr int kWidth = 8;
    using Scalar = float;
    using Sum = F8;
};

template <class T>
inline T splat(double value) {
    if constexpr (Lane<T>::kWidth == 1) {
        return value;
    } else {
        return T{} + static_cast<typename Lane<T>::Scalar>(value);
    }
}

inline double root(double v) {
    return std::sqrt(v);
}
inline F8 root(F8 v) {
#ifdef __AVX__
    return __builtin_ia32_sqrtps256(v);
#else
    F8 out;
    for (int lane = 0; lane < 8; ++lane) out[lane] = std::sqrt(v[lane]);
    return out;
#endif
}
inline double larger(double a, double b) {
    return a > b ? a : b;
}
inline F8 larger(F8 a, F8 b) {
    return a > b ? a : b;
}
inline double smaller(double a, double b) {
    return a < b ? a : b;
}
inline F8 smaller(F8 a, F8 b) {
    return a < b ? a : b;
}
inline double choose(bool mask, double a, double b) {
    return mask ? a : b;
}
inline F8 choose(I8 mask, F8 a, F8 b) {
    return mask ? a : b;
}
inline double magnitude(double v) {
    return std::fabs(v);
}
inline F8 magnitude(F8 v) {
    return v < 0.0f ? -v : v;
}

/// Loads and stores from plain arrays of Lane<T>::Scalar, aligned to the lane width.
template <class T>
inline T load(const typename Lane<T>::Scalar* from) {
    return *reinterpret_cast<const T*>(from);
}
template <class T>
inline void store(typename Lane<T>::Scalar* to, T value) {
    *reinterpret_cast<T*>(to) = value;
}

}  // namespace gradwright
