#include "u128.h"

#include <math.h>
#include <stddef.h>

struct u128 u128_product(struct u128 a, struct u128 b) {
    struct u128 product = u128_mul(a.lo, b.lo);
    product.hi += a.lo * b.hi + a.hi * b.lo;
    return product;
}

struct u128 u128_divide(struct u128 a, struct u128 divisor, struct u128 *rest) {
    struct u128 quotient = {0, 0}, left = a;
    if (divisor.hi == 0U) {
        quotient.hi = a.hi / divisor.lo;
        left = u128_of(0);
        quotient.lo = u128_div_u64((struct u128){a.lo, a.hi % divisor.lo}, divisor.lo, &left.lo);
    } else if (u128_cmp(a, divisor) >= 0) {
        // By the divisor's upper 64 bits, of half the dividend: at most one too large
        // (Knuth 4.3.1).
        const unsigned shift = u64_leading_zeros(divisor.hi);
        uint64_t unused;
        quotient.lo =
            u128_div_u64(u128_shift_right(a, 1), u128_shift_left(divisor, shift).hi, &unused);
        quotient = u128_shift_right(u128_shift_left(quotient, shift), 63);
        quotient.lo -= quotient.lo != 0U ? 1U : 0U;
        left = u128_sub(a, u128_product(quotient, divisor));
        if (u128_cmp(left, divisor) >= 0) {
            left = u128_sub(left, divisor);
            quotient.lo++;
        }
    }
    if (rest != NULL) {
        *rest = left;
    }
    return quotient;
}

struct u128 u128_shift_left(struct u128 a, unsigned shift) {
    if (shift >= 64U) {
        return (struct u128){0, a.lo << (shift - 64U)};
    }
    return shift == 0U ? a
                       : (struct u128){a.lo << shift, (a.hi << shift) | (a.lo >> (64U - shift))};
}

struct u128 u128_shift_right(struct u128 a, unsigned shift) {
    if (shift >= 64U) {
        return u128_of(a.hi >> (shift - 64U));
    }
    return shift == 0U ? a
                       : (struct u128){(a.lo >> shift) | (a.hi << (64U - shift)), a.hi >> shift};
}

unsigned u128_bit_length(struct u128 a) {
    return a.hi != 0U ? 128U - u64_leading_zeros(a.hi) : 64U - u64_leading_zeros(a.lo);
}

long double u128_value(struct u128 a) {
    return ldexpl((long double)a.hi, 64) + (long double)a.lo;
}

struct u128 u128_abs(struct i128 a) {
    const struct i128 size = a.hi < 0 ? i128_neg(a) : a;
    return (struct u128){size.lo, (uint64_t)size.hi};
}

struct i128 i128_with_sign(struct u128 a, bool negative) {
    const struct i128 size = {a.lo, (int64_t)a.hi};
    return negative ? i128_neg(size) : size;
}

int64_t i64_mul_div(int64_t a, int64_t b, int64_t divisor) {
    const bool negative = ((a < 0) != (b < 0)) != (divisor < 0);
    const struct u128 size =
        u128_divide(u128_mul(u64_abs(a), u64_abs(b)), u128_of(u64_abs(divisor)), NULL);
    const int64_t most = size.hi != 0U || size.lo > INT64_MAX ? INT64_MAX : (int64_t)size.lo;
    return negative ? -most : most;
}
