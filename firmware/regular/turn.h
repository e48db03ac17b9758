/// Exact rotations of integer vectors, for algorithms that need general position.
///
/// A quaternion of four integers makes a matrix of integers whose rows are at right angles and
/// equally long: a rotation times `scale`. So what is turned keeps its angles exactly.
#ifndef REGULAR_TURN_H
#define REGULAR_TURN_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Largest size of a quaternion's component: scale is at most 2^14.
#define TURN_QUATERNION_MAX 64

struct turn {
    struct vec3 row[3];
    int32_t scale; ///< the length of each row: the quaternion's squared length
};

/// Components at most TURN_QUATERNION_MAX in size, not all zero.
struct turn turn_from(const int32_t quaternion[4]);

/// A fixed sequence of turns: 0 is the identity; later ones have larger scales, up to
/// TURN_QUATERNION_MAX^2 or so. Tried one after the other, they leave any degeneracy that is not
/// one of the set itself.
struct turn turn_try(uint32_t number);

/// Does `scale` times the vector's length fit int32, so that turn_forth does?
bool turn_fits(const struct turn *turn, struct vec3 a);

/// The turned vector, times scale.
struct vec3 turn_forth(const struct turn *turn, struct vec3 a);

#endif
