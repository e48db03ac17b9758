/// Anderson's algorithms A and B: the narrowest cone off the edges and vertices of a Voronoi
/// diagram.
#ifndef SPHERE_VORONOI_CIRCLE_H
#define SPHERE_VORONOI_CIRCLE_H

#include "sphere/cone.h"
#include "sphere/hull.h"
#include "sphere/voronoi_mesh.h"

#include <stdbool.h>

/// Bytes of workspace, aligned to 8, that always suffice for count points: A's, by insertion or by
/// merging. B needs HULL_WORKSPACE_BYTES(count) and so many for the corners of the hull.
#define VORONOI_CIRCLE_WORKSPACE_BYTES(count)                                                      \
    (VORONOI_MESH_BYTES(count) + VORONOI_MERGE_BYTES(count) + HULL_WORKSPACE_BYTES(count) + 7U)

struct voronoi_circle_options {
    bool hull;  ///< first take the hull: B; else A, with all points
    bool merge; ///< by Anderson's merge, else by insertion
};

struct voronoi_circle_result {
    struct cone_result cone;
    uint32_t site_count;     ///< of the diagram: B: the hull's corners
    uint32_t triangle_count; ///< its vertices, those on one circle apart
    uint64_t side_tests;     ///< to build it
    bool by_pair;            ///< an edge decided: two points
    size_t bytes_needed;     ///< of workspace; CONE_ERROR_WORKSPACE: as far as is known
};

/// The narrowest cone of count directions, components any int32.
/// Returns:   CONE_OK, CONE_INFEASIBLE, CONE_EMPTY, CONE_ERROR_ZERO_VECTOR, or
///            CONE_ERROR_WORKSPACE: the workspace is smaller than result->bytes_needed.
/// Cost:      the diagram, expected O(n log n) of all points or of the hull's; then a few tests
///            an edge.
/// Accuracy:  the support is exact for the true directions; the axis as cone_settle_support.
/// Shown:     tests/property/methods.c.
/// Source:    Anderson 1985, section 4.1; docs/geometry.md, "Algorithms A and B".
enum cone_status voronoi_circle(const struct vec3 *points, uint32_t count,
                                const struct voronoi_circle_options *options, void *workspace,
                                size_t workspace_bytes,
                                struct voronoi_circle_result *result) MUST_CHECK;

#endif
