/// Random and degenerate sets of directions for the tests of cone and hull.
#ifndef SUPPORT_CONE_SETS_H
#define SUPPORT_CONE_SETS_H

#include "fixed/vec3.h"

#include <stdint.h>

enum cone_class {
    CLASS_CAP,        // anywhere in a cap of 1e-6 rad to 89.99 degrees, unit vectors
    CLASS_CAP_MIXED,  // the same, lengths from 2^8 to 2^31
    CLASS_RING,       // on the rim of such a cap, as nearly as unit vectors in Q1.30 can be
    CLASS_RING_WIDE,  // on a rim of 89 to 89.999 degrees
    CLASS_RING_SHARP, // on a rim of 89.999 to 90 degrees
    CLASS_NARROW,     // within a few units of one direction: narrower than 1e-6 rad
    CLASS_SPHERE,     // anywhere
    CLASS_GRID,       // small integers: many exact coplanarities and repetitions
    CLASS_HALF_GRID,  // small integers with z >= 0: zero often on the border of the hull
    CLASS_ARC,        // exactly on one great circle, spans from tiny to the full turn
    CLASS_CIRCLE,     // exactly on one circle
    CLASS_ANTIPODAL,  // holds an opposite pair, or one that is one unit beside
    CLASS_BOUNDARY,   // zero on the border of the hull of three, then one unit beside
    CLASS_EXTREMES,   // components from the ends of int32
    CLASS_REPEATED,   // few directions, repeated at several lengths
    CLASS_COUNT
};

extern const char *const cone_class_names[CLASS_COUNT];

#define CONE_SETS_SMALL_MAX 12

/// Draws 1 to CONE_SETS_SMALL_MAX vectors, none of them zero; returns how many.
uint32_t cone_sets_draw(enum cone_class class, uint64_t *random, struct vec3 *points);

/// The set of those of the 26 directions with components -1, 0, 1 whose bits are set, if they are
/// at most `limit`; returns how many, or 0.
uint32_t cone_sets_of_bits(uint32_t bits, uint32_t limit, struct vec3 *points);

/// Puts the points into a random order.
void cone_sets_shuffle(uint64_t *random, struct vec3 *points, uint32_t count);

enum cone_large_class {
    LARGE_CAP,        // uniform in a cap of any width
    LARGE_RING,       // on its rim
    LARGE_NORMAL,     // normal distribution around a direction, cut off at 89 degrees
    LARGE_SPIRAL,     // winds outward: the worst order for methods that add points one by one
    LARGE_GRID,       // integers up to 50 with z > 0
    LARGE_ARC,        // on one great circle
    LARGE_CIRCLE,     // exactly on one circle
    LARGE_HEMISPHERE, // uniform in a cap of 89.9 to 89.9999 degrees
    LARGE_SPHERE,     // anywhere: infeasible
    LARGE_BLOCKED,    // a wide cap and, last, the opposite of its middle: infeasible
    LARGE_COUNT
};

extern const char *const cone_large_class_names[LARGE_COUNT];

/// Draws `count` vectors, none of them zero.
void cone_sets_draw_large(enum cone_large_class class, uint64_t *random, struct vec3 *points,
                          uint32_t count);

/// v / |v| in Q1.30, by long double: independent of the firmware's own normalisation.
struct vec3 cone_sets_normalise(struct vec3 v);

/// Is the length within 2^-29 of one, as CONE_LENGTHS_UNIT asks for?
bool cone_sets_is_unit(struct vec3 v);

/// Uniform in [0, 1).
double cone_sets_uniform(uint64_t *random);

#endif
