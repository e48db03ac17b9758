/// The smallest sphere through two, three or four points, with a rational centre. Exact for all
/// int32 points.
///
/// The centre is `origin + numerator / denominator`. The widths, with differences of 33 bits:
/// numerator 170 bits, denominator 137, the test of a point 208, the test of the centre 208.
#ifndef SOLID_CIRCUMSPHERE_H
#define SOLID_CIRCUMSPHERE_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct circumsphere {
    uint8_t count;
    struct vec3 point[4];
    struct vec3 origin; ///< point[0]
    struct i256 numerator[3];
    struct i256 denominator; ///< above 0
};

/// count: 1 to 4 points; one gives a sphere of radius 0.
/// Returns: false if they are not in general position (equal, on a line, or in a plane).
bool circumsphere_through(const struct vec3 *points, uint8_t count, struct circumsphere *out);

/// Is the centre in the closed segment, triangle or tetrahedron of the points? Only then no smaller
/// sphere holds them.
bool circumsphere_is_smallest(const struct circumsphere *sphere);

/// Sign of the point's distance from the sphere: 1 outside, 0 on it, -1 inside.
int circumsphere_side(const struct circumsphere *sphere, struct vec3 p);

/// The centre in units of 2^-30, each component rounded to nearest. The centre must be in the hull
/// of the points.
struct vec3_i64 circumsphere_center_q30(const struct circumsphere *sphere);

/// A radius in units of 2^-30 about that rounded centre that holds everything the sphere holds: at
/// most 5 units more than the true radius.
uint64_t circumsphere_radius_q30(const struct circumsphere *sphere, struct vec3_i64 center_q30);

#endif
