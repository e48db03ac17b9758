/// Wide integers for exact geometric predicates: 128 and 256 bits, two's complement.
///
/// Every predicate of the geometry (side of a great circle, order of distances) is decided by the
/// sign of an integer polynomial in the coordinates. docs/geometry.md has the widths: determinants
/// of int32 vectors need 96 bits, of Q2.61 vectors 189 bits, and the tests of an arc 251 bits.
/// There is one portable path on every target, built from 32 x 32 -> 64 bit products; `__int128` is
/// only the reference that the tests compare with (tests/unit/test_fixed.c, tests/property/wide.c).
/// Nothing here reports overflow: each caller states why its values fit. Sums wrap.
#ifndef FIXED_WIDE_H
#define FIXED_WIDE_H

#include "fixed/not_inline.h"

#include <stdbool.h>
#include <stdint.h>

/// hi * 2^64 + lo.
struct i128 {
    uint64_t lo;
    int64_t hi;
};

/// Unsigned: hi * 2^64 + lo.
struct u128 {
    uint64_t lo;
    uint64_t hi;
};

/// word[0] is the least significant; the sign is bit 63 of word[3].
struct i256 {
    uint64_t word[4];
};

/// Full product of two unsigned 64-bit numbers.
INLINE_BUT_ON_M0PLUS struct u128 u128_mul(uint64_t a, uint64_t b) {
    const uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    const uint64_t low = a0 * b0;
    const uint64_t mid1 = a1 * b0 + (low >> 32); // at most 2^64 - 2^32: no carry
    const uint64_t mid2 = a0 * b1 + (uint32_t)mid1;
    return (struct u128){(mid2 << 32) | (uint32_t)low, a1 * b1 + (mid1 >> 32) + (mid2 >> 32)};
}

static inline struct u128 u128_add(struct u128 a, struct u128 b) {
    const uint64_t lo = a.lo + b.lo;
    return (struct u128){lo, a.hi + b.hi + (lo < a.lo)};
}

static inline int u128_cmp(struct u128 a, struct u128 b) {
    if (a.hi != b.hi) {
        return a.hi < b.hi ? -1 : 1;
    }
    return a.lo == b.lo ? 0 : (a.lo < b.lo ? -1 : 1);
}

/// The high 64 bits of a * b: the product of two fractions of 2^64.
static inline uint64_t u64_mul_high(uint64_t a, uint64_t b) {
    return u128_mul(a, b).hi;
}

/// The same, or up to 2 less: what can do with that saves a product and the carries.
INLINE_BUT_ON_M0PLUS uint64_t u64_mul_high_near(uint64_t a, uint64_t b) {
    const uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    return a1 * b1 + (a1 * b0 >> 32) + (a0 * b1 >> 32);
}

static inline uint64_t u64_abs(int64_t a) {
    return a < 0 ? 0U - (uint64_t)a : (uint64_t)a;
}

static inline struct i128 i128_from_i64(int64_t a) {
    return (struct i128){(uint64_t)a, a < 0 ? -1 : 0};
}

static inline struct i128 i128_add(struct i128 a, struct i128 b) {
    const uint64_t lo = a.lo + b.lo;
    return (struct i128){lo, (int64_t)((uint64_t)a.hi + (uint64_t)b.hi + (lo < a.lo))};
}

static inline struct i128 i128_neg(struct i128 a) {
    const uint64_t lo = 0U - a.lo;
    return (struct i128){lo, (int64_t)(~(uint64_t)a.hi + (a.lo == 0U))};
}

static inline struct i128 i128_sub(struct i128 a, struct i128 b) {
    return (struct i128){a.lo - b.lo, (int64_t)((uint64_t)a.hi - (uint64_t)b.hi - (a.lo < b.lo))};
}

/// -1, 0 or 1.
static inline int i128_sign(struct i128 a) {
    if (a.hi < 0) {
        return -1;
    }
    return (a.hi | (int64_t)(a.lo >> 1) | (int64_t)(a.lo & 1U)) != 0 ? 1 : 0;
}

static inline int i128_cmp(struct i128 a, struct i128 b) {
    if (a.hi != b.hi) {
        return a.hi < b.hi ? -1 : 1;
    }
    return a.lo == b.lo ? 0 : (a.lo < b.lo ? -1 : 1);
}

/// Full product of two signed 64-bit numbers; every pair fits.
INLINE_BUT_ON_M0PLUS struct i128 i128_mul(int64_t a, int64_t b) {
    const struct u128 p = u128_mul((uint64_t)a, (uint64_t)b);
    uint64_t hi = p.hi;
    hi -= a < 0 ? (uint64_t)b : 0U;
    hi -= b < 0 ? (uint64_t)a : 0U;
    return (struct i128){p.lo, (int64_t)hi};
}

static inline struct i256 i256_from_i128(struct i128 a) {
    const uint64_t fill = a.hi < 0 ? UINT64_MAX : 0U;
    return (struct i256){{a.lo, (uint64_t)a.hi, fill, fill}};
}

/// -1, 0 or 1.
static inline int i256_sign(struct i256 a) {
    if ((a.word[3] >> 63) != 0U) {
        return -1;
    }
    return (a.word[0] | a.word[1] | a.word[2] | a.word[3]) != 0U ? 1 : 0;
}

struct i256 i256_add(struct i256 a, struct i256 b);
struct i256 i256_sub(struct i256 a, struct i256 b);
struct i256 i256_neg(struct i256 a);

/// Full product of two signed 128-bit numbers; every pair fits.
struct i256 i256_mul(struct i128 a, struct i128 b);

/// a * b modulo 2^256: the product, where it fits. Shown: tests/property/wide.c.
struct i256 i256_product(struct i256 a, struct i256 b);

/// Number of bits of |a|: 0 for 0, 1 for 1 and -1, 255 for most large numbers.
unsigned i256_bit_length(struct i256 a);

/// a / 2^shift, rounded toward minus infinity, as 64 bits. The quotient must fit; shift 0 to 255.
int64_t i256_shift_right_i64(struct i256 a, unsigned shift);

/// Number of leading zero bits; 64 for 0. The compiler's own: an instruction, or a table on a
/// Cortex-M0+.
static inline unsigned u64_leading_zeros(uint64_t a) {
    return a == 0U ? 64U : (unsigned)__builtin_clzll(a);
}

/// (hi * 2^64 + lo) / divisor, rounded down; *remainder gets the rest.
/// hi < divisor, so that the quotient fits. Cost: four 64-bit divisions by 32-bit numbers.
uint64_t u128_div_u64(struct u128 dividend, uint64_t divisor, uint64_t *remainder);

#endif
