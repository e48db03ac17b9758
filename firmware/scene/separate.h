/// Which of two objects can hide the other: planes that separate them, and a bit for each object
/// and plane.
///
/// For each two objects of a scene there is a plane between them; one plane serves all pairs that
/// it separates. A row of bits tells for each object on which side of each plane it is (SEPL1), a
/// second one whether it is on one side at all (SEPL2). An eye on one side of a plane makes the
/// objects on that side those that can hide the others: the thesis' SO, by bit operations on two
/// rows. Objects may touch each other.
/// Source: Levine 1975, chapter VI.E, as corrected in docs/geometry.md.
#ifndef SCENE_SEPARATE_H
#define SCENE_SEPARATE_H

#include "scene/shape.h"

/// A plane, and which side an object counts to that lies in it as a whole.
struct separate_plane {
    struct shape_plane plane;
    bool inside_front;
};

struct separate {
    const struct shape_set *set;
    struct separate_plane *planes;
    uint32_t *side;  ///< SEPL1: rows of row_words; 1: in front
    uint32_t *both;  ///< SEPL2: 1: on one side
    uint32_t *eye;   ///< a row: 1: the eye is in front
    uint32_t *level; ///< a row: 1: the eye is on the plane
    uint32_t plane_count, plane_room, row_words;
    size_t workspace_bytes;
};

/// Bytes of workspace, aligned to 8, for a scene of so many objects and so many planes. A lattice
/// of cubes takes as many planes as it has gaps between layers; n objects in disorder up to 3 n.
#define SEPARATE_WORKSPACE_BYTES(object_count, plane_count)                                        \
    ((size_t)(plane_count) * sizeof(struct separate_plane) +                                       \
     (2U * (size_t)(object_count) + 2U) * (((size_t)(plane_count) + 31U) / 32U) * 4U + 8U)

enum separate_status {
    SEPARATE_OK = 0,
    SEPARATE_ERROR_CAPACITY = -1, ///< more planes needed
    SEPARATE_ERROR_PAIR = -2      ///< no plane is between two objects: fault[0], fault[1]
};

/// Finds the planes. Pairs with a wire frame need none (the wire is then clipped).
/// Cost: object_count^2 / 2 comparisons of rows; for each plane found each vertex once.
enum separate_status separate_build(struct separate *separate, const struct shape_set *set,
                                    uint32_t plane_room, void *workspace, size_t workspace_bytes,
                                    uint32_t fault[2]) MUST_CHECK;

/// Is there a plane between two objects? Exact, and they may touch; two polygons in one plane are
/// apart. For solids and planes; for a wire frame false may mean that none was found.
/// Cost: as many planes as the two have faces, and as pairs of edges, times their vertices.
bool separate_pair(const struct shape_set *set, uint32_t a, uint32_t b, struct shape_plane *out);

/// Marks the planes for an eye.
void separate_look(struct separate *separate, struct vec3 eye);

enum separate_order {
    SEPARATE_BEHIND = -1, ///< the first may be hidden by the second: SO(l, m) = -1
    SEPARATE_NEITHER = 0,
    SEPARATE_BEFORE = 1, ///< the first may hide the second
    SEPARATE_UNKNOWN = 2 ///< no plane is between them
};

/// SO(l, m), from rows l and m and the eye's.
enum separate_order separate_order(const struct separate *separate, uint32_t l, uint32_t m);

#endif
