/// Numbers with an exponent against long double, whose mantissa has three bits more.
#include "check.h"

#include "fixed/real.h"

#include <math.h>

static uint64_t seed = UINT64_C(0x5EED0022);

static long double value(struct real a) {
    return ldexpl((long double)a.mantissa, a.exponent);
}

static bool is_normal(struct real a) {
    const uint64_t size = u64_abs(a.mantissa);
    return (a.mantissa == 0 && a.exponent == 0) || (size >> 60 == 1U && size >> 61 == 0U);
}

static struct real any(void) {
    const uint64_t bits = check_random(&seed);
    const int32_t exponent = (int32_t)(check_random(&seed) % 200U) - 100;
    return real((int64_t)(bits | 1U) >> (check_random(&seed) % 60U), exponent);
}

/// Within 2^-60 of the wanted one, in its own size.
static bool is_close(struct real got, long double want) {
    return CHECK(is_normal(got)) &&
           CHECK(fabsl(value(got) - want) <= 1.01L * ldexpl(fabsl(want), -60));
}

static void operations(void) {
    for (int i = 0; i < 1000000 && check_clean(); i++) {
        const struct real a = any(), b = any();
        is_close(real_mul(a, b), value(a) * value(b));
        if (b.mantissa != 0) {
            is_close(real_div(a, b), value(a) / value(b));
        }
        is_close(real_root(real_abs(a)), sqrtl(fabsl(value(a))));
        CHECK(value(real_scale(a, 5)) == value(a) * 32.0L);
        CHECK_EQ(real_less(a, b), value(a) < value(b));
        CHECK_EQ(real_sign(a), (value(a) > 0) - (value(a) < 0));
    }
}

/// Sums of numbers of like signs are as good as the others; where they cancel, as their parts.
static void sums(void) {
    for (int i = 0; i < 1000000 && check_clean(); i++) {
        const struct real a = any();
        struct real b = any();
        if (i % 2 == 0 && b.mantissa != 0) { // about as large
            b.exponent = a.exponent + (int32_t)(check_random(&seed) % 5U) - 2;
        }
        const long double x = value(a), y = value(b), large = fmaxl(fabsl(x), fabsl(y));
        CHECK(fabsl(value(real_add(a, b)) - (x + y)) <= ldexpl(large, -59));
        CHECK(fabsl(value(real_sub(a, b)) - (x - y)) <= ldexpl(large, -59));
        if (a.exponent == b.exponent && (a.mantissa < 0) == (b.mantissa < 0)) {
            CHECK(value(real_sub(a, b)) == x - y);
        }
        CHECK(is_normal(real_add(a, b)));
        CHECK(is_normal(real_sub(a, b)));
        CHECK_EQ(real_sub(a, a).mantissa, 0);
    }
}

static void edges(void) {
    const struct real zero = real(0, 7), one = real(1, 0);
    CHECK_EQ(zero.exponent, 0);
    CHECK_EQ(real_mul(zero, one).mantissa, 0);
    CHECK_EQ(real_div(one, zero).mantissa, 0);
    CHECK_EQ(real_div(zero, one).mantissa, 0);
    CHECK_EQ(real_root(real(-4, 0)).mantissa, 0);
    CHECK_EQ(real_to_i64(real_add(one, zero), 3), 8);
    CHECK_EQ(real_to_i64(real(INT64_MAX, 0), 0), INT64_C(1) << 62);
    CHECK_EQ(real_to_i64(real(-INT64_MAX, 0), 0), -(INT64_C(1) << 62));
    CHECK_EQ(real_to_i64(real(3, -1), 0), 2); // half away from zero
    CHECK_EQ(real_to_i64(real(-3, -1), 0), -2);
    CHECK_EQ(real_to_i64(real(5, -2), 0), 1);
    CHECK_EQ(real_to_i64(real(1, -200), 0), 0);
    CHECK_EQ(real_to_i64(real(1, 61), 0), INT64_C(1) << 61);
    CHECK_EQ(real_to_i64(real_root(real(49, 0)), 0), 7);
    CHECK_EQ(real_to_i64(real_neg(real(49, 0)), 0), -49);
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(operations);
    TEST(sums);
    TEST(edges);
    return check_finish();
}
