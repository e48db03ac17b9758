/// What a solid or a plane hides from an eye: the points behind it, as convex pieces of space.
///
/// The shadow of a convex solid is bounded by planes through the eye and its silhouette, and by the
/// planes of the faces that are turned to the eye: a point is hidden if it is strictly on the inner
/// side of all of them. That is the same as: the way from the eye to the point passes the inside of
/// the solid. A point on the solid's surface or on the border of its picture is not hidden by it.
/// An eye inside a solid sees nothing; one on its surface sees what lies away from it. A plane
/// hides what is beyond it and inside its outline; edge-on, nothing. Points may be anywhere, behind
/// the viewer, too.
///
/// Every answer is the sign of an integer: exact. Shown: tests/property/hidden.c, against rays
/// followed in rational numbers.
#ifndef SCENE_SIGHT_H
#define SCENE_SIGHT_H

#include "scene/fraction.h"
#include "scene/shape.h"
#include "scene/tree.h"

/// Points relative to the eye: normal . p < offset, or <= where `closed`.
struct sight_bound {
    struct vec3_i64 normal; ///< components below 2^62
    struct i128 offset;     ///< below 2^95
    bool closed;
};

/// Most bounds of an object: one a face and one an edge; of a plane a piece needs one more than it
/// has corners.
#define SIGHT_BOUNDS_MAX(face_count, edge_count, corner_count)                                     \
    ((size_t)(face_count) + (size_t)(edge_count) + (size_t)(corner_count))

/// A convex piece of a shadow: bounds[first .. first + count).
struct sight_piece {
    uint32_t first, count;
};

/// The shadows of some objects for one eye.
struct sight {
    struct vec3 eye;
    struct sight_bound *bounds;
    struct sight_piece *pieces;
    uint32_t bound_count, piece_count;
    uint32_t bound_room, piece_room;
};

/// p - eye; p within SHAPE_COORDINATE_MAX, the eye within TREE_COORDINATE_MAX.
static inline struct vec3 sight_from_eye(struct vec3 eye, struct vec3 p) {
    return vec3(p.x - eye.x, p.y - eye.y, p.z - eye.z);
}

/// Adds the shadow of an object. Returns the number of its pieces: 1 for a solid, 0 for a wire
/// frame and for planes edge-on, and UINT32_MAX if there is no room.
uint32_t sight_add(struct sight *sight, const struct shape_set *set, uint32_t object);

/// The part of the way from a to b (both relative to the eye) in a piece of shadow, without its
/// ends. False: none of it, or a single point.
/// Cost:     two products a bound; ends at the first bound that both ends are beyond.
bool sight_clip(const struct sight *sight, const struct sight_piece *piece, struct vec3 a,
                struct vec3 b, struct span *out);

/// Is a point (relative to the eye) in a piece of shadow? Cost: a product a bound; ends at the
/// first that the point is beyond.
bool sight_hides(const struct sight *sight, const struct sight_piece *piece, struct vec3 p);

/// May a piece of shadow hold a point of a ball? False is certain. centre: relative to the eye.
/// Cost: as sight_hides.
bool sight_may_hide(const struct sight *sight, const struct sight_piece *piece, struct vec3 centre,
                    uint32_t radius);

#endif
