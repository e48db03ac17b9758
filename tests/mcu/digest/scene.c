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
    node->part = TREE_NONE;
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
    block.node[0] = (struct tree_node){.description_count = 1, .part = TREE_NONE};
    block.description[0] =
        (struct tree_description){.kind = TREE_NODES, .first = 1, .count = LEAVES};
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
                                        .source_count = LEAVES * EACH};
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
        walk_start(&walk, &tree, &view);
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

int main(void) {
    TEST(walks);
    TEST(aims);
    return check_finish();
}
