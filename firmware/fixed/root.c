#include "fixed/root.h"

/// floor(sqrt(value)) for a leading bit at position 31 or 30: two Newton steps from a straight
/// line, which is within 6 %; the result is then at most one too large.
static uint32_t root_normalised(uint32_t value) {
    uint32_t root = (value >> 17) + (value >> 19) + 24200U;
    root = (root + value / root) / 2U;
    root = (root + value / root) / 2U;
    return root - (root > 65535U || root * root > value ? 1U : 0U);
}

uint32_t root_u32(uint32_t value) {
    if (value == 0U) {
        return 0;
    }
    const unsigned shift = (u64_leading_zeros(value) - 32U) & ~1U;
    return root_normalised(value << shift) >> (shift / 2U);
}

uint32_t root_u64(uint64_t value) {
    if (value == 0U) {
        return 0;
    }
    // An even shift that brings the leading bit to position 63 or 62; the root shifts by half of
    // it.
    const unsigned shift = u64_leading_zeros(value) & ~1U;
    const uint64_t n = value << shift;
    const uint32_t high = (uint32_t)(n >> 32), digit = (uint32_t)n >> 16;
    const uint32_t s = root_normalised(high), rest = high - s * s; // rest <= 2 s < 2^17
    // (rest * 2^16 + digit) / (2 s), halved first so that the dividend fits 32 bits.
    const uint32_t dividend = (rest << 15) | (digit >> 1);
    const uint32_t q = dividend / s, r = 2U * (dividend % s) + (digit & 1U);
    const uint64_t square = (uint64_t)q * q, left = ((uint64_t)r << 16) | (uint16_t)n;
    // The sum may reach 2^32 when q is 2^16; then the square exceeds what is left and one comes
    // off.
    const uint64_t root = ((uint64_t)s << 16) + q - (square > left ? 1U : 0U);
    return (uint32_t)(root >> (shift / 2U));
}

uint64_t root_u128(struct u128 value) {
    if (value.hi == 0U) {
        return root_u64(value.lo);
    }
    const unsigned shift = u64_leading_zeros(value.hi) & ~1U;
    const uint64_t high =
        shift == 0U ? value.hi : (value.hi << shift) | (value.lo >> (64U - shift));
    const uint64_t low = value.lo << shift;
    const uint64_t s = root_u64(high), rest = high - s * s; // rest <= 2 s < 2^33
    const uint32_t digit = (uint32_t)(low >> 32);
    const uint64_t dividend = (rest << 31) | (digit >> 1);
    const uint64_t q = dividend / s, r = 2U * (dividend % s) + (digit & 1U); // q <= 2^32
    const uint64_t root = (s << 32) + q;                                     // wraps to 0 at 2^64
    bool too_large = r <= UINT32_MAX &&
                     u128_cmp(u128_mul(q, q), (struct u128){(r << 32) | (uint32_t)low, 0}) > 0;
    return ((root - (too_large ? 1U : 0U)) >> (shift / 2U));
}
