/// Certificates for hulls and spheres of points in space, by GMP: nothing here is shared with
/// firmware/solid/.
#ifndef SUPPORT_SOLID_CHECK_H
#define SUPPORT_SOLID_CHECK_H

#include "solid/solid_hull.h"
#include "solid/solid_sphere.h"

/// NULL if the answer is the hull; else what is wrong. A closed surface of triangles with no point
/// above any of them is the hull; then each vertex has to be a corner of it (three of its faces'
/// normals are independent), and the first of equal points.
const char *solid_check_hull(const struct vec3 *points, uint32_t count,
                             const struct solid_hull *hull);

/// NULL if the answer is the smallest sphere; else what is wrong. It is if the centre is a convex
/// combination of points that are equally far from it, and no point is farther.
const char *solid_check_sphere(const struct vec3 *points, uint32_t count,
                               const struct solid_sphere *sphere);

enum solid_class {
    SOLID_CUBE,     // uniform in a box of any size
    SOLID_BALL,     // uniform in a ball
    SOLID_SHELL,    // on a sphere, rounded
    SOLID_GRID,     // small integers: repeated, collinear and coplanar points
    SOLID_FLAT,     // in one plane
    SOLID_NEARLY,   // in one plane but for one unit here and there
    SOLID_LINE,     // on one line
    SOLID_ENDS,     // components at the ends of int32
    SOLID_REPEATED, // a few points many times
    SOLID_LATTICE,  // the corners and inside of a lattice of cubes
    SOLID_CLASS_COUNT
};

extern const char *const solid_class_names[SOLID_CLASS_COUNT];

void solid_draw(enum solid_class class, uint64_t *random, struct vec3 *points, uint32_t count);

/// Uniform in [0, limit).
uint32_t solid_below(uint64_t *random, uint32_t limit);

#endif
