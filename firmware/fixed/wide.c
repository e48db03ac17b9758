#include "fixed/wide.h"

struct i256 i256_add(struct i256 a, struct i256 b) {
    struct i256 sum;
    uint64_t carry = 0;
    for (unsigned i = 0; i < 4U; i++) {
        const uint64_t partial = a.word[i] + carry;
        carry = partial < carry;
        sum.word[i] = partial + b.word[i];
        carry += sum.word[i] < partial;
    }
    return sum;
}

struct i256 i256_neg(struct i256 a) {
    struct i256 negated;
    uint64_t carry = 1;
    for (unsigned i = 0; i < 4U; i++) {
        negated.word[i] = ~a.word[i] + carry;
        carry = carry != 0U && negated.word[i] == 0U;
    }
    return negated;
}

struct i256 i256_sub(struct i256 a, struct i256 b) {
    struct i256 difference;
    uint64_t borrow = 0;
    for (unsigned i = 0; i < 4U; i++) {
        const uint64_t partial = a.word[i] - b.word[i];
        const uint64_t next = (a.word[i] < b.word[i]) || (partial < borrow);
        difference.word[i] = partial - borrow;
        borrow = next;
    }
    return difference;
}

struct i256 i256_mul(struct i128 a, struct i128 b) {
    const bool negative = (a.hi < 0) != (b.hi < 0);
    const struct i128 x = a.hi < 0 ? i128_neg(a) : a, y = b.hi < 0 ? i128_neg(b) : b;
    // |-2^127| is 2^127 as unsigned words, so reading hi as unsigned is right for every value.
    const struct u128 p00 = u128_mul(x.lo, y.lo), p01 = u128_mul(x.lo, (uint64_t)y.hi),
                      p10 = u128_mul((uint64_t)x.hi, y.lo),
                      p11 = u128_mul((uint64_t)x.hi, (uint64_t)y.hi);
    struct u128 mid = u128_add((struct u128){p00.hi, 0}, (struct u128){p01.lo, 0});
    mid = u128_add(mid, (struct u128){p10.lo, 0});
    const struct u128 high =
        u128_add(p11, u128_add((struct u128){p01.hi, 0},
                               u128_add((struct u128){p10.hi, 0}, (struct u128){mid.hi, 0})));
    const struct i256 product = {{p00.lo, mid.lo, high.lo, high.hi}};
    return negative ? i256_neg(product) : product;
}

struct i256 i256_product(struct i256 a, struct i256 b) {
    struct i256 product = {{0}};
    for (unsigned i = 0; i < 4U; i++) {
        uint64_t carry = 0;
        for (unsigned j = 0; i + j < 4U; j++) {
            const struct u128 sum =
                u128_add(u128_mul(a.word[i], b.word[j]), (struct u128){product.word[i + j], 0});
            product.word[i + j] = sum.lo + carry;
            carry = sum.hi + (product.word[i + j] < carry);
        }
    }
    return product;
}

unsigned i256_bit_length(struct i256 a) {
    const struct i256 size = i256_sign(a) < 0 ? i256_neg(a) : a;
    for (unsigned i = 4; i != 0U; i--) {
        if (size.word[i - 1U] != 0U) {
            return 64U * i - u64_leading_zeros(size.word[i - 1U]);
        }
    }
    return 0;
}

int64_t i256_shift_right_i64(struct i256 a, unsigned shift) {
    const unsigned index = shift / 64U, bits = shift % 64U;
    const uint64_t fill = (a.word[3] >> 63) != 0U ? UINT64_MAX : 0U;
    const uint64_t low = a.word[index], high = index < 3U ? a.word[index + 1U] : fill;
    return (int64_t)(bits == 0U ? low : (low >> bits) | (high << (64U - bits)));
}

/// One digit of the schoolbook division in base 2^32 (Knuth, Algorithm D): the estimate from the
/// leading digits is at most two too large.
static uint32_t divide_digit(uint64_t *remainder, uint32_t next, uint64_t divisor) {
    const uint64_t top = divisor >> 32, low = (uint32_t)divisor;
    uint64_t digit = *remainder / top;
    uint64_t rest = *remainder % top;
    while (digit > UINT32_MAX || digit * low > ((rest << 32) | next)) {
        digit--;
        rest += top;
        if (rest > UINT32_MAX) {
            break;
        }
    }
    *remainder =
        (*remainder << 32) + next - digit * divisor; // exact modulo 2^64, and below divisor
    return (uint32_t)digit;
}

uint64_t u128_div_u64(struct u128 dividend, uint64_t divisor, uint64_t *remainder) {
    const unsigned shift = u64_leading_zeros(divisor);
    const uint64_t d = divisor << shift;
    uint64_t r =
        shift == 0U ? dividend.hi : (dividend.hi << shift) | (dividend.lo >> (64U - shift));
    const uint64_t low = dividend.lo << shift;
    const uint64_t high_digit = divide_digit(&r, (uint32_t)(low >> 32), d);
    const uint64_t low_digit = divide_digit(&r, (uint32_t)low, d);
    *remainder = r >> shift;
    return (high_digit << 32) | low_digit;
}
