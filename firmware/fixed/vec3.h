/// Vectors of three integers: products, exact orientation tests, normalisation.
///
/// A direction is any int32 vector but zero, of any length; a unit vector is one in Q1.30 (`_q30`).
/// World axes: x east, y north, z up. det(a, b, c) = a . (b x c).
#ifndef FIXED_VEC3_H
#define FIXED_VEC3_H

#include "fixed/must_check.h"
#include "fixed/q30.h"
#include "fixed/wide.h"

#include <stdbool.h>
#include <stdint.h>

struct vec3 {
    int32_t x, y, z;
};

struct vec3_i64 {
    int64_t x, y, z;
};

struct vec3_i128 {
    struct i128 x, y, z;
};

static inline struct vec3 vec3(int32_t x, int32_t y, int32_t z) {
    return (struct vec3){x, y, z};
}

static inline struct vec3_i64 vec3_widen(struct vec3 a) {
    return (struct vec3_i64){a.x, a.y, a.z};
}

static inline bool vec3_is_zero(struct vec3 a) {
    return (a.x | a.y | a.z) == 0;
}

static inline bool vec3_equal(struct vec3 a, struct vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Components must not be INT32_MIN.
static inline struct vec3 vec3_neg(struct vec3 a) {
    return vec3(-a.x, -a.y, -a.z);
}

/// Dot product in 64 bits: for unit vectors, and any whose components are at most 2^30 in size.
static inline int64_t vec3_dot_unit(struct vec3 a, struct vec3 b) {
    return (int64_t)a.x * b.x + (int64_t)a.y * b.y + (int64_t)a.z * b.z;
}

/// Dot product of any two int32 vectors.
struct i128 vec3_dot(struct vec3 a, struct vec3 b);

/// Cross product of any two int32 vectors. Fits: the largest component is 2^63 - 2^31, because 2^31
/// is no int32 and so the two products can't both be 2^62 with opposite signs.
static inline struct vec3_i64 vec3_cross(struct vec3 a, struct vec3 b) {
    return (struct vec3_i64){(int64_t)a.y * b.z - (int64_t)a.z * b.y,
                             (int64_t)a.z * b.x - (int64_t)a.x * b.z,
                             (int64_t)a.x * b.y - (int64_t)a.y * b.x};
}

/// Squared length of any int32 vector: at most 3 * 2^62.
static inline uint64_t vec3_norm2(struct vec3 a) {
    const uint64_t x = u64_abs(a.x), y = u64_abs(a.y), z = u64_abs(a.z);
    return x * x + y * y + z * z;
}

/// Dot product of a wide vector with an int32 vector. Any values: 63 + 31 + 2 bits.
struct i128 vec3_i64_dot_vec3(struct vec3_i64 a, struct vec3 b);

/// Sign of det(a, b, c) for any int32 vectors: seen from outside the sphere, 1 if c is strictly
/// left of the great circle from a to b, 0 if on it, -1 if strictly right. Shown:
/// tests/unit/test_fixed.c "determinant".
static inline int vec3_det_sign(struct vec3 a, struct vec3 b, struct vec3 c) {
    return i128_sign(vec3_i64_dot_vec3(vec3_cross(a, b), c));
}

static inline struct vec3_i64 vec3_i64_sub(struct vec3_i64 a, struct vec3_i64 b) {
    return (struct vec3_i64){a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Dot product of vectors with components of at most 2^62 in size: 126 bits.
struct i128 vec3_i64_dot(struct vec3_i64 a, struct vec3_i64 b);

/// Cross product of vectors with components of at most 2^62 in size: 126 bits.
struct vec3_i128 vec3_i64_cross(struct vec3_i64 a, struct vec3_i64 b);

/// Dot product of a 128-bit and a 64-bit vector. Any values: 127 + 63 + 2 bits.
struct i256 vec3_i128_dot(struct vec3_i128 a, struct vec3_i64 b);

/// a / |a| in Q1.30. a: any int32 vector but zero (which stays zero).
/// Accuracy: correctly rounded, ties away from zero: a multiple of a gives the same bits, and so
/// does -a
///           but for the sign (tests/property/fixed_vectors.c).
struct vec3 vec3_normalise(struct vec3 a);

/// a / |a| in Q2.61: components of at most 2^61 in size. Correctly rounded like vec3_normalise.
/// Why so fine: a cone of 1e-6 rad has to be found to 5e-9 rad, and in Q1.30 the rounding of the
/// lengths tilts the plane through three such points by 1e-3 rad (docs/geometry.md, "Narrow
/// cones").
struct vec3_i64 vec3_normalise_q61(struct vec3 a);

/// a / |a| in Q1.30 for any int64 vector but zero (which stays zero).
/// Accuracy: correctly rounded like vec3_normalise: the bits depend on the direction only
///           (tests/property/fixed_vectors.c).
struct vec3 vec3_i64_normalise(struct vec3_i64 a);

/// The same for a vector that is only known to `error` units a component. False: the bits depend on
/// what is not known (always, if the largest component is below 2^32), and unit_q30 is not set or a
/// guess.
/// Shown: tests/property/fixed_vectors.c.
bool vec3_i64_normalise_within(struct vec3_i64 a, uint32_t error, struct vec3 *unit_q30) MUST_CHECK;

/// floor(|a|) of any int64 vector with components of at most 2^62 in size.
uint64_t vec3_i64_length(struct vec3_i64 a);

#endif
