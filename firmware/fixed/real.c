#include "fixed/real.h"

#include "fixed/root.h"

#define MANTISSA_BITS 61

/// The magnitude's leading 61 bits, rounded, with its exponent. size: below 2^63.
static struct real pack(bool negative, uint64_t size, int32_t exponent) {
    if (size == 0U) {
        return (struct real){0, 0};
    }
    const int excess = 64 - (int)u64_leading_zeros(size) - MANTISSA_BITS;
    if (excess <= 0) {
        size <<= -excess;
    } else {
        size = (size + (UINT64_C(1) << (excess - 1))) >> excess;
    }
    exponent += excess;
    if (size >> MANTISSA_BITS != 0U) { // rounded up to the next power of two
        size >>= 1;
        exponent++;
    }
    return (struct real){negative ? -(int64_t)size : (int64_t)size, exponent};
}

struct real real(int64_t value, int32_t exponent) {
    return pack(value < 0, u64_abs(value), exponent);
}

struct real real_add(struct real a, struct real b) {
    if (a.mantissa == 0 || b.mantissa == 0) {
        return a.mantissa == 0 ? b : a;
    }
    if (a.exponent < b.exponent) {
        const struct real swap = a;
        a = b;
        b = swap;
    }
    const int32_t apart = a.exponent - b.exponent;
    if (apart > MANTISSA_BITS) {
        return a;
    }
    // One bit to the left, so that numbers one exponent apart lose nothing: sums are below 2^63.
    const int64_t large = a.mantissa * 2;
    const int64_t small = apart == 0 ? b.mantissa * 2 : b.mantissa >> (apart - 1);
    const int64_t sum = large + small;
    return pack(sum < 0, u64_abs(sum), a.exponent - 1);
}

struct real real_sub(struct real a, struct real b) {
    return real_add(a, real_neg(b));
}

struct real real_mul(struct real a, struct real b) {
    if (a.mantissa == 0 || b.mantissa == 0) {
        return (struct real){0, 0};
    }
    // 2^120 to 2^122, cut to 62 or 63 bits.
    const struct u128 product = u128_mul(u64_abs(a.mantissa), u64_abs(b.mantissa));
    uint64_t size = (product.hi << 5) | (product.lo >> 59);
    int32_t exponent = a.exponent + b.exponent + 60;
    if (size >> 62 != 0U) {
        size >>= 1;
        exponent++;
    }
    size = (size + 1U) >> 1;
    if (size >> MANTISSA_BITS != 0U) { // rounded up to the next power of two
        size >>= 1;
        exponent++;
    }
    return (struct real){(a.mantissa ^ b.mantissa) < 0 ? -(int64_t)size : (int64_t)size, exponent};
}

struct real real_div(struct real a, struct real b) {
    if (b.mantissa == 0) {
        return b;
    }
    const uint64_t size = u64_abs(a.mantissa), divisor = u64_abs(b.mantissa);
    uint64_t rest;
    const uint64_t quotient = u128_div_u64((struct u128){size << 61, size >> 3}, divisor, &rest);
    return pack((a.mantissa < 0) != (b.mantissa < 0), quotient, a.exponent - b.exponent - 61);
}

struct real real_root(struct real a) {
    if (a.mantissa <= 0) {
        return (struct real){0, 0};
    }
    const bool odd = (a.exponent & 1) != 0;
    const uint64_t size = (uint64_t)a.mantissa << (odd ? 1 : 0);
    const uint64_t root = root_u128((struct u128){size << 60, size >> 4}); // 2^60 to 2^61
    return pack(false, root, (a.exponent - (odd ? 1 : 0) - 60) / 2);
}

int64_t real_to_i64(struct real a, int32_t bits) {
    const int32_t shift = a.exponent + bits;
    const int64_t most = (int64_t)1 << 62;
    if (a.mantissa == 0) {
        return 0;
    }
    if (shift > 0) {
        const bool fits = shift == 1;
        return fits ? a.mantissa * 2 : (a.mantissa < 0 ? -most : most);
    }
    if (shift < -MANTISSA_BITS) {
        return 0;
    }
    const uint64_t size = u64_abs(a.mantissa);
    const uint64_t rounded = shift == 0 ? size : (size + (UINT64_C(1) << (-shift - 1))) >> -shift;
    return a.mantissa < 0 ? -(int64_t)rounded : (int64_t)rounded;
}
