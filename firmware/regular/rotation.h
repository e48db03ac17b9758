/// Exact rotations of integer vectors, for algorithms that need general position.
///
/// A quaternion of four integers makes a matrix of integers whose rows are at right angles and
/// equally long: a rotation times `scale`. So what is turned keeps its angles exactly, and what is
/// found among the turned ones comes back exactly.
#ifndef REGULAR_ROTATION_H
#define REGULAR_ROTATION_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Largest size of a quaternion's component: scale is at most 2^14.
#define ROTATION_QUATERNION_MAX 64

struct rotation {
    struct vec3 row[3];
    int32_t scale; ///< the length of each row: the quaternion's squared length
};

/// Components at most ROTATION_QUATERNION_MAX in size, not all zero.
struct rotation rotation_from(const int32_t quaternion[4]);

/// A fixed sequence of rotations: 0 is the identity; later ones have larger scales, up to
/// ROTATION_QUATERNION_MAX^2 or so. Tried one after the other, they leave any degeneracy that is
/// not one of the set itself.
struct rotation rotation_try(uint32_t number);

/// Does `scale` times the vector's length fit int32, so that rotation_apply does?
bool rotation_fits(const struct rotation *rotation, struct vec3 a);

/// The turned vector, times scale.
struct vec3 rotation_apply(const struct rotation *rotation, struct vec3 a);

/// Turns a cross product back: from that of rotation_apply(a) and rotation_apply(b) to a x b,
/// exactly. Shown: tests/property/lineup.c.
struct vec3_i64 rotation_back(const struct rotation *rotation, struct vec3_i64 cross);

#endif
