#include "sphere/site.h"

#include "fixed/root_sum.h"

struct site site_from(struct vec3 vector) {
    struct site site = {.vector = vector, .unit_q61 = vec3_normalise_q61(vector)};
    site.unit_q30 = vec3((int32_t)(site.unit_q61.x >> 31), (int32_t)(site.unit_q61.y >> 31),
                         (int32_t)(site.unit_q61.z >> 31));
    return site;
}

// ---------------------------------------------------------------- filters

/// Differences of units: each component is off by less than 1.5 units, from two roundings.
static struct vec3_i64 from_to_q30(const struct site *from, const struct site *to) {
    return (struct vec3_i64){(int64_t)to->unit_q30.x - from->unit_q30.x,
                             (int64_t)to->unit_q30.y - from->unit_q30.y,
                             (int64_t)to->unit_q30.z - from->unit_q30.z};
}

static struct vec3_i64 from_to_q61(const struct site *from, const struct site *to) {
    return vec3_i64_sub(to->unit_q61, from->unit_q61);
}

static uint64_t max_u64(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/// At least 2: the bounds below count on it.
static uint64_t size_of(struct vec3_i64 a) {
    return max_u64(max_u64(u64_abs(a.x), 2U), max_u64(u64_abs(a.y), u64_abs(a.z)));
}

/// A sign that holds also if the value is off by less than error.
static int sure_sign_i128(struct i128 value, struct i128 error) {
    return i128_cmp(value, error) >= 0 ? 1 : (i128_cmp(value, i128_neg(error)) <= 0 ? -1 : 0);
}

/// Error of a dot product of two vectors whose components are off by 1.5: at most
/// 3 (1.5 m + 1.5 m + 2.25) < 13 m, m the larger size, at least 2.
static struct i128 dot_error(struct vec3_i64 a, struct vec3_i64 b) {
    return i128_mul((int64_t)max_u64(size_of(a), size_of(b)), 13);
}

static int dot_sure_sign(struct vec3_i64 a, struct vec3_i64 b) {
    return sure_sign_i128(vec3_i64_dot(a, b), dot_error(a, b));
}

/// det(a, b, c) of differences of Q1.30 units: below 2^93. Error of each of its six products: at
/// most 1.5 * 3 m^2 + 2.25 * 3 m + 3.4 < 9 m^2; in all 54 m^2 < 2^6 m^2.
static int det_sure_sign_q30(struct vec3_i64 a, struct vec3_i64 b, struct vec3_i64 c) {
    const struct vec3_i64 n = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    const int64_t m = (int64_t)max_u64(size_of(a), max_u64(size_of(b), size_of(c)));
    return sure_sign_i128(vec3_i64_dot(n, c), i128_mul(m << 6, m));
}

/// The same of Q2.61 units: below 2^186.
static int det_sure_sign_q61(struct vec3_i64 a, struct vec3_i64 b, struct vec3_i64 c) {
    const int64_t m = (int64_t)max_u64(size_of(a), max_u64(size_of(b), size_of(c)));
    const struct i256 value = vec3_i128_dot(vec3_i64_cross(a, b), c);
    const struct i256 error = i256_mul(i128_mul(m, m), i128_from_i64(64));
    if (i256_sign(i256_sub(value, error)) >= 0) {
        return 1;
    }
    return i256_sign(i256_add(value, error)) <= 0 ? -1 : 0;
}

// ---------------------------------------------------------------- roots

static struct u128 size_i128(struct i128 a) {
    const struct i128 size = i128_sign(a) < 0 ? i128_neg(a) : a;
    return (struct u128){size.lo, (uint64_t)size.hi};
}

/// sign * value * sqrt(radicand)
static void set_term(struct root_term *term, int sign, struct i128 value, struct u128 radicand) {
    root_term_set(term, sign * i128_sign(value), size_i128(value), radicand);
}

static struct u128 norm2(const struct site *a) {
    return (struct u128){vec3_norm2(a->vector), 0};
}

/// sign * det(a, b, c) * |d|: squares below 2^190 * 2^64, since no determinant of int32 vectors
/// exceeds 2^95.
static void set_det_term(struct root_term *term, int sign, const struct site *a,
                         const struct site *b, const struct site *c, const struct site *d) {
    set_term(term, sign, vec3_i64_dot_vec3(vec3_cross(a->vector, b->vector), c->vector), norm2(d));
}

/// det(b - a, c - a, d - a) of unit vectors, times all four lengths.
static int plane_sign_exactly(const struct site *a, const struct site *b, const struct site *c,
                              const struct site *d) {
    struct root_term of_a, of_b, of_c, of_d;
    set_det_term(&of_a, 1, b, c, d, a);
    set_det_term(&of_b, -1, a, c, d, b);
    set_det_term(&of_c, 1, a, b, d, c);
    set_det_term(&of_d, -1, a, b, c, d);
    return root_sum_4(&of_a, &of_b, &of_c, &of_d);
}

/// sign * (a . b) * |c|: squares below 2^128 * 2^64.
static void set_dot_term(struct root_term *term, int sign, const struct site *a,
                         const struct site *b, const struct site *c) {
    set_term(term, sign, vec3_dot(a->vector, b->vector), norm2(c));
}

/// 1 + a . b - x . a - x . b of unit vectors, times all three lengths.
static int cap_sign_exactly(const struct site *a, const struct site *b, const struct site *x) {
    struct root_term one, ab, xa, xb;
    struct huge square;
    huge_from_u128(&one.square, u128_mul(vec3_norm2(a->vector), vec3_norm2(b->vector)));
    huge_from_u128(&ab.square, norm2(x));
    huge_mul(&square, &one.square, &ab.square);
    one.square = square;
    one.sign = 1;
    set_dot_term(&ab, 1, a, b, x);
    set_dot_term(&xa, -1, x, a, b);
    set_dot_term(&xb, -1, x, b, a);
    return root_sum_4(&one, &ab, &xa, &xb);
}

// ---------------------------------------------------------------- tests

int site_plane_sign(const struct site *a, const struct site *b, const struct site *c,
                    const struct site *d) {
    const int sign = det_sure_sign_q30(from_to_q30(a, b), from_to_q30(a, c), from_to_q30(a, d));
    if (sign != 0) {
        return sign;
    }
    const int finer = det_sure_sign_q61(from_to_q61(a, b), from_to_q61(a, c), from_to_q61(a, d));
    return finer != 0 ? finer : plane_sign_exactly(a, b, c, d);
}

int site_cap_sign(const struct site *a, const struct site *b, const struct site *x) {
    const int sign = dot_sure_sign(from_to_q30(a, x), from_to_q30(b, x));
    if (sign != 0) {
        return sign;
    }
    const int finer = dot_sure_sign(from_to_q61(a, x), from_to_q61(b, x));
    return finer != 0 ? finer : cap_sign_exactly(a, b, x);
}

int site_distance_cmp(const struct site *a, const struct site *b, const struct site *c,
                      const struct site *d) {
    const struct vec3_i64 ab = from_to_q61(a, b), cd = from_to_q61(c, d);
    const int sign = sure_sign_i128(i128_sub(vec3_i64_dot(ab, ab), vec3_i64_dot(cd, cd)),
                                    i128_add(dot_error(ab, ab), dot_error(cd, cd)));
    if (sign != 0) {
        return sign;
    }
    // The larger cosine is the shorter distance: (c . d) |a| |b| - (a . b) |c| |d|, squares below
    // 2^256.
    struct root_term of_cd, of_ab;
    set_term(&of_cd, 1, vec3_dot(c->vector, d->vector),
             u128_mul(vec3_norm2(a->vector), vec3_norm2(b->vector)));
    set_term(&of_ab, -1, vec3_dot(a->vector, b->vector),
             u128_mul(vec3_norm2(c->vector), vec3_norm2(d->vector)));
    return root_sum_2(&of_cd, &of_ab);
}
