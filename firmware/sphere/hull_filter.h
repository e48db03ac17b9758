/// Drops points that surely are not extreme: those inside a polygon of a few others.
#ifndef SPHERE_HULL_FILTER_H
#define SPHERE_HULL_FILTER_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

#define HULL_FILTER_CORNERS 16U

/// A polygon as a fan of triangles from its first corner, in normals of 31 bits; and four of its
/// corners as a polygon of their own, inside of which most points of a round set are told without a
/// search.
struct hull_filter {
    uint32_t corners;
    bool has_inner;
    struct vec3 inner[4];                   ///< edges
    struct vec3 spoke[HULL_FILTER_CORNERS]; ///< first corner x corner
    struct vec3 edge[HULL_FILTER_CORNERS];  ///< corner x next corner
};

/// corners:  3 to HULL_FILTER_CORNERS of a strictly convex polygon, clockwise.
/// Cost:     two cross products a corner, and four.
/// Accuracy: the normals are rounded to 31 bits, which hull_filter_apply allows for.
/// Source:   Akl, Toussaint 1978 (a few extreme points throw most others away).
struct hull_filter hull_filter(const struct vec3 *points, const uint32_t *corners, uint32_t count);

/// Lists, ascending, the points that are not surely strictly inside; returns how many.
/// Cost:     4 dot products of 64 bits a point, and some 6 more of those outside the inner polygon.
/// Accuracy: a point is dropped only if three determinants have the right sign by more than the
///           normals' rounding: no extreme point ever, nor one that equals a corner. What is
///           dropped is a positive combination of corners, so the set's hull, and whether it has
///           one, stay the same (tests/property/hull_exact.c).
/// Source:   as hull_filter; docs/geometry.md, "The hull".
uint32_t hull_filter_apply(const struct hull_filter *filter, const struct vec3 *points,
                           uint32_t count, uint32_t *kept);

#endif
