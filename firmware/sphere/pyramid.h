/// The method of 1982: the narrowest cone from the edges of the convex pyramid around the points.
#ifndef SPHERE_PYRAMID_H
#define SPHERE_PYRAMID_H

#include "fixed/must_check.h"
#include "sphere/cone.h"
#include "sphere/site.h"

#include <stddef.h>
#include <stdint.h>

/// A face of the pyramid, from its edge to the next one counter-clockwise (seen from outside the
/// sphere).
struct pyramid_face {
    struct vec3_i64 normal; ///< edge x next edge: points on its side have a dot product >= 0
    uint32_t edge;          ///< index of a point
    uint32_t next;
    int8_t side; ///< of the point that is being added
};

/// Bytes of workspace, aligned to 8, for a pyramid of at most edges_max edges; count edges always
/// suffice.
#define PYRAMID_WORKSPACE_BYTES(edges_max)                                                         \
    ((size_t)(edges_max) * (sizeof(struct pyramid_face) + sizeof(struct site)))

struct pyramid_result {
    struct cone_result cone;
    uint32_t edges, edges_most; ///< of the last pyramid, and of the largest on the way
    uint32_t edges_max;         ///< CONE_ERROR_WORKSPACE: what the workspace has room for
    uint64_t face_tests;        ///< scalar products of a point and a face
    uint64_t triples;           ///< of edges that were looked at
    bool by_pair;               ///< the two farthest edges decided
};

/// The narrowest cone of count directions, components any int32.
/// Returns:   CONE_OK, CONE_INFEASIBLE, CONE_EMPTY, CONE_ERROR_ZERO_VECTOR, or
///            CONE_ERROR_WORKSPACE: the pyramid has more edges than the workspace has room for,
///            result->edges_max.
/// Cost:      count times the faces at that time for the pyramid; h^2 for the farthest pair of
///            its h edges; if that does not decide, up to h^3 triples, each with up to h tests.
/// Accuracy:  the support is exact for the true directions; the axis as cone_settle_support.
/// Shown:     tests/property/methods.c.
/// Source:    Anderson 1982, with the corrections of docs/geometry.md, "The pyramid of 1982".
enum cone_status pyramid_narrowest(const struct vec3 *points, uint32_t count, void *workspace,
                                   size_t workspace_bytes,
                                   struct pyramid_result *result) MUST_CHECK;

#endif
