#include "big.h"

#include "fixed/wide.h"

#include <assert.h>
#include <stdbool.h>

static void trim(struct big *a) {
    while (a->count != 0U && a->word[a->count - 1U] == 0U) {
        a->count--;
    }
}

void big_set(struct big *a, uint64_t value) {
    a->word[0] = value;
    a->count = value != 0U ? 1U : 0U;
}

void big_multiply_add(struct big *a, uint64_t factor, uint64_t term) {
    uint64_t carry = term;
    for (uint32_t i = 0; i < a->count; i++) {
        const struct u128 sum = u128_add(u128_mul(a->word[i], factor), (struct u128){carry, 0});
        a->word[i] = sum.lo;
        carry = sum.hi;
    }
    if (carry != 0U) {
        assert(a->count < BIG_WORDS);
        a->word[a->count++] = carry;
    }
    trim(a);
}

void big_multiply_power10(struct big *a, uint32_t exponent) {
    const uint64_t ten_to_19 = UINT64_C(10000000000000000000);
    for (; exponent >= 19U; exponent -= 19U) {
        big_multiply_add(a, ten_to_19, 0);
    }
    for (; exponent != 0U; exponent--) {
        big_multiply_add(a, 10, 0);
    }
}

int big_compare(const struct big *a, const struct big *b) {
    if (a->count != b->count) {
        return a->count < b->count ? -1 : 1;
    }
    for (uint32_t i = a->count; i != 0U; i--) {
        if (a->word[i - 1U] != b->word[i - 1U]) {
            return a->word[i - 1U] < b->word[i - 1U] ? -1 : 1;
        }
    }
    return 0;
}

void big_add(struct big *a, const struct big *b) {
    while (a->count < b->count) {
        a->word[a->count++] = 0;
    }
    uint64_t carry = 0;
    for (uint32_t i = 0; i < a->count; i++) {
        const uint64_t sum = a->word[i] + carry;
        a->word[i] = sum + (i < b->count ? b->word[i] : 0U);
        carry = sum < carry || a->word[i] < sum ? 1U : 0U;
    }
    if (carry != 0U) {
        assert(a->count < BIG_WORDS);
        a->word[a->count++] = carry;
    }
}

void big_subtract(struct big *a, const struct big *b) {
    uint64_t borrow = 0;
    for (uint32_t i = 0; i < a->count; i++) {
        const uint64_t left = a->word[i] - borrow, taken = i < b->count ? b->word[i] : 0U;
        borrow = left > a->word[i] || left < taken ? 1U : 0U;
        a->word[i] = left - taken;
    }
    assert(borrow == 0U);
    trim(a);
}

uint32_t big_bit_length(const struct big *a) {
    if (a->count == 0U) {
        return 0;
    }
    return a->count * 64U - (uint32_t)__builtin_clzll(a->word[a->count - 1U]);
}

uint32_t big_trailing_zeros(const struct big *a) {
    uint32_t i = 0;
    while (a->word[i] == 0U) {
        i++;
    }
    return i * 64U + (uint32_t)__builtin_ctzll(a->word[i]);
}

void big_shift_right(struct big *a, uint32_t shift) {
    const uint32_t words = shift / 64U, bits = shift % 64U;
    if (words >= a->count) {
        a->count = 0;
        return;
    }
    for (uint32_t i = 0; i + words < a->count; i++) {
        const uint64_t low = a->word[i + words];
        const uint64_t high = i + words + 1U < a->count ? a->word[i + words + 1U] : 0U;
        a->word[i] = bits == 0U ? low : (low >> bits) | (high << (64U - bits));
    }
    a->count -= words;
    trim(a);
}

static bool bit_at(const struct big *a, uint32_t bit) {
    return bit / 64U < a->count && ((a->word[bit / 64U] >> (bit % 64U)) & 1U) != 0U;
}

uint64_t big_round_shift(const struct big *a, uint32_t shift) {
    struct big whole = *a;
    big_shift_right(&whole, shift);
    assert(whole.count <= 1U);
    const uint64_t value = whole.count == 0U ? 0U : whole.word[0];
    const bool half = shift != 0U && bit_at(a, shift - 1U);
    return value + (half ? 1U : 0U);
}

void big_gcd(struct big *a, struct big *b) {
    if (b->count == 0U) {
        return;
    }
    if (a->count == 0U) {
        *a = *b;
        return;
    }
    // Binary algorithm; the common power of two is put back at the end.
    const uint32_t zeros_a = big_trailing_zeros(a), zeros_b = big_trailing_zeros(b);
    uint32_t common = zeros_a < zeros_b ? zeros_a : zeros_b;
    big_shift_right(a, zeros_a);
    big_shift_right(b, zeros_b);
    while (b->count != 0U) {
        if (big_compare(a, b) > 0) {
            const struct big swap = *a;
            *a = *b;
            *b = swap;
        }
        big_subtract(b, a);
        if (b->count != 0U) {
            big_shift_right(b, big_trailing_zeros(b));
        }
    }
    for (; common >= 63U; common -= 63U) {
        big_multiply_add(a, UINT64_C(1) << 63, 0);
    }
    big_multiply_add(a, UINT64_C(1) << common, 0);
}

void big_divide_exact(struct big *a, const struct big *divisor) {
    // Exact division from the low end (Jebelean 1993): with an odd divisor, each low word of the
    // quotient follows from the low word of what is left and the inverse of the divisor's low word.
    struct big odd = *divisor;
    const uint32_t zeros = big_trailing_zeros(divisor);
    big_shift_right(&odd, zeros);
    big_shift_right(a, zeros);
    uint64_t inverse = odd.word[0]; // right in 3 bits; each step doubles them
    for (int i = 0; i < 5; i++) {
        inverse *= 2U - odd.word[0] * inverse;
    }
    for (uint32_t i = 0; i < a->count; i++) {
        const uint64_t digit = a->word[i] * inverse;
        uint64_t borrow = 0;
        for (uint32_t j = 0; i + j < a->count; j++) {
            const struct u128 product = u128_mul(digit, j < odd.count ? odd.word[j] : 0U);
            const struct u128 taken = u128_add(product, (struct u128){borrow, 0});
            borrow = taken.hi + (a->word[i + j] < taken.lo ? 1U : 0U);
            a->word[i + j] -= taken.lo;
        }
        assert(borrow == 0U && a->word[i] == 0U);
        a->word[i] = digit;
    }
    trim(a);
}
