/// Q1.30 fixed point: 2^30 is one. Unit vectors, sines and cosines.
///
/// A q30_t is a plain int32_t so that the compiler's integer arithmetic applies; what it means
/// stands in the name of the variable (`ahead_q30`). Range of the type: [-2, 2), of the values
/// used: [-1, 1].
#ifndef FIXED_Q30_H
#define FIXED_Q30_H

#include <stdint.h>

typedef int32_t q30_t;

#define Q30_ONE ((q30_t)1 << 30)

/// value / 2^bits, rounded to nearest, half away from zero, so that f(-v) = -f(v).
/// Why odd: a rounded set of directions must stay antipodal where the exact one was.
/// bits: 1 to 62; |value| < 2^63 - 2^(bits-1). Shown: tests/unit/test_fixed.c "odd rounding".
static inline int64_t round_shift_i64(int64_t value, unsigned bits) {
    const int64_t half = (int64_t)1 << (bits - 1U);
    return value >= 0 ? (value + half) >> bits : -((-value + half) >> bits);
}

/// Product of two Q1.30 numbers, within 0.5 ulp. |a| and |b| at most 2^30 (or a product below 2).
static inline q30_t q30_mul(q30_t a, q30_t b) {
    return (q30_t)round_shift_i64((int64_t)a * b, 30U);
}

#endif
