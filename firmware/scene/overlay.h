/// Objects that move, appear and vanish in a scene, in RAM over the tree in its file.
///
/// An object of the file can be away from its place; then walks and aiming leave it out. An *item*
/// is a thing at a place of its own: an object of the file moved by an offset (the same object may
/// be there several times), or points of the caller's. To move an object is to take it away from
/// its place and to add it as an item. Items are the leaves of a second tree of spheres, balanced,
/// whose nodes hold the spheres of their two children.
///
/// A change touches only ancestors: of an object the clusters above it that become empty or are not
/// any more; of an item the nodes above it, and where the tree gets out of balance their children.
/// The file is not written and need not be copied.
///
/// Shown: tests/property/scene_overlay.c (10^6 random changes against a tree built anew).
#ifndef SCENE_OVERLAY_H
#define SCENE_OVERLAY_H

#include "fixed/must_check.h"
#include "scene/tree.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define OVERLAY_NONE      UINT32_MAX
#define OVERLAY_ITEMS_MAX (UINT32_C(1) << 20)
/// No path from the root down has more nodes: a tree in which no two siblings' heights differ by
/// more than one has at least as many leaves as the Fibonacci number of its levels' number, plus
/// one; for 2^20 leaves that is 29 levels.
#define OVERLAY_LEVELS_MAX 32U

struct overlay_sphere {
    struct vec3 center;
    uint32_t radius;
};

struct overlay_item {
    const struct tree_point *points; ///< the caller's; NULL: an object of the file
    uint32_t part_or_count;          ///< the object, or how many points
    struct vec3 offset;              ///< added to every point
    uint32_t leaf; ///< its node; of a free item the next free one, with OVERLAY_FREE
};
#define OVERLAY_FREE UINT32_C(0x80000000)

struct overlay_node {
    struct overlay_sphere sphere;
    uint32_t parent;   ///< OVERLAY_NONE of the root; of a free node the next free one
    uint32_t child[2]; ///< of a leaf OVERLAY_NONE and the item
    uint32_t height;   ///< 0 of a leaf
};

struct overlay {
    const struct tree *tree;
    uint32_t *away; ///< a bit a part: objects away from their place, clusters without anything left
    struct overlay_item *items;
    struct overlay_node *nodes;
    uint32_t item_room, root, free_item, free_node;
    uint32_t item_count;    ///< in use
    uint64_t nodes_touched; ///< since overlay_open: how many nodes changes have written
};

/// Bytes of workspace, aligned to 8, for a tree with so many parts and for so many items at a time.
#define OVERLAY_WORKSPACE_BYTES(parts, items)                                                      \
    ((((size_t)(parts) + 63U) / 64U) * 8U +                                                        \
     (size_t)(items) * (sizeof(struct overlay_item) + 2U * sizeof(struct overlay_node)))

enum overlay_status {
    OVERLAY_OK = 0,
    OVERLAY_ERROR_WORKSPACE = -1, ///< too small, or items > OVERLAY_ITEMS_MAX
    OVERLAY_ERROR_CAPACITY = -2,  ///< as many items as there may be
    OVERLAY_ERROR_OBJECT = -3,    ///< no object of the file, no item, or no points
    OVERLAY_ERROR_RANGE = -4      ///< would be beyond TREE_COORDINATE_MAX
};

/// Everything in its place, no items. tree and workspace must outlive the overlay.
enum overlay_status overlay_open(struct overlay *overlay, const struct tree *tree, uint32_t items,
                                 void *workspace, size_t workspace_bytes) MUST_CHECK;

/// Takes an object away from its place, or puts it back. part: of the tree, with a name.
/// Cost: the children of each cluster above it that changes.
enum overlay_status overlay_set_away(struct overlay *overlay, uint32_t part, bool away) MUST_CHECK;

/// Adds an object of the file once more, moved by an offset, whether it is in its place or away.
/// Cost: a path down and up the tree of items: at most OVERLAY_LEVELS_MAX nodes each.
enum overlay_status overlay_add_object(struct overlay *overlay, uint32_t part, struct vec3 offset,
                                       uint32_t *item) MUST_CHECK;

/// Adds points of the caller's, which must stay as they are until the item is removed.
/// Cost: as above, and two passes over the points.
enum overlay_status overlay_add_points(struct overlay *overlay, const struct tree_point *points,
                                       uint32_t count, struct vec3 offset,
                                       uint32_t *item) MUST_CHECK;

/// Moves an item to another offset; after an error it is where it was. Cost: as overlay_add_object.
enum overlay_status overlay_move(struct overlay *overlay, uint32_t item,
                                 struct vec3 offset) MUST_CHECK;

/// Cost: the path up.
enum overlay_status overlay_remove(struct overlay *overlay, uint32_t item) MUST_CHECK;

/// Is the part away? overlay may be NULL: nothing is.
static inline bool overlay_is_away(const struct overlay *overlay, uint32_t part) {
    return overlay != NULL && part != TREE_NONE &&
           (overlay->away[part / 32U] >> part % 32U & 1U) != 0U;
}

/// The node where a walk of the items begins; OVERLAY_NONE: there are none.
static inline uint32_t overlay_root(const struct overlay *overlay) {
    return overlay != NULL ? overlay->root : OVERLAY_NONE;
}

/// A place moved by an offset; beyond TREE_COORDINATE_MAX, where only a damaged file has anything,
/// it stays there.
static inline struct vec3 overlay_place(struct vec3 p, struct vec3 offset) {
    const int64_t most = TREE_COORDINATE_MAX;
    const int64_t x = (int64_t)p.x + offset.x, y = (int64_t)p.y + offset.y,
                  z = (int64_t)p.z + offset.z;
    return vec3((int32_t)(x < -most  ? -most
                          : x > most ? most
                                     : x),
                (int32_t)(y < -most  ? -most
                          : y > most ? most
                                     : y),
                (int32_t)(z < -most  ? -most
                          : z > most ? most
                                     : z));
}

#endif
