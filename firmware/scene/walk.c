#include "scene/walk.h"

void walk_start(struct walk *walk, const struct tree *tree, const struct overlay *overlay,
                const struct view *view) {
    walk->tree = tree;
    walk->overlay = overlay;
    walk->view = view;
    walk->shapes = false;
    walk->depth = tree->header->node_count != 0U ? 1U : 0U;
    walk->level[0] = (struct walk_level){0, 1, false};
    walk->item = OVERLAY_NONE;
    walk->items_depth = 0;
    if (overlay_root(overlay) != OVERLAY_NONE) {
        walk->pending[walk->items_depth].node = overlay_root(overlay);
        walk->pending[walk->items_depth++].inside = false;
    }
    walk->nodes_opened = 0;
    walk->sphere_tests = 0;
}

/// Can anything of it be seen? *inside: its parent is inside; becomes whether it is.
static bool is_seen(struct walk *walk, struct vec3 center, uint32_t radius, bool *inside) {
    walk->nodes_opened++;
    if (walk->view != NULL && !*inside) {
        const enum view_place place = view_place(walk->view, center, radius);
        walk->sphere_tests++;
        *inside = place == VIEW_INSIDE;
        return place != VIEW_OUTSIDE;
    }
    return true;
}

/// As large as it appears; of everything at once the largest.
static uint32_t radius_px_q8_of(const struct walk *walk, struct vec3 center, uint32_t radius) {
    return walk->view == NULL ? UINT32_MAX : view_radius_px_q8(walk->view, center, radius);
}

/// The next node of the tree in the file. False: it has children, or can't be seen.
static bool visit(struct walk *walk, struct walk_item *out) {
    struct walk_level *const level = &walk->level[walk->depth - 1U];
    const uint32_t index = level->next++;
    const struct tree_node *const node = &walk->tree->nodes[index];
    const bool in_place = walk->item == OVERLAY_NONE;
    const struct vec3 offset = in_place ? vec3(0, 0, 0) : walk->overlay->items[walk->item].offset;
    const struct vec3 center = overlay_place(tree_center(node), offset);
    bool inside = level->inside;
    if ((in_place && overlay_is_away(walk->overlay, node->part)) ||
        !is_seen(walk, center, node->radius, &inside)) {
        return false;
    }
    const uint32_t radius_px_q8 = radius_px_q8_of(walk, center, node->radius);
    const uint32_t distance = walk->view == NULL ? 0U : view_distance(walk->view->eye, center);
    const struct tree_description *const d = view_choose(walk->tree, node, radius_px_q8, distance);
    const enum tree_kind kind = tree_kind(d);
    const struct tree_shape *const shape =
        walk->shapes && kind != TREE_CENTER ? tree_shape_at(walk->tree, index) : NULL;
    if (kind == TREE_NODES && shape == NULL) { // tree_open has counted the levels
        walk->level[walk->depth++] = (struct walk_level){d->first, d->first + d->count, inside};
        return false;
    }
    *out = (struct walk_item){.node = node,
                              .description = d,
                              .shape = shape,
                              .item = walk->item,
                              .offset = offset,
                              .center = center,
                              .crossing = !inside,
                              .radius_px_q8 = radius_px_q8};
    if (kind == TREE_POINTS && shape == NULL) {
        out->points = &walk->tree->points[d->first];
        out->point_count = d->count;
    }
    return true;
}

/// The next node of the overlay. False: it has children, can't be seen, or is an object of the
/// file, whose tree the levels are in now.
static bool visit_overlay(struct walk *walk, struct walk_item *out) {
    walk->items_depth--;
    const struct overlay_node *const node =
        &walk->overlay->nodes[walk->pending[walk->items_depth].node];
    bool inside = walk->pending[walk->items_depth].inside;
    if (node->child[0] != OVERLAY_NONE) {
        for (unsigned i = 0; i < 2U && (i != 0U || is_seen(walk, node->sphere.center,
                                                           node->sphere.radius, &inside));
             i++) {
            walk->pending[walk->items_depth].node = node->child[i];
            walk->pending[walk->items_depth++].inside = inside;
        }
        return false;
    }
    const struct overlay_item *const item = &walk->overlay->items[node->child[1]];
    if (item->points == NULL) { // the object's own node is looked at next
        const uint32_t at = walk->tree->parts[item->part_or_count].node;
        walk->item = node->child[1];
        walk->level[walk->depth++] = (struct walk_level){at, at + 1U, inside};
        return false;
    }
    if (!is_seen(walk, node->sphere.center, node->sphere.radius, &inside)) {
        return false;
    }
    *out = (struct walk_item){.points = item->points,
                              .point_count = item->part_or_count,
                              .item = node->child[1],
                              .offset = item->offset,
                              .center = node->sphere.center,
                              .crossing = !inside,
                              .radius_px_q8 =
                                  radius_px_q8_of(walk, node->sphere.center, node->sphere.radius)};
    return true;
}

bool walk_next(struct walk *walk, struct walk_item *item) {
    for (;;) {
        if (walk->depth != 0U) {
            const struct walk_level *const level = &walk->level[walk->depth - 1U];
            if (level->next == level->end) {
                walk->depth--;
            } else if (visit(walk, item)) {
                return true;
            }
        } else if (walk->items_depth == 0U) {
            return false;
        } else if (visit_overlay(walk, item)) {
            return true;
        }
    }
}
