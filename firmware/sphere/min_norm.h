/// The point of least norm in the convex hull of integer points, held by at most three of them.
///
/// For unit vectors that point lies on the axis of their narrowest cone, and the points that hold
/// it are the cone's support; for vectors of any length it is zero exactly if the viewpoint is in
/// their hull. One set of exact tests so serves the solver twice: on Q2.61 unit vectors for the
/// cone, on the raw integers for feasibility. Every decision is the sign of an integer below 2^251.
/// Source: Gilbert, Johnson, Keerthi 1988 (the subproblem); Wolfe 1976; docs/geometry.md, "The
/// pivot solver".
#ifndef SPHERE_MIN_NORM_H
#define SPHERE_MIN_NORM_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// A support of one to three points, |component| <= 2^61, whose convex hull's point of least norm
/// is not zero and lies inside it (all weights positive). What a test of another point needs is
/// kept.
struct min_norm {
    uint8_t count;
    uint32_t index[3];
    struct vec3_i64 point[3];
    struct vec3_i128 normal; // count 3: of the plane through the points, away from zero
    struct vec3_i64 chord;   // count 2: point[1] - point[0]
    struct i128 chord2;      // count 2: chord . chord
    struct i128 against;     // count 1: point . point; count 2: point[0] . chord, negative
};

/// One point, not zero.
void min_norm_start(struct min_norm *support, uint32_t index, struct vec3_i64 point);

/// Is the point on the near side of the plane through the nearest point, so that it would shorten
/// the norm? Exact. Cost: one or two 256-bit products.
bool min_norm_violated_by(const struct min_norm *support, struct vec3_i64 point);

/// Takes in a point that violates; the support becomes that of the hull of both, and its norm gets
/// smaller. Returns: false, and leaves the support, if zero lies in the hull of the (at most four)
/// points. Cost:    at most seven subsets, each tried by signs.
bool min_norm_enter(struct min_norm *support, uint32_t index, struct vec3_i64 point) MUST_CHECK;

/// A vector along the nearest point, with components below 2^62: within 2^-60 of its direction.
struct vec3_i64 min_norm_direction(const struct min_norm *support);

#endif
