/// Integer vectors as directions: reduced by their common divisor, one of the two opposite ones.
/// For the files of regular/ only.
#ifndef REGULAR_PRIMITIVE_H
#define REGULAR_PRIMITIVE_H

#include "fixed/vec3.h"

#include <stdint.h>

/// The greatest common divisor; of 0 and a it is a.
static inline uint64_t primitive_gcd(uint64_t a, uint64_t b) {
    while (b != 0U) {
        const uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/// a / gcd. Zero stays zero.
struct vec3_i64 primitive_reduced(struct vec3_i64 a);

/// a / gcd, with the first component that is not 0 above 0. Zero stays zero.
struct vec3 primitive_vec3(struct vec3 a);
struct vec3_i64 primitive_vec3_i64(struct vec3_i64 a);

static inline bool primitive_equal(struct vec3_i64 a, struct vec3_i64 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static inline bool primitive_is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

/// Differences of points of regular/regular.h: 21 bits; their cross products: 43.
static inline struct vec3 primitive_between(struct vec3 from, struct vec3 to) {
    return vec3(to.x - from.x, to.y - from.y, to.z - from.z);
}

/// For hash tables: a number that all bits of a take part in.
uint32_t primitive_hash(struct vec3_i64 a);

/// floor(a / divisor), divisor above 0.
struct u128 primitive_quotient(struct u128 a, uint64_t divisor);

#endif
