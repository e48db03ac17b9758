/// firmware/fixed/wide.h and the products of vec3.h against GMP.
///
/// Operands have random bit lengths and are often at the ends of a word: runs of ones and zeros,
/// where a lost carry shows. COUNT and SEED in the environment draw more or other samples.
#include "check.h"

#include "fixed/vec3.h"
#include "fixed/wide.h"

#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long count;

/// Up to `words` random 64-bit words with long runs of equal bits, as a two's complement number.
static void any_words(uint64_t *word, unsigned words) {
    const unsigned kind = (unsigned)(check_random(&seed) % 4U);
    for (unsigned i = 0; i < words; i++) {
        const uint64_t bits = check_random(&seed);
        word[i] = kind == 0U ? bits : (bits & 1U) != 0U ? UINT64_MAX : 0U;
        if (kind == 1U) {
            word[i] ^= UINT64_C(1) << (bits >> 58);
        } else if (kind == 2U) {
            word[i] = (bits & 2U) != 0U ? word[i] << (bits >> 58) : word[i] >> (bits >> 58);
        }
    }
    // A random length: the sign fills the rest.
    const unsigned keep = (unsigned)(check_random(&seed) % (64U * words)) + 1U;
    const uint64_t fill = (check_random(&seed) & 1U) != 0U ? UINT64_MAX : 0U;
    for (unsigned i = 0; i < words; i++) {
        if (64U * i >= keep) {
            word[i] = fill;
        } else if (64U * (i + 1U) > keep) {
            const uint64_t low = UINT64_MAX >> (64U * (i + 1U) - keep);
            word[i] = (word[i] & low) | (fill & ~low);
        }
    }
}

static int64_t any_i64(void) {
    uint64_t word;
    any_words(&word, 1);
    return (int64_t)word;
}

static struct i128 any_i128(void) {
    uint64_t word[2];
    any_words(word, 2);
    return (struct i128){word[0], (int64_t)word[1]};
}

static struct i256 any_i256(void) {
    struct i256 a;
    any_words(a.word, 4);
    return a;
}

/// The words, the last one signed, as an integer of any size.
static void set_words(mpz_t to, const uint64_t *word, unsigned words) {
    mpz_import(to, words, -1, sizeof *word, 0, 0, word);
    if ((word[words - 1U] >> 63) != 0U) {
        mpz_t modulus;
        mpz_init_set_ui(modulus, 1);
        mpz_mul_2exp(modulus, modulus, 64UL * words);
        mpz_sub(to, to, modulus);
        mpz_clear(modulus);
    }
}

static void set_i128(mpz_t to, struct i128 a) {
    const uint64_t word[2] = {a.lo, (uint64_t)a.hi};
    set_words(to, word, 2);
}

static void set_i256(mpz_t to, struct i256 a) {
    set_words(to, a.word, 4);
}

/// Is got = wanted modulo 2^bits?
static bool equal_modulo(const mpz_t got, const mpz_t wanted, unsigned bits) {
    mpz_t rest;
    mpz_init(rest);
    mpz_sub(rest, got, wanted);
    const bool equal = mpz_divisible_2exp_p(rest, bits) != 0;
    mpz_clear(rest);
    return equal;
}

static mpz_t p, q, got, wanted;

static void sums_of_128_bits(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct i128 a = any_i128(), b = any_i128();
        set_i128(p, a);
        set_i128(q, b);
        mpz_add(wanted, p, q);
        set_i128(got, i128_add(a, b));
        CHECK(equal_modulo(got, wanted, 128));
        mpz_sub(wanted, p, q);
        set_i128(got, i128_sub(a, b));
        CHECK(equal_modulo(got, wanted, 128));
        mpz_neg(wanted, p);
        set_i128(got, i128_neg(a));
        CHECK(equal_modulo(got, wanted, 128));
        CHECK_EQ(i128_sign(a), mpz_sgn(p));
        const int order = mpz_cmp(p, q);
        CHECK_EQ(i128_cmp(a, b), order > 0 ? 1 : (order < 0 ? -1 : 0));
        const struct u128 ua = {a.lo, (uint64_t)a.hi}, ub = {b.lo, (uint64_t)b.hi};
        const struct u128 sum = u128_add(ua, ub);
        CHECK(sum.lo == i128_add(a, b).lo && sum.hi == (uint64_t)i128_add(a, b).hi);
        mpz_fdiv_r_2exp(p, p, 128);
        mpz_fdiv_r_2exp(q, q, 128);
        const int unsigned_order = mpz_cmp(p, q);
        CHECK_EQ(u128_cmp(ua, ub), unsigned_order > 0 ? 1 : (unsigned_order < 0 ? -1 : 0));
    }
}

static void products(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const int64_t a = any_i64(), b = any_i64();
        mpz_set_si(p, a);
        mpz_set_si(q, b);
        mpz_mul(wanted, p, q);
        set_i128(got, i128_mul(a, b));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
        const struct u128 product = u128_mul((uint64_t)a, (uint64_t)b);
        mpz_set_ui(p, (uint64_t)a);
        mpz_set_ui(q, (uint64_t)b);
        mpz_mul(wanted, p, q);
        const uint64_t word[3] = {product.lo, product.hi, 0};
        set_words(got, word, 3);
        CHECK_EQ(mpz_cmp(got, wanted), 0);
        CHECK(u64_mul_high((uint64_t)a, (uint64_t)b) == product.hi);
        const struct i128 c = any_i128(), d = any_i128();
        set_i128(p, c);
        set_i128(q, d);
        mpz_mul(wanted, p, q);
        set_i256(got, i256_mul(c, d));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
    }
    // The only product of 128-bit numbers that needs all 255 bits.
    const struct i128 least = {0, INT64_MIN};
    set_i256(got, i256_mul(least, least));
    mpz_set_ui(wanted, 1);
    mpz_mul_2exp(wanted, wanted, 254);
    CHECK_EQ(mpz_cmp(got, wanted), 0);
}

static void sums_of_256_bits(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct i256 a = any_i256(), b = any_i256();
        set_i256(p, a);
        set_i256(q, b);
        mpz_add(wanted, p, q);
        set_i256(got, i256_add(a, b));
        CHECK(equal_modulo(got, wanted, 256));
        mpz_sub(wanted, p, q);
        set_i256(got, i256_sub(a, b));
        CHECK(equal_modulo(got, wanted, 256));
        mpz_neg(wanted, p);
        set_i256(got, i256_neg(a));
        CHECK(equal_modulo(got, wanted, 256));
        CHECK_EQ(i256_sign(a), mpz_sgn(p));
        CHECK_EQ(i256_bit_length(a), mpz_sgn(p) == 0 ? 0 : (int64_t)mpz_sizeinbase(p, 2));
        const struct i128 c = any_i128();
        set_i128(p, c);
        set_i256(got, i256_from_i128(c));
        CHECK_EQ(mpz_cmp(got, p), 0);
    }
}

static void shifts(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct i256 a = any_i256();
        set_i256(p, a);
        for (unsigned shift = 0; shift < 256U;
             shift += 1U + (unsigned)(check_random(&seed) % 97U)) {
            mpz_fdiv_q_2exp(wanted, p, shift);
            if (mpz_fits_slong_p(wanted)) {
                CHECK_EQ(i256_shift_right_i64(a, shift), mpz_get_si(wanted));
            }
        }
        const uint64_t b = (uint64_t)any_i64();
        mpz_set_ui(p, b);
        CHECK_EQ(u64_leading_zeros(b), b == 0U ? 64 : 64 - (int64_t)mpz_sizeinbase(p, 2));
    }
}

static void division(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const uint64_t divisor = (uint64_t)any_i64(), lo = (uint64_t)any_i64();
        if (divisor == 0U) {
            continue;
        }
        const uint64_t hi = (i & 1U) != 0U ? divisor - 1U : (uint64_t)any_i64() % divisor;
        uint64_t rest;
        const uint64_t quotient = u128_div_u64((struct u128){lo, hi}, divisor, &rest);
        const uint64_t word[3] = {lo, hi, 0};
        set_words(p, word, 3);
        mpz_set_ui(wanted, mpz_fdiv_q_ui(q, p, divisor));
        CHECK(mpz_cmp_ui(wanted, rest) == 0);
        CHECK(mpz_cmp_ui(q, quotient) == 0);
    }
}

// ---------------------------------------------------------------- determinants and products

static int32_t any_i32(void) {
    static const int32_t ends[] = {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX - 1, INT32_MAX};
    const uint64_t bits = check_random(&seed);
    return bits % 3U == 0U ? ends[(bits >> 8) % 7U]
                           : (int32_t)(uint32_t)((int64_t)bits >> (bits >> 58) % 64U);
}

static struct vec3 any_vec3(void) {
    return vec3(any_i32(), any_i32(), any_i32());
}

/// wanted += a * b * c.
static void add_product(int32_t a, int32_t b, int32_t c) {
    mpz_set_si(p, a);
    mpz_mul_si(p, p, b);
    mpz_mul_si(p, p, c);
    mpz_add(wanted, wanted, p);
}

static void subtract_product(int32_t a, int32_t b, int32_t c) {
    mpz_neg(wanted, wanted);
    add_product(a, b, c);
    mpz_neg(wanted, wanted);
}

static void determinants(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3 a = any_vec3(), b = any_vec3();
        struct vec3 c = any_vec3();
        if (i % 2U == 0U) { // nearly in the plane of a and b
            c = vec3(a.x / 2 - b.x / 2, a.y / 2 - b.y / 2, a.z / 2 - b.z / 2);
        }
        mpz_set_ui(wanted, 0);
        add_product(a.x, b.y, c.z);
        subtract_product(a.x, b.z, c.y);
        add_product(a.y, b.z, c.x);
        subtract_product(a.y, b.x, c.z);
        add_product(a.z, b.x, c.y);
        subtract_product(a.z, b.y, c.x);
        CHECK_EQ(vec3_det_sign(a, b, c), mpz_sgn(wanted));
        set_i128(got, vec3_i64_dot_vec3(vec3_cross(b, c), a));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
    }
}

/// 2^62 at most, as vec3.h asks for.
static struct vec3_i64 any_vec3_i64(void) {
    return (struct vec3_i64){any_i64() / 2, any_i64() / 2, any_i64() / 2};
}

static void add_i64_product(mpz_t sum, int64_t a, int64_t b, int sign) {
    mpz_set_si(q, a);
    mpz_mul_si(q, q, b);
    if (sign < 0) {
        mpz_sub(sum, sum, q);
    } else {
        mpz_add(sum, sum, q);
    }
}

static void products_of_wide_vectors(void) {
    mpz_t cross;
    mpz_init(cross);
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3_i64 a = any_vec3_i64(), b = any_vec3_i64(), c = any_vec3_i64();
        mpz_set_ui(wanted, 0);
        add_i64_product(wanted, a.x, b.x, 1);
        add_i64_product(wanted, a.y, b.y, 1);
        add_i64_product(wanted, a.z, b.z, 1);
        set_i128(got, vec3_i64_dot(a, b));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
        const struct vec3_i128 normal = vec3_i64_cross(a, b);
        const int64_t left[3][4] = {
            {a.y, b.z, a.z, b.y}, {a.z, b.x, a.x, b.z}, {a.x, b.y, a.y, b.x}};
        const struct i128 component[3] = {normal.x, normal.y, normal.z};
        const int64_t factor[3] = {c.x, c.y, c.z};
        mpz_set_ui(wanted, 0);
        for (unsigned axis = 0; axis < 3U; axis++) {
            mpz_set_ui(cross, 0);
            add_i64_product(cross, left[axis][0], left[axis][1], 1);
            add_i64_product(cross, left[axis][2], left[axis][3], -1);
            set_i128(got, component[axis]);
            CHECK_EQ(mpz_cmp(got, cross), 0);
            mpz_mul_si(cross, cross, factor[axis]);
            mpz_add(wanted, wanted, cross);
        }
        set_i256(got, vec3_i128_dot(normal, c));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
    }
    mpz_clear(cross);
}

static void products_modulo_2_256(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct i256 a = any_i256(), b = any_i256();
        set_i256(p, a);
        set_i256(q, b);
        mpz_mul(wanted, p, q);
        set_i256(got, i256_product(a, b));
        mpz_sub(wanted, wanted, got);
        CHECK(mpz_divisible_2exp_p(wanted, 256) != 0);
    }
}

static void products_of_int32_vectors(void) {
    for (unsigned long i = 0; i < count && check_clean(); i++) {
        const struct vec3 a = any_vec3(), b = any_vec3();
        mpz_set_ui(wanted, 0);
        add_i64_product(wanted, a.x, b.x, 1);
        add_i64_product(wanted, a.y, b.y, 1);
        add_i64_product(wanted, a.z, b.z, 1);
        set_i128(got, vec3_dot(a, b));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
        mpz_set_ui(wanted, 0);
        add_i64_product(wanted, a.x, a.x, 1);
        add_i64_product(wanted, a.y, a.y, 1);
        add_i64_product(wanted, a.z, a.z, 1);
        CHECK(mpz_cmp_ui(wanted, vec3_norm2(a)) == 0);
        const struct vec3_i64 wide = {any_i64(), any_i64(), any_i64()};
        mpz_set_ui(wanted, 0);
        add_i64_product(wanted, wide.x, b.x, 1);
        add_i64_product(wanted, wide.y, b.y, 1);
        add_i64_product(wanted, wide.z, b.z, 1);
        set_i128(got, vec3_i64_dot_vec3(wide, b));
        CHECK_EQ(mpz_cmp(got, wanted), 0);
    }
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19820501U;
    count = count_text != NULL ? strtoul(count_text, NULL, 0) : 300000UL;
    printf("# seed %llu, %lu samples a test\n", (unsigned long long)seed, count);
    mpz_inits(p, q, got, wanted, (mpz_ptr)NULL);
    TEST(sums_of_128_bits);
    TEST(products);
    TEST(sums_of_256_bits);
    TEST(products_modulo_2_256);
    TEST(shifts);
    TEST(division);
    TEST(determinants);
    TEST(products_of_int32_vectors);
    TEST(products_of_wide_vectors);
    mpz_clears(p, q, got, wanted, (mpz_ptr)NULL);
    return check_finish();
}
