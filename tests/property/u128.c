/// boards/linux/u128.h against GMP, on 64- and 32-bit systems alike.
///
/// Operands are often runs of ones and zeros, and divisors often the leading half of the dividend,
/// where an estimated quotient is off. COUNT and SEED in the environment draw more or others.
#include "check.h"

#include "u128.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed = UINT64_C(0x71B3C5D9A0E4F286);
static unsigned long count = 200000;
static mpz_t a_value, b_value, wanted, wanted_rest, got_value;

static uint64_t any_word(void) {
    const uint64_t bits = check_random(&seed), kind = check_random(&seed) % 4U;
    return kind == 0U   ? bits
           : kind == 1U ? UINT64_MAX << (bits % 64U)
           : kind == 2U ? UINT64_MAX >> (bits % 64U)
                        : bits % 3U - 1U;
}

static struct u128 any(void) {
    const struct u128 a = {any_word(), any_word()};
    return u128_shift_right(a, (unsigned)(check_random(&seed) % 128U));
}

static void set(mpz_t to, struct u128 a) {
    const uint64_t word[2] = {a.lo, a.hi};
    mpz_import(to, 2, -1, sizeof *word, 0, 0, word);
}

static bool equal(struct u128 got, const mpz_t value) {
    set(got_value, got);
    return mpz_cmp(got_value, value) == 0;
}

static void quotients_and_rests(void) {
    unsigned long large = 0;
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        struct u128 a = any(), b = any(), rest;
        if (i % 4U == 0U) { // a little more or less than a multiple
            a = u128_product(b, u128_of(any_word() >> 40));
            a = i % 8U == 0U ? u128_sub(a, u128_of(1)) : u128_add(a, u128_of(1));
        }
        if (u128_is_zero(b)) {
            continue;
        }
        large += b.hi != 0U && u128_cmp(a, b) > 0 ? 1U : 0U;
        set(a_value, a);
        set(b_value, b);
        mpz_fdiv_qr(wanted, wanted_rest, a_value, b_value);
        const struct u128 quotient = u128_divide(a, b, &rest);
        CHECK(equal(quotient, wanted));
        CHECK(equal(rest, wanted_rest));
        CHECK(u128_cmp(u128_divide(a, b, NULL), quotient) == 0);
    }
    CHECK(large > count / 20U);
}

static void products_differences_and_shifts(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct u128 a = any(), b = any();
        set(a_value, a);
        set(b_value, b);
        mpz_mul(wanted, a_value, b_value);
        mpz_fdiv_r_2exp(wanted, wanted, 128);
        CHECK(equal(u128_product(a, b), wanted));
        mpz_sub(wanted, a_value, b_value);
        mpz_fdiv_r_2exp(wanted, wanted, 128);
        CHECK(equal(u128_sub(a, b), wanted));
        mpz_ior(wanted, a_value, b_value);
        CHECK(equal(u128_or(a, b), wanted));
        const unsigned shift = (unsigned)(i % 128U);
        mpz_mul_2exp(wanted, a_value, shift);
        mpz_fdiv_r_2exp(wanted, wanted, 128);
        CHECK(equal(u128_shift_left(a, shift), wanted));
        mpz_fdiv_q_2exp(wanted, a_value, shift);
        CHECK(equal(u128_shift_right(a, shift), wanted));
        const bool zero = mpz_sgn(a_value) == 0;
        CHECK_EQ(u128_is_zero(a), zero);
        CHECK_EQ(u128_bit_length(a), zero ? 0U : mpz_sizeinbase(a_value, 2));
    }
}

static void signs(void) {
    const struct i128 least = {0, INT64_MIN};
    CHECK(u128_cmp(u128_abs(least), (struct u128){0, UINT64_C(1) << 63}) == 0);
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct u128 size = u128_shift_right(any(), 1);
        const struct i128 negative = i128_with_sign(size, true);
        CHECK(u128_cmp(u128_abs(negative), size) == 0);
        CHECK(u128_cmp(u128_abs(i128_with_sign(size, false)), size) == 0);
        CHECK_EQ(i128_sign(i128_add(negative, i128_with_sign(size, false))), 0);
        CHECK_EQ(i128_sign(negative), u128_is_zero(size) ? 0 : -1);
    }
}

static void set_i64(mpz_t to, int64_t a) {
    set(to, u128_of(u64_abs(a)));
    if (a < 0) {
        mpz_neg(to, to);
    }
}

static void scaled_and_saturated(void) {
    unsigned long beyond = 0;
    mpz_t most;
    mpz_init(most);
    set_i64(most, INT64_MAX);
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const int64_t a = (int64_t)any_word(), b = (int64_t)any_word();
        const int64_t divisor = (int64_t)any_word();
        if (divisor == 0) {
            continue;
        }
        set_i64(a_value, a);
        set_i64(b_value, b);
        mpz_mul(wanted, a_value, b_value);
        set_i64(b_value, divisor);
        mpz_tdiv_q(wanted, wanted, b_value);
        if (mpz_cmpabs(wanted, most) > 0) {
            beyond++;
            mpz_mul_si(wanted, most, mpz_sgn(wanted));
        }
        set_i64(got_value, i64_mul_div(a, b, divisor));
        CHECK(mpz_cmp(got_value, wanted) == 0);
    }
    CHECK(beyond > count / 100U);
    mpz_clear(most);
}

/// Within 1.5 units in the last place of a long double, of however many bits.
static void floating_values(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct u128 a = any();
        const long double value = u128_value(a);
        const long double high = floorl(ldexpl(value, -64));
        const struct u128 back = {(uint64_t)(value - ldexpl(high, 64)), (uint64_t)high};
        if (high >= 0x1p64L) { // 2^128, from below
            CHECK(u128_bit_length(u128_sub(u128_of(0), a)) <= 128U - LDBL_MANT_DIG + 1U);
            continue;
        }
        const struct u128 off = u128_cmp(a, back) > 0 ? u128_sub(a, back) : u128_sub(back, a);
        const unsigned bits = u128_bit_length(a);
        const unsigned last = bits > LDBL_MANT_DIG ? bits - LDBL_MANT_DIG : 0U;
        CHECK(last == 0U
                  ? u128_is_zero(off)
                  : u128_cmp(off, u128_shift_right(u128_shift_left(u128_of(3), last), 1)) <= 0);
    }
}

int main(void) {
    const char *text = getenv("SEED");
    seed = text != NULL ? strtoull(text, NULL, 0) : seed;
    text = getenv("COUNT");
    count = text != NULL ? strtoul(text, NULL, 0) : count;
    printf("# seed 0x%016llx, count %lu\n", (unsigned long long)seed, count);
    mpz_inits(a_value, b_value, wanted, wanted_rest, got_value, (mpz_ptr)0);
    TEST(quotients_and_rests);
    TEST(products_differences_and_shifts);
    TEST(signs);
    TEST(scaled_and_saturated);
    TEST(floating_values);
    mpz_clears(a_value, b_value, wanted, wanted_rest, got_value, (mpz_ptr)0);
    return check_finish();
}
