/// Convex hull of points in space.
///
/// Exact for all int32 points: no vertex is lost and none is invented, however flat or regular the
/// set. Repeated points count once (the first of them); a point on an edge or in a face of the hull
/// is no vertex.
#ifndef SOLID_SOLID_HULL_H
#define SOLID_SOLID_HULL_H

#include "fixed/must_check.h"
#include "solid/mesh.h"

#include <stddef.h>
#include <stdint.h>

enum solid_hull_status {
    SOLID_HULL_OK = 0,
    SOLID_HULL_EMPTY = -1, ///< no points
    SOLID_HULL_ERROR_WORKSPACE = -2,
    SOLID_HULL_ERROR_COUNT = -3 ///< more than SOLID_HULL_COUNT_MAX
};

enum solid_hull_method {
    /// Caps, each point kept with one face that it is above: for real work.
    SOLID_HULL_CAPS,
    /// Caps as Levine has them: in rounds, each with every point left against every face. For
    /// comparison.
    SOLID_HULL_LEVINE,
    /// Chand and Kapur 1970: about each edge a plane is turned over all points. For comparison.
    SOLID_HULL_WRAP
};

#define SOLID_HULL_COUNT_MAX (UINT32_C(1) << 29)

/// Bytes of workspace for count points, aligned to 8.
#define SOLID_HULL_WORKSPACE_BYTES(count) MESH_WORKSPACE_BYTES((count) < 8U ? 8U : (count))

struct solid_face {
    uint32_t vertex[3]; ///< counter-clockwise from outside, the smallest index first
};

struct solid_hull {
    /// 3: a solid. 2: all points are in one plane. 1: on one line. 0: equal.
    uint8_t dimension;
    /// In the workspace. Dimension 3: ascending. 2: the corners of the polygon in order, from the
    /// smallest index on, counter-clockwise as seen from +z; from +y where the plane is parallel to
    /// z, from +x where it is parallel to y, too. 1: the ends, ascending. 0: the first point.
    const uint32_t *vertices;
    uint32_t vertex_count;
    /// In the workspace. Dimension 3: 2 vertex_count - 4 triangles; a face with more corners is
    /// several of them. Else none.
    const struct solid_face *faces;
    uint32_t face_count;
    /// How many times a point was tested against a plane; SOLID_HULL_WRAP: two for each point and
    /// edge, as Levine counts. The search for points that are extreme along fixed directions is not
    /// counted.
    uint64_t side_tests;
};

/// points:   count, any int32; not modified.
/// Cost:     SOLID_HULL_CAPS: O(count log count) tests measured on cubes, balls, spheres and curves
///           (tests/property/solid_hull.c prints them); not proven for every set.
///           LEVINE: count * faces; WRAP: 3 * count * faces. No allocation, no recursion.
/// Accuracy: exact (tests/property/solid_hull.c: brute force over all planes in rational
///           arithmetic, the definition on large sets, and the three methods against each other).
/// Source:   Levine 1975, chapter IV, as corrected in docs/geometry.md; Barber, Dobkin, Huhdanpaa
///           1996 (a list of points for each face).
enum solid_hull_status solid_hull_find(const struct vec3 *points, uint32_t count,
                                       enum solid_hull_method method, void *workspace,
                                       size_t workspace_bytes,
                                       struct solid_hull *result) MUST_CHECK;

#endif
