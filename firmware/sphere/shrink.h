/// Anderson's algorithm C: the narrowest cone by shrinking a circle around the hull.
#ifndef SPHERE_SHRINK_H
#define SPHERE_SHRINK_H

#include "fixed/must_check.h"
#include "sphere/cone.h"
#include "sphere/hull.h"
#include "sphere/site.h"

#include <stddef.h>
#include <stdint.h>

/// Bytes of workspace for count points, aligned to 8: a site for each corner of the hull, and the
/// hull's own.
#define SHRINK_WORKSPACE_BYTES(count)                                                              \
    ((size_t)(count) * sizeof(struct site) + HULL_WORKSPACE_BYTES(count))

struct shrink_result {
    struct cone_result cone; ///< point_reads counts the corners read while shrinking, too
    uint32_t hull_size;
    uint32_t iterations;   ///< circles that were tried
    uint64_t corner_reads; ///< corners read while shrinking
};

/// The narrowest cone of count directions, components any int32.
/// Returns:   CONE_OK, CONE_INFEASIBLE, CONE_EMPTY, CONE_ERROR_ZERO_VECTOR, or
///            CONE_ERROR_WORKSPACE (the workspace is smaller than
///            SHRINK_WORKSPACE_BYTES(count)).
/// Cost:      the hull, then a pass over the rest of its corners for each circle: at most h - 1
///            circles, O(h^2), reached on half circles; about log h on random hulls (make
///            bench-cone).
/// Accuracy:  the support is exact for the true directions; the axis as cone_settle_support.
/// Shown:     tests/property/methods.c.
/// Source:    Anderson 1985, section 4.3, with the corrections of docs/geometry.md, "Algorithm
///            C".
enum cone_status shrink_narrowest(const struct vec3 *points, uint32_t count, void *workspace,
                                  size_t workspace_bytes, struct shrink_result *result) MUST_CHECK;

#endif
