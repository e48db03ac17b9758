/// 128-bit unsigned integers, in C that also 32-bit processors compile: what readers and writers of
/// decimals need beyond firmware/fixed/wide.h. Sums and products wrap.
/// Shown: tests/property/u128.c, against GMP.
#ifndef LINUX_U128_H
#define LINUX_U128_H

#include "fixed/wide.h"

static inline struct u128 u128_of(uint64_t a) {
    return (struct u128){a, 0};
}

static inline bool u128_is_zero(struct u128 a) {
    return (a.lo | a.hi) == 0U;
}

static inline struct u128 u128_or(struct u128 a, struct u128 b) {
    return (struct u128){a.lo | b.lo, a.hi | b.hi};
}

static inline struct u128 u128_sub(struct u128 a, struct u128 b) {
    return (struct u128){a.lo - b.lo, a.hi - b.hi - (a.lo < b.lo ? 1U : 0U)};
}

/// a * b modulo 2^128.
struct u128 u128_product(struct u128 a, struct u128 b);

/// a / divisor, rounded down; *rest, unless it is NULL, gets what is left. divisor: not zero.
struct u128 u128_divide(struct u128 a, struct u128 divisor, struct u128 *rest);

/// a * 2^shift and a / 2^shift, rounded down; shift: 0 to 127.
struct u128 u128_shift_left(struct u128 a, unsigned shift);
struct u128 u128_shift_right(struct u128 a, unsigned shift);

/// 0 for 0, 1 for 1, 128 for the largest.
unsigned u128_bit_length(struct u128 a);

/// Within 1.5 units of its last place; nearest where a long double has 64 bits or more.
long double u128_value(struct u128 a);

/// |a|: 2^127 for the least.
struct u128 u128_abs(struct i128 a);

/// a or -a; a: at most 2^127 - 1.
struct i128 i128_with_sign(struct u128 a, bool negative);

/// a * b / divisor, rounded toward zero; where that is beyond int64, INT64_MAX or -INT64_MAX.
/// divisor: not zero.
int64_t i64_mul_div(int64_t a, int64_t b, int64_t divisor);

#endif
