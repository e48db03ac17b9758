/// Decimals and the directions they become, against GMP's rational numbers.
#include "check.h"

#include "decimal.h"
#include "direction.h"

#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed = UINT64_C(0x8CB92BA72F3D8DD7);

static uint64_t below(uint64_t bound) {
    return check_random(&seed) % bound;
}

enum { TEXT_BYTES = 2048 };

// ---------------------------------------------------------------- what GMP makes of a text

/// A decimal text as a rational; our own grammar, without the code under test.
static void rational(mpq_t out, const char *text) {
    char digits[TEXT_BYTES];
    size_t size = 0;
    long exponent = 0;
    const char *at = text;
    const bool negative = *at == '-';
    at += *at == '-' || *at == '+' ? 1 : 0;
    bool point = false;
    for (; *at != '\0' && *at != 'e' && *at != 'E'; at++) {
        if (*at == '.') {
            point = true;
        } else {
            digits[size++] = *at;
            exponent -= point ? 1 : 0;
        }
    }
    digits[size] = '\0';
    exponent += *at != '\0' ? atol(at + 1) : 0;
    mpz_set_str(mpq_numref(out), digits, 10);
    mpz_set_ui(mpq_denref(out), 1);
    mpz_t power;
    mpz_init(power);
    mpz_ui_pow_ui(power, 10, (unsigned long)labs(exponent));
    mpz_mul(exponent < 0 ? mpq_denref(out) : mpq_numref(out),
            exponent < 0 ? mpq_denref(out) : mpq_numref(out), power);
    mpq_canonicalize(out);
    if (negative) {
        mpq_neg(out, out);
    }
    mpz_clear(power);
}

/// A random number as people and programs write them: all sizes, both grammars.
static void any_text(char text[TEXT_BYTES], unsigned digits_most, unsigned exponent_most) {
    size_t at = 0;
    const unsigned digits = 1U + (unsigned)below(digits_most);
    const unsigned point = (unsigned)below(digits + 2U);
    if (below(2) != 0U) {
        text[at++] = below(4) == 0U ? '+' : '-';
    }
    const bool zeros = below(4) == 0U; // many zeros, at the ends too
    for (unsigned i = 0; i < digits; i++) {
        if (i == point) {
            text[at++] = '.';
        }
        text[at++] = zeros && below(3) != 0U ? '0' : (char)('0' + below(10));
    }
    if (point == digits) {
        text[at++] = '.';
    }
    text[at] = '\0';
    if (exponent_most != 0U && below(2) != 0U) {
        const char *const letter = below(2) != 0U ? "e" : "E";
        const char *const sign = below(2) != 0U ? "-" : (below(2) != 0U ? "+" : "");
        snprintf(text + at, TEXT_BYTES - at, "%s%s%u", letter, sign,
                 (unsigned)below(exponent_most));
    }
}

static enum decimal_status read_text(const char *text, struct decimal *out) {
    return decimal_read(text, strlen(text), out);
}

// ---------------------------------------------------------------- grammar

static void what_is_a_decimal_number(void) {
    static const char *const good[] = {"0",
                                       "-0",
                                       "+1",
                                       "1.",
                                       ".5",
                                       "00.",
                                       "1e5",
                                       "1E+05",
                                       "1.5e-3",
                                       "-.5e1",
                                       "1e-300",
                                       "1e300",
                                       "0e999999999999",
                                       "0.1000000000"};
    static const char *const bad[] = {
        "",      ".",  "-",  "+",   "e5",    "1e", "1e+", "1.2.3", "0x10", "nan", "inf",     "-inf",
        "1_000", "1 ", " 1", "--1", "1e5.0", "1f", "٣",   "1e5e5", "+-1",  "1,5", "infinity"};
    struct decimal value;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        if (!CHECK_EQ(read_text(good[i], &value), DECIMAL_OK)) {
            printf("  %s\n", good[i]);
        }
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        if (!CHECK_EQ(read_text(bad[i], &value), DECIMAL_ERROR_SYNTAX)) {
            printf("  %s\n", bad[i]);
        }
    }
    CHECK_EQ(read_text("-0.00", &value), DECIMAL_OK);
    CHECK(!value.negative && value.digit_count == 0U);
}

static void the_range_of_decimals(void) {
    struct decimal value;
    CHECK_EQ(read_text("1e400", &value), DECIMAL_OK);
    CHECK_EQ(read_text("9.9e400", &value), DECIMAL_OK);
    CHECK_EQ(read_text("1e401", &value), DECIMAL_ERROR_RANGE);
    CHECK_EQ(read_text("1e-1100", &value), DECIMAL_OK);
    CHECK_EQ(read_text("1.1e-1100", &value), DECIMAL_ERROR_RANGE);
    CHECK_EQ(read_text("1e99999999999999999999", &value), DECIMAL_ERROR_RANGE);
    CHECK_EQ(read_text("1e-99999999999999999999", &value), DECIMAL_ERROR_RANGE);
    // Every double that is written out exactly can be read; this one has 767 digits.
    char text[TEXT_BYTES];
    snprintf(text, sizeof text, "%.1074f", 2.2250738585072009e-308);
    CHECK_EQ(read_text(text, &value), DECIMAL_OK);
    snprintf(text, sizeof text, "%.1074f", 4.9406564584124654e-324);
    CHECK_EQ(read_text(text, &value), DECIMAL_OK);
    CHECK_EQ(value.exponent, -1074);
}

// ---------------------------------------------------------------- values

static void comparison_and_scaling(void) {
    static const uint64_t factors[] = {1, 10, 1000, 360, UINT64_C(1) << 32, UINT64_C(1) << 48};
    mpq_t a, b, scaled;
    mpz_t wanted;
    mpq_inits(a, b, scaled, (mpq_ptr)0);
    mpz_init(wanted);
    int64_t beyond = 0;
    for (int i = 0; i < 100000 && check_clean(); i++) {
        char text_a[TEXT_BYTES], text_b[TEXT_BYTES];
        struct decimal da, db;
        any_text(text_a, i % 16 == 0 ? 60U : 12U, 20U);
        any_text(text_b, i % 16 == 1 ? 60U : 12U, 20U);
        if (i % 8 == 0) {
            strcpy(text_b, text_a); // equal, perhaps with one more zero
            if (strchr(text_a, '.') != NULL && strpbrk(text_a, "eE") == NULL) {
                strcat(text_b, "0");
            }
        }
        CHECK_EQ(read_text(text_a, &da), DECIMAL_OK);
        CHECK_EQ(read_text(text_b, &db), DECIMAL_OK);
        rational(a, text_a);
        rational(b, text_b);
        const int order = mpq_cmp(a, b);
        CHECK_EQ(decimal_compare(&da, &db), order > 0 ? 1 : (order < 0 ? -1 : 0));

        // round(a * numerator / denominator), half away from zero.
        const uint64_t numerator = factors[below(6)], denominator = factors[below(6)];
        mpq_set_ui(scaled, numerator, denominator);
        mpq_canonicalize(scaled);
        mpq_mul(scaled, scaled, a);
        mpz_abs(wanted, mpq_numref(scaled));
        mpz_mul_ui(wanted, wanted, 2);
        mpz_add(wanted, wanted, mpq_denref(scaled));
        mpz_fdiv_q(wanted, wanted, mpq_denref(scaled));
        mpz_fdiv_q_2exp(wanted, wanted, 1);
        if (mpq_sgn(scaled) < 0) {
            mpz_neg(wanted, wanted);
        }
        int64_t got = 0;
        const bool fits = mpz_cmpabs_ui(wanted, INT64_MAX) <= 0;
        CHECK_EQ(decimal_scale(&da, numerator, denominator, &got), fits);
        beyond += fits ? 0 : 1;
        if (fits && !CHECK_EQ(got, mpz_get_si(wanted))) {
            printf("  %s\n", text_a);
        }
    }
    CHECK(beyond > 100);
    mpq_clears(a, b, scaled, (mpq_ptr)0);
    mpz_clear(wanted);
}

static bool fixed_is(const struct decimal *value, int32_t places, int64_t wanted) {
    struct i128 fixed;
    return decimal_fixed(value, places, &fixed) && i128_cmp(fixed, i128_from_i64(wanted)) == 0;
}

static void degrees_in_fixed_point(void) {
    struct decimal value;
    struct i128 fixed;
    int64_t whole;
    CHECK_EQ(read_text("-12.5", &value), DECIMAL_OK);
    CHECK(fixed_is(&value, 3, -12500));
    CHECK(decimal_whole(&value, &whole) && whole == -12);
    CHECK_EQ(read_text("0.00049999", &value), DECIMAL_OK);
    CHECK(fixed_is(&value, 3, 0));
    CHECK_EQ(read_text("1e-200", &value), DECIMAL_OK);
    CHECK(fixed_is(&value, 27, 0));
    CHECK_EQ(read_text("9999999999.9", &value), DECIMAL_OK);
    CHECK(decimal_fixed(&value, 27, &fixed));
    CHECK_EQ(read_text("1e10", &value), DECIMAL_OK);
    CHECK(!decimal_fixed(&value, 27, &fixed));
    // More digits than an integer holds: cut, not wrapped.
    CHECK_EQ(read_text("1.99999999999999999999999999999999999999999999999", &value), DECIMAL_OK);
    CHECK(fixed_is(&value, 3, 1999));
    CHECK_EQ(read_text("-9223372036854775808", &value), DECIMAL_OK);
    CHECK(decimal_whole(&value, &whole) && whole == INT64_MIN);
    CHECK_EQ(read_text("9223372036854775807.5", &value), DECIMAL_OK);
    CHECK(decimal_whole(&value, &whole) && whole == INT64_MAX);
    for (int negative = 0; negative < 2; negative++) { // one too many, and 2^64
        CHECK_EQ(read_text(&"-9223372036854775809"[1 - negative], &value), DECIMAL_OK);
        CHECK(!decimal_whole(&value, &whole));
        CHECK_EQ(read_text(&"-18446744073709551616"[1 - negative], &value), DECIMAL_OK);
        CHECK(!decimal_whole(&value, &whole));
    }
}

// ---------------------------------------------------------------- directions

/// What direction.h says in words, in rational numbers. False: zero.
static bool reference_direction(char texts[6][TEXT_BYTES], mpz_t out[3]) {
    mpq_t point, viewpoint;
    mpz_t common;
    mpq_inits(point, viewpoint, (mpq_ptr)0);
    mpz_init_set_ui(common, 1);
    mpq_t v[3];
    for (int i = 0; i < 3; i++) {
        mpq_init(v[i]);
        rational(point, texts[i]);
        rational(viewpoint, texts[3 + i]);
        mpq_sub(v[i], point, viewpoint);
        mpz_lcm(common, common, mpq_denref(v[i]));
    }
    for (int i = 0; i < 3; i++) {
        mpz_divexact(out[i], common, mpq_denref(v[i]));
        mpz_mul(out[i], out[i], mpq_numref(v[i]));
        mpq_clear(v[i]);
    }
    mpz_gcd(common, out[0], out[1]);
    mpz_gcd(common, common, out[2]);
    const bool any = mpz_sgn(common) != 0;
    for (int i = 0; i < 3 && any; i++) {
        mpz_divexact(out[i], out[i], common);
    }
    mpq_clears(point, viewpoint, (mpq_ptr)0);
    mpz_clear(common);
    return any;
}

static size_t bits_of(mpz_t v[3]) {
    size_t bits = 0;
    for (int i = 0; i < 3; i++) {
        const size_t size = mpz_sgn(v[i]) == 0 ? 0U : mpz_sizeinbase(v[i], 2);
        bits = size > bits ? size : bits;
    }
    return bits;
}

/// v / 2^shift, half away from zero.
static int64_t rounded(mpz_t v, size_t shift) {
    mpz_t size;
    mpz_init(size);
    mpz_abs(size, v);
    if (shift != 0U) {
        mpz_fdiv_q_2exp(size, size, shift - 1U);
        mpz_add_ui(size, size, 1);
        mpz_fdiv_q_2exp(size, size, 1);
    }
    const int64_t result = mpz_get_si(size);
    mpz_clear(size);
    return mpz_sgn(v) < 0 ? -result : result;
}

static bool check_components(mpz_t v[3], size_t shift, int64_t x, int64_t y, int64_t z) {
    return CHECK_EQ(x, rounded(v[0], shift)) && CHECK_EQ(y, rounded(v[1], shift)) &&
           CHECK_EQ(z, rounded(v[2], shift));
}

/// v as the direction of the six texts must be given.
static bool check_direction(mpz_t v[3], const struct direction *got) {
    const size_t bits = bits_of(v);
    size_t shift = bits > 31U ? bits - 31U : 0U;
    for (int i = 0; i < 3; i++) { // a component that rounds up to 2^31
        shift += llabs(rounded(v[i], shift)) > INT32_MAX ? 1U : 0U;
    }
    const struct vec3 c = got->coarse;
    const struct vec3_i64 f = got->fine;
    CHECK_EQ(got->fine_exact, bits <= 62U);
    if (bits <= 31U) { // then any multiple that fits is good
        CHECK(got->fine_exact && c.x == f.x && c.y == f.y && c.z == f.z);
        const int64_t largest = mpz_sgn(v[0]) != 0   ? c.x / mpz_get_si(v[0])
                                : mpz_sgn(v[1]) != 0 ? c.y / mpz_get_si(v[1])
                                                     : c.z / mpz_get_si(v[2]);
        return CHECK(largest > 0) && CHECK_EQ(c.x, largest * mpz_get_si(v[0])) &&
               CHECK_EQ(c.y, largest * mpz_get_si(v[1])) &&
               CHECK_EQ(c.z, largest * mpz_get_si(v[2]));
    }
    return check_components(v, shift, c.x, c.y, c.z) &&
           check_components(v, bits > 62U ? bits - 62U : 0U, f.x, f.y, f.z);
}

static bool read_direction(char texts[6][TEXT_BYTES], struct direction *out) {
    struct decimal values[6];
    for (int i = 0; i < 6; i++) {
        if (!CHECK_EQ(read_text(texts[i], &values[i]), DECIMAL_OK)) {
            printf("  %s\n", texts[i]);
        }
    }
    return direction_from_decimals(values, values + 3, out);
}

/// Six texts of one kind of file.
static void any_texts(int kind, char texts[6][TEXT_BYTES]) {
    static const struct {
        unsigned digits, exponent;
    } kinds[] = {{4, 0}, {9, 3}, {18, 5}, {30, 10}, {40, 40}, {60, 330}, {390, 10}};
    for (int i = 0; i < 6; i++) {
        any_text(texts[i], kinds[kind].digits, kinds[kind].exponent);
        if (i >= 3 && below(2) != 0U) {
            strcpy(texts[i], below(2) != 0U ? texts[i - 3] : "0"); // equal ones cancel
        }
    }
}

static void directions_are_exact_or_rounded_once(void) {
    static char texts[6][TEXT_BYTES];
    mpz_t v[3];
    mpz_inits(v[0], v[1], v[2], (mpz_ptr)0);
    int64_t zero = 0, exact = 0, fine_exact = 0, cases = 0;
    for (int kind = 0; kind < 7; kind++) {
        for (int i = 0; i < (kind < 5 ? 20000 : 300) && check_clean(); i++) {
            any_texts(kind, texts);
            struct direction got;
            const bool any = reference_direction(texts, v);
            CHECK_EQ(read_direction(texts, &got), any);
            zero += any ? 0 : 1;
            cases++;
            if (!any || check_direction(v, &got)) {
                exact += any && got.coarse_exact ? 1 : 0;
                fine_exact += any && got.fine_exact && !got.coarse_exact ? 1 : 0;
                continue;
            }
            for (int j = 0; j < 6; j++) {
                printf("  %s\n", texts[j]);
            }
        }
    }
    check_note("directions", cases);
    check_note("at the viewpoint", zero);
    check_note("that fit int32", exact);
    check_note("that fit 62 bits only", fine_exact);
    CHECK(zero > 100 && exact > 10000 && fine_exact > 1000);
    mpz_clears(v[0], v[1], v[2], (mpz_ptr)0);
}

static struct direction of(const char *x, const char *y, const char *z) {
    static const struct decimal origin[3];
    struct decimal point[3];
    struct direction out = {0};
    CHECK(read_text(x, &point[0]) == DECIMAL_OK && read_text(y, &point[1]) == DECIMAL_OK &&
          read_text(z, &point[2]) == DECIMAL_OK);
    CHECK(direction_from_decimals(point, origin, &out));
    return out;
}

static bool equal(struct direction a, struct direction b) {
    return vec3_equal(a.coarse, b.coarse) && a.fine.x == b.fine.x && a.fine.y == b.fine.y &&
           a.fine.z == b.fine.z;
}

static void long_directions_depend_on_nothing_but_the_direction(void) {
    const struct direction a = of("0.123456789012345678", "-9.87654321098765432", "3.3");
    CHECK(!a.coarse_exact && !a.fine_exact);
    CHECK(equal(a, of("123456.789012345678", "-9876543.21098765432", "3300000")));
    CHECK(equal(a, of("0.370370367037037034", "-29.62962963296296296", "9.9")));
    CHECK(equal(a, of("1.23456789012345678e-200", "-98.7654321098765432e-200", "33e-200")));
    const struct direction minus = of("-0.123456789012345678", "9.87654321098765432", "-3.3");
    CHECK(vec3_equal(minus.coarse, vec3_neg(a.coarse)));
    CHECK(minus.fine.x == -a.fine.x && minus.fine.y == -a.fine.y && minus.fine.z == -a.fine.z);
    // The largest would round up to 2^31: one more bit goes.
    const struct direction edge = of("4294967295", "3", "2");
    CHECK_EQ(edge.coarse.x, INT64_C(1) << 30);
    CHECK_EQ(edge.coarse.y, 1);
    CHECK_EQ(edge.coarse.z, 1); // 0.5, away from zero
}

// ---------------------------------------------------------------- degrees

static struct i128 degrees(int64_t whole, int64_t millionths) {
    const int64_t value = whole * 1000000 + millionths;
    const struct u128 unit = decimal_power10(DIRECTION_DEGREE_PLACES - 6);
    return i128_with_sign(u128_product(u128_of(u64_abs(value)), unit), value < 0);
}

static void the_sky(void) {
    struct direction got, opposite;
    direction_from_degrees(degrees(90, 0), degrees(0, 0), &got);
    CHECK(vec3_equal(got.coarse, vec3(0, 1 << 30, 0)));
    direction_from_degrees(degrees(-540, 0), degrees(0, 0), &got);
    CHECK(vec3_equal(got.coarse, vec3(-(1 << 30), 0, 0)));
    direction_from_degrees(degrees(77, 123456), degrees(90, 0), &got);
    CHECK(vec3_equal(got.coarse, vec3(0, 0, 1 << 30)));
    direction_from_degrees(degrees(0, 0), degrees(30, 0),
                           &got); // sin 30 = 1/2, to half a unit of 2^-31
    CHECK_EQ(got.coarse.z, 1 << 30);
    for (int i = 0; i < 20000 && check_clean(); i++) {
        const bool corner = i % 4 == 0; // multiples of 45 degrees too
        const struct i128 a = corner ? degrees(45 * (int64_t)below(9), 0)
                                     : degrees((int64_t)below(360), (int64_t)below(1000000));
        const struct i128 d = corner ? degrees(45 * (int64_t)below(5) - 90, 0)
                                     : degrees((int64_t)below(180) - 90, (int64_t)below(1000000));
        direction_from_degrees(a, d, &got);
        direction_from_degrees(i128_add(a, degrees(180, 0)), i128_neg(d), &opposite);
        CHECK(vec3_equal(opposite.coarse, vec3_neg(got.coarse)));
        CHECK(opposite.fine.x == -got.fine.x && opposite.fine.y == -got.fine.y &&
              opposite.fine.z == -got.fine.z);
        direction_from_degrees(i128_sub(a, degrees(720, 0)), d, &opposite);
        CHECK(equal(got, opposite));
    }
}

int main(void) {
    printf("# seed 0x%016llx\n", (unsigned long long)seed);
    TEST(what_is_a_decimal_number);
    TEST(the_range_of_decimals);
    TEST(comparison_and_scaling);
    TEST(degrees_in_fixed_point);
    TEST(directions_are_exact_or_rounded_once);
    TEST(long_directions_depend_on_nothing_but_the_direction);
    TEST(the_sky);
    return check_finish();
}
