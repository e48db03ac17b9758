#include "fixed/vec3.h"

#include "fixed/root.h"

struct i128 vec3_dot(struct vec3 a, struct vec3 b) {
    const struct i128 xy =
        i128_add(i128_from_i64((int64_t)a.x * b.x), i128_from_i64((int64_t)a.y * b.y));
    return i128_add(xy, i128_from_i64((int64_t)a.z * b.z));
}

struct i128 vec3_i64_dot_vec3(struct vec3_i64 a, struct vec3 b) {
    // a = high * 2^32 + low; both partial sums of three products fit 66 bits, so they are kept as
    // two words.
    const int64_t x1 = a.x >> 32, y1 = a.y >> 32, z1 = a.z >> 32;
    const int64_t x0 = (uint32_t)a.x, y0 = (uint32_t)a.y, z0 = (uint32_t)a.z;
    const struct i128 low = i128_add(i128_add(i128_from_i64(x0 * b.x), i128_from_i64(y0 * b.y)),
                                     i128_from_i64(z0 * b.z));
    const struct i128 high = i128_add(i128_add(i128_from_i64(x1 * b.x), i128_from_i64(y1 * b.y)),
                                      i128_from_i64(z1 * b.z));
    const struct i128 shifted = {high.lo << 32,
                                 (int64_t)(((uint64_t)high.hi << 32) | (high.lo >> 32))};
    return i128_add(low, shifted);
}

struct i128 vec3_i64_dot(struct vec3_i64 a, struct vec3_i64 b) {
    return i128_add(i128_add(i128_mul(a.x, b.x), i128_mul(a.y, b.y)), i128_mul(a.z, b.z));
}

struct vec3_i128 vec3_i64_cross(struct vec3_i64 a, struct vec3_i64 b) {
    return (struct vec3_i128){i128_sub(i128_mul(a.y, b.z), i128_mul(a.z, b.y)),
                              i128_sub(i128_mul(a.z, b.x), i128_mul(a.x, b.z)),
                              i128_sub(i128_mul(a.x, b.y), i128_mul(a.y, b.x))};
}

struct i256 vec3_i128_dot(struct vec3_i128 a, struct vec3_i64 b) {
    return i256_add(i256_add(i256_mul(a.x, i128_from_i64(b.x)), i256_mul(a.y, i128_from_i64(b.y))),
                    i256_mul(a.z, i128_from_i64(b.z)));
}

static struct u128 u128_shift_left(struct u128 a, unsigned shift) {
    if (shift == 0U) {
        return a;
    }
    return shift < 64U ? (struct u128){a.lo << shift, (a.hi << shift) | (a.lo >> (64U - shift))}
                       : (struct u128){0, a.lo << (shift - 64U)};
}

/// Is size / sqrt(norm2) * 2^61 < candidate - 1/2, decided exactly: size^2 * 2^124 < (2 candidate -
/// 1)^2 * norm2. candidate: at most 2^61 + 2; size^2 <= norm2 < 2^64.
static bool rounds_below(uint64_t size, uint64_t norm2, uint64_t candidate) {
    const uint64_t odd = 2U * candidate - 1U; // below 2^63
    const struct u128 odd2 = u128_mul(odd, odd), low = u128_mul(odd2.lo, norm2),
                      high = u128_add(u128_mul(odd2.hi, norm2), (struct u128){low.hi, 0});
    // right = high : low.lo in 192 bits; left = size^2 shifted by 124, its lowest 64 bits empty.
    const uint64_t size2 = size * size;
    const int order = u128_cmp((struct u128){size2 << 60, size2 >> 4}, high);
    return order != 0 ? order < 0 : low.lo != 0U;
}

/// round(size / sqrt(norm2) * 2^61), correctly rounded, from a length that is good to 2^-62.
static int64_t normalise_component(int32_t component, uint64_t norm2, uint64_t length,
                                   unsigned shift) {
    const uint64_t size = u64_abs(component);
    uint64_t rest;
    // length = sqrt(norm2 << 2 shift) * 2^32 has its leading bit at 63; size << shift < 2^32.
    const struct u128 dividend = u128_shift_left((struct u128){size << shift, 0}, 93U);
    uint64_t quotient = u128_div_u64(dividend, length, &rest);
    while (!rounds_below(size, norm2, quotient + 1U)) {
        quotient++;
    }
    while (quotient != 0U && rounds_below(size, norm2, quotient)) {
        quotient--;
    }
    return component < 0 ? -(int64_t)quotient : (int64_t)quotient;
}

static struct vec3_i64 normalise_any_q61(struct vec3 a) {
    const uint64_t norm2 = vec3_norm2(a);
    if (norm2 == 0U) {
        return (struct vec3_i64){0, 0, 0};
    }
    const unsigned shift = u64_leading_zeros(norm2) / 2U;
    const uint64_t length = root_u128((struct u128){0, norm2 << (2U * shift)});
    return (struct vec3_i64){normalise_component(a.x, norm2, length, shift),
                             normalise_component(a.y, norm2, length, shift),
                             normalise_component(a.z, norm2, length, shift)};
}

/// One component of a vector whose squared length is 2^60 + excess, |excess| <= 2^32, times 2^31 /
/// |a|, by the series 1 - e/2 + 3/8 e^2 of the inverse root. False: too close to a tie to tell.
static bool scale_near_unit(int64_t component, int64_t excess, int64_t *scaled) {
    // In units of 2^-30 of the result; the terms left out and the cuts are below 2^6 of them.
    const int64_t square = (int64_t)(u64_abs(excess) * u64_abs(excess) >> 34);
    const int64_t correction = 3 * component * square / ((int64_t)1 << 28) - component * excess;
    const int64_t fraction = correction & (((int64_t)1 << 30) - 1), half = (int64_t)1 << 29;
    *scaled = component * ((int64_t)1 << 31) + (correction >> 30) + (fraction > half);
    return fraction < half - 64 || fraction > half + 64;
}

struct vec3_i64 vec3_normalise_q61(struct vec3 a) {
    const uint64_t one = UINT64_C(1) << 60, norm2 = vec3_norm2(a), near = UINT64_C(1) << 32;
    if (norm2 - (one - near) <= 2U * near) {
        const int64_t excess = (int64_t)(norm2 - one);
        struct vec3_i64 unit;
        if (scale_near_unit(a.x, excess, &unit.x) && scale_near_unit(a.y, excess, &unit.y) &&
            scale_near_unit(a.z, excess, &unit.z)) {
            return unit;
        }
    }
    return normalise_any_q61(a);
}

/// Sizes of components.
struct size3 {
    uint64_t x, y, z;
};

/// A squared length: squares 2^62 + products 2^32 + rest. From sizes of at most 2^62, each taken as
/// high 2^31 + low, the sums of the three kinds of products fit 64 bits.
struct norm2 {
    uint64_t squares, products, rest;
};

static inline struct norm2 norm2_of(struct size3 a) {
    const uint32_t xh = (uint32_t)(a.x >> 31), xl = a.x & INT32_MAX;
    const uint32_t yh = (uint32_t)(a.y >> 31), yl = a.y & INT32_MAX;
    const uint32_t zh = (uint32_t)(a.z >> 31), zl = a.z & INT32_MAX;
    return (struct norm2){.squares = (uint64_t)xh * xh + (uint64_t)yh * yh + (uint64_t)zh * zh,
                          .products = (uint64_t)xh * xl + (uint64_t)yh * yl + (uint64_t)zh * zl,
                          .rest = (uint64_t)xl * xl + (uint64_t)yl * yl + (uint64_t)zl * zl};
}

uint64_t vec3_i64_length(struct vec3_i64 a) {
    const struct norm2 n = norm2_of((struct size3){u64_abs(a.x), u64_abs(a.y), u64_abs(a.z)});
    return root_u128(u128_add(
        (struct u128){n.squares << 62, n.squares >> 2},
        u128_add((struct u128){n.products << 32, n.products >> 32}, (struct u128){n.rest, 0})));
}

static struct i128 square_i64(int64_t a) {
    return i128_mul(a, a);
}

/// Is |component| / |a| * 2^30 below candidate - 1/2? Exact, from the squares of both sides times
/// 2 |a|, which are below 2^191. candidate: at most 2^30 + 1.
static bool rounds_below_i64(int64_t component, struct vec3_i64 a, uint64_t candidate) {
    const uint64_t odd = 2U * candidate - 1U; // below 2^32
    const struct i128 odd2 = {odd * odd, 0};
    const struct i256 right =
        i256_add(i256_add(i256_mul(square_i64(a.x), odd2), i256_mul(square_i64(a.y), odd2)),
                 i256_mul(square_i64(a.z), odd2));
    const struct i256 left = i256_mul(square_i64(component), (struct i128){UINT64_C(1) << 62, 0});
    return i256_sign(i256_sub(left, right)) < 0;
}

/// 1 / sqrt(m) in Q62 for m = n / 2^64, n at least 2^62: relative 2^-55.
/// Newton's iteration doubles the digits: three steps in 32 bits, one in 64.
static uint64_t inverse_root_q62(uint64_t n) {
    const uint32_t m = (uint32_t)(n >> 32);
    // A parabola through the range, 2.4 % off at most: 2.67 - 3.29 m + 1.64 m^2, in Q29.
    const uint32_t slope =
        UINT32_C(1763812404) - (uint32_t)((uint64_t)m * UINT32_C(879699425) >> 32);
    uint32_t y = UINT32_C(1433893831) - (uint32_t)((uint64_t)m * slope >> 32);
    for (unsigned i = 0; i < 3U; i++) { // 2.4e-2, 8.7e-4, 1.2e-6, 2^-28
        const uint32_t y2 = (uint32_t)((uint64_t)y * y >> 29);
        const uint32_t less = (UINT32_C(3) << 29) - (uint32_t)((uint64_t)m * y2 >> 32);
        y = (uint32_t)((uint64_t)y * less >> 30);
    }
    // y (1 + r / 2) with r = 1 - m y^2, |r| < 2^-26.
    const int64_t r_q58 = (int64_t)((UINT64_C(1) << 58) - u64_mul_high_near(n, (uint64_t)y * y));
    return ((uint64_t)y << 33) + (uint64_t)((int64_t)y * r_q58 >> 26);
}

/// Sizes in Q54 have 24 bits more than Q30.
#define FINE_BITS 24U
#define FINE_HALF (UINT64_C(1) << (FINE_BITS - 1U))
/// Those of a normalised vector are good to 4 units.
#define FINE_BAND UINT64_C(8)

/// Of a / |a| in Q54. zeros: leading ones of the largest, below 64.
static struct size3 normalise_finely(struct size3 a, unsigned zeros) {
    // The largest one gets its leading bit at position 61. At most two bits too many are cut: 2^-62
    // of the length.
    const struct size3 scaled =
        zeros >= 2U ? (struct size3){a.x << (zeros - 2U), a.y << (zeros - 2U), a.z << (zeros - 2U)}
                    : (struct size3){a.x >> (2U - zeros), a.y >> (2U - zeros), a.z >> (2U - zeros)};
    // |scaled|^2, without the rest, is n 2^even, so size / |scaled| = size / sqrt(n / 2^64) / 2^(32
    // + even / 2).
    const struct norm2 norm2 = norm2_of(scaled);                 // 2^122 to 3 * 2^124
    const uint64_t top = norm2.squares + (norm2.products >> 30); // even is 62
    const bool large = top >> 62 != 0U;
    const uint64_t n = large ? top : (norm2.squares << 2) + (norm2.products >> 28); // or 60
    const uint64_t inverse_q62 = inverse_root_q62(n);
    // size (62 bits) * Q62 / 2^64 / 2^(even / 2 - 24) = Q54
    const unsigned shift = large ? 7U : 6U;
    return (struct size3){u64_mul_high_near(scaled.x, inverse_q62) >> shift,
                          u64_mul_high_near(scaled.y, inverse_q62) >> shift,
                          u64_mul_high_near(scaled.z, inverse_q62) >> shift};
}

/// Is the fine size so near to the middle between two Q30 sizes that its error could round it the
/// other way?
static inline bool is_near_tie(uint64_t fine, uint64_t band) {
    return (fine & (2U * FINE_HALF - 1U)) - (FINE_HALF - band) <= 2U * band;
}

static inline int32_t rounded(int64_t sign, uint64_t fine) {
    const int32_t size = (int32_t)((fine + FINE_HALF) >> FINE_BITS);
    return sign < 0 ? -size : size;
}

bool vec3_i64_normalise_within(struct vec3_i64 a, uint32_t error, struct vec3 *unit_q30) {
    const struct size3 size = {u64_abs(a.x), u64_abs(a.y), u64_abs(a.z)};
    const unsigned zeros = u64_leading_zeros(size.x | size.y | size.z);
    // |a| is at least 2^(63 - zeros), so errors of each component turn and stretch it by less than
    // 2 error / 2^(63 - zeros) of a unit, and that is 2^54 fine ones.
    const uint64_t band = FINE_BAND + (((uint64_t)error << (zeros & 31U)) >> 8);
    if (zeros == 64U || (error != 0U && zeros > 31U) || band >= FINE_HALF) {
        *unit_q30 = vec3(0, 0, 0);
        return false;
    }
    const struct size3 fine = normalise_finely(size, zeros);
    *unit_q30 = vec3(rounded(a.x, fine.x), rounded(a.y, fine.y), rounded(a.z, fine.z));
    return !is_near_tie(fine.x, band) && !is_near_tie(fine.y, band) && !is_near_tie(fine.z, band);
}

/// component / |a| * 2^30, correctly rounded, from a guess that is at most 1 off.
static int32_t round_exactly(int64_t component, struct vec3_i64 a, int32_t guess) {
    uint64_t size = u64_abs(guess) + 1U;
    while (size != 0U && rounds_below_i64(component, a, size)) {
        size--;
    }
    return component < 0 ? -(int32_t)size : (int32_t)size;
}

struct vec3 vec3_i64_normalise(struct vec3_i64 a) {
    struct vec3 unit;
    if (!vec3_i64_normalise_within(a, 0, &unit) && (a.x | a.y | a.z) != 0) {
        unit.x = round_exactly(a.x, a, unit.x);
        unit.y = round_exactly(a.y, a, unit.y);
        unit.z = round_exactly(a.z, a, unit.z);
    }
    return unit;
}

struct vec3 vec3_normalise(struct vec3 a) {
    return vec3_i64_normalise(vec3_widen(a));
}
