#include "property/support/scene_sets.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>

const char *const scene_shape_names[SCENE_SHAPE_COUNT] = {"box", "ball", "cloud", "details"};

static double uniform(uint64_t *random) {
    return (double)(check_random(random) >> 11) * 0x1p-52 - 1.0;
}

static struct vec3 somewhere(uint64_t *random, double size, bool ball) {
    double x, y, z;
    do {
        x = uniform(random);
        y = uniform(random);
        z = uniform(random);
    } while (ball && x * x + y * y + z * z > 1.0);
    return vec3((int32_t)(x * size), (int32_t)(y * size), (int32_t)(z * size));
}

static struct vec3 sum(struct vec3 a, struct vec3 b) {
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static void add_detail(struct scene_text *s, uint32_t px_q8, uint32_t first, uint32_t count) {
    s->details[s->detail_count++] =
        (struct scene_detail){.radius_px_q8 = px_q8, .first = first, .count = count};
    s->objects[s->object_count - 1U].detail_count++;
}

struct scene_text scene_set_draw(const struct scene_set *set, uint64_t *random) {
    struct scene_text s = {0};
    const uint32_t n = set->count, objects = set->objects;
    s.vertices.directions = malloc(n * sizeof *s.vertices.directions);
    s.vertices.unit = 1.0L;
    s.vertices.count = n;
    s.points = malloc(n * sizeof *s.points);
    s.objects = malloc(objects * sizeof *s.objects);
    s.details = malloc(2U * objects * sizeof *s.details);
    s.groups = malloc(4U * sizeof *s.groups);
    const bool detailed = set->shape == SCENE_DETAIL;
    for (uint32_t g = 0; g < 4U && detailed; g++) { // 0 holds 1 and 2; 3 is beside it
        s.groups[s.group_count++] = (struct scene_group){g == 1U || g == 2U ? 0 : -1};
    }
    // Compact: their size is a tenth of the distance to the next one.
    const double whole = 0x1p26, size = 0.1 * whole / cbrt((double)objects);
    struct vec3 at = vec3(0, 0, 0);
    for (uint32_t i = 0, object = 0; i < n; i++) {
        if (object < objects && i == (uint32_t)((uint64_t)object * n / objects)) {
            at = somewhere(random, whole, set->shape == SCENE_BALL);
            const uint32_t end = (uint32_t)((uint64_t)(object + 1U) * n / objects);
            if (object == 0U || !set->loose) {
                const int32_t group = detailed ? (int32_t)((uint64_t)object * 4U / objects) : -1;
                s.objects[s.object_count++] =
                    (struct scene_object){group, s.detail_count, 0, 0, SCENE_NONE};
                const uint32_t last = set->loose ? n : end, few = (last - i) / 4U;
                if (detailed && few != 0U) {
                    add_detail(&s, 0, i, few);
                    add_detail(&s, 20U * 256U, i + few, last - i - few);
                } else {
                    add_detail(&s, 0, i, last - i);
                }
            }
            object++;
        }
        s.points[s.point_count++] = i;
        s.vertices.directions[i] = set->shape == SCENE_CLOUD
                                       ? somewhere(random, whole, false)
                                       : sum(at, somewhere(random, size, false));
    }
    return s;
}

size_t scene_set_open(const struct scene_text *scene, const struct scene_build_options *options,
                      void **block, struct tree *tree) {
    size_t size = 0, fault;
    *block = NULL;
    if (!CHECK_EQ(scene_build(scene, options, block, &size), SCENE_BUILD_OK) ||
        !CHECK_EQ(tree_open(*block, size, tree, &fault), TREE_OK)) {
        exit(1);
    }
    return size;
}

uint32_t scene_set_finest(const struct tree *tree, struct vec3 eye, struct vec3 *out,
                          uint32_t *reference) {
    const uint32_t nodes = tree->header->node_count;
    unsigned char *const reached = calloc(nodes + 1U, 1);
    uint32_t count = 0;
    reached[0] = 1;
    for (uint32_t i = 0; i < nodes; i++) {
        const struct tree_node *const node = &tree->nodes[i];
        const struct tree_description *const d =
            &tree->descriptions[node->first_description + node->description_count - 1U];
        for (uint32_t k = d->first;
             reached[i] && tree_kind(d) == TREE_NODES && k < d->first + d->count; k++) {
            reached[k] = 1;
        }
        for (uint32_t k = d->first;
             reached[i] && tree_kind(d) == TREE_POINTS && k < d->first + d->count; k++) {
            out[count] = vec3(tree->points[k].x - eye.x, tree->points[k].y - eye.y,
                              tree->points[k].z - eye.z);
            reference[count++] = k;
        }
    }
    free(reached);
    return count;
}
