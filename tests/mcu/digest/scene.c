/// A tree of spheres: its check, what of it a view takes, and the cone of all that it holds.
#include "mcu/digest/sets.h"

#include "fixed/root.h"
#include "scene/scene_aim.h"
#include "scene/walk.h"

#define LEAVES 12U
#define EACH   5U

static struct {
    struct tree_header header;
    struct tree_node node[1U + LEAVES];
    struct tree_description description[1U + 2U * LEAVES];
    struct tree_point point[LEAVES * EACH];
    struct tree_part part[1U + LEAVES];
    char names[2U * LEAVES];
} block;

static struct scene_aim_memory memory;

static uint32_t distance_up(const struct tree_node *node, const struct tree_point *point) {
    const struct vec3 apart = vec3(point->x - node->x, point->y - node->y, point->z - node->z);
    return root_u64(vec3_norm2(apart)) + 1U;
}

static void draw_leaf(struct digest *d, uint32_t leaf) {
    struct tree_node *const node = &block.node[1U + leaf];
    node->x = digest_within(d, 100000);
    node->y = digest_within(d, 100000);
    node->z = digest_within(d, 100000);
    node->radius = 0;
    node->first_description = 1U + 2U * leaf;
    node->description_count = 2;
    node->part = 1U + leaf;
    block.part[1U + leaf] = (struct tree_part){1U + leaf, 0, 2U * leaf, 0};
    block.description[1U + 2U * leaf] = (struct tree_description){.kind = TREE_CENTER, .count = 1};
    block.description[2U + 2U * leaf] =
        (struct tree_description){.threshold = 256U * (1U + digest_below(d, 20)),
                                  .kind = TREE_POINTS,
                                  .first = leaf * EACH,
                                  .count = EACH};
    for (uint32_t i = leaf * EACH; i < (leaf + 1U) * EACH; i++) {
        struct tree_point *const p = &block.point[i];
        p->x = node->x + digest_within(d, 3000);
        p->y = node->y + digest_within(d, 3000);
        p->z = node->z + digest_within(d, 3000);
        p->source = i;
        const uint32_t from_leaf = distance_up(node, p), from_root = distance_up(block.node, p);
        node->radius = from_leaf > node->radius ? from_leaf : node->radius;
        block.node[0].radius = from_root > block.node[0].radius ? from_root : block.node[0].radius;
    }
}

static struct tree draw_tree(struct digest *d) {
    block.node[0] = (struct tree_node){.description_count = 1};
    block.description[0] =
        (struct tree_description){.kind = TREE_NODES, .first = 1, .count = LEAVES};
    block.part[0] = (struct tree_part){0, TREE_NONE, TREE_NONE, 0};
    for (uint32_t leaf = 0; leaf < LEAVES; leaf++) {
        draw_leaf(d, leaf);
    }
    block.header = (struct tree_header){.magic = TREE_MAGIC,
                                        .version = TREE_VERSION,
                                        .size_bytes = sizeof block,
                                        .node_count = 1U + LEAVES,
                                        .description_count = 1U + 2U * LEAVES,
                                        .point_count = LEAVES * EACH,
                                        .level_count = 2,
                                        .source_count = LEAVES * EACH,
                                        .part_count = 1U + LEAVES,
                                        .name_bytes = sizeof block.names};
    const size_t covered = offsetof(struct tree_header, node_count);
    block.header.crc32 = tree_crc32(0, (const uint8_t *)&block + covered, sizeof block - covered);
    struct tree tree = {0};
    size_t fault_offset;
    CHECK_EQ(tree_open(&block, sizeof block, &tree, &fault_offset), TREE_OK);
    digest_u64(d, block.header.crc32);
    return tree;
}

static void walks(void) {
    struct digest d = digest_start(51);
    for (int i = 0; i < 600; i++) {
        const struct tree tree = draw_tree(&d);
        const struct vec3 ahead = vec3_normalise(digest_any_direction(&d));
        const struct vec3 right =
            vec3_i64_normalise(vec3_cross(ahead, vec3_normalise(digest_any_direction(&d))));
        const struct vec3 up = vec3_i64_normalise(vec3_cross(right, ahead));
        struct vec3 eye;
        eye.x = digest_within(&d, 200000);
        eye.y = digest_within(&d, 200000);
        eye.z = digest_within(&d, 200000);
        struct view view;
        view_set(&view, eye, right, ahead, up, 256U * (200U + digest_below(&d, 800)), 640, 480);
        struct walk walk;
        struct walk_item item;
        walk_start(&walk, &tree, NULL, &view);
        while (walk_next(&walk, &item)) {
            digest_u64(&d, (uint64_t)(item.node - tree.nodes));
            digest_u64(&d, item.description->kind);
            digest_u64(&d, item.crossing);
            digest_u64(&d, item.radius_px_q8);
        }
        digest_u64(&d, walk.sphere_tests);
    }
    digest_finish(&d, "digest scene/walk");
}

static void aims(void) {
    struct digest d = digest_start(53);
    for (int i = 0; i < 150; i++) {
        const struct tree tree = draw_tree(&d);
        struct scene_aim_options options = {.focal_px_q8 = i % 2 == 0 ? 0U : 256U * 500U};
        options.eye.x = digest_within(&d, 400000);
        options.eye.y = digest_within(&d, 400000);
        options.eye.z = digest_within(&d, 400000);
        struct scene_aim_result result;
        const enum scene_aim_status status = scene_aim(&tree, &options, &memory, &result);
        digest_i64(&d, status);
        if (status == SCENE_AIM_OK) {
            digest_vec3(&d, result.cone.axis_q30);
            digest_u64(&d, result.cone.half_angle_turn64);
            digest_u64(&d, result.loss_px_q8);
            digest_u64(&d, result.point_reads);
            for (uint8_t k = 0; k < result.cone.support_count; k++) {
                digest_u64(&d, result.reference[k]);
            }
        }
        digest_u64(&d, result.nodes_opened);
    }
    digest_finish(&d, "digest scene/aim");
}

#define ITEMS 10U
static uint64_t room[OVERLAY_WORKSPACE_BYTES(1U + LEAVES, ITEMS) / sizeof(uint64_t) + 1U];

static struct vec3 draw_offset(struct digest *d) {
    struct vec3 offset;
    offset.x = digest_within(d, 200000);
    offset.y = digest_within(d, 200000);
    offset.z = digest_within(d, 200000);
    return offset;
}

/// Any change; what cannot be is refused everywhere alike.
static void change(struct digest *d, struct overlay *overlay) {
    const uint32_t what = digest_below(d, 5), item = digest_below(d, ITEMS),
                   part = digest_below(d, 1U + LEAVES);
    const struct vec3 offset = draw_offset(d);
    uint32_t added = 0;
    switch (what) {
    case 0:
        digest_i64(d, overlay_set_away(overlay, part, digest_below(d, 2) != 0U));
        break;
    case 1:
        digest_i64(d, overlay_add_object(overlay, part, offset, &added));
        break;
    case 2:
        digest_i64(d, overlay_add_points(overlay, block.point, EACH, offset, &added));
        break;
    case 3:
        digest_i64(d, overlay_remove(overlay, item));
        break;
    default:
        digest_i64(d, overlay_move(overlay, item, offset));
        break;
    }
    digest_u64(d, added);
    digest_u64(d, overlay->nodes_touched);
    if (overlay_root(overlay) != OVERLAY_NONE) {
        digest_vec3(d, overlay->nodes[overlay->root].sphere.center);
        digest_u64(d, overlay->nodes[overlay->root].sphere.radius);
    }
}

static void overlays(void) {
    struct digest d = digest_start(59);
    for (int i = 0; i < 60; i++) {
        const struct tree tree = draw_tree(&d);
        struct overlay overlay;
        CHECK_EQ(overlay_open(&overlay, &tree, ITEMS, room, sizeof room), OVERLAY_OK);
        for (int k = 0; k < 60; k++) {
            change(&d, &overlay);
        }
        const struct scene_aim_options options = {.eye = draw_offset(&d), .overlay = &overlay};
        struct scene_aim_result result;
        const enum scene_aim_status status = scene_aim(&tree, &options, &memory, &result);
        digest_i64(&d, status);
        if (status == SCENE_AIM_OK) {
            digest_vec3(&d, result.cone.axis_q30);
            digest_u64(&d, result.item[0]);
        }
        digest_u64(&d, result.nodes_opened);
        struct view view;
        struct walk walk;
        struct walk_item item;
        view_set(&view, options.eye, vec3(Q30_ONE, 0, 0), vec3(0, Q30_ONE, 0), vec3(0, 0, Q30_ONE),
                 256U * 400U, 640, 480);
        walk_start(&walk, &tree, &overlay, &view);
        while (walk_next(&walk, &item)) {
            digest_u64(&d, item.item);
            digest_vec3(&d, item.center);
        }
    }
    digest_finish(&d, "digest scene/overlay");
}

int main(void) {
    TEST(walks);
    TEST(aims);
    TEST(overlays);
    return check_finish();
}
