/// Brute-force reference for small sets of directions: all pairs, triples and quadruples. Shares no
/// code with firmware/ (only the declaration of struct vec3).
///
/// Feasibility and witnesses are decided in exact 128-bit integers. Angles are long doubles of at
/// least 64 bits; small ones come from differences of unit vectors and those near 90 degrees from
/// exact determinants, so that the optimum is known to 0.02 nrad at nearly any shape
/// (tests/property/cone_random.c prints by how much it
/// differs from MPFR).
#ifndef SUPPORT_CONE_BRUTE_H
#define SUPPORT_CONE_BRUTE_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

#define BRUTE_COUNT_MAX 16

/// A set with everything that several questions need.
struct brute {
    struct vec3 point[BRUTE_COUNT_MAX];
    unsigned count;
    long double unit[BRUTE_COUNT_MAX][3];
    long double length[BRUTE_COUNT_MAX];
};

/// points: 1 to BRUTE_COUNT_MAX vectors, none of them zero.
void brute_set(struct brute *brute, const struct vec3 *points, unsigned count);

/// Sign of det(a, b, c) in __int128.
int brute_det_sign(struct vec3 a, struct vec3 b, struct vec3 c);

/// Opposite or equal rays: -1 or 1; 0 if not parallel.
int brute_parallel(struct vec3 a, struct vec3 b);

/// Is zero in the closed convex hull of the points? By Caratheodory's theorem some two, three or
/// four of them tell. Exact.
bool brute_zero_in_hull(const struct vec3 *points, unsigned count);

/// Half-angle in radians of the narrowest cone of a feasible set: the largest that any two or three
/// of the points need. *sharp: good to BRUTE_RAD_MAX. Not so when one point is almost opposite to
/// two that almost coincide: whether such a triangle is acute, long doubles can't tell.
long double brute_half_angle(const struct brute *brute, bool *sharp);

#define BRUTE_RAD_MAX 2e-11

/// Largest true angle in radians from the axis (any vector) to any point.
long double brute_largest_angle(const struct brute *brute, struct vec3 axis);

#endif
