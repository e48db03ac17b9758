/// Unsigned integers of up to 1,088 bits, for the few signs that 256 bits can't decide
/// (fixed/root_sum.h).
///
/// Nothing here reports overflow: each caller states why its values fit.
/// Shown:     tests/property/site_exact.c.
#ifndef FIXED_HUGE_H
#define FIXED_HUGE_H

#include "fixed/wide.h"

#include <stdint.h>

#define HUGE_LIMBS 34U

/// limb[0] is the least significant; limbs from `count` on are not set, and limb[count - 1] is not
/// 0.
struct huge {
    uint32_t count;
    uint32_t limb[HUGE_LIMBS];
};

void huge_from_u128(struct huge *to, struct u128 value);

/// -1, 0 or 1.
int huge_cmp(const struct huge *a, const struct huge *b);

/// to may be a or b, here and below.
void huge_add(struct huge *to, const struct huge *a, const struct huge *b);

/// *to = |a - b|. Returns the sign of a - b.
int huge_difference(struct huge *to, const struct huge *a, const struct huge *b);

/// to must be neither a nor b.
/// Cost:      a product of 32-bit numbers for each pair of limbs.
void huge_mul(struct huge *to, const struct huge *a, const struct huge *b);

/// *to = a * 2^shift, shift 0 to 31.
void huge_shift_left(struct huge *to, const struct huge *a, unsigned shift);

/// floor(sqrt(a * 4^shift)), by digits. The root and twice that are below 2^1088.
/// Cost:      a comparison for each bit of the root.
void huge_root(struct huge *to, const struct huge *a, unsigned shift);

/// Number of bits: 0 for 0.
unsigned huge_bit_length(const struct huge *a);

/// a / 2^shift, rounded down; the quotient must fit 64 bits.
uint64_t huge_shift_right_u64(const struct huge *a, unsigned shift);

#endif
