/// Solids, planes and wire frames: what a picture with hidden lines is made of.
///
/// A solid is convex, closed, its faces flat and counter-clockwise from outside. A plane is a flat
/// polygon with any simple outline, seen from both sides; it is kept as convex pieces. A wire frame
/// is edges that hide nothing. Every answer is exact for the integers given: a face whose corners
/// are off its plane by one unit is not flat.
#ifndef SCENE_SHAPE_H
#define SCENE_SHAPE_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// No coordinate of a vertex is larger in size; the eye may be at up to TREE_COORDINATE_MAX.
#define SHAPE_COORDINATE_MAX (INT32_C(1) << 28)
#define SHAPE_NONE           UINT32_MAX

enum shape_kind { SHAPE_SOLID, SHAPE_PLANE, SHAPE_WIRE };

/// normal . p < offset is behind the face. Components below 2^60.
struct shape_plane {
    struct vec3_i64 normal;
    struct i128 offset;
};

/// A face of a solid, or a convex piece of a plane. Corners by vertex; in a piece of a plane
/// SHAPE_DIAGONAL marks the side from that corner to the next as one to another piece, of which
/// this one holds the points.
#define SHAPE_DIAGONAL UINT32_C(0x80000000)
struct shape_face {
    uint32_t first_corner, corner_count;
};

struct shape_edge {
    uint32_t from, to;
    /// Of a solid: the face in whose order the edge runs from `from` to `to`, and the other one.
    /// Else SHAPE_NONE.
    uint32_t left, right;
    bool drawn; ///< false: between two parts of one flat face
};

struct shape_object {
    enum shape_kind kind;
    uint32_t first_vertex, vertex_count;
    uint32_t first_face, face_count;
    uint32_t first_edge, edge_count;
};

/// Arrays of the caller, and how many of each are in use and have room.
struct shape_set {
    struct vec3 *vertices;
    uint32_t *corners;
    struct shape_face *faces;
    struct shape_plane *planes; ///< one a face
    struct shape_edge *edges;
    struct shape_object *objects;
    uint32_t vertex_count, corner_count, face_count, edge_count, object_count;
    uint32_t vertex_room, corner_room, face_room, edge_room, object_room;
};

enum shape_status {
    SHAPE_OK = 0,
    SHAPE_ERROR_CAPACITY = -1,
    SHAPE_ERROR_RANGE = -2,   ///< a coordinate or a corner's number
    SHAPE_ERROR_FLAT = -3,    ///< a face's corners are not in one plane
    SHAPE_ERROR_CONVEX = -4,  ///< the solid reaches beyond one of its faces; or no solid at all
    SHAPE_ERROR_CLOSED = -5,  ///< an edge has not two faces that run along it in opposite ways
    SHAPE_ERROR_OUTLINE = -6, ///< a face or a plane with no area, or an outline that crosses itself
};

/// Adds a solid. points: count; corners: of all faces one after the other, by point;
/// corner_counts: of each face. drawn: for each corner whether the edge from it to the next is
/// drawn; NULL: all are. fault_face: which face, if one is at fault. After an error the set is as
/// it was.
/// Cost:     count * face_count side tests; edges are matched by searching those of the solid.
/// Accuracy: exact (tests/property/hidden.c).
enum shape_status shape_add_solid(struct shape_set *set, const struct vec3 *points, uint32_t count,
                                  const uint32_t *corners, const uint32_t *corner_counts,
                                  uint32_t face_count, const bool *drawn,
                                  uint32_t *fault_face) MUST_CHECK;

/// Adds a plane: its outline, each corner once, in any direction. A convex outline is one piece;
/// else it is cut into triangles. The corners must be in one plane, or each triangle keeps to its
/// own (`bent`: allowed, for outlines that were rounded).
/// Cost:     count^3 at worst.
enum shape_status shape_add_plane(struct shape_set *set, const struct vec3 *outline, uint32_t count,
                                  bool bent) MUST_CHECK;

/// Adds a wire frame: edge_count pairs of points. No edge may have two equal ends.
enum shape_status shape_add_wire(struct shape_set *set, const struct vec3 *points, uint32_t count,
                                 const uint32_t *ends, uint32_t edge_count) MUST_CHECK;

/// The plane of three points, positive where they are counter-clockwise; a zero normal if they are
/// collinear.
struct shape_plane shape_plane_through(struct vec3 a, struct vec3 b, struct vec3 c);

/// Sign of normal . p - offset: 1 in front, 0 on it, -1 behind. Any int32 point.
static inline int shape_side(const struct shape_plane *plane, struct vec3 p) {
    return i128_sign(i128_sub(vec3_i64_dot_vec3(plane->normal, p), plane->offset));
}

#endif
