// Number types of the contact law: `double` (one contact at a time, the reference), `F8` and `F16` (eight and
// sixteen contacts in float). The law is one text over all (contact_law.h). Plain GCC vector extensions: the
// compiler maps F8 to one AVX register or two SSE ones, so the same source serves any x86-64 or Arm machine;
// std::experimental::simd would add nothing here but compile time. F16 is for machines with registers that
// wide; lane by lane both give the same bits.
#pragma once
#include <cmath>
#include <cstdint>

namespace gradwright {

using F8 = float __attribute__((vector_size(32)));
using F4 = float __attribute__((vector_size(16)));
using F16 = float __attribute__((vector_size(64)));
using I8 = std::int32_t __attribute__((vector_size(32)));
using I16 = std::int32_t __attribute__((vector_size(64)));
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
    using Half = D4;  ///< half the lanes in double
};
template <>
struct Lane<F16> {
    static constexpr int kWidth = 16;
    using Scalar = float;
    using Sum = F8;
    using Half = D8;
};

/// The wide law's type on the machine it is compiled for.
#ifdef __AVX512F__
using WideFloat = F16;
#else
using WideFloat = F8;
#endif

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
inline F16 root(F16 v) {
#ifdef __AVX512F__
    return __builtin_ia32_sqrtps512_mask(v, v, -1, 4);
#else
    F16 out;
    for (int lane = 0; lane < 16; ++lane) out[lane] = std::sqrt(v[lane]);
    return out;
#endif
}
/// 1/v and 1/sqrt(v) to a few parts in 1e5 or better, v > 0: for iterations that mend the error.
inline double rough_inverse(double v) {
    return 1 / v;
}
inline double rough_inverse_root(double v) {
    return 1 / std::sqrt(v);
}
inline F8 rough_inverse(F8 v) {
    return 1.0f / v;
}
inline F8 rough_inverse_root(F8 v) {
    return 1.0f / root(v);
}
inline F16 rough_inverse(F16 v) {
#ifdef __AVX512F__
    return __builtin_ia32_rcp14ps512_mask(v, v, -1);
#else
    return 1.0f / v;
#endif
}
inline F16 rough_inverse_root(F16 v) {
#ifdef __AVX512F__
    return __builtin_ia32_rsqrt14ps512_mask(v, v, -1);
#else
    return 1.0f / root(v);
#endif
}
inline double larger(double a, double b) {
    return a > b ? a : b;
}
inline F8 larger(F8 a, F8 b) {
    return a > b ? a : b;
}
inline F16 larger(F16 a, F16 b) {
    return a > b ? a : b;
}
inline double smaller(double a, double b) {
    return a < b ? a : b;
}
inline F8 smaller(F8 a, F8 b) {
    return a < b ? a : b;
}
inline F16 smaller(F16 a, F16 b) {
    return a < b ? a : b;
}
inline double choose(bool mask, double a, double b) {
    return mask ? a : b;
}
inline F8 choose(I8 mask, F8 a, F8 b) {
    return mask ? a : b;
}
inline F16 choose(I16 mask, F16 a, F16 b) {
    return mask ? a : b;
}
inline double magnitude(double v) {
    return std::fabs(v);
}
inline F8 magnitude(F8 v) {
    return v < 0.0f ? -v : v;
}
inline F16 magnitude(F16 v) {
    return v < 0.0f ? -v : v;
}

/// One bit a lane where a < b, lane 0 lowest.
inline std::uint32_t bits_where_less(F8 a, F8 b) {
#ifdef __AVX__
    return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<F8>(a < b)));
#else
    std::uint32_t bits = 0;
    for (int lane = 0; lane < 8; ++lane) bits |= std::uint32_t{a[lane] < b[lane]} << lane;
    return bits;
#endif
}
/// One bit a lane of a comparison's result, and back.
inline std::uint32_t bits_of(I8 mask) {
    return bits_where_less(__builtin_convertvector(mask, F8), F8{});  // true is -1
}
inline I8 lanes_of(std::uint32_t bits) {
    const I8 lane = {1, 2, 4, 8, 16, 32, 64, 128};
    return ((I8{} + static_cast<std::int32_t>(bits)) & lane) != 0;
}
inline std::uint32_t bits_where_less(F16 a, F16 b) {
#ifdef __AVX512F__
    return __builtin_ia32_cmpps512_mask(a, b, 1, -1, 4);
#else
    std::uint32_t bits = 0;
    for (int lane = 0; lane < 16; ++lane) bits |= std::uint32_t{a[lane] < b[lane]} << lane;
    return bits;
#endif
}
inline std::uint32_t bits_where_less(D8 a, D8 b) {
#ifdef __AVX512F__
    return __builtin_ia32_cmppd512_mask(a, b, 1, -1, 4);
#else
    std::uint32_t bits = 0;
    for (int lane = 0; lane < 8; ++lane) bits |= std::uint32_t{a[lane] < b[lane]} << lane;
    return bits;
#endif
}
/// The nearest whole number, lane by lane.
inline F8 nearest_whole(F8 v) {
#ifdef __AVX__
    return __builtin_ia32_roundps256(v, 0);
#else
    for (int lane = 0; lane < 8; ++lane) v[lane] = std::nearbyint(v[lane]);
    return v;
#endif
}
inline F16 nearest_whole(F16 v) {
#ifdef __AVX512F__
    return __builtin_ia32_rndscaleps_mask(v, 0, v, -1, 4);
#else
    for (int lane = 0; lane < 16; ++lane) v[lane] = std::nearbyint(v[lane]);
    return v;
#endif
}
inline D4 nearest_whole(D4 v) {
#ifdef __AVX__
    return __builtin_ia32_roundpd256(v, 0);
#else
    for (int lane = 0; lane < 4; ++lane) v[lane] = std::nearbyint(v[lane]);
    return v;
#endif
}
inline D8 nearest_whole(D8 v) {
#ifdef __AVX512F__
    return __builtin_ia32_rndscalepd_mask(v, 0, v, -1, 4);
#else
    for (int lane = 0; lane < 8; ++lane) v[lane] = std::nearbyint(v[lane]);
    return v;
#endif
}

/// A load from anywhere.
template <class T>
inline T load_unaligned(const typename Lane<T>::Scalar* from) {
    T out;
    __builtin_memcpy(&out, from, sizeof out);
    return out;
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
