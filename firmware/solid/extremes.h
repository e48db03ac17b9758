/// Points that are extreme along fourteen directions: vertices of the hull, found in one pass.
#ifndef SOLID_EXTREMES_H
#define SOLID_EXTREMES_H

#include "solid/side.h"

#include <stdbool.h>
#include <stdint.h>

#define EXTREMES_DIRECTIONS 7U

/// The points with the largest and the smallest x, y, z, x+y+z, -x+y+z, x+y-z and -x+y-z: of equals
/// the last in side_order, of equal points the first.
struct extremes {
    uint32_t most[EXTREMES_DIRECTIONS], least[EXTREMES_DIRECTIONS];
    uint32_t list[2U * EXTREMES_DIRECTIONS]; ///< the same, each index once
    uint32_t count;
    struct side_range range;
};

/// count >= 1. Source: Levine 1975, chapter IV, step 1.
void extremes_find(const struct vec3 *points, uint32_t count, struct extremes *out);

/// A box whose inside (low < p < high on all axes) is inside the hull. May be empty.
struct extremes_box {
    struct vec3 low, high;
};

/// From the points that are extreme along the eight diagonals. Why it holds: along any direction,
/// the diagonal point of the same octant is at least as far out as every corner of the box.
struct extremes_box extremes_box(const struct vec3 *points, const struct extremes *extremes);

static inline bool extremes_inside(const struct extremes_box *box, struct vec3 p) {
    return p.x > box->low.x && p.x < box->high.x && p.y > box->low.y && p.y < box->high.y &&
           p.z > box->low.z && p.z < box->high.z;
}

/// Four points that span space, three that span a plane, or as many as there are: the list's
/// farthest from each other, and from the whole set where the list is flat.
/// Returns: the dimension of the set, 0 to 3; corner holds one more than that.
/// Accuracy: the dimension is exact; which points are taken is a matter of speed only.
uint8_t extremes_span(const struct vec3 *points, uint32_t count, const struct extremes *extremes,
                      uint32_t corner[4]);

#endif
