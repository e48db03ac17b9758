/// tree_open on damaged blocks: every bit of some files flipped, with the checksum as it was and
/// made right again, and cut short; whatever is accepted is walked and aimed at. SEED=N.
#include "check.h"
#include "property/support/scene_sets.h"
#include "property/support/solid_check.h"

#include "scene/scene_aim.h"
#include "scene/walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed;
static struct scene_aim_memory memory;
static unsigned long accepted, refused;

static void set_crc(unsigned char *block, size_t size) {
    const size_t covered = offsetof(struct tree_header, node_count);
    const uint32_t crc = tree_crc32(0, block + covered, size - covered);
    memcpy(block + offsetof(struct tree_header, crc32), &crc, sizeof crc);
}

/// Uses a tree in every way; each must end.
static void use(const struct tree *tree) {
    const struct vec3 eye = vec3(1 << 28, -(1 << 27), 1 << 26);
    for (uint32_t focal = 0; focal <= 100U * 256U; focal += 50U * 256U) {
        const struct scene_aim_options options = {.eye = eye,
                                                  .focal_px_q8 = focal,
                                                  .warm = (const uint32_t[4]){0, 7, 1U << 31, ~0U},
                                                  .warm_count = 4};
        struct scene_aim_result result;
        const enum scene_aim_status status = scene_aim(tree, &options, &memory, &result);
        CHECK(status != SCENE_AIM_UNFINISHED);
    }
    struct view view;
    struct walk walk;
    struct walk_item item;
    view_set(&view, eye, vec3(0, -Q30_ONE, 0), vec3(-Q30_ONE, 0, 0), vec3(0, 0, Q30_ONE),
             300U * 256U, 640, 480);
    walk_start(&walk, tree, NULL, &view);
    uint64_t points = 0;
    while (walk_next(&walk, &item)) {
        for (uint32_t i = 0;
             tree_kind(item.description) == TREE_POINTS && i < item.description->count; i++) {
            points += (uint64_t)tree->points[item.description->first + i].source;
        }
    }
    CHECK(walk.nodes_opened <= tree->header->node_count);
    CHECK(points <= UINT64_MAX / 2U);
}

static void try_block(const void *block, size_t size) {
    struct tree tree;
    size_t offset = SIZE_MAX;
    if (tree_open(block, size, &tree, &offset) == TREE_OK) {
        accepted++;
        use(&tree);
    } else {
        refused++;
        CHECK(offset <= size);
    }
}

/// A copy that ends where the block ends, so that the sanitizers see a read beyond.
static void every_bit(void) {
    for (int shape = 0; shape < SCENE_SHAPE_COUNT && check_clean(); shape++) {
        const struct scene_set set = {(enum scene_shape)shape, 40, 4, false};
        struct scene_text scene = scene_set_draw(&set, &seed);
        void *block;
        struct tree tree;
        const size_t size = scene_set_open(&scene, &scene_build_default, &block, &tree);
        use(&tree);
        unsigned char *const copy = malloc(size);
        for (size_t bit = 0; bit < 8U * size && check_clean(); bit++) {
            memcpy(copy, block, size);
            copy[bit / 8U] ^= (unsigned char)(1U << (bit % 8U));
            size_t offset;
            CHECK(tree_open(copy, size, &tree, &offset) != TREE_OK);
            set_crc(copy, size);
            try_block(copy, size);
        }
        free(copy);
        free(block);
        scene_text_free(&scene);
    }
    printf("# with the checksum made right: %lu accepted, %lu refused\n", accepted, refused);
}

/// Several fields wrong at once, and lengths that do not fit.
static void many_fields(void) {
    const struct scene_set set = {SCENE_DETAIL, 60, 6, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    void *block;
    struct tree tree;
    const size_t size = scene_set_open(&scene, &scene_build_default, &block, &tree);
    for (int i = 0; i < 20000 && check_clean(); i++) {
        uint32_t *const copy = malloc(size);
        memcpy(copy, block, size);
        for (uint32_t k = 0; k <= solid_below(&seed, 4); k++) {
            copy[4U + solid_below(&seed, (uint32_t)size / 4U - 4U)] =
                solid_below(&seed, 2) != 0U ? solid_below(&seed, 60)
                                            : (uint32_t)check_random(&seed);
        }
        set_crc((unsigned char *)copy, size);
        try_block(copy, size);
        free(copy);
    }
    for (size_t part = 0; part < size && check_clean(); part++) {
        unsigned char *const copy = malloc(part + 1U);
        size_t offset;
        memcpy(copy, block, part);
        CHECK(tree_open(copy, part, &tree, &offset) != TREE_OK);
        free(copy);
    }
    free(block);
    scene_text_free(&scene);
}

/// Does each sphere hold all points below it? And is there as much of it as can be asked for?
static void spheres_hold_their_points(void) {
    for (int shape = 0; shape < SCENE_SHAPE_COUNT && check_clean(); shape++) {
        const struct scene_set set = {(enum scene_shape)shape, 3000, 30, false};
        struct scene_text scene = scene_set_draw(&set, &seed);
        void *block;
        struct tree tree;
        scene_set_open(&scene, &scene_build_default, &block, &tree);
        const uint32_t nodes = tree.header->node_count;
        uint32_t *const parent = malloc(nodes * sizeof *parent);
        for (uint32_t i = 0; i < nodes; i++) {
            for (uint32_t k = 0; k < tree.nodes[i].description_count; k++) {
                const struct tree_description *const d =
                    &tree.descriptions[tree.nodes[i].first_description + k];
                for (uint32_t c = 0; c < d->count; c++) {
                    if (tree_kind(d) == TREE_NODES) {
                        parent[d->first + c] = i;
                        continue;
                    }
                    const struct tree_point *const p = &tree.points[d->first + c];
                    for (uint32_t n = i; tree_kind(d) == TREE_POINTS; n = parent[n]) {
                        const double x = (double)p->x - tree.nodes[n].x,
                                     y = (double)p->y - tree.nodes[n].y,
                                     z = (double)p->z - tree.nodes[n].z, r = tree.nodes[n].radius;
                        CHECK(x * x + y * y + z * z <= r * r);
                        if (n == 0U) {
                            break;
                        }
                    }
                }
            }
        }
        free(parent);
        free(block);
        scene_text_free(&scene);
    }
}

/// Marks what is below a node, in all descriptions.
static void mark(const struct tree *tree, uint32_t node, bool *below) {
    for (uint32_t k = 0; k < tree->nodes[node].description_count; k++) {
        const struct tree_description *const d =
            &tree->descriptions[tree->nodes[node].first_description + k];
        for (uint32_t i = d->first; i < d->first + d->count; i++) {
            if (tree_kind(d) == TREE_NODES) {
                mark(tree, i, below);
            } else if (tree_kind(d) == TREE_POINTS) {
                below[tree->points[i].source] = true;
            }
        }
    }
}

/// Is there a node with these vertices below it and no others?
static bool is_node(const struct tree *tree, const bool *wanted, uint32_t count) {
    bool *const below = malloc(count * sizeof *below);
    bool found = false;
    for (uint32_t node = 0; node < tree->header->node_count && !found; node++) {
        memset(below, 0, count * sizeof *below);
        mark(tree, node, below);
        found = memcmp(below, wanted, count * sizeof *below) == 0;
    }
    free(below);
    return found;
}

/// The user's groups and objects are nodes, whatever is clustered around and below them.
static void clusters_are_kept(void) {
    const struct scene_set set = {SCENE_DETAIL, 600, 24, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    void *block;
    struct tree tree;
    scene_set_open(&scene, &scene_build_default, &block, &tree);
    bool *const wanted = malloc(set.count * sizeof *wanted);
    for (int32_t group = 0; group < (int32_t)scene.group_count; group++) {
        memset(wanted, 0, set.count * sizeof *wanted);
        for (uint32_t i = 0; i < scene.object_count; i++) {
            int32_t of = scene.objects[i].group;
            while (of >= 0 && of != group) {
                of = scene.groups[of].parent;
            }
            for (uint32_t k = 0; of == group && k < scene.objects[i].detail_count; k++) {
                const struct scene_detail *const d =
                    &scene.details[scene.objects[i].first_detail + k];
                memset(wanted + scene.points[d->first], 1, d->count); // one after the other
            }
        }
        CHECK(is_node(&tree, wanted, set.count));
    }
    uint32_t objects = 0;
    for (uint32_t i = 0; i < tree.header->part_count; i++) {
        objects += tree.parts[i].name != TREE_NONE ? 1U : 0U;
    }
    CHECK_EQ(objects, scene.object_count);
    // A set that is none: the first vertices of two objects.
    memset(wanted, 0, set.count * sizeof *wanted);
    wanted[0] = wanted[set.count - 1U] = true;
    CHECK(!is_node(&tree, wanted, set.count));
    free(wanted);
    free(block);
    scene_text_free(&scene);
}

int main(void) {
    const char *seed_text = getenv("SEED");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750604U;
    printf("# seed %llu\n", (unsigned long long)seed);
    CHECK_EQ(tree_crc32(0, "123456789", 9), 0xCBF43926U);
    TEST(every_bit);
    TEST(many_fields);
    TEST(spheres_hold_their_points);
    TEST(clusters_are_kept);
    return check_finish();
}
