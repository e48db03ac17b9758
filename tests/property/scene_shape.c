/// Solids, faces and lines from text to the file: each corner is the vertex that the text names,
/// solids are told from faces, and what is neither planar nor convex is refused. Then every bit of
/// such a file is flipped. SEED=N, COUNT=N scenes.
#include "check.h"
#include "property/support/scene_sets.h"
#include "property/support/solid_check.h"

#include "scene/walk.h"
#include "solid/solid_hull.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint64_t seed;
static unsigned long scene_count = 60UL;
static const char *path;

enum { POINTS_MOST = 24, OBJECTS_MOST = 12, ELEMENTS_MOST = 64, CORNERS_MOST = 16 };

/// What the text says, kept beside it.
struct wanted {
    enum tree_shape_kind kind;
    uint32_t elements;
    uint32_t corners[ELEMENTS_MOST];
    struct vec3 corner[ELEMENTS_MOST][CORNERS_MOST]; ///< as written
};

struct model {
    uint32_t objects;
    struct wanted object[OBJECTS_MOST];
};

static struct vec3 somewhere(int32_t size) {
    struct vec3 p;
    p.x = (int32_t)solid_below(&seed, 2U * (uint32_t)size + 1U) - size;
    p.y = (int32_t)solid_below(&seed, 2U * (uint32_t)size + 1U) - size;
    p.z = (int32_t)solid_below(&seed, 2U * (uint32_t)size + 1U) - size;
    return p;
}

static void write_vertices(FILE *out, const struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        fprintf(out, "v %d %d %d\n", points[i].x, points[i].y, points[i].z);
    }
}

/// An element of these of the last `count` vertices.
static void write_element(FILE *out, struct wanted *w, char sort, const struct vec3 *points,
                          uint32_t count, const uint32_t *corner, uint32_t corners) {
    fprintf(out, "%c", sort);
    for (uint32_t k = 0; k < corners; k++) {
        fprintf(out, " %d/7", (int)corner[k] - (int)count);
        w->corner[w->elements][k] = points[corner[k]];
    }
    fprintf(out, "\n");
    w->corners[w->elements++] = corners;
}

/// The triangles of a hull; inward: all turned.
static void write_solid(FILE *out, struct wanted *w, bool inward) {
    struct vec3 points[POINTS_MOST];
    static uint64_t workspace[SOLID_HULL_WORKSPACE_BYTES(POINTS_MOST) / 8U + 1U];
    struct solid_hull hull;
    const uint32_t count = 4U + solid_below(&seed, 12);
    do {
        for (uint32_t i = 0; i < count; i++) {
            points[i] = somewhere(1000000);
        }
    } while (solid_hull_find(points, count, SOLID_HULL_CAPS, workspace, sizeof workspace, &hull) !=
                 SOLID_HULL_OK ||
             hull.dimension != 3U);
    write_vertices(out, points, count);
    for (uint32_t f = 0; f < hull.face_count; f++) {
        const uint32_t *const v = hull.faces[f].vertex;
        const uint32_t turned[3] = {v[2], v[1], v[0]};
        write_element(out, w, 'f', points, count, inward ? turned : v, 3);
        if (inward) { // the reader turns it outward again
            w->corner[f][0] = points[v[0]];
            w->corner[f][2] = points[v[2]];
        }
    }
    w->kind = TREE_SOLID;
}

/// A concave polygon in a plane that goes anyhow.
static void write_face(FILE *out, struct wanted *w) {
    static const int32_t outline[6][2] = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
    const struct vec3 at = somewhere(100000), a = somewhere(1000), b = somewhere(1000);
    struct vec3 points[6];
    uint32_t corner[6];
    for (uint32_t i = 0; i < 6U; i++) {
        points[i] = vec3(at.x + outline[i][0] * a.x + outline[i][1] * b.x,
                         at.y + outline[i][0] * a.y + outline[i][1] * b.y,
                         at.z + outline[i][0] * a.z + outline[i][1] * b.z);
        corner[i] = i;
    }
    write_vertices(out, points, 6);
    write_element(out, w, 'f', points, 6, corner, 6);
    w->kind = TREE_FACES;
}

static void write_lines(FILE *out, struct wanted *w) {
    struct vec3 points[POINTS_MOST];
    const uint32_t count = 2U + solid_below(&seed, 10);
    for (uint32_t i = 0; i < count; i++) {
        points[i] = somewhere(500000);
    }
    write_vertices(out, points, count);
    for (uint32_t e = 0; e <= solid_below(&seed, 5); e++) {
        uint32_t corner[CORNERS_MOST];
        const uint32_t corners = 2U + solid_below(&seed, CORNERS_MOST - 2U);
        for (uint32_t k = 0; k < corners; k++) {
            corner[k] = solid_below(&seed, count);
        }
        write_element(out, w, 'l', points, count, corner, corners);
    }
    w->kind = TREE_LINES;
}

static void write_scene(struct model *model) {
    FILE *const out = fopen(path, "w");
    *model = (struct model){.objects = 1U + solid_below(&seed, OBJECTS_MOST)};
    for (uint32_t i = 0; i < model->objects && out != NULL; i++) {
        fprintf(out, "o thing %u\n", i);
        switch (solid_below(&seed, 4)) {
        case 0:
            write_lines(out, &model->object[i]);
            break;
        case 1:
            write_face(out, &model->object[i]);
            break;
        default:
            write_solid(out, &model->object[i], solid_below(&seed, 2) != 0U);
            break;
        }
    }
    if (out == NULL || fclose(out) != 0) {
        exit(1);
    }
}

/// The same corners in the same order, from any of them on.
static bool same_outline(const struct tree *tree, const struct tree_element *e,
                         const struct wanted *w, uint32_t at) {
    double unit_double; // a power of ten of the file's
    memcpy(&unit_double, tree->header->unit_double, sizeof unit_double);
    const int32_t unit = (int32_t)(1.0 / unit_double + 0.5);
    for (uint32_t shift = 0; shift < e->corner_count; shift++) {
        uint32_t k = 0;
        for (; k < e->corner_count; k++) {
            const struct tree_point *const p =
                &tree->points[tree->corners[e->first_corner + (k + shift) % e->corner_count]];
            const struct vec3 q = w->corner[at][k];
            if (p->x != q.x * unit || p->y != q.y * unit || p->z != q.z * unit) {
                break;
            }
        }
        if (k == e->corner_count) {
            return true;
        }
        if (e->kind == TREE_LINE) {
            return false;
        }
    }
    return false;
}

static uint32_t number_of(const struct tree *tree, uint32_t node) {
    for (uint32_t i = 0; i < tree->header->part_count; i++) {
        if (tree->parts[i].node == node) {
            return (uint32_t)strtoul(tree->names + tree->parts[i].name + strlen("thing "), NULL,
                                     10);
        }
    }
    return UINT32_MAX;
}

static void corners_are_the_texts(void) {
    unsigned long solids = 0, elements = 0;
    for (unsigned long i = 0; i < scene_count && check_clean(); i++) {
        static struct model model;
        write_scene(&model);
        struct scene_text scene;
        void *block;
        struct tree tree;
        CHECK_EQ(scene_text_read(path, true, &scene), EXIT_STATUS_OK);
        scene_set_open(&scene, &scene_build_default, &block, &tree);
        CHECK_EQ(tree.header->shape_count, model.objects);
        unsigned seen = 0;
        for (uint32_t k = 0; k < tree.header->shape_count; k++) {
            const struct tree_shape *const s = &tree.shapes[k];
            CHECK(tree_shape_at(&tree, s->node) == s);
            const uint32_t number = number_of(&tree, s->node);
            if (!CHECK(number < model.objects)) {
                break;
            }
            seen |= 1U << number;
            const struct wanted *const w = &model.object[number];
            CHECK_EQ(s->kind, w->kind);
            solids += s->kind == TREE_SOLID;
            CHECK_EQ(s->element_count, w->elements);
            for (uint32_t e = 0; e < w->elements && check_clean(); e++, elements++) {
                const struct tree_element *const got = &tree.elements[s->first_element + e];
                CHECK_EQ(got->corner_count, w->corners[e]);
                CHECK(same_outline(&tree, got, w, e));
            }
        }
        CHECK_EQ(seen, (1U << model.objects) - 1U);
        CHECK(tree_find_part(&tree, "thing 0") != TREE_NONE);
        CHECK(tree_find_part(&tree, "thing") == TREE_NONE);
        free(block);
        scene_text_free(&scene);
    }
    printf("# %lu solids, %lu faces and lines\n", solids, elements);
}

/// Reads everything that a block says of its shapes, as a renderer would.
static void use(const struct tree *tree) {
    struct view view;
    struct walk walk;
    struct walk_item item;
    uint64_t sum = 0;
    view_set(&view, vec3(0, -(1 << 29), 0), vec3(Q30_ONE, 0, 0), vec3(0, Q30_ONE, 0),
             vec3(0, 0, Q30_ONE), 300U * 256U, 640, 480);
    walk_start(&walk, tree, NULL, &view);
    walk.shapes = true;
    while (walk_next(&walk, &item)) {
        for (uint32_t e = 0; item.shape != NULL && e < item.shape->element_count; e++) {
            const struct tree_element *const element =
                &tree->elements[item.shape->first_element + e];
            for (uint32_t k = 0; k < element->corner_count; k++) {
                sum += (uint32_t)tree->points[tree->corners[element->first_corner + k]].x;
            }
        }
    }
    for (uint32_t i = 0; i < tree->header->part_count; i++) {
        const uint32_t name = tree->parts[i].name;
        sum += name != TREE_NONE ? strlen(tree->names + name) : 0U;
    }
    CHECK(sum != 1U);
    CHECK(tree_find_part(tree, "no such name") == TREE_NONE);
}

static void every_bit(void) {
    FILE *const out = fopen(path, "w");
    if (out == NULL) {
        exit(1);
    }
    static struct wanted w[3];
    fprintf(out, "group all\no solid\n");
    write_solid(out, &w[0], false);
    fprintf(out, "group inner\no face\n");
    write_face(out, &w[1]);
    fprintf(out, "end\nend\no lines\ndetail 0\np 1 2\ndetail 9\n");
    write_lines(out, &w[2]);
    fclose(out);
    struct scene_text scene;
    void *block;
    struct tree tree;
    CHECK_EQ(scene_text_read(path, true, &scene), EXIT_STATUS_OK);
    const size_t size = scene_set_open(&scene, &scene_build_default, &block, &tree);
    const size_t covered = offsetof(struct tree_header, node_count);
    use(&tree);
    unsigned long accepted = 0;
    unsigned char *const copy = malloc(size); // ends where the block ends
    for (size_t bit = 0; bit < 8U * size && check_clean(); bit++) {
        size_t offset = SIZE_MAX;
        memcpy(copy, block, size);
        copy[bit / 8U] ^= (unsigned char)(1U << (bit % 8U));
        CHECK(tree_open(copy, size, &tree, &offset) != TREE_OK);
        CHECK(offset <= size);
        const uint32_t crc = tree_crc32(0, copy + covered, size - covered);
        memcpy(copy + offsetof(struct tree_header, crc32), &crc, sizeof crc);
        if (tree_open(copy, size, &tree, &offset) == TREE_OK) {
            accepted++;
            use(&tree);
        } else {
            CHECK(offset <= size);
        }
    }
    printf("# %zu bits, %lu accepted with the checksum made right\n", 8U * size, accepted);
    free(copy);
    free(block);
    scene_text_free(&scene);
}

/// A text with some bytes wrong is read or refused; what is read can be built and opened.
static void damaged_texts(void) {
    static struct model model;
    static char text[1 << 16];
    unsigned long read = 0, refused = 0;
    fflush(stderr);
    const int heard = dup(2), nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nowhere, 2); // a line for each that is refused
    for (unsigned long i = 0; i < 20U * scene_count && check_clean(); i++) {
        if (i % 2U == 0U) {
            write_scene(&model);
        }
        FILE *file = fopen(path, "r");
        const size_t size = file != NULL ? fread(text, 1, sizeof text, file) : 0U;
        if (file == NULL || fclose(file) != 0 || size == 0U) {
            exit(1);
        }
        static const char some[] = "0123456789.-+e/ \n\tvflpgo#\1\377";
        for (uint32_t k = 0; k <= i % 4U; k++) {
            text[solid_below(&seed, (uint32_t)size)] =
                some[solid_below(&seed, (uint32_t)sizeof some)];
        }
        file = fopen(path, "w");
        if (file == NULL || fwrite(text, 1, size, file) != size || fclose(file) != 0) {
            exit(1);
        }
        struct scene_text scene;
        if (scene_text_read(path, true, &scene) == EXIT_STATUS_OK) {
            void *block;
            struct tree tree;
            scene_set_open(&scene, &scene_build_default, &block, &tree);
            if (tree.header->node_count != 0U) {
                use(&tree);
            }
            free(block);
            read++;
        } else {
            refused++;
        }
        scene_text_free(&scene);
    }
    dup2(heard, 2);
    close(heard);
    close(nowhere);
    printf("# %lu read, %lu refused\n", read, refused);
    CHECK(read > 10U && refused > 10U);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750606U;
    scene_count = count_text != NULL ? strtoul(count_text, NULL, 0) : scene_count;
    printf("# seed %llu, %lu scenes\n", (unsigned long long)seed, scene_count);
    char name[] = "/tmp/boresight-shape-XXXXXX";
    const int handle = mkstemp(name);
    if (handle < 0) {
        return 1;
    }
    close(handle);
    path = name;
    TEST(corners_are_the_texts);
    TEST(every_bit);
    TEST(damaged_texts);
    unlink(name);
    return check_finish();
}
