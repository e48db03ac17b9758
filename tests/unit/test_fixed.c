/// firmware/fixed against __int128 where the compiler has it, and against identities where it has
/// not.
#include "check.h"

#include "fixed/bam32.h"
#include "fixed/q30.h"
#include "fixed/root.h"
#include "fixed/trig.h"
#include "fixed/vec3.h"
#include "fixed/wide.h"

static uint64_t seed = UINT64_C(0x9E3779B97F4A7C15);

/// A random number whose size is itself random: every bit length comes up.
static uint64_t any_u64(void) {
    const uint64_t bits = check_random(&seed);
    return bits >> (check_random(&seed) % 64U);
}

static int64_t any_i64(void) {
    const uint64_t value = any_u64();
    return (check_random(&seed) & 1U) != 0U ? (int64_t)value : (int64_t)(0U - value);
}

static int32_t any_i32(void) {
    return (int32_t)(uint32_t)any_i64();
}

static void odd_rounding(void) {
    CHECK_EQ(round_shift_i64(3, 1), 2);
    CHECK_EQ(round_shift_i64(-3, 1), -2);
    CHECK_EQ(round_shift_i64(5, 2), 1);
    CHECK_EQ(round_shift_i64(-6, 2), -2);
    for (int i = 0; i < 1000 && check_clean(); i++) {
        const int64_t value = any_i64() / 4;
        const unsigned bits = 1U + (unsigned)(check_random(&seed) % 60U);
        CHECK_EQ(round_shift_i64(-value, bits), -round_shift_i64(value, bits));
    }
    CHECK_EQ(q30_mul(Q30_ONE, -Q30_ONE), -Q30_ONE);
    CHECK_EQ(q30_mul(Q30_ONE / 2, Q30_ONE / 2), Q30_ONE / 4);
}

static void binary_angles(void) {
    CHECK_EQ(bam32_diff(bam32(0), bam32(1)), -1);
    CHECK_EQ(bam32_diff(bam32(5), bam32(0xFFFFFFFFU)), 6);
    CHECK_EQ(bam32_signed(bam32(BAM32_HALF)), INT32_MIN);
    CHECK_EQ(bam32_signed(bam32(BAM32_HALF - 1U)), INT32_MAX);
    CHECK_EQ(bam32_neg(bam32(1)).bam, 0xFFFFFFFFU);
    CHECK_EQ(bam32_add(bam32(BAM32_HALF), bam32(BAM32_HALF)).bam, 0);
}

#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 int128;
__extension__ typedef unsigned __int128 uint128;

static int128 from_wide(struct i128 a) {
    return (int128)(((uint128)(uint64_t)a.hi << 64) | a.lo);
}

static struct i128 to_wide(int128 a) {
    return (struct i128){(uint64_t)a, (int64_t)(a >> 64)};
}

static int128 any_i128(void) {
    const int128 value = (int128)(((uint128)any_u64() << 64) | any_u64());
    return value >> (check_random(&seed) % 128U);
}

static void wide_128_matches_the_compiler(void) {
    for (int i = 0; i < CHECK_ROUNDS(200000) && check_clean(); i++) {
        const int64_t a = any_i64(), b = any_i64();
        const int128 p = any_i128(), q = any_i128();
        CHECK(from_wide(i128_mul(a, b)) == (int128)a * b);
        CHECK(from_wide(i128_add(to_wide(p), to_wide(q))) == (int128)((uint128)p + (uint128)q));
        CHECK(from_wide(i128_sub(to_wide(p), to_wide(q))) == (int128)((uint128)p - (uint128)q));
        CHECK(from_wide(i128_neg(to_wide(p))) == (int128)(0 - (uint128)p));
        CHECK_EQ(i128_sign(to_wide(p)), p > 0 ? 1 : (p < 0 ? -1 : 0));
        CHECK_EQ(i128_cmp(to_wide(p), to_wide(q)), p > q ? 1 : (p < q ? -1 : 0));
        const uint64_t c = any_u64(), d = any_u64() | 1U;
        const struct u128 product = u128_mul(c, d);
        CHECK((((uint128)product.hi << 64) | product.lo) == (uint128)c * d);
    }
    const int128 least = (int128)((uint128)1 << 127);
    CHECK_EQ(i128_sign(to_wide(least)), -1);
    CHECK_EQ(i128_sign(to_wide(1)), 1);
    CHECK_EQ(i128_sign(to_wide((int128)1 << 64)), 1);
}

static void long_division_matches_the_compiler(void) {
    for (int i = 0; i < CHECK_ROUNDS(200000) && check_clean(); i++) {
        uint64_t divisor = any_u64() | 1U, rest;
        if ((i & 3) == 0) {
            divisor = UINT64_MAX -
                      any_u64() % 5U; // the estimates of a digit are worst near powers of two
        } else if ((i & 3) == 1) {
            divisor = (UINT64_C(1) << (check_random(&seed) % 64U)) + any_u64() % 2U;
        }
        const struct u128 n = {any_u64(), (i & 4) != 0 ? divisor - 1U : any_u64() % divisor};
        const uint128 whole = ((uint128)n.hi << 64) | n.lo;
        const uint64_t quotient = u128_div_u64(n, divisor, &rest);
        CHECK(quotient == (uint64_t)(whole / divisor));
        CHECK(rest == (uint64_t)(whole % divisor));
    }
}

static void determinant(void) {
    for (int i = 0; i < CHECK_ROUNDS(100000) && check_clean(); i++) {
        const struct vec3 a = vec3(any_i32(), any_i32(), any_i32());
        const struct vec3 b = vec3(any_i32(), any_i32(), any_i32());
        const struct vec3 c = vec3(any_i32(), any_i32(), any_i32());
        const int128 det = ((int128)((int64_t)a.y * b.z) - (int64_t)a.z * b.y) * c.x +
                           ((int128)((int64_t)a.z * b.x) - (int64_t)a.x * b.z) * c.y +
                           ((int128)((int64_t)a.x * b.y) - (int64_t)a.y * b.x) * c.z;
        CHECK_EQ(vec3_det_sign(a, b, c), det > 0 ? 1 : (det < 0 ? -1 : 0));
        CHECK(from_wide(vec3_dot(a, b)) ==
              (int128)((int64_t)a.x * b.x) + (int64_t)a.y * b.y + (int64_t)a.z * b.z);
    }
}
#endif

static void determinant_at_the_ends_of_the_range(void) {
    const int32_t low = INT32_MIN, high = INT32_MAX;
    CHECK_EQ(vec3_det_sign(vec3(low, low, low), vec3(low, low, high), vec3(high, low, low)), -1);
    CHECK_EQ(vec3_det_sign(vec3(high, 0, 0), vec3(0, high, 0), vec3(0, 0, high)), 1);
    CHECK_EQ(vec3_det_sign(vec3(low, 0, 0), vec3(0, low, 0), vec3(0, 0, low)), -1);
    CHECK_EQ(vec3_det_sign(vec3(high, high, high), vec3(low, low, low), vec3(1, 2, 3)), 0);
    // One unit beside a plane through two long vectors.
    CHECK_EQ(vec3_det_sign(vec3(high, high - 1, 1), vec3(high - 1, high - 2, 1), vec3(1, 1, 0)), 0);
    CHECK_EQ(vec3_cross(vec3(0, low, high), vec3(0, high, low)).x,
             (int64_t)low * low - (int64_t)high * high);
}

static void wide_256_identities(void) {
    for (int i = 0; i < CHECK_ROUNDS(20000) && check_clean(); i++) {
        const struct i128 a = {any_u64(), any_i64()}, b = {any_u64(), any_i64()},
                          c = {any_u64(), any_i64() / 2};
        const struct i128 a_half = {a.lo, a.hi / 2};
        const struct i256 left = i256_mul(
            b, i128_add(a_half, c.hi == INT64_MIN ? a_half : (struct i128){c.lo, c.hi / 2}));
        const struct i256 right =
            i256_add(i256_mul(b, a_half),
                     i256_mul(b, c.hi == INT64_MIN ? a_half : (struct i128){c.lo, c.hi / 2}));
        CHECK_EQ(i256_sign(i256_sub(left, right)), 0);
        CHECK_EQ(i256_sign(i256_mul(a, b)), i128_sign(a) * i128_sign(b));
        CHECK_EQ(i256_sign(i256_add(left, i256_neg(left))), 0);
        const struct i256 narrow = i256_from_i128(a);
        const unsigned shift = (unsigned)(check_random(&seed) % 64U);
        CHECK_EQ(i256_shift_right_i64(narrow, 64U), a.hi);
        CHECK_EQ(
            i256_shift_right_i64(i256_mul(a, (struct i128){UINT64_C(1) << shift, 0}), 64U + shift),
            a.hi);
    }
    CHECK_EQ(i256_bit_length(i256_from_i128(i128_from_i64(0))), 0);
    CHECK_EQ(i256_bit_length(i256_from_i128(i128_from_i64(-1))), 1);
    CHECK_EQ(i256_bit_length(i256_from_i128((struct i128){0, 1})), 65);
    CHECK_EQ(u64_leading_zeros(0), 64);
    for (unsigned bit = 0; bit < 64U; bit++) {
        CHECK_EQ(u64_leading_zeros(UINT64_C(1) << bit), 63U - bit);
        CHECK_EQ(u64_leading_zeros(UINT64_MAX >> bit), bit);
    }
}

/// root <= sqrt(value) < root + 1, without a square that could overflow.
static bool is_root_u64(uint64_t value, uint64_t root) {
    return root <= UINT32_MAX && root * root <= value && value - root * root <= 2U * root;
}

static void square_roots(void) {
    CHECK_EQ(root_u32(UINT32_MAX), 65535);
    CHECK_EQ(root_u64(UINT64_MAX), UINT32_MAX);
    CHECK(root_u128((struct u128){UINT64_MAX, UINT64_MAX}) == UINT64_MAX);
    CHECK_EQ(root_u64(0), 0);
    for (int i = 0; i < CHECK_ROUNDS(200000) && check_clean(); i++) {
        const uint64_t n = any_u64(), r = (uint32_t)any_u64();
        CHECK(is_root_u64(n, root_u64(n)));
        CHECK(root_u64(r * r) == r);
        CHECK(r == 0U || root_u64(r * r - 1U) == r - 1U);
        CHECK(root_u64(r * r + 2U * r) == r);
        const uint64_t s = any_u64();
        const struct u128 square = u128_mul(s, s);
        CHECK(root_u128(square) == s);
        const struct u128 below = {square.lo - 1U, square.hi - (square.lo == 0U)};
        CHECK(s == 0U || root_u128(below) == s - 1U);
        const struct u128 above =
            u128_add(u128_add(square, (struct u128){s, 0}), (struct u128){s, 0});
        CHECK(root_u128(above) == s);
    }
}

static void trigonometry_at_the_quarter_turns(void) {
    static const q30_t sines[] = {0, Q30_ONE, 0, -Q30_ONE};
    for (unsigned quarter = 0; quarter < 4U; quarter++) {
        const struct sincos got = trig_sincos(bam32(quarter << 30));
        CHECK_EQ(got.sin_q30, sines[quarter]);
        CHECK_EQ(got.cos_q30, sines[(quarter + 1U) % 4U]);
    }
    CHECK_EQ(trig_sincos(bam32(0x20000000U)).sin_q30, 759250125); // sqrt(1/2)
    CHECK_EQ(trig_atan2(0, 0).bam, 0);
    CHECK_EQ(trig_atan2(0, 5).bam, 0);
    CHECK_EQ(trig_atan2(5, 5).bam, 0x20000000U);
    CHECK_EQ(trig_atan2(5, 0).bam, 0x40000000U);
    CHECK_EQ(trig_atan2(0, -5).bam, 0x80000000U);
    CHECK_EQ(trig_atan2(-5, 0).bam, 0xC0000000U);
    CHECK_EQ(trig_atan2(INT64_MIN, INT64_MIN).bam, 0xA0000000U);
    CHECK_EQ(trig_atan2(INT64_MAX, INT64_MAX).bam, 0x20000000U);
    for (int i = 0; i < CHECK_ROUNDS(100000) && check_clean(); i++) {
        const bam32_t angle = bam32((uint32_t)check_random(&seed));
        const struct sincos there = trig_sincos(angle), back = trig_sincos(bam32_neg(angle));
        CHECK_EQ(back.sin_q30, -there.sin_q30);
        CHECK_EQ(back.cos_q30, there.cos_q30);
        // The point on the circle leads back to the angle: 0.71 ulp of 0.93 nrad, in BAM of 1.46
        // nrad.
        CHECK_NEAR(bam32_diff(trig_atan2(there.sin_q30, there.cos_q30), angle), 0, 1);
    }
}

static void normalisation(void) {
    const struct vec3 z = vec3_normalise(vec3(0, 0, -7));
    CHECK(vec3_equal(z, vec3(0, 0, -Q30_ONE)));
    CHECK(vec3_is_zero(vec3_normalise(vec3(0, 0, 0))));
    CHECK(vec3_is_zero(vec3_i64_normalise((struct vec3_i64){0, 0, 0})));
    CHECK(vec3_equal(vec3_normalise(vec3(3, 4, 0)), vec3(644245094, 858993459, 0)));
    for (int i = 0; i < CHECK_ROUNDS(50000) && check_clean(); i++) {
        const struct vec3 a = vec3(any_i32(), any_i32(), any_i32());
        if (vec3_is_zero(a)) {
            continue;
        }
        const struct vec3 unit = vec3_normalise(a);
        const int64_t excess = (int64_t)(vec3_norm2(unit) - ((uint64_t)1 << 60));
        CHECK_NEAR(excess, 0, (int64_t)1 << 31); // within 1 ulp of unit length
        const struct vec3 wide_unit = vec3_i64_normalise(vec3_widen(a));
        CHECK(vec3_equal(unit, wide_unit));
        const struct vec3_i64 shifted = {(int64_t)a.x * 4096, (int64_t)a.y * 4096,
                                         (int64_t)a.z * 4096};
        CHECK(vec3_equal(vec3_i64_normalise(shifted), wide_unit));
        const struct vec3_i64 fine = vec3_normalise_q61(a);
        CHECK_NEAR(round_shift_i64(fine.x, 31), unit.x, 1);
        CHECK_NEAR(round_shift_i64(fine.y, 31), unit.y, 1);
        CHECK_NEAR(round_shift_i64(fine.z, 31), unit.z, 1);
    }
    const struct vec3 corner = vec3(INT32_MIN, INT32_MIN, INT32_MIN);
    CHECK(vec3_equal(vec3_normalise(corner), vec3_normalise(vec3(-1, -1, -1))));
    const struct vec3_i64 far_corner = {INT64_MIN, INT64_MIN, INT64_MIN};
    CHECK(vec3_equal(vec3_i64_normalise(far_corner), vec3_normalise(vec3(-1, -1, -1))));
}

int main(void) {
    TEST(odd_rounding);
    TEST(binary_angles);
#ifdef __SIZEOF_INT128__
    TEST(wide_128_matches_the_compiler);
    TEST(long_division_matches_the_compiler);
    TEST(determinant);
#endif
    TEST(determinant_at_the_ends_of_the_range);
    TEST(wide_256_identities);
    TEST(square_roots);
    TEST(trigonometry_at_the_quarter_turns);
    TEST(normalisation);
    return check_finish();
}
