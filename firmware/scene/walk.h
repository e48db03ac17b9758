/// What of a scene a camera sees, and in which detail: a walk through the tree, one description
/// after the other.
#ifndef SCENE_WALK_H
#define SCENE_WALK_H

#include "scene/overlay.h"
#include "scene/view.h"

struct walk_level {
    uint32_t next, end; ///< nodes
    bool inside;        ///< their parent is in the pyramid: they need no test
};

struct walk {
    const struct tree *tree;
    const struct overlay *overlay; ///< NULL: everything is in its place
    const struct view *view;       ///< NULL: everything, in its finest description
    bool shapes; ///< set it after walk_start: a node with a shape is given as that, not in points
    uint32_t depth; ///< levels in use
    struct walk_level level[TREE_LEVELS_MAX];
    uint32_t item;        ///< of the overlay: whose tree the levels are in; else OVERLAY_NONE
    uint32_t items_depth; ///< in use of `pending`: nodes of the overlay
    struct {
        uint32_t node;
        bool inside;
    } pending[OVERLAY_LEVELS_MAX + 1U];
    uint32_t nodes_opened; ///< nodes looked at
    uint32_t sphere_tests; ///< of these, tested against the pyramid
};

/// Something to draw: points, a centre, or a shape.
struct walk_item {
    /// NULL for points of the caller's, which the overlay was given.
    const struct tree_node *node;
    const struct tree_description *description; ///< of the node: the one chosen
    const struct tree_shape *shape;             ///< NULL: none
    const struct tree_point *points;            ///< without a shape; NULL: the centre alone
    uint32_t point_count;
    uint32_t item;         ///< of the overlay; OVERLAY_NONE: in its place
    struct vec3 offset;    ///< to be added to every point: overlay_place
    struct vec3 center;    ///< of the sphere, moved already
    bool crossing;         ///< the border of the picture may cut it
    uint32_t radius_px_q8; ///< of the node's sphere; for TREE_CENTER it bounds the error
};

/// tree, overlay (NULL: none) and view (NULL: everything, in its finest description) must outlive
/// the walk.
void walk_start(struct walk *walk, const struct tree *tree, const struct overlay *overlay,
                const struct view *view);

/// The next item that may be seen. False: there are no more.
/// Cost: a test and a projection for each node whose parent crosses the border; below a node that
///       is inside only the projection.
/// Accuracy: no point in the pyramid is left out, and of each object exactly one description is
///       given (tests/property/scene_walk.c, scene_overlay.c).
bool walk_next(struct walk *walk, struct walk_item *item);

#endif
