#include "fixed/huge.h"

static void trim(struct huge *a, uint32_t count) {
    while (count > 0U && a->limb[count - 1U] == 0U) {
        count--;
    }
    a->count = count;
}

static uint32_t limb_or_zero(const struct huge *a, uint32_t i) {
    return i < a->count ? a->limb[i] : 0U;
}

void huge_from_u128(struct huge *to, struct u128 value) {
    to->limb[0] = (uint32_t)value.lo;
    to->limb[1] = (uint32_t)(value.lo >> 32);
    to->limb[2] = (uint32_t)value.hi;
    to->limb[3] = (uint32_t)(value.hi >> 32);
    trim(to, 4);
}

int huge_cmp(const struct huge *a, const struct huge *b) {
    if (a->count != b->count) {
        return a->count < b->count ? -1 : 1;
    }
    for (uint32_t i = a->count; i-- > 0U;) {
        if (a->limb[i] != b->limb[i]) {
            return a->limb[i] < b->limb[i] ? -1 : 1;
        }
    }
    return 0;
}

void huge_add(struct huge *to, const struct huge *a, const struct huge *b) {
    const uint32_t count = a->count > b->count ? a->count : b->count;
    uint64_t carry = 0;
    for (uint32_t i = 0; i < count; i++) {
        carry += (uint64_t)limb_or_zero(a, i) + limb_or_zero(b, i);
        to->limb[i] = (uint32_t)carry;
        carry >>= 32;
    }
    to->count = count;
    if (carry != 0U) {
        to->limb[to->count++] = (uint32_t)carry;
    }
}

int huge_difference(struct huge *to, const struct huge *a, const struct huge *b) {
    const int order = huge_cmp(a, b);
    const struct huge *large = order < 0 ? b : a, *small = order < 0 ? a : b;
    const uint32_t count = large->count;
    uint64_t borrow = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t digit = (uint64_t)large->limb[i] - limb_or_zero(small, i) - borrow;
        to->limb[i] = (uint32_t)digit;
        borrow = digit >> 63;
    }
    trim(to, count);
    return order;
}

void huge_mul(struct huge *to, const struct huge *a, const struct huge *b) {
    const uint32_t count = a->count + b->count;
    for (uint32_t i = 0; i < count; i++) {
        to->limb[i] = 0;
    }
    for (uint32_t i = 0; i < a->count; i++) {
        uint64_t carry = 0;
        for (uint32_t j = 0; j < b->count; j++) {
            // At most (2^32 - 1)^2 + 2 (2^32 - 1) = 2^64 - 1.
            carry += (uint64_t)a->limb[i] * b->limb[j] + to->limb[i + j];
            to->limb[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        to->limb[i + b->count] = (uint32_t)carry;
    }
    trim(to, count);
}

void huge_shift_left(struct huge *to, const struct huge *a, unsigned shift) {
    uint32_t carry = 0;
    const uint32_t count = a->count;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t wide = (uint64_t)a->limb[i] << shift;
        to->limb[i] = (uint32_t)wide | carry;
        carry = (uint32_t)(wide >> 32);
    }
    to->count = count;
    if (carry != 0U) {
        to->limb[to->count++] = carry;
    }
}

static uint32_t bit_at(const struct huge *a, unsigned bit) {
    return limb_or_zero(a, bit / 32U) >> (bit % 32U) & 1U;
}

unsigned huge_bit_length(const struct huge *a) {
    return a->count == 0U ? 0U : 32U * a->count + 32U - u64_leading_zeros(a->limb[a->count - 1U]);
}

uint64_t huge_shift_right_u64(const struct huge *a, unsigned shift) {
    const unsigned from = shift / 32U, bits = shift % 32U;
    const uint64_t low = ((uint64_t)limb_or_zero(a, from + 1U) << 32) | limb_or_zero(a, from);
    return bits == 0U ? low
                      : (low >> bits) | ((uint64_t)limb_or_zero(a, from + 2U) << (64U - bits));
}

/// *to = *to * 2^shift + low, shift below 32, low below 2^shift.
static void append(struct huge *to, unsigned shift, uint32_t low) {
    huge_shift_left(to, to, shift);
    if (to->count == 0U) {
        to->limb[0] = 0;
        to->count = low != 0U;
    }
    to->limb[0] |= low;
}

void huge_root(struct huge *to, const struct huge *a, unsigned shift) {
    struct huge rest, trial;
    rest.count = 0;
    to->count = 0;
    // Digit by digit in base 4: rest is what is left of the leading digits, less the square of the
    // root so far.
    for (unsigned pair = (huge_bit_length(a) + 1U) / 2U + shift; pair-- > 0U;) {
        const unsigned low = pair < shift ? 0U : 2U * (pair - shift);
        append(&rest, 2, pair < shift ? 0U : bit_at(a, low + 1U) << 1 | bit_at(a, low));
        trial = *to;
        append(&trial, 2, 1);
        const bool fits = huge_cmp(&rest, &trial) >= 0;
        if (fits) {
            huge_difference(&rest, &rest, &trial);
        }
        append(to, 1, fits ? 1U : 0U);
    }
}
