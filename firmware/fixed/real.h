/// Numbers with an exponent, for the few formulas whose values span many magnitudes: what a
/// floating-point unit would do, in integers, the same bits everywhere.
///
/// Where every quantity has a known range, plain fixed point is smaller and faster; it is used for
/// all that touches every point. A `struct real` is for the handful of operations per decision that
/// divide and take roots: circles through three others, small linear systems.
#ifndef FIXED_REAL_H
#define FIXED_REAL_H

#include "fixed/wide.h"

#include <stdbool.h>
#include <stdint.h>

/// mantissa * 2^exponent with 2^60 <= |mantissa| < 2^61, or zero (0, 0). Exponents of inputs must
/// stay within +-10,000, so that no chain of the operations here can leave int32.
struct real {
    int64_t mantissa;
    int32_t exponent;
};

/// value * 2^exponent, exactly where |value| < 2^61, else its leading 61 bits. Not INT64_MIN.
struct real real(int64_t value, int32_t exponent);

/// Accuracy of + - * / and root: relative 2^-60, and the difference of numbers within a factor of
/// two of each other is exact (tests/property/real.c).
struct real real_add(struct real a, struct real b);
struct real real_sub(struct real a, struct real b);
struct real real_mul(struct real a, struct real b);
/// A divisor of zero gives zero: callers decide before whether a quotient exists.
struct real real_div(struct real a, struct real b);
/// The root of a negative number is zero.
struct real real_root(struct real a);

static inline struct real real_neg(struct real a) {
    return (struct real){-a.mantissa, a.exponent};
}

static inline struct real real_abs(struct real a) {
    return a.mantissa < 0 ? real_neg(a) : a;
}

static inline int real_sign(struct real a) {
    return (a.mantissa > 0) - (a.mantissa < 0);
}

/// a * 2^shift.
static inline struct real real_scale(struct real a, int32_t shift) {
    return (struct real){a.mantissa, a.mantissa == 0 ? 0 : a.exponent + shift};
}

static inline bool real_less(struct real a, struct real b) {
    return real_sub(a, b).mantissa < 0;
}

/// a * 2^bits as an integer, rounded to nearest, half away from zero; what does not fit becomes
/// +-2^62.
int64_t real_to_i64(struct real a, int32_t bits);

#endif
