/// The narrowest cap about one, two or three directions, exactly. For the files of regular/ only.
///
/// A support vector a stands for the unit vector a / |a|. One: the cap is that point. Two: their
/// arc is its diameter. Three: all lie on its rim. Where great circles are forbidden, the supports
/// are normals, turned toward the cell, and the disc between the circles has the same centre; the
/// sine of its radius is the cosine of the cap's. Where points are forbidden, three of them lie on
/// the rim of the empty cap itself.
/// Shown:     tests/property/regular_optimize.c.
#ifndef REGULAR_DISC_H
#define REGULAR_DISC_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Components below 2^43. The direction of the centre is on the side of the supports.
struct disc {
    uint8_t count;
    struct vec3_i64 support[3];
};

/// Sign of the difference of the cosines of two caps: 1 if a is the narrower one. Exact, as
/// regular/surd.h is.
int disc_compare(const struct disc *a, const struct disc *b);

/// Does a direction lie strictly outside of the cap? Exact. The cap is narrower than a half-sphere.
bool disc_excludes(const struct disc *disc, struct vec3_i64 direction);

/// Are all three angles of the triangle at most right angles, so that no two of its corners hold
/// the cap alone? Exact. For three supports.
bool disc_is_held(const struct disc *disc);

/// The centre, with components of up to 61 bits, within 2^-58 of its direction; of one support, the
/// support itself.
struct vec3_i64 disc_centre(const struct disc *disc);

/// a / |a| in Q2.61: each component within 2^-59, and none above 1. Components of a below 2^61, not
/// all 0.
struct vec3_i64 disc_unit_q61(struct vec3_i64 a);

/// The angle between a direction and the nearest of a line's two directions, 2^64 a turn, at most a
/// quarter. Components below 2^62. Accuracy: DISC_ANGLE_ERROR.
uint64_t disc_line_angle(struct vec3_i64 a, struct vec3_i64 line);
/// In units of 2^64 a turn: 2^-54 rad.
#define DISC_ANGLE_ERROR 256U

#endif
