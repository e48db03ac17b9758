/// Sines and angles of 64 bits against long double (64 bits of mantissa), at random and at round
/// arguments.
#include "check.h"

#include "fixed/trig_fine.h"

#include <math.h>

static const long double turn = 6.283185307179586476925286766559005768L;
static uint64_t seed = UINT64_C(0x5EED0021);

static long double rad(uint64_t turn64) {
    return ldexpl((long double)turn64, -64) * turn;
}

static void check_sincos(uint64_t turn64, long double *most) {
    const struct sincos_q62 got = trig_fine_sincos(turn64);
    // Near the half turn the argument itself would be rounded: use the rest.
    const uint64_t rest = turn64 & (TURN64_QUARTER - 1U);
    const long double s = sinl(rad(rest)), c = cosl(rad(rest));
    const long double sine[4] = {s, c, -s, -c}, cosine[4] = {c, -s, -c, s};
    const unsigned quadrant = (unsigned)(turn64 >> 62);
    *most = fmaxl(*most, fabsl(ldexpl((long double)got.sin_q62, -62) - sine[quadrant]));
    *most = fmaxl(*most, fabsl(ldexpl((long double)got.cos_q62, -62) - cosine[quadrant]));
}

static void sines_and_cosines(void) {
    long double most = 0;
    for (uint64_t i = 0; i < 64U; i++) {
        for (int64_t off = -2; off <= 2; off++) {
            check_sincos(i * (UINT64_C(1) << 58) + (uint64_t)off, &most);
        }
    }
    for (int i = 0; i < 1000000; i++) {
        check_sincos(check_random(&seed) >> (i % 40), &most);
    }
    check_note("error in 2^-62, most", (int64_t)ldexpl(most, 62));
    CHECK(most < ldexpl(1, -59));
    const struct sincos_q62 zero = trig_fine_sincos(0), quarter = trig_fine_sincos(TURN64_QUARTER);
    CHECK_EQ(zero.sin_q62, 0);
    CHECK_EQ(zero.cos_q62, INT64_C(1) << 62);
    CHECK_EQ(quarter.sin_q62, INT64_C(1) << 62);
    CHECK_EQ(quarter.cos_q62, 0);
}

static int64_t component(unsigned shift) {
    return (int64_t)check_random(&seed) >> (2U + shift);
}

/// Two vectors a random angle apart, down to 2^-50 rad, both of about 2^61.
static void angles_between_vectors(void) {
    long double most = 0;
    for (int i = 0; i < 300000; i++) {
        struct vec3_i64 a = {component(0), component(0), component(0)}, b = a;
        const unsigned apart = (unsigned)(check_random(&seed) % 48U);
        b.x += component(apart + 1U) / 2;
        b.y += component(apart + 1U) / 2;
        b.x = b.x / 2;
        b.y = b.y / 2;
        b.z = b.z / 2;
        if (i % 2 == 0) {
            b = (struct vec3_i64){-b.x, -b.y, -b.z};
        }
        const __float128 x = (__float128)a.y * b.z - (__float128)a.z * b.y,
                         y = (__float128)a.z * b.x - (__float128)a.x * b.z,
                         z = (__float128)a.x * b.y - (__float128)a.y * b.x;
        const long double across = sqrtl((long double)(x * x + y * y + z * z));
        const __float128 dot =
            (__float128)a.x * b.x + (__float128)a.y * b.y + (__float128)a.z * b.z;
        const long double want = atan2l(across, (long double)dot);
        const uint64_t got = trig_fine_angle(a, b);
        // Beyond a quarter turn by the rest, which has the digits.
        const long double error =
            i % 2 == 0 ? fabsl(rad((UINT64_C(1) << 63) - got) - atan2l(across, -(long double)dot))
                       : fabsl(rad(got) - want);
        most = fmaxl(most, error);
    }
    check_note("error in 2^-62 rad, most", (int64_t)ldexpl(most, 62));
    CHECK(most < ldexpl(1, -54));
}

static void angles_between_units(void) {
    long double most = 0;
    for (int i = 0; i < 300000; i++) {
        const struct vec3 a = vec3_normalise(
            vec3((int32_t)check_random(&seed) >> 1, (int32_t)(check_random(&seed) >> 33), 1000));
        const unsigned shift = (unsigned)(check_random(&seed) % 30U);
        const struct vec3 b = vec3_normalise(
            vec3(a.x + ((int32_t)check_random(&seed) >> (shift + 1U)), a.y / 2 + a.y / 2, a.z));
        const long double x = (long double)((int64_t)a.y * b.z - (int64_t)a.z * b.y),
                          y = (long double)((int64_t)a.z * b.x - (int64_t)a.x * b.z),
                          z = (long double)((int64_t)a.x * b.y - (int64_t)a.y * b.x);
        const long double want =
            atan2l(sqrtl(x * x + y * y + z * z), (long double)vec3_dot_unit(a, b));
        most = fmaxl(most, fabsl(rad(trig_fine_angle_q30(a, b)) - want));
    }
    check_note("error in 2^-62 rad, most", (int64_t)ldexpl(most, 62));
    CHECK(most < ldexpl(1, -54));
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(sines_and_cosines);
    TEST(angles_between_vectors);
    TEST(angles_between_units);
    return check_finish();
}
