/// A convex polyhedron of triangles that grows by one vertex at a time: what all but one of the
/// hull methods build on.
///
/// Every decision is the sign of an exact determinant, and a face is visible from a point only if
/// the point is strictly above it. So no triangle is ever degenerate, the visible faces are
/// connected, and the polyhedron has 2 V - 4 faces for V vertices throughout.
/// Source: Levine 1975, chapter IV, step 4 (convex caps).
#ifndef SOLID_MESH_H
#define SOLID_MESH_H

#include "solid/side.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define MESH_NONE UINT32_MAX

struct mesh_face {
    struct side_plane plane;
    int64_t farthest;        ///< value of the first point of the list
    uint32_t vertex[3];      ///< counter-clockwise from outside
    uint32_t across[3];      ///< the face beyond the edge from vertex[i] to vertex[(i + 1) % 3]
    uint32_t mark;           ///< 2 * step of the last test, and 1 if it was visible then
    uint32_t link;           ///< next of the visible, the new or the unused faces
    uint32_t head, tail;     ///< the points above it, for the method's use
    uint32_t before, behind; ///< the queue of faces with points above them
    bool in_use;
};

struct mesh {
    const struct vec3 *points;
    uint32_t count;
    struct vec3 apex; ///< the point with index `count`, for flat sets
    struct side_range range;
    struct mesh_face *faces;
    uint32_t *next;    ///< of count + 1 points: next in a list; while a cap is built, on the rim
    uint32_t *outside; ///< of count + 1 points: for one on the rim the hidden face beyond its edge
    uint32_t slots, slots_used, unused;
    uint32_t face_count;
    uint32_t step;
    uint32_t queue_first, queue_last;
    uint64_t side_tests;
};

/// A polyhedron on so many points, and an apex, has at most so many faces.
#define MESH_FACES(count)           (2U * (size_t)(count))
#define MESH_WORKSPACE_BYTES(count) (MESH_FACES(count) * 104U + ((size_t)(count) + 1U) * 8U)

/// Lays the mesh out in a workspace of MESH_WORKSPACE_BYTES(count), aligned to 8; no face yet.
void mesh_open(struct mesh *mesh, const struct vec3 *points, uint32_t count,
               struct side_range range, void *workspace);

static inline struct vec3 mesh_point(const struct mesh *mesh, uint32_t index) {
    return index == mesh->count ? mesh->apex : mesh->points[index];
}

/// Four points that are not in one plane. Earlier faces go.
void mesh_start(struct mesh *mesh, const uint32_t corner[4]);

/// Sign of the point's height above the face.
int mesh_side(struct mesh *mesh, uint32_t face, uint32_t point);

/// -1, 0 or 1: which of two points is higher above a face; each with its side_value.
int mesh_compare(const struct mesh *mesh, uint32_t face, uint32_t a, int64_t value_a, uint32_t b,
                 int64_t value_b);

/// What mesh_add leaves: the new faces, a ring in the order of `link` that ends with MESH_NONE, and
/// the points that lay above the faces that went, in the order of `next`.
struct mesh_cap {
    uint32_t first_face;
    uint32_t first_point;
};

/// Replaces the faces that the point sees by a cap with the point as its tip. seed: one of them.
/// Cost: a test for each face that it sees or that touches one of these.
struct mesh_cap mesh_add(struct mesh *mesh, uint32_t seed, uint32_t point);

/// Puts a point on the list of a face. value: its side_value; the highest comes first: of equals
/// the last in side_order, of equal points the first index.
void mesh_hang(struct mesh *mesh, uint32_t face, uint32_t point, int64_t value);

/// Hangs each point of a chain on the first of the faces (by link) that it is above; the others are
/// inside. skip: left out.
void mesh_share_out(struct mesh *mesh, uint32_t chain, uint32_t first_face, uint32_t skip);

#endif
