/// A direction near the vertical that lies in no forbidden plane: in azimuth between two adjacent
/// vertical planes, and steeper than every other one. For the files of regular/ only.
///
/// A forbidden plane with normal n holds the direction (h, M), h horizontal, if n . h + M n_z = 0.
/// Where n_z is 0 only the azimuth counts: h must not lie in the plane's trace. Where it isn't,
/// M |n_z| > |n . h| suffices.
/// Source: the paper's sections 5.2 and 6: a wedge, and a small circle about the pole.
#ifndef REGULAR_WEDGE_H
#define REGULAR_WEDGE_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Traces are primitive (regular/primitive.h), below 2^21 each.
struct wedge {
    struct vec3_i64 first; ///< zero: no vertical plane so far
    struct vec3_i64 next;  ///< counter-clockwise the next one; zero: there is no other
    uint64_t operations;
};

/// A vertical plane by its trace: any vector along it but zero; z is ignored.
void wedge_add(struct wedge *wedge, struct vec3_i64 trace);

/// A horizontal direction in no trace; zero if there is no trace. Components below 2^22.
struct vec3 wedge_azimuth(const struct wedge *wedge);

/// The smallest M for this one plane, 0 if it is vertical: floor(|n . h| / |n_z|) + 1, below 2^67.
struct u128 wedge_steepness(struct vec3_i64 normal, struct vec3 azimuth);

#endif
