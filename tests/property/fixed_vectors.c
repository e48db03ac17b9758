/// Normalisation of vectors in firmware/fixed/vec3.h against GMP.
///
/// Correct rounding is decided in exact integers: the wanted component is the q with
/// (2q - 1)^2 |a|^2 <= (2 |a_i| 2^bits)^2 < (2q + 1)^2 |a|^2, the lower end being a tie that rounds
/// away from zero. COUNT and SEED in the environment draw more or other samples.
#include "check.h"

#include "fixed/vec3.h"

#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long count;

static int64_t any_i64(void) {
    static const int64_t ends[] = {INT64_MIN, INT64_MIN + 1, -1, 0, 1, INT64_MAX - 1, INT64_MAX};
    const uint64_t bits = check_random(&seed);
    return bits % 8U == 0U ? ends[(bits >> 8) % 7U]
                           : (int64_t)check_random(&seed) >> ((bits >> 8) % 64U);
}

static int32_t any_i32(void) {
    static const int32_t ends[] = {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX - 1, INT32_MAX};
    const uint64_t bits = check_random(&seed);
    return bits % 8U == 0U ? ends[(bits >> 8) % 7U]
                           : (int32_t)(uint32_t)(bits >> 32) >> ((bits >> 8) % 32U);
}

static struct vec3 any_vec3(void) {
    return vec3(any_i32(), any_i32(), any_i32());
}

// ---------------------------------------------------------------- exact rounding of int32 vectors

static mpz_t norm2, left, right;

/// Is `got` = a / sqrt(norm2) * 2^bits, correctly rounded, ties away from zero?
static bool rounded_correctly(int64_t a, int64_t got, unsigned bits) {
    if (got != 0 && (got < 0) != (a < 0)) {
        return false;
    }
    const uint64_t size = u64_abs(got);
    mpz_set_si(left, a);
    mpz_mul(left, left, left);
    mpz_mul_2exp(left, left, 2UL * bits + 2UL);
    mpz_set_ui(right, 2U * size + 1U);
    mpz_mul(right, right, right);
    mpz_mul(right, right, norm2);
    if (mpz_cmp(left, right) >= 0) {
        return false;
    }
    mpz_set_ui(right, size == 0U ? 0U : 2U * size - 1U);
    mpz_mul(right, right, right);
    mpz_mul(right, right, norm2);
    return mpz_cmp(left, right) >= 0;
}

static void set_norm2(struct vec3 a) {
    mpz_set_ui(norm2, u64_abs((int64_t)a.x * a.x));
    mpz_add_ui(norm2, norm2, u64_abs((int64_t)a.y * a.y));
    mpz_add_ui(norm2, norm2, u64_abs((int64_t)a.z * a.z));
}

static bool check_rounding(struct vec3 a) {
    set_norm2(a);
    const struct vec3 unit = vec3_normalise(a);
    const struct vec3_i64 fine = vec3_normalise_q61(a);
    return CHECK(rounded_correctly(a.x, unit.x, 30)) && CHECK(rounded_correctly(a.y, unit.y, 30)) &&
           CHECK(rounded_correctly(a.z, unit.z, 30)) && CHECK(rounded_correctly(a.x, fine.x, 61)) &&
           CHECK(rounded_correctly(a.y, fine.y, 61)) && CHECK(rounded_correctly(a.z, fine.z, 61));
}

static void int32_vectors_are_rounded_correctly(void) {
    for (int32_t x = -9; x <= 9; x++) {
        for (int32_t y = -9; y <= 9; y++) {
            for (int32_t z = -9; z <= 9 && check_clean(); z++) {
                if (x != 0 || y != 0 || z != 0) {
                    check_rounding(vec3(x, y, z));
                }
            }
        }
    }
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3 a = any_vec3();
        if (!vec3_is_zero(a)) {
            check_rounding(a);
        }
    }
}

/// No component is ever exactly half way: that needs |a| = 2^31 a_i / (2q + 1), so |a|^2 would hold
/// more factors of two than a_i^2, and a sum of three squares with an odd one among them is never
/// divisible by four. The nearest misses have |a| just beside 2^31.
static void near_ties(void) {
    for (unsigned long i = 0; i < count / 4U && check_clean(); i++) {
        // A long vector along an axis with a small component beside it: a_i / |a| * 2^30 is near
        // a half when |a| is near 2^31.
        const int32_t small = (int32_t)(check_random(&seed) % 65536U);
        const int32_t other = (int32_t)(check_random(&seed) % 65536U);
        const int32_t large = INT32_MIN + (int32_t)(check_random(&seed) % 4U);
        check_rounding(vec3(2 * small + 1, large, other));
        check_rounding(vec3(other, 2 * small + 1, large));
        check_rounding(vec3(large, other, -2 * small - 1));
    }
}

// ---------------------------------------------------------------- one direction, one answer

static bool same_unit(struct vec3 a, struct vec3 b) {
    return CHECK_EQ(a.x, b.x) && CHECK_EQ(a.y, b.y) && CHECK_EQ(a.z, b.z);
}

static void length_and_sign_change_nothing(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3 a = vec3(any_i32() >> 8, any_i32() >> 12, any_i32() >> (1U + i % 31U));
        if (vec3_is_zero(a)) {
            continue;
        }
        // At least the largest component, and at most twice it.
        const uint64_t largest = u64_abs(a.x) | u64_abs(a.y) | u64_abs(a.z);
        const uint64_t factor_max = INT32_MAX / (largest + 1U);
        const int32_t factor = 1 + (int32_t)(check_random(&seed) % factor_max);
        const struct vec3 scaled = vec3(a.x * factor, a.y * factor, a.z * factor);
        const struct vec3 unit = vec3_normalise(a);
        same_unit(vec3_normalise(scaled), unit);
        same_unit(vec3_normalise(vec3_neg(a)), vec3_neg(unit));
        const struct vec3_i64 fine = vec3_normalise_q61(a),
                              fine_scaled = vec3_normalise_q61(scaled),
                              fine_back = vec3_normalise_q61(vec3_neg(a));
        CHECK(fine.x == fine_scaled.x && fine.y == fine_scaled.y && fine.z == fine_scaled.z);
        CHECK(fine.x == -fine_back.x && fine.y == -fine_back.y && fine.z == -fine_back.z);
        // Any length up to 64 bits.
        const uint64_t stretch_max = INT64_MAX / (largest + 1U);
        const int64_t stretch = 1 + (int64_t)((check_random(&seed) >> (i % 60U)) % stretch_max);
        const struct vec3_i64 far = {a.x * stretch, a.y * stretch, a.z * stretch};
        same_unit(vec3_i64_normalise(far), unit);
        same_unit(vec3_i64_normalise((struct vec3_i64){-far.x, -far.y, -far.z}), vec3_neg(unit));
    }
}

// ---------------------------------------------------------------- int64 vectors

static void check_rounding_i64(struct vec3_i64 a) {
    const int64_t of[3] = {a.x, a.y, a.z};
    mpz_set_ui(norm2, 0);
    for (unsigned axis = 0; axis < 3U; axis++) {
        mpz_set_si(left, of[axis]);
        mpz_addmul(norm2, left, left);
    }
    const struct vec3 unit = vec3_i64_normalise(a);
    CHECK(rounded_correctly(a.x, unit.x, 30) && rounded_correctly(a.y, unit.y, 30) &&
          rounded_correctly(a.z, unit.z, 30));
}

static void int64_vectors_are_rounded_correctly(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3_i64 a = {any_i64(), any_i64(), any_i64()};
        if ((a.x | a.y | a.z) == 0) {
            continue;
        }
        check_rounding_i64(a);
        const struct vec3_i64 half = {a.x / 2, a.y / 2, a.z / 2};
        mpz_set_si(left, half.x);
        mpz_mul(norm2, left, left);
        mpz_set_si(left, half.y);
        mpz_addmul(norm2, left, left);
        mpz_set_si(left, half.z);
        mpz_addmul(norm2, left, left);
        mpz_sqrt(norm2, norm2);
        CHECK(mpz_cmp_ui(norm2, vec3_i64_length(half)) == 0);
    }
}

/// Directions with a component 2^-24 to 2^-32 units beside a tie, found by search, and multiples of
/// them: rounding from a length of 62 bits gave different bits for different multiples.
static void int64_vectors_beside_ties(void) {
    static const struct vec3 direction[] = {
        {-133731894, 883804667, -379173447},  {8248970, -182158897, 884328375},
        {-851037102, -676981233, 481225914},  {137607435, -234222344, -622859111},
        {-275415709, 1034698689, -116756647}, {1, 1, INT32_MIN}};
    for (unsigned i = 0; i < sizeof direction / sizeof *direction; i++) {
        const struct vec3 a = direction[i], unit = vec3_normalise(a);
        same_unit(vec3_i64_normalise(vec3_widen(a)), unit);
        for (unsigned long k = 0; k < count / 40U && check_clean(); k++) {
            const int64_t stretch = 1 + (int64_t)(check_random(&seed) >> (33U + k % 31U));
            const struct vec3_i64 far = {a.x * stretch, a.y * stretch, a.z * stretch};
            check_rounding_i64(far);
            same_unit(vec3_i64_normalise(far), unit);
        }
    }
}

/// Where vec3_i64_normalise_within is sure, every corner of the box of the error has the same bits.
static bool check_within(struct vec3_i64 a, uint32_t error) {
    struct vec3 unit;
    if (!vec3_i64_normalise_within(a, error, &unit)) {
        return false;
    }
    for (unsigned corner = 0; corner < 8U; corner++) {
        const int64_t e = error;
        const struct vec3_i64 moved = {a.x + ((corner & 1U) != 0U ? e : -e),
                                       a.y + ((corner & 2U) != 0U ? e : -e),
                                       a.z + ((corner & 4U) != 0U ? e : -e)};
        same_unit(vec3_i64_normalise(moved), unit);
    }
    return true;
}

static void what_is_not_known_changes_no_bit(void) {
    unsigned long sure = 0, of = 0;
    for (unsigned long i = 0; i < count / 4U && check_clean(); i++) {
        const struct vec3_i64 a = {any_i64() / 2, any_i64() / 2, any_i64() / 2};
        check_within(a, (uint32_t)(check_random(&seed) >> (33U + i % 31U)));
        const struct vec3_i64 full = {a.x / 2, a.y / 2,
                                      (int64_t)(check_random(&seed) >> 4 | UINT64_C(1) << 59)};
        sure += check_within(full, 64);
        of++;
    }
    printf("# sure of %lu of %lu vectors of 60 bits that are known to 64 units\n", sure, of);
    CHECK(of - sure <= of / 1000U);
    // 2^-20 units beside a tie it must not be, as soon as the error reaches across.
    const struct vec3 tie = {8248970, -182158897, 884328375};
    const int64_t stretch = (int64_t)1 << 30;
    struct vec3 unit;
    CHECK(!vec3_i64_normalise_within(
        (struct vec3_i64){tie.x * stretch, tie.y * stretch, tie.z * stretch}, 1024, &unit));
    CHECK(!vec3_i64_normalise_within((struct vec3_i64){0, 0, 0}, 0, &unit));
}

static void zero_stays_zero(void) {
    CHECK(vec3_is_zero(vec3_normalise(vec3(0, 0, 0))));
    const struct vec3_i64 fine = vec3_normalise_q61(vec3(0, 0, 0));
    CHECK_EQ(fine.x | fine.y | fine.z, 0);
    CHECK(vec3_is_zero(vec3_i64_normalise((struct vec3_i64){0, 0, 0})));
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19850301U;
    count = count_text != NULL ? strtoul(count_text, NULL, 0) : 400000UL;
    printf("# seed %llu, %lu samples a test\n", (unsigned long long)seed, count);
    mpz_inits(norm2, left, right, (mpz_ptr)NULL);
    TEST(int32_vectors_are_rounded_correctly);
    TEST(near_ties);
    TEST(length_and_sign_change_nothing);
    TEST(int64_vectors_are_rounded_correctly);
    TEST(int64_vectors_beside_ties);
    TEST(what_is_not_known_changes_no_bit);
    TEST(zero_stays_zero);
    mpz_clears(norm2, left, right, (mpz_ptr)NULL);
    return check_finish();
}
