/// On which side of the plane through three points does a fourth one lie? Exact for all int32
/// points.
///
/// Most answers come from one 64-bit product with the rounded normal; where its error could matter,
/// the determinant decides, in at most 102 bits.
#ifndef SOLID_SIDE_H
#define SOLID_SIDE_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Of a set of points: what the filter's error depends on.
struct side_range {
    uint8_t bits; ///< no two coordinates of one axis differ by 2^bits or more; 1 to 32
};

/// The range of a set between the corners of its box.
struct side_range side_range_of(struct vec3 low, struct vec3 high);

/// The plane through three points. The side toward which (b - a) x (c - a) points is positive.
struct side_plane {
    struct vec3_i64 normal; ///< rounded toward zero where `exact` is not set
    uint64_t offset;        ///< normal . a, modulo 2^64
    bool exact;             ///< side_value is the determinant itself
};

/// a, b, c: of the set with this range. Collinear points give a zero normal, which is exact.
struct side_plane side_plane_through(struct side_range range, struct vec3 a, struct vec3 b,
                                     struct vec3 c);

/// The determinant divided by a power of two, off by less than side_band; below 3 * 2^60 in size.
/// p: of the set.
static inline int64_t side_value(const struct side_plane *plane, struct vec3 p) {
    // The sums wrap, and so may the parts; the whole fits.
    return (int64_t)((uint64_t)plane->normal.x * (uint64_t)(int64_t)p.x +
                     (uint64_t)plane->normal.y * (uint64_t)(int64_t)p.y +
                     (uint64_t)plane->normal.z * (uint64_t)(int64_t)p.z - plane->offset);
}

/// The error of the value of a plane that is not exact: each component of its normal lacks less
/// than 1.
static inline int64_t side_band(struct side_range range) {
    return (int64_t)3 << range.bits;
}

/// Sign of det(b - a, c - a, p - a), from wide integers. Any int32 points.
int side_exact(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 p);

/// Sign of det(b - a, c - a, p - a) - det(b - a, c - a, q - a): is p farther out than q?
int side_compare(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 p, struct vec3 q);

/// Are three points on one line?
bool side_collinear(struct vec3 a, struct vec3 b, struct vec3 c);

static inline struct vec3_i64 side_between(struct vec3 from, struct vec3 to) {
    return (struct vec3_i64){(int64_t)to.x - from.x, (int64_t)to.y - from.y,
                             (int64_t)to.z - from.z};
}

/// Order by x, then y, then z: -1, 0 or 1. Of several points that are extreme in one direction, the
/// last in this order is a vertex of the hull.
static inline int side_order(struct vec3 a, struct vec3 b) {
    if (a.x != b.x) {
        return a.x < b.x ? -1 : 1;
    }
    if (a.y != b.y) {
        return a.y < b.y ? -1 : 1;
    }
    return a.z == b.z ? 0 : (a.z < b.z ? -1 : 1);
}

#endif
