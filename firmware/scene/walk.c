#include "scene/walk.h"

void walk_start(struct walk *walk, const struct tree *tree, const struct view *view) {
    walk->tree = tree;
    walk->view = view;
    walk->shapes = false;
    walk->depth = tree->header->node_count != 0U ? 1U : 0U;
    walk->level[0] = (struct walk_level){0, 1, false};
    walk->nodes_opened = 0;
    walk->sphere_tests = 0;
}

bool walk_next(struct walk *walk, struct walk_item *item) {
    while (walk->depth != 0U) {
        struct walk_level *const level = &walk->level[walk->depth - 1U];
        if (level->next == level->end) {
            walk->depth--;
            continue;
        }
        const struct tree_node *const node = &walk->tree->nodes[level->next++];
        const struct vec3 center = tree_center(node);
        bool inside = level->inside;
        walk->nodes_opened++;
        if (!inside) {
            const enum view_place place = view_place(walk->view, center, node->radius);
            walk->sphere_tests++;
            if (place == VIEW_OUTSIDE) {
                continue;
            }
            inside = place == VIEW_INSIDE;
        }
        const uint32_t radius_px_q8 = view_radius_px_q8(walk->view, center, node->radius);
        const struct tree_description *const d =
            view_choose(walk->tree, node, radius_px_q8, view_distance(walk->view->eye, center));
        const struct tree_shape *const shape =
            walk->shapes && tree_kind(d) != TREE_CENTER
                ? tree_shape_at(walk->tree, (uint32_t)(node - walk->tree->nodes))
                : NULL;
        if (tree_kind(d) == TREE_NODES && shape == NULL) { // tree_open has counted the levels
            walk->level[walk->depth++] = (struct walk_level){d->first, d->first + d->count, inside};
            continue;
        }
        *item = (struct walk_item){node, d, shape, !inside, radius_px_q8};
        return true;
    }
    return false;
}
