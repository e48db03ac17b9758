/// The point of least norm in the convex hull of integer points, held by at most three of them.
///
/// For unit vectors that point lies on the axis of their narrowest cone, and the points that hold
/// it are the cone's support; for vectors of any length it is zero exactly if the viewpoint is in
/// their hull. One set of exact tests so serves twice: on Q2.61 unit vectors for the cone, on the
/// raw integers for feasibility. Every decision is the sign of an integer below 2^251. For unit
/// vectors most signs are plain from 64-bit products of the same vectors rounded to Q1.30; the wide
/// integers decide the rest.
/// Accuracy: every decision is exact (tests/property/min_norm.c, and every test of the cone).
/// Source:   Gilbert, Johnson, Keerthi 1988 (the subproblem); Wolfe 1976; docs/geometry.md, "The
///           pivot solver": for all functions here.
#ifndef SPHERE_MIN_NORM_H
#define SPHERE_MIN_NORM_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// A point with its index in the caller's list.
struct min_norm_point {
    uint32_t index;
    union {
        struct {
            struct vec3 given;    ///< unit: any int32 vector; normalised to Q2.61 it is the point
            struct vec3 unit_q30; ///< unit: the same in Q1.30, its length within 2^-29 of one
        };
        struct vec3_i64 exact; ///< not unit: the point, |component| <= 2^61
    };
};

/// A half-space in 64 bits, for unit vectors whose length is within 2^-29 of one, in a loop: a
/// point whose depth is above MIN_NORM_BAND surely does not violate the support, one below
/// -MIN_NORM_BAND surely does, and in between only the exact test can tell. The depth falls the
/// farther out a point lies; depths compare for one filter. Three points: their plane. Two: the
/// ball on their chord a b, outside of which unit vectors violate: half of (p - a).(p - b) = p.p -
/// p.(a + b) + a.b, where p.p is one.
struct min_norm_filter {
    struct vec3
        normal; ///< at most 2^30: factors of 32 bits are a quarter of the work on a Cortex-M4
    int64_t offset;
};

/// What rounding can do to a depth: units are off by at most 5, and normals below 2^31; p.p is off
/// by 2^32.
#define MIN_NORM_BAND ((int64_t)1 << 36)

/// At most 7 * 2^60, also for vectors that are no units. Cost: three products of 64 bits.
static inline int64_t min_norm_depth(const struct min_norm_filter *filter, struct vec3 unit_q30) {
    return vec3_dot_unit(filter->normal, unit_q30) - filter->offset;
}

/// A support of one to three points whose convex hull's point of least norm is not zero and lies
/// inside it (all weights positive).
struct min_norm {
    uint8_t count;
    bool unit; ///< the points are unit vectors
    struct min_norm_point point[3];
    struct min_norm_filter filter; ///< unit: of this support
    bool turned;                   ///< count 3: the cross product of the edges points toward zero
    bool side_known;               ///< ... as the filter tells already
    bool exact_known;              ///< what follows is worked out
    struct vec3_i64 exact[3];      ///< the points
    struct vec3_i128 normal;       ///< count 3: of the plane through the points, away from zero
    struct vec3_i64 chord;         ///< count 2: exact[1] - exact[0]
    struct i128 chord2;            ///< count 2: chord . chord
    struct i128 against;           ///< count 1: exact . exact; count 2: exact[0] . chord, negative
};

/// One point, not zero. unit: whether this and all later points are unit vectors. Cost: a copy.
void min_norm_start(struct min_norm *support, const struct min_norm_point *point, bool unit);

/// One to three points at once, unit as above. False: the hull's point of least norm does not lie
/// inside it, and the support is not set. Cost: one subset of min_norm_enter.
bool min_norm_hold(struct min_norm *support, const struct min_norm_point *points, unsigned count,
                   bool unit) MUST_CHECK;

/// Does the point lie on the near side of the plane through the nearest point, so that it would
/// shorten the norm? Exact.
/// Cost:    one 64-bit dot product of unit vectors where that tells; else, once for a support, a
///          cross product of 128 bits, and one dot product of 256 bits.
bool min_norm_violated_by(struct min_norm *support, const struct min_norm_point *point);

/// Takes in a point that violates; the support becomes that of the hull of both, and its norm gets
/// smaller.
/// Returns: false, and leaves the support, if zero lies in the hull of the (at most four) points.
/// Cost:    for unit vectors some 150 instructions if the filters can tell, as nearly always (an
///          acute corner by the law of cosines from six dot products); else at most seven subsets,
///          each tried by signs.
bool min_norm_enter(struct min_norm *support, const struct min_norm_point *point) MUST_CHECK;

/// A vector along the nearest point, with components below 2^62: within 2^-60 of its direction.
/// Cost:    one shift of the exact plane, or two dot products and nine products of 128 bits.
struct vec3_i64 min_norm_direction(struct min_norm *support);

/// That direction as a unit vector, Q1.30: the bits of vec3_i64_normalise(min_norm_direction), for
/// points that are given as unit vectors in 64 bits unless they are too close to a tie or to each
/// other (1e-3 rad). Cost: some 400 instructions, else 1,200.
struct vec3 min_norm_axis(struct min_norm *support);

#endif
