/// firmware/fixed trig and root over their domains, against MPFR and GMP.
///
/// `make check` covers all 2^29 + 1 arguments of the first octant of trig_sincos, every step of
/// root_u32 with the numbers beside it, and samples of the rest, in about 35 s. With EXHAUSTIVE=1
/// in the environment also every argument of the other octants (about 3 minutes) and every input of
/// root_u32 (1 minute). SEED=N draws other samples.
#include "check.h"

#include "fixed/bam32.h"
#include "fixed/q30.h"
#include "fixed/root.h"
#include "fixed/trig.h"
#include "fixed/wide.h"

#include <gmp.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

#define PRECISION_BITS 128
#define OCTANT         (UINT32_C(1) << 29)

// What the headers claim.
#define SINCOS_ULP_MAX     0.5001
#define ATAN2_BAM_MAX      0.5001
#define ATAN2_TURN_RAD_MAX 0x1p-55

static uint64_t seed;
static bool exhaustive;

/// A random number whose size is itself random: every bit length comes up.
static uint64_t any_u64(void) {
    const uint64_t bits = check_random(&seed);
    return bits >> (check_random(&seed) % 64U);
}

// ---------------------------------------------------------------- sine and cosine

/// The reference: sin(block + fine) by the sum formula from two tables of MPFR values. Two products
/// and a sum of doubles are within 4e-16, which is 4e-7 ulp of Q1.30.
#define FINE_BITS         14U
#define FINE_COUNT        (1U << FINE_BITS)
#define REFERENCE_ULP_MAX 1e-6

struct sincos_f64 {
    double sine, cosine;
};

static struct sincos_f64 fine[FINE_COUNT];
static mpfr_t bam_to_rad, exact_angle, exact_sine, exact_cosine;

static struct sincos_f64 mpfr_sincos(uint32_t bam) {
    mpfr_mul_ui(exact_angle, bam_to_rad, bam, MPFR_RNDN);
    mpfr_sin_cos(exact_sine, exact_cosine, exact_angle, MPFR_RNDN);
    return (struct sincos_f64){mpfr_get_d(exact_sine, MPFR_RNDN),
                               mpfr_get_d(exact_cosine, MPFR_RNDN)};
}

static void start_sincos(void) {
    mpfr_inits2(PRECISION_BITS, bam_to_rad, exact_angle, exact_sine, exact_cosine, (mpfr_ptr)NULL);
    mpfr_const_pi(bam_to_rad, MPFR_RNDN);
    mpfr_div_2ui(bam_to_rad, bam_to_rad, 31, MPFR_RNDN);
    for (uint32_t i = 0; i < FINE_COUNT; i++) {
        fine[i] = mpfr_sincos(i);
    }
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

/// Worst error of one block in ulp; *reference_error gets that of the reference at one place.
static double sincos_block_error(uint32_t start, double *reference_error) {
    const struct sincos_f64 base = mpfr_sincos(start);
    const uint32_t sample = (uint32_t)(check_random(&seed) % FINE_COUNT);
    double worst = 0.0;
    for (uint32_t i = 0; i < FINE_COUNT; i++) {
        const double sine = base.sine * fine[i].cosine + base.cosine * fine[i].sine;
        const double cosine = base.cosine * fine[i].cosine - base.sine * fine[i].sine;
        const struct sincos got = trig_sincos(bam32(start + i));
        worst = larger(worst, fabs(got.sin_q30 - sine * 0x1p30));
        worst = larger(worst, fabs(got.cos_q30 - cosine * 0x1p30));
        if (i == sample) {
            const struct sincos_f64 exact = mpfr_sincos(start + i);
            *reference_error =
                larger(fabs(exact.sine - sine), fabs(exact.cosine - cosine)) * 0x1p30;
        }
    }
    return worst;
}

static void sincos_of_the_first_octant(void) {
    double worst = 0.0, worst_reference = 0.0;
    for (uint32_t start = 0; start < OCTANT && check_clean(); start += FINE_COUNT) {
        double reference_error = 0.0;
        worst = larger(worst, sincos_block_error(start, &reference_error));
        worst_reference = larger(worst_reference, reference_error);
    }
    const struct sincos eighth = trig_sincos(bam32(OCTANT));
    CHECK_EQ(eighth.sin_q30, 759250125);
    CHECK_EQ(eighth.cos_q30, 759250125);
    printf("# trig_sincos: worst error %.6f ulp of 2^-30; the reference's own %.1e ulp\n", worst,
           worst_reference);
    CHECK(worst_reference <= REFERENCE_ULP_MAX);
    CHECK(worst <= SINCOS_ULP_MAX - REFERENCE_ULP_MAX);
}

static bool same(uint32_t bam, q30_t sine, q30_t cosine) {
    const struct sincos got = trig_sincos(bam32(bam));
    return CHECK_EQ(got.sin_q30, sine) && CHECK_EQ(got.cos_q30, cosine);
}

/// The other seven octants have the same numbers as the first, swapped and negated, bit for bit.
static void sincos_of_the_other_octants(void) {
    const uint32_t step = exhaustive ? 1U : 127U;
    for (uint32_t a = 0; a <= OCTANT && check_clean(); a += step) {
        const struct sincos first = trig_sincos(bam32(a));
        const q30_t s = first.sin_q30, c = first.cos_q30;
        const uint32_t quarter = BAM32_QUARTER, half = BAM32_HALF;
        (void)(same(quarter - a, c, s) && same(quarter + a, c, -s) && same(half - a, s, -c) &&
               same(half + a, -s, -c) && same(half + quarter - a, -c, -s) &&
               same(half + quarter + a, -c, s) && same(0U - a, -s, c));
    }
}

// ---------------------------------------------------------------- arc tangent

static mpfr_t y_exact, x_exact, angle_exact, rad_per_turn64;

static void start_atan2(void) {
    mpfr_inits2(PRECISION_BITS, y_exact, x_exact, angle_exact, rad_per_turn64, (mpfr_ptr)NULL);
    mpfr_const_pi(rad_per_turn64, MPFR_RNDN);
    mpfr_div_2ui(rad_per_turn64, rad_per_turn64, 63, MPFR_RNDN);
}

static double worst_rad, worst_bam, worst_reference_rad;

static void set_angle(uint64_t y, uint64_t x) {
    mpfr_set_ui(y_exact, y, MPFR_RNDN);
    mpfr_set_ui(x_exact, x, MPFR_RNDN);
    mpfr_atan2(angle_exact, y_exact, x_exact, MPFR_RNDN);
}

/// |turn64 - angle_exact| in radians.
static double turn64_error(uint64_t turn64) {
    mpfr_mul_ui(y_exact, rad_per_turn64, turn64, MPFR_RNDN);
    mpfr_sub(y_exact, y_exact, angle_exact, MPFR_RNDN);
    return fabs(mpfr_get_d(y_exact, MPFR_RNDN));
}

/// All four quadrants of trig_atan2 from one angle of the first, in BAM.
static void check_quadrants(uint64_t y, uint64_t x, long double quadrant_bam) {
    if (y > INT64_MAX || x > INT64_MAX) {
        return;
    }
    for (unsigned quadrant = 0; quadrant < 4U; quadrant++) {
        const bool left = (quadrant & 1U) != 0U, below = (quadrant & 2U) != 0U;
        const int64_t signed_x = left ? -(int64_t)x : (int64_t)x;
        const int64_t signed_y = below ? -(int64_t)y : (int64_t)y;
        long double wanted = left ? 0x1p31L - quadrant_bam : quadrant_bam;
        wanted = below ? 0x1p32L - wanted : wanted;
        const long double got = (long double)trig_atan2(signed_y, signed_x).bam;
        const long double apart = fabsl(got - wanted);
        worst_bam = larger(worst_bam, (double)(apart > 0x1p31L ? 0x1p32L - apart : apart));
    }
}

static void check_atan2_with_mpfr(uint64_t y, uint64_t x) {
    const uint64_t got = trig_atan2_turn64(y, x);
    set_angle(y, x);
    const double error = turn64_error(got);
    CHECK(got <= UINT64_C(1) << 62);
    CHECK(error <= ATAN2_TURN_RAD_MAX);
    worst_rad = larger(worst_rad, error);
    mpfr_div(x_exact, angle_exact, rad_per_turn64, MPFR_RNDN);
    check_quadrants(y, x, mpfr_get_ld(x_exact, MPFR_RNDN) * 0x1p-32L);
}

/// The same from atan2l, which is a hundred times as fast. It is itself checked now and then.
static void check_atan2_with_libm(uint64_t y, uint64_t x, bool validate) {
    const long double turn = 0x1.921fb54442d1846ap2L; // 2 pi, to 2^-62
    const long double angle = atan2l((long double)y, (long double)x);
    const uint64_t got = trig_atan2_turn64(y, x);
    const double error = (double)fabsl((long double)got * (turn * 0x1p-64L) - angle);
    CHECK(error <= ATAN2_TURN_RAD_MAX);
    worst_rad = larger(worst_rad, error);
    check_quadrants(y, x, angle / turn * 0x1p32L);
    if (validate) {
        set_angle(y, x);
        mpfr_set_ld(y_exact, angle, MPFR_RNDN);
        mpfr_sub(y_exact, y_exact, angle_exact, MPFR_RNDN);
        worst_reference_rad = larger(worst_reference_rad, fabs(mpfr_get_d(y_exact, MPFR_RNDN)));
    }
}

/// Ratios where a mistake would show: the ends and middles of the 65 table intervals, the diagonal,
/// the axes, and powers of two with their neighbours.
static void structured_atan2(void) {
    for (uint64_t k = 0; k <= 128U; k++) {
        for (unsigned bits = 8; bits <= 63U; bits++) {
            const uint64_t x = UINT64_C(1) << bits, y = k * (x >> 7);
            for (uint64_t beside = 0; beside < 5U; beside++) {
                check_atan2_with_mpfr(y + beside, x);
                check_atan2_with_mpfr(y - (beside <= y ? beside : 0U), x - 1U);
                check_atan2_with_mpfr(x, y + beside);
            }
        }
    }
    for (unsigned i = 0; i < 64U; i++) {
        for (unsigned j = 0; j < 64U; j++) {
            const uint64_t y = UINT64_C(1) << i, x = UINT64_C(1) << j;
            check_atan2_with_mpfr(y, x);
            check_atan2_with_mpfr(y - 1U, x | 1U);
            check_atan2_with_mpfr(UINT64_MAX >> i, UINT64_MAX >> j);
        }
        check_atan2_with_mpfr(0, UINT64_C(1) << i);
        check_atan2_with_mpfr(UINT64_C(1) << i, 0);
    }
}

static void arc_tangent(void) {
    structured_atan2();
    const unsigned long count = exhaustive ? 20000000UL : 900000UL;
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const uint64_t y = any_u64(), x = any_u64();
        if ((y | x) != 0U) {
            check_atan2_with_mpfr(y, x);
        }
    }
    for (unsigned long i = 0; i < 5U * count && check_clean(); i++) {
        const uint64_t y = check_random(&seed), x = check_random(&seed);
        check_atan2_with_libm(y >> (i % 3U), x >> (i % 5U), i % 64U == 0U);
    }
    CHECK_EQ(trig_atan2_turn64(0, 0), 0);
    printf("# trig_atan2_turn64: worst error %.3e rad = 2^%.2f rad = %.2f units of 2^-64 turn; "
           "atan2l's own %.1e rad\n",
           worst_rad, log2(worst_rad), worst_rad / 6.283185307179586 * 0x1p64, worst_reference_rad);
    printf("# trig_atan2: worst error %.9f BAM\n", worst_bam);
    CHECK(worst_reference_rad <= 0x1p-62);
    CHECK(worst_bam <= ATAN2_BAM_MAX);
}

// ---------------------------------------------------------------- square roots

/// Every place where the root steps, the number before it and the one before the next step.
static void root_of_32_bits(void) {
    for (uint64_t r = 0; r <= UINT16_MAX && check_clean(); r++) {
        CHECK_EQ(root_u32((uint32_t)(r * r)), r);
        CHECK_EQ(root_u32((uint32_t)(r * r + r)), r);
        CHECK_EQ(root_u32((uint32_t)(r * r + 2U * r)), r);
    }
    const uint32_t step = exhaustive ? 1U : 37U;
    uint64_t r = 0, wrong = 0;
    for (uint64_t value = 0; value <= UINT32_MAX; value += step) {
        while ((r + 1U) * (r + 1U) <= value) {
            r++;
        }
        wrong += root_u32((uint32_t)value) != r;
    }
    CHECK_EQ(wrong, 0);
}

static mpz_t value_mpz, root_mpz;

static bool check_root_u128(uint64_t hi, uint64_t lo) {
    mpz_set_ui(value_mpz, hi);
    mpz_mul_2exp(value_mpz, value_mpz, 64);
    mpz_add_ui(value_mpz, value_mpz, lo);
    mpz_sqrt(root_mpz, value_mpz);
    const uint64_t wanted = mpz_get_ui(root_mpz);
    return CHECK(root_u128((struct u128){lo, hi}) == wanted) &&
           (hi != 0U || CHECK(root_u64(lo) == wanted));
}

/// Squares of s and the numbers beside them; 128 bits in all.
static void check_beside_square(uint64_t s) {
    __extension__ typedef unsigned __int128 uint128;
    const uint128 square = (uint128)s * s;
    const uint128 beside[] = {square - (s != 0U), square, square + s, square + 2U * (uint128)s};
    for (unsigned i = 0; i < sizeof beside / sizeof *beside; i++) {
        check_root_u128((uint64_t)(beside[i] >> 64), (uint64_t)beside[i]);
    }
}

static void root_of_64_and_128_bits(void) {
    mpz_inits(value_mpz, root_mpz, (mpz_ptr)NULL);
    for (unsigned i = 0; i < 64U; i++) {
        for (unsigned j = 0; j < 64U && check_clean(); j++) {
            check_beside_square((UINT64_C(1) << i) + (UINT64_C(1) << j)); // the sum may wrap: fine
            check_beside_square((UINT64_C(1) << i) - (UINT64_C(1) << j));
            check_beside_square((UINT64_MAX >> i) - (UINT64_C(1) << j));
            check_root_u128(UINT64_MAX >> i, UINT64_MAX << j);
            check_root_u128(UINT64_MAX << i, UINT64_MAX >> j);
            check_root_u128(UINT64_C(1) << i, UINT64_C(1) << j);
            check_root_u128(0, (UINT64_C(1) << i) + (UINT64_C(1) << j));
            check_root_u128(0, (UINT64_C(1) << i) - (UINT64_C(1) << j));
        }
    }
    for (unsigned i = 0; i < 1000000U && check_clean(); i++) {
        check_root_u128(any_u64(), check_random(&seed));
        check_root_u128(0, any_u64());
        check_beside_square(any_u64());
        check_beside_square(any_u64() >> 32);
    }
    mpz_clears(value_mpz, root_mpz, (mpz_ptr)NULL);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *exhaustive_text = getenv("EXHAUSTIVE");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 20240229U;
    exhaustive = exhaustive_text != NULL && exhaustive_text[0] == '1';
    printf("# seed %llu\n", (unsigned long long)seed);
    start_sincos();
    start_atan2();
    TEST(sincos_of_the_first_octant);
    TEST(sincos_of_the_other_octants);
    TEST(arc_tangent);
    TEST(root_of_32_bits);
    TEST(root_of_64_and_128_bits);
    mpfr_clears(bam_to_rad, exact_angle, exact_sine, exact_cosine, (mpfr_ptr)NULL);
    mpfr_clears(y_exact, x_exact, angle_exact, rad_per_turn64, (mpfr_ptr)NULL);
    mpfr_free_cache();
    return check_finish();
}
