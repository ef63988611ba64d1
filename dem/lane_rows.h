// Between grains and lanes: the records of the grains of a tile's pairs become one vector a quantity, forces
// become one record a pair again. A row is one grain's or pair's, a column one quantity of all lanes. Private
// to dem/.
#pragma once
#include "dem/lanes.h"

namespace gradwright {

/// Both halves of the lanes, in float.
inline F8 join(D4 lo, D4 hi) {
    const F4 a = __builtin_convertvector(lo, F4), b = __builtin_convertvector(hi, F4);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline F16 join(D8 lo, D8 hi) {
    const F8 a = __builtin_convertvector(lo, F8), b = __builtin_convertvector(hi, F8);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

/// Four rows of four, `row(lane)`, as columns: lanes [first, first + 4).
template <class Row>
inline void gather4(D4 out[4], int first, Row&& row) {
    const D4 a = row(first), b = row(first + 1), c = row(first + 2), d = row(first + 3);
    const D4 ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const D4 cd0 = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    out[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    out[2] = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    out[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}
/// Eight of them. Which two rows share a register is chosen so that the columns come out in order.
template <class Row>
inline void gather4(D8 out[4], int first, Row&& row) {
    const auto two = [&](int lo, int hi) {
        return __builtin_shufflevector(row(first + lo), row(first + hi), 0, 1, 2, 3, 4, 5, 6, 7);
    };
    const D8 a = two(0, 2), b = two(1, 3), c = two(4, 6), d = two(5, 7);
    const D8 ab0 = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
             ab1 = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const D8 cd0 = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
             cd1 = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    out[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5, 8, 9, 12, 13);
    out[1] = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5, 8, 9, 12, 13);
    out[2] = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7, 10, 11, 14, 15);
    out[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7, 10, 11, 14, 15);
}

/// Within each run of four lanes: four columns' four by four.
template <class T>
inline void turn4(T c[4]) {
    if constexpr (Lane<T>::kWidth == 8) {
        const T ab0 = __builtin_shufflevector(c[0], c[1], 0, 8, 1, 9, 4, 12, 5, 13),
                ab1 = __builtin_shufflevector(c[0], c[1], 2, 10, 3, 11, 6, 14, 7, 15);
        const T cd0 = __builtin_shufflevector(c[2], c[3], 0, 8, 1, 9, 4, 12, 5, 13),
                cd1 = __builtin_shufflevector(c[2], c[3], 2, 10, 3, 11, 6, 14, 7, 15);
        c[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 8, 9, 4, 5, 12, 13);
        c[1] = __builtin_shufflevector(ab0, cd0, 2, 3, 10, 11, 6, 7, 14, 15);
        c[2] = __builtin_shufflevector(ab1, cd1, 0, 1, 8, 9, 4, 5, 12, 13);
        c[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 10, 11, 6, 7, 14, 15);
    } else {
        const auto low = [](T a, T b) {
            return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
        };
        const auto high = [](T a, T b) {
            return __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
        };
        const auto first = [](T a, T b) {
            return __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
        };
        const auto second = [](T a, T b) {
            return __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
        };
        const T ab0 = low(c[0], c[1]), ab1 = high(c[0], c[1]);
        const T cd0 = low(c[2], c[3]), cd1 = high(c[2], c[3]);
        c[0] = first(ab0, cd0);
        c[1] = second(ab0, cd0);
        c[2] = first(ab1, cd1);
        c[3] = second(ab1, cd1);
    }
}

/// Rows of eight, `row(lane)`, as eight columns.
template <class Row>
inline void gather8(F8 out[8], Row&& row) {
    for (int k = 0; k < 8; ++k) out[k] = row(k);
    turn4(out);
    turn4(out + 4);
    for (int k = 0; k < 4; ++k) {
        const F8 a = out[k], b = out[k + 4];
        out[k] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
        out[k + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    }
}
template <class Row>
inline void gather8(F16 out[8], Row&& row) {
    const auto two = [&](int lo, int hi) {
        return __builtin_shufflevector(row(lo), row(hi), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                       15);
    };
    for (int k = 0; k < 4; ++k) {
        out[k] = two(k, k + 4);
        out[k + 4] = two(k + 8, k + 12);
    }
    turn4(out);
    turn4(out + 4);
    for (int k = 0; k < 4; ++k) {
        const F16 a = out[k], b = out[k + 4];
        out[k] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27);
        out[k + 4] =
            __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31);
    }
}

/// Eight columns as rows of eight, one after the other in memory. The columns are used up.
inline void write_rows(F8 columns[8], F8* rows) {
    turn4(columns);
    turn4(columns + 4);
    for (int k = 0; k < 4; ++k) {
        const F8 a = columns[k], b = columns[k + 4];
        rows[k] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
        rows[k + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    }
}
inline void write_rows(F16 columns[8], F8* rows) {
    turn4(columns);
    turn4(columns + 4);
    for (int k = 0; k < 4; ++k) {
        const F16 a = columns[k], b = columns[k + 4];
        rows[k] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 16, 17, 18, 19);
        rows[k + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 20, 21, 22, 23);
        rows[k + 8] = __builtin_shufflevector(a, b, 8, 9, 10, 11, 24, 25, 26, 27);
        rows[k + 12] = __builtin_shufflevector(a, b, 12, 13, 14, 15, 28, 29, 30, 31);
    }
}

}  // namespace gradwright
