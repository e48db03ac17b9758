/// Exact tests on directions of any length, as the points of the unit sphere that they are.
///
/// A site is an int32 vector v; its point is v / |v|. The tests are signs of polynomials of
/// such points, which are sums of up to four square roots of integers (fixed/root_sum.h): no
/// rounding takes part in an answer. Most signs are plain from the points rounded to Q1.30,
/// nearly all others from Q2.61, each with a bound of its error that shrinks with the
/// distances; the roots decide the rest, such as points exactly on one circle.
/// Cost:      of a test, some 10 products of 64 bits (Q1.30), 40 (Q2.61), a few thousand (roots).
/// Accuracy:  every test is exact.
/// Source:    docs/geometry.md, "True directions".
/// Shown:     tests/property/site_exact.c (against reals of 1,200 bits, and planted
///            coincidences).
#ifndef SPHERE_SITE_H
#define SPHERE_SITE_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct site {
    struct vec3 vector;       ///< as given: any int32 but zero
    struct vec3_i64 unit_q61; ///< vec3_normalise_q61
    struct vec3 unit_q30;     ///< the same in Q1.30, rounded down
};

/// Cost: vec3_normalise_q61. Accuracy: correctly rounded.
struct site site_from(struct vec3 vector);

/// Sign of det(b - a, c - a, d - a): seen from outside, with a, b, c counter-clockwise around a
/// cap, 1 if d lies outside of the plane through them on the side of their normal (b - a) x (c -
/// a): strictly inside the circle of which that normal is the axis. 0: on one circle (great circles
/// included).
int site_plane_sign(const struct site *a, const struct site *b, const struct site *c,
                    const struct site *d);

/// Sign of (x - a) . (x - b): 1 if x lies strictly outside the circle whose diameter is the arc a
/// b, and so if the triangle a x b is acute at x; 0 on it, -1 inside.
int site_cap_sign(const struct site *a, const struct site *b, const struct site *x);

/// Sign of the distance a b minus the distance c d.
int site_distance_cmp(const struct site *a, const struct site *b, const struct site *c,
                      const struct site *d);

/// Sign of det(a, b, c). Cost: nine products of 64 bits.
static inline int site_side(const struct site *a, const struct site *b, const struct site *c) {
    return vec3_det_sign(a->vector, b->vector, c->vector);
}

#endif
