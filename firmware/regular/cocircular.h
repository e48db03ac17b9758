/// Four points on one circle in a projection. For the files of regular/ only.
#ifndef REGULAR_COCIRCULAR_H
#define REGULAR_COCIRCULAR_H

#include "regular/line_table.h"
#include "regular/regular.h"

/// Components of a direction at most: the products below then fit 64 bits.
#define COCIRCULAR_DIRECTION_MAX 255

/// Are two of the points equal, or four on one circle, when projected along the direction? Seen
/// from a third point of a circle, a chord appears under one angle, whose cotangent is rational
/// but for a common factor: for each chord, equal cotangents are looked up in a hash table.
/// strict:   three points on one line of the projection that are on none in space count, too.
/// Returns:  true without a conflict.
/// Cost:     expected O(n^3).
bool cocircular_none(const struct vec3 *points, uint32_t count, struct vec3 direction, bool strict,
                     struct line_table *lines, struct regular_conflict *conflict);

#endif
