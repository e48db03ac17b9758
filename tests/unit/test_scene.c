/// A small tree by hand: what the file may be, what a view takes of it, what an overlay changes.
/// tests/property/scene_*.c have the rest.
#include "check.h"

#include "scene/scene_aim.h"
#include "scene/walk.h"

/// Two rows of two objects with two points each, at x = -30, -10, 10, 30 and y = 100.
enum { OBJECTS = 4, NODES = 7 };

static struct {
    struct tree_header header;
    struct tree_node node[NODES];
    struct tree_description description[NODES];
    struct tree_point point[2 * OBJECTS];
    struct tree_part part[NODES];
    struct tree_shape shape[1];
    struct tree_element element[1];
    uint32_t corner[2];
    char names[8];
} block;

static struct scene_aim_memory memory;
static struct tree tree;
static size_t fault_offset;

static enum tree_status open_block(void) {
    const size_t covered = offsetof(struct tree_header, node_count);
    block.header.crc32 = tree_crc32(0, (const uint8_t *)&block + covered, sizeof block - covered);
    return tree_open(&block, sizeof block, &tree, &fault_offset);
}

static void make_node(uint32_t node, int32_t x, uint32_t radius, uint32_t parent, uint32_t name) {
    block.node[node] = (struct tree_node){x, 100, 0, radius, node, 1, node};
    block.part[node] = (struct tree_part){node, parent, name, node};
}

static void make_block(void) {
    make_node(0, 0, 32, TREE_NONE, TREE_NONE);
    make_node(1, -20, 12, 0, TREE_NONE);
    make_node(2, 20, 12, 0, TREE_NONE);
    for (uint32_t i = 0; i < 3U; i++) {
        block.description[i] =
            (struct tree_description){.kind = TREE_NODES, .first = 1U + 2U * i, .count = 2};
    }
    for (uint32_t i = 0; i < OBJECTS; i++) {
        const int32_t x = -30 + 20 * (int32_t)i;
        make_node(3U + i, x, 2, 1U + i / 2U, 2U * i);
        block.description[3U + i] =
            (struct tree_description){.kind = TREE_POINTS, .first = 2U * i, .count = 2};
        block.point[2U * i] = (struct tree_point){x, 100, -1, 2U * i};
        block.point[2U * i + 1U] = (struct tree_point){x, 100, 1, 2U * i + 1U};
        block.names[2U * i] = (char)('a' + (int)i);
        block.names[2U * i + 1U] = '\0';
    }
    block.shape[0] = (struct tree_shape){5, TREE_LINES, 0, 1};
    block.element[0] = (struct tree_element){TREE_LINE, 0, 2};
    block.corner[0] = 4;
    block.corner[1] = 5;
    block.header = (struct tree_header){.magic = TREE_MAGIC,
                                        .version = TREE_VERSION,
                                        .size_bytes = sizeof block,
                                        .node_count = NODES,
                                        .description_count = NODES,
                                        .point_count = 2U * OBJECTS,
                                        .level_count = 3,
                                        .source_count = 2U * OBJECTS,
                                        .part_count = NODES,
                                        .shape_count = 1,
                                        .element_count = 1,
                                        .corner_count = 2,
                                        .name_bytes = sizeof block.names};
    CHECK_EQ(open_block(), TREE_OK);
}

static void names_and_shapes(void) {
    make_block();
    CHECK_EQ(tree_find_part(&tree, "c"), 5U);
    CHECK_EQ(tree_find_part(&tree, "e"), TREE_NONE);
    CHECK_EQ(tree_find_part(&tree, ""), TREE_NONE);
    CHECK(tree_shape_at(&tree, 5) == &block.shape[0]);
    CHECK(tree_shape_at(&tree, 4) == NULL);
    CHECK(tree_shape_at(&tree, 6) == NULL);
}

/// A word of the block that is not what it should be: refused; of what hangs on nothing else at its
/// own place.
static void wrong_words(void) {
    static const struct {
        size_t offset;
        uint32_t value;
    } wrong[] = {
        {offsetof(struct tree_header, level_count), 4},
        {offsetof(struct tree_header, node_count), 8},
        {64 + offsetof(struct tree_node, part), 1},
        {64 + offsetof(struct tree_node, part), TREE_NONE},
        {64 + 28 * 3 + offsetof(struct tree_node, part), TREE_NONE},
        {64 + 28 * 3 + offsetof(struct tree_node, radius), UINT32_C(1) << 31},
        {64 + 28 * 7 + offsetof(struct tree_description, threshold), 1},
        {64 + 28 * 7 + offsetof(struct tree_description, kind), 3},
        {64 + 28 * 7 + offsetof(struct tree_description, count), 0},
        {64 + 28 * 7 + offsetof(struct tree_description, count), 3},
        {64 + 44 * 7, UINT32_C(1) << 30},
        {64 + 44 * 7 + 12, 2 * OBJECTS},
        {64 + 44 * 7 + 128 + offsetof(struct tree_part, parent), 0},
        {64 + 44 * 7 + 128 + 16 * 3 + offsetof(struct tree_part, parent), 2},
        {64 + 44 * 7 + 128 + 16 * 3 + offsetof(struct tree_part, name), 8},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        make_block();
        uint32_t *const word = (uint32_t *)(void *)((uint8_t *)&block + wrong[i].offset);
        *word = wrong[i].value;
        CHECK(open_block() != TREE_OK);
        CHECK(fault_offset < sizeof block);
    }
    make_block();
    block.shape[0].kind = TREE_LINES + 1U;
    CHECK_EQ(open_block(), TREE_ERROR_STRUCTURE);
    CHECK_EQ(fault_offset, (size_t)((uint8_t *)&block.shape[0] - (uint8_t *)&block));
    make_block();
    block.element[0].kind = TREE_FACE;
    CHECK_EQ(open_block(), TREE_ERROR_STRUCTURE);
    CHECK_EQ(fault_offset, (size_t)((uint8_t *)&block.element[0] - (uint8_t *)&block));
    make_block();
    block.corner[1] = 2U * OBJECTS;
    CHECK_EQ(open_block(), TREE_ERROR_STRUCTURE);
    CHECK_EQ(fault_offset, (size_t)((uint8_t *)&block.corner[1] - (uint8_t *)&block));
    make_block();
    block.names[7] = 'x';
    CHECK_EQ(open_block(), TREE_ERROR_STRUCTURE);
    block.names[7] = '\0';
    CHECK_EQ(open_block(), TREE_OK);
}

static void by_distance(void) {
    static const struct tree_description list[4] = {
        {UINT32_MAX, TREE_CENTER | TREE_BY_DISTANCE, 0, 1},
        {500, TREE_CENTER | TREE_BY_DISTANCE, 0, 1},
        {20, TREE_CENTER | TREE_BY_DISTANCE, 0, 1},
        {0, TREE_CENTER | TREE_BY_DISTANCE, 0, 1}};
    const struct tree_node node = {0, 0, 0, 5, 0, 4, TREE_NONE};
    const struct tree here = {.descriptions = list};
    static const uint32_t from[6] = {501, 500, 21, 20, 1, 0}, wanted[6] = {0, 1, 1, 2, 2, 3};
    for (unsigned i = 0; i < 6U; i++) {
        // Whatever the radius is.
        CHECK(view_choose(&here, &node, i, from[i]) == &list[wanted[i]]);
    }
    CHECK_EQ(view_distance(vec3(0, 0, 0), vec3(3, 4, 0)), 5U);
    CHECK_EQ(view_distance(vec3(0, 0, 0), vec3(1, 1, 1)), 2U);
    const int32_t most = TREE_COORDINATE_MAX;
    CHECK_EQ(view_distance(vec3(-most, -most, -most), vec3(most, most, most)), 3719550784U);
}

static struct view look_from(struct vec3 eye) {
    struct view view;
    view_set(&view, eye, vec3(Q30_ONE, 0, 0), vec3(0, Q30_ONE, 0), vec3(0, 0, Q30_ONE), 500U * 256U,
             640, 480);
    return view;
}

struct found {
    uint32_t items, points, opened, tested;
};

static struct found walk_all(const struct overlay *overlay, struct vec3 eye) {
    const struct view view = look_from(eye);
    struct walk walk;
    struct walk_item item;
    struct found found = {0, 0, 0, 0};
    walk_start(&walk, &tree, overlay, &view);
    while (walk_next(&walk, &item)) {
        found.items++;
        found.points += item.point_count;
    }
    found.opened = walk.nodes_opened;
    found.tested = walk.sphere_tests;
    return found;
}

/// Below a sphere that is inside nothing is tested; beside the picture nothing is opened.
static void inside_is_not_tested_again(void) {
    make_block();
    struct found found = walk_all(NULL, vec3(0, -500, 0));
    CHECK_EQ(found.points, 8U);
    CHECK_EQ(found.opened, 7U);
    CHECK_EQ(found.tested, 1U);
    // Only the left half: the right cluster is tested and left.
    found = walk_all(NULL, vec3(-60, 40, 0));
    CHECK_EQ(found.points, 4U);
    CHECK_EQ(found.tested, 5U);
    found = walk_all(NULL, vec3(0, 500, 0));
    CHECK_EQ(found.points, 0U);
    CHECK_EQ(found.tested, 1U);
}

static void shapes_instead_of_points(void) {
    make_block();
    const struct view view = look_from(vec3(0, -500, 0));
    struct walk walk;
    struct walk_item item;
    uint32_t shapes = 0, points = 0;
    walk_start(&walk, &tree, NULL, &view);
    walk.shapes = true;
    while (walk_next(&walk, &item)) {
        shapes += item.shape != NULL ? 1U : 0U;
        points += item.point_count;
    }
    CHECK_EQ(shapes, 1U);
    CHECK_EQ(points, 6U);
}

static uint64_t workspace[OVERLAY_WORKSPACE_BYTES(NODES, 3) / sizeof(uint64_t) + 1U];
static struct overlay overlay;

static void open_overlay(void) {
    make_block();
    CHECK_EQ(overlay_open(&overlay, &tree, 3, workspace, 64), OVERLAY_ERROR_WORKSPACE);
    CHECK_EQ(overlay_open(&overlay, &tree, 3, workspace, sizeof workspace), OVERLAY_OK);
}

static void clusters_become_empty(void) {
    open_overlay();
    const uint32_t a = tree_find_part(&tree, "a"), b = tree_find_part(&tree, "b");
    CHECK_EQ(overlay_set_away(&overlay, 0, true), OVERLAY_ERROR_OBJECT); // a cluster
    CHECK_EQ(overlay_set_away(&overlay, NODES, true), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(overlay_set_away(&overlay, a, true), OVERLAY_OK);
    CHECK(overlay_is_away(&overlay, a) && !overlay_is_away(&overlay, 1));
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).points, 6U);
    CHECK_EQ(overlay_set_away(&overlay, b, true), OVERLAY_OK);
    CHECK(overlay_is_away(&overlay, 1) && !overlay_is_away(&overlay, 0));
    // Its parts are not even looked at.
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).opened, 4U);
    CHECK_EQ(overlay_set_away(&overlay, tree_find_part(&tree, "c"), true), OVERLAY_OK);
    CHECK_EQ(overlay_set_away(&overlay, tree_find_part(&tree, "d"), true), OVERLAY_OK);
    CHECK(overlay_is_away(&overlay, 0));
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).opened, 0U);
    struct scene_aim_options options = {.overlay = &overlay};
    struct scene_aim_result result;
    CHECK_EQ(scene_aim(&tree, &options, &memory, &result), SCENE_AIM_EMPTY);
    CHECK_EQ(overlay_set_away(&overlay, b, false), OVERLAY_OK);
    CHECK(!overlay_is_away(&overlay, 0) && !overlay_is_away(&overlay, 1));
    CHECK(overlay_is_away(&overlay, 2));
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).points, 2U);
    CHECK_EQ(scene_aim(&tree, &options, &memory, &result), SCENE_AIM_OK);
    CHECK_EQ(result.reference[0], 2U);
    CHECK_EQ(result.item[0], OVERLAY_NONE);
}

static void items_come_and_go(void) {
    static const struct tree_point own[2] = {{0, 50, 3, 0}, {0, 50, 5, 1}};
    open_overlay();
    const uint32_t d = tree_find_part(&tree, "d");
    uint32_t item[4];
    CHECK_EQ(overlay_add_object(&overlay, 0, vec3(0, 0, 0), &item[0]), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(overlay_add_object(&overlay, d, vec3(TREE_COORDINATE_MAX - 30, 0, 0), &item[0]),
             OVERLAY_ERROR_RANGE);
    CHECK_EQ(overlay_add_object(&overlay, d, vec3(0, 0, 20), &item[0]), OVERLAY_OK);
    CHECK_EQ(overlay_add_object(&overlay, d, vec3(0, 0, -20), &item[1]), OVERLAY_OK);
    CHECK_EQ(overlay_add_points(&overlay, own, 0, vec3(0, 0, 0), &item[2]), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(overlay_add_points(&overlay, own, 2, vec3(0, 50, 0), &item[2]), OVERLAY_OK);
    CHECK_EQ(overlay_add_points(&overlay, own, 2, vec3(0, 50, 0), &item[3]),
             OVERLAY_ERROR_CAPACITY);
    struct found found = walk_all(&overlay, vec3(0, -500, 0));
    CHECK_EQ(found.items, 7U);
    CHECK_EQ(found.points, 14U);
    CHECK_EQ(overlay_set_away(&overlay, d, true), OVERLAY_OK); // its items stay
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).points, 12U);
    CHECK_EQ(overlay_move(&overlay, item[1], vec3(-90, -70, 0)), OVERLAY_OK);
    CHECK_EQ(overlay_move(&overlay, item[1], vec3(INT32_MIN, 0, 0)), OVERLAY_ERROR_RANGE);
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).points, 12U);

    // Of all: the object moved to (-60, 30), and the other one at (30, 100, 20).
    struct scene_aim_options options = {.overlay = &overlay};
    struct scene_aim_result result;
    CHECK_EQ(scene_aim(&tree, &options, &memory, &result), SCENE_AIM_OK);
    bool left = false, right = false;
    for (uint8_t i = 0; i < result.cone.support_count; i++) {
        left = left || result.item[i] == item[1];
        right = right || result.item[i] == item[0];
    }
    CHECK(left && right);
    options.eye = vec3(-60, 30, 1);
    CHECK_EQ(scene_aim(&tree, &options, &memory, &result), SCENE_AIM_AT_VIEWPOINT);
    CHECK_EQ(result.item[0], item[1]);
    CHECK_EQ(result.reference[0], 7U);

    CHECK_EQ(overlay_remove(&overlay, item[1]), OVERLAY_OK);
    CHECK_EQ(overlay_remove(&overlay, item[1]), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(overlay_move(&overlay, item[1], vec3(0, 0, 0)), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(overlay_remove(&overlay, OVERLAY_NONE), OVERLAY_ERROR_OBJECT);
    CHECK_EQ(walk_all(&overlay, vec3(0, -500, 0)).points, 10U);
    CHECK_EQ(overlay_remove(&overlay, item[0]), OVERLAY_OK);
    CHECK_EQ(overlay_remove(&overlay, item[2]), OVERLAY_OK);
    CHECK_EQ(overlay_root(&overlay), OVERLAY_NONE);
    for (unsigned i = 0; i < 3U; i++) {
        CHECK_EQ(overlay_add_object(&overlay, d, vec3(0, 0, (int32_t)i), &item[i]), OVERLAY_OK);
    }
    CHECK_EQ(overlay.item_count, 3U);
}

/// A tree without anything: only the caller's points.
static void over_nothing(void) {
    static const struct tree_point own[1] = {{7, 50, 3, 0}};
    const struct tree_header empty = {.magic = TREE_MAGIC,
                                      .version = TREE_VERSION,
                                      .size_bytes = sizeof empty,
                                      .crc32 = tree_crc32(0, (const uint8_t[48]){0}, 48)};
    struct tree nothing;
    CHECK_EQ(tree_open(&empty, sizeof empty, &nothing, &fault_offset), TREE_OK);
    CHECK_EQ(overlay_open(&overlay, &nothing, 1, workspace, sizeof workspace), OVERLAY_OK);
    const struct scene_aim_options options = {.overlay = &overlay};
    struct scene_aim_result result;
    CHECK_EQ(scene_aim(&nothing, &options, &memory, &result), SCENE_AIM_EMPTY);
    uint32_t item;
    CHECK_EQ(overlay_add_points(&overlay, own, 1, vec3(0, 0, 0), &item), OVERLAY_OK);
    CHECK_EQ(scene_aim(&nothing, &options, &memory, &result), SCENE_AIM_OK);
    CHECK_EQ(result.item[0], item);
}

int main(void) {
    TEST(names_and_shapes);
    TEST(wrong_words);
    TEST(by_distance);
    TEST(inside_is_not_tested_again);
    TEST(shapes_instead_of_points);
    TEST(clusters_become_empty);
    TEST(items_come_and_go);
    TEST(over_nothing);
    return check_finish();
}
