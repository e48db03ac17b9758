/// Directions in exact clockwise order about a pivot: by merging, or by buckets of their angles.
/// Accuracy: exact, all of it (tests/property/hull_exact.c).
/// Source:   docs/geometry.md, "The hull", where nothing else is said.
#ifndef SPHERE_HULL_ORDER_H
#define SPHERE_HULL_ORDER_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// The half great circle from the pivot through a point, as a vector in a plane: the point
/// projected along the pivot onto the coordinate plane that the pivot is farthest from. Exact, and
/// its angle grows clockwise as seen from outside the sphere. (0, 0): parallel to the pivot.
struct hull_ray {
    int64_t u, v;
};

struct hull_pivot {
    const struct vec3 *points;
    struct vec3 direction;
    uint8_t along;        ///< the pivot's largest component
    uint64_t comparisons; ///< of two rays, so far
};

/// Cost: three comparisons.
struct hull_pivot hull_pivot(const struct vec3 *points, uint32_t index);
/// Cost: four products of 64 bits.
struct hull_ray hull_ray(const struct hull_pivot *pivot, struct vec3 point);

/// Does a come strictly before b, counted from the ray (1, 0)? Cost: two products of 64 by 64 bits,
/// if both are in one half.
bool hull_ray_before(struct hull_ray a, struct hull_ray b);
/// The same angle? Cost: the same.
bool hull_ray_equal(struct hull_ray a, struct hull_ray b);

/// Puts the points of a list, none of them parallel to the pivot, into the order of their rays;
/// equal rays stay in the order of the list. spare: as large as the list.
/// Cost:    count log2 count exact comparisons.
void hull_order_merge(struct hull_pivot *pivot, uint32_t *list, uint32_t *spare, uint32_t count);

/// The same through count buckets of equal width in the angle's stead (rounded to 30 bits a
/// quadrant); each bucket is then sorted exactly, and the whole order checked exactly.
/// The result is in `sorted`. list: overwritten, like keys (count) and starts (count + 1).
/// Cost:    expected O(count) where the angles have a bounded density; count log2 count at worst:
///          a bucket is merged, and if the check fails, because rays of two buckets differ by less
///          than the rounding, all are.
/// Source:  Anderson 1985, section 3 (bucket sort); the diamond angle v / (u + v) is elementary.
void hull_order_buckets(struct hull_pivot *pivot, uint32_t *list, uint32_t *sorted, uint32_t *keys,
                        uint32_t *starts, uint32_t count);

#endif
