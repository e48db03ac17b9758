#include "direction.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/// Half a unit in each of three components of a vector that is at least 2^61 long is 2^-61.2.
const long double direction_decimals_error_rad = 0x1p-61L;
/// Two factors with three roundings each, the reduction's three, and the rounding to 62 bits.
const long double direction_degrees_error_rad = 16 * LDBL_EPSILON + 0x1p-60L;

/// Three magnitudes with signs, in 128 bits.
struct wide_vector {
    struct u128 size[3];
    bool negative[3];
};

static uint64_t gcd_u64(uint64_t a, uint64_t b) {
    while (b != 0U) {
        const uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static struct u128 gcd(struct u128 a, struct u128 b) {
    while (!u128_is_zero(b) && (a.hi | b.hi) != 0U) {
        struct u128 rest;
        u128_divide(a, b, &rest);
        a = b;
        b = rest;
    }
    return u128_is_zero(b) ? a : u128_of(gcd_u64(a.lo, b.lo));
}

static int64_t with_sign(uint64_t size, bool negative) {
    return negative ? -(int64_t)size : (int64_t)size;
}

/// Scales a length of `bits` bits to `target` bits: the shift that does.
static unsigned shift_to(unsigned bits, unsigned target) {
    return bits > target ? bits - target : 0U;
}

static uint64_t round_shift_u128(struct u128 value, unsigned shift) {
    if (shift == 0U) {
        return value.lo;
    }
    return u128_shift_right(value, shift).lo + (u128_shift_right(value, shift - 1U).lo & 1U);
}

static struct vec3_i64 rounded(const struct wide_vector *v, unsigned shift) {
    return (struct vec3_i64){with_sign(round_shift_u128(v->size[0], shift), v->negative[0]),
                             with_sign(round_shift_u128(v->size[1], shift), v->negative[1]),
                             with_sign(round_shift_u128(v->size[2], shift), v->negative[2])};
}

static bool fits_int32(struct vec3_i64 a) {
    return u64_abs(a.x) <= INT32_MAX && u64_abs(a.y) <= INT32_MAX && u64_abs(a.z) <= INT32_MAX;
}

static struct vec3 narrow(struct vec3_i64 a) {
    return vec3((int32_t)a.x, (int32_t)a.y, (int32_t)a.z);
}

static unsigned longest(const struct wide_vector *v) {
    return u128_bit_length(u128_or(u128_or(v->size[0], v->size[1]), v->size[2]));
}

/// False: zero.
static bool from_wide(struct wide_vector *v, struct direction *out) {
    unsigned bits = longest(v);
    if (bits == 0U) {
        return false;
    }
    if (bits > 31U) {
        const struct u128 divisor = gcd(gcd(v->size[0], v->size[1]), v->size[2]);
        if (u128_cmp(divisor, u128_of(1)) != 0) {
            for (int i = 0; i < 3; i++) {
                v->size[i] = u128_divide(v->size[i], divisor, NULL);
            }
        }
        bits = longest(v);
    }
    const unsigned coarse_shift = shift_to(bits, 31U), fine_shift = shift_to(bits, 62U);
    struct vec3_i64 coarse = rounded(v, coarse_shift);
    if (!fits_int32(coarse)) { // rounded up to 2^31
        coarse = rounded(v, coarse_shift + 1U);
    }
    out->coarse = narrow(coarse);
    out->fine = rounded(v, fine_shift);
    out->coarse_exact = coarse_shift == 0U;
    out->fine_exact = fine_shift == 0U;
    return true;
}

/// point - viewpoint in units of 10^-shift. False: the sum could exceed 128 bits.
static bool subtract_wide(const struct decimal point[3], const struct decimal viewpoint[3],
                          int32_t shift, struct wide_vector *out) {
    for (int i = 0; i < 3; i++) {
        struct i128 difference = {0, 0};
        const struct decimal *const terms[2] = {&point[i], &viewpoint[i]};
        for (int j = 0; j < 2; j++) {
            const struct decimal *const a = terms[j];
            if (a->digit_count == 0U) {
                continue;
            }
            const int32_t zeros = a->exponent + shift;
            if (zeros + (int32_t)a->digit_count > DECIMAL_HEAD_DIGITS) {
                return false;
            }
            const struct u128 size =
                zeros == 0 ? a->head : u128_product(a->head, decimal_power10((uint32_t)zeros));
            difference = i128_add(difference, i128_with_sign(size, a->negative != (j == 1)));
        }
        out->negative[i] = difference.hi < 0;
        out->size[i] = u128_abs(difference);
    }
    return true;
}

struct big_vector {
    struct big size[3];
    bool negative[3];
};

static void subtract_big(const struct decimal point[3], const struct decimal viewpoint[3],
                         int32_t shift, struct big_vector *out) {
    for (int i = 0; i < 3; i++) {
        struct big other;
        decimal_magnitude(&point[i], shift, &out->size[i]);
        decimal_magnitude(&viewpoint[i], shift, &other);
        out->negative[i] = point[i].negative;
        if (point[i].negative != viewpoint[i].negative) {
            out->negative[i] =
                out->size[i].count != 0U ? point[i].negative : !viewpoint[i].negative;
            big_add(&out->size[i], &other);
        } else if (big_compare(&out->size[i], &other) >= 0) {
            big_subtract(&out->size[i], &other);
        } else {
            big_subtract(&other, &out->size[i]);
            out->size[i] = other;
            out->negative[i] = !point[i].negative;
        }
    }
}

/// Divides out the common divisor. False: zero.
static bool reduce_big(struct big_vector *v) {
    struct big divisor = v->size[0], other = v->size[1];
    big_gcd(&divisor, &other);
    other = v->size[2];
    big_gcd(&divisor, &other);
    if (divisor.count == 0U) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        big_divide_exact(&v->size[i], &divisor);
    }
    return true;
}

static struct vec3_i64 rounded_big(const struct big_vector *v, uint32_t shift) {
    return (struct vec3_i64){with_sign(big_round_shift(&v->size[0], shift), v->negative[0]),
                             with_sign(big_round_shift(&v->size[1], shift), v->negative[1]),
                             with_sign(big_round_shift(&v->size[2], shift), v->negative[2])};
}

static bool from_big(struct big_vector *v, struct direction *out) {
    if (!reduce_big(v)) {
        return false;
    }
    unsigned bits = 0;
    for (int i = 0; i < 3; i++) {
        const unsigned length = big_bit_length(&v->size[i]);
        bits = length > bits ? length : bits;
    }
    const unsigned coarse_shift = shift_to(bits, 31U), fine_shift = shift_to(bits, 62U);
    struct vec3_i64 coarse = rounded_big(v, coarse_shift);
    if (!fits_int32(coarse)) {
        coarse = rounded_big(v, coarse_shift + 1U);
    }
    out->coarse = narrow(coarse);
    out->fine = rounded_big(v, fine_shift);
    out->coarse_exact = coarse_shift == 0U;
    out->fine_exact = fine_shift == 0U;
    return true;
}

bool direction_from_decimals(const struct decimal point[3], const struct decimal viewpoint[3],
                             struct direction *out) {
    int32_t lowest = INT32_MAX;
    for (int i = 0; i < 3; i++) {
        if (point[i].digit_count != 0U && point[i].exponent < lowest) {
            lowest = point[i].exponent;
        }
        if (viewpoint[i].digit_count != 0U && viewpoint[i].exponent < lowest) {
            lowest = viewpoint[i].exponent;
        }
    }
    if (lowest == INT32_MAX) {
        return false; // all zero
    }
    struct wide_vector wide;
    if (subtract_wide(point, viewpoint, -lowest, &wide)) {
        return from_wide(&wide, out);
    }
    struct big_vector big;
    subtract_big(point, viewpoint, -lowest, &big);
    return from_big(&big, out);
}

/// Sine and cosine of an angle in units of 10^-27 degrees.
static void sincos_degrees(struct i128 angle, long double *sine, long double *cosine) {
    const struct u128 eighth = u128_product(u128_of(45), decimal_power10(DIRECTION_DEGREE_PLACES));
    const struct u128 quarter = u128_shift_left(eighth, 1), turn = u128_shift_left(eighth, 3);
    struct u128 rest;
    u128_divide(u128_abs(angle), turn, &rest);
    rest = angle.hi < 0 && !u128_is_zero(rest) ? u128_sub(turn, rest) : rest;
    const int quadrant = (int)u128_divide(rest, quarter, &rest).lo;
    const bool upper = u128_cmp(rest, eighth) > 0, middle = u128_cmp(rest, eighth) == 0;
    const struct u128 folded = upper ? u128_sub(quarter, rest) : rest;
    const long double rad_per_degree = 0.017453292519943295769236907684886127L;
    const long double x = u128_value(folded) / 1e27L * rad_per_degree;
    // At 45 degrees both are the same number, whichever of them the quadrant asks for.
    const long double small = middle ? sqrtl(0.5L) : sinl(x), large = middle ? small : cosl(x);
    const long double s = upper ? large : small, c = upper ? small : large;
    *sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
    *cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

static struct vec3_i64 scaled(const long double v[3], long double factor) {
    return (struct vec3_i64){(int64_t)roundl(v[0] * factor), (int64_t)roundl(v[1] * factor),
                             (int64_t)roundl(v[2] * factor)};
}

void direction_from_degrees(struct i128 right_ascension, struct i128 declination,
                            struct direction *out) {
    long double sin_a, cos_a, sin_d, cos_d;
    sincos_degrees(right_ascension, &sin_a, &cos_a);
    sincos_degrees(declination, &sin_d, &cos_d);
    const long double v[3] = {cos_d * cos_a, cos_d * sin_a, sin_d};
    struct vec3_i64 coarse = scaled(v, 0x1p31L);
    if (!fits_int32(coarse)) {
        coarse = scaled(v, 0x1p30L);
    }
    out->coarse = narrow(coarse);
    out->fine = scaled(v, 0x1p61L);
    out->coarse_exact = false;
    out->fine_exact = false;
}
