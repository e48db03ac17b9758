#include "scene_nodes.h"

#include "solid/solid_sphere.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct output {
    struct tree_header header;
    uint32_t *queue; ///< nodes in the order of the block
    struct tree_node *nodes;
    uint32_t *parent; ///< of each node: the part above it; TREE_NONE: none
    uint32_t *object; ///< of each node: the object that it is a part of, index + 1
    struct tree_description *descriptions;
    struct tree_point *points;
    uint32_t *placed; ///< where each of the build's points stands among these
    struct tree_part *parts;
    struct tree_shape *shapes;
    struct tree_element *elements;
    uint32_t *corners;
    char *names;
};

/// The smallest sphere of a node's points in whole units, rounded outward.
static bool set_sphere(const struct build *b, const struct build_node *node, struct vec3 *points,
                       void *workspace, struct tree_node *out) {
    for (uint32_t i = 0; i < node->count; i++) {
        const struct cluster_point *const p = &b->order[node->first + i];
        points[i] = vec3(p->x, p->y, p->z);
    }
    struct solid_sphere sphere;
    if (solid_sphere_find(points, node->count, workspace, SOLID_SPHERE_WORKSPACE_BYTES(node->count),
                          &sphere) != SOLID_SPHERE_OK) {
        return false;
    }
    out->x = (int32_t)round_shift_i64(sphere.center_q30.x, 30);
    out->y = (int32_t)round_shift_i64(sphere.center_q30.y, 30);
    out->z = (int32_t)round_shift_i64(sphere.center_q30.z, 30);
    // Half a unit on each axis, 0.867 in all, and up.
    const uint64_t one = UINT64_C(1) << 30;
    out->radius =
        node->count == 1U ? 0U : (uint32_t)((sphere.radius_q30 + 931000000U + one - 1U) >> 30);
    return true;
}

static void add_description(struct output *o, uint32_t threshold, uint32_t kind, uint32_t first,
                            uint32_t count) {
    o->descriptions[o->header.description_count++] =
        (struct tree_description){threshold, kind, first, count};
}

/// object: that it is a part of, index + 1; 0: of none.
static void put_child(struct output *o, uint32_t child, uint32_t part, uint32_t object) {
    o->object[o->header.node_count] = object;
    o->parent[o->header.node_count] = part;
    o->queue[o->header.node_count++] = child;
}

/// From the file's unit; at least 1.
static uint32_t in_units(const struct build *b, double distance) {
    const double units = floor(distance / (double)b->scene->vertices.unit);
    return units < 1.0 ? 1U : units < UINT32_MAX ? (uint32_t)units : UINT32_MAX;
}

/// The user's own descriptions, a child each.
static void put_details(const struct build *b, struct output *o, const struct build_node *node,
                        uint32_t object) {
    for (uint32_t k = 0; k < node->child_count; k++) {
        const struct scene_detail *const d = &b->scene->details[node->thresholds - 1U + k];
        const bool far = d->distance > 0;
        const uint32_t first = far ? UINT32_MAX : 0U,
                       other = far ? in_units(b, d->distance) : d->radius_px_q8;
        add_description(o, k == 0U ? first : other, TREE_NODES | (far ? TREE_BY_DISTANCE : 0U),
                        o->header.node_count, 1);
        put_child(o, b->kids[node->child + k], TREE_NONE, object);
    }
}

/// A node's descriptions; its children enter the queue, its points the list.
static void put_descriptions(const struct build *b, struct output *o, const struct build_node *node,
                             uint32_t at) {
    const uint32_t part = o->nodes[at].part;
    const bool own = node->object != 0U && node->object != BUILD_CLUSTER;
    const uint32_t object = own ? node->object : o->object[at];
    if (node->thresholds != 0U) {
        put_details(b, o, node, object);
        return;
    }
    uint32_t fine = 0;
    if (b->options->coarse_px_q8 != 0U && node->child_count != 0U) {
        add_description(o, 0, TREE_CENTER, 0, 1);
        fine = b->options->coarse_px_q8;
    }
    if (node->child_count != 0U) {
        add_description(o, fine, TREE_NODES, o->header.node_count, node->child_count);
        for (uint32_t k = 0; k < node->child_count; k++) {
            put_child(o, b->kids[node->child + k], node->object == BUILD_CLUSTER ? part : TREE_NONE,
                      object);
        }
        return;
    }
    add_description(o, fine, TREE_POINTS, o->header.point_count, node->count);
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
        const struct cluster_point *const p = &b->order[i];
        o->placed[i] = o->header.point_count;
        o->points[o->header.point_count++] = (struct tree_point){p->x, p->y, p->z, p->source};
    }
}

/// An object, or a node above some: the next part. Returns: its index; TREE_NONE: it is neither.
static uint32_t put_part(const struct build *b, struct output *o, uint32_t at,
                         const struct build_node *node) {
    const struct scene_text *const s = b->scene;
    if (node->object == 0U) {
        return TREE_NONE;
    }
    struct tree_part part = {at, o->parent[at], TREE_NONE, 0};
    if (node->object != BUILD_CLUSTER) {
        const struct scene_object *const object = &s->objects[node->object - 1U];
        const char *const name = object->name != SCENE_NONE ? s->names + object->name : "";
        part.line = object->line <= UINT32_MAX ? (uint32_t)object->line : 0U;
        part.name = o->header.name_bytes;
        memcpy(o->names + part.name, name, strlen(name) + 1U);
        o->header.name_bytes += (uint32_t)strlen(name) + 1U;
    }
    o->parts[o->header.part_count] = part;
    return o->header.part_count++;
}

/// A vertex of a description and its point.
struct corner {
    uint32_t source, point;
};

static int by_source(const void *a, const void *b) {
    const struct corner *const p = a, *const q = b;
    return p->source != q->source ? (p->source < q->source ? -1 : 1) : 0;
}

static bool put_shape(const struct build *b, struct output *o, uint32_t at,
                      const struct build_node *node) {
    const struct scene_text *const s = b->scene;
    const struct scene_detail *const d = &s->details[node->detail - 1U];
    struct corner *const list = malloc(node->count * sizeof *list);
    if (list == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < node->count; i++) {
        list[i] = (struct corner){b->order[node->first + i].source, o->placed[node->first + i]};
    }
    qsort(list, node->count, sizeof *list, by_source);
    o->shapes[o->header.shape_count++] =
        (struct tree_shape){at, d->shape, o->header.element_count, d->element_count};
    for (uint32_t k = d->first_element; k < d->first_element + d->element_count; k++) {
        const struct scene_element *const e = &s->elements[k];
        o->elements[o->header.element_count++] =
            (struct tree_element){e->kind, o->header.corner_count, e->count};
        for (uint32_t i = e->first; i < e->first + e->count; i++) {
            const struct corner wanted = {s->corners[i], 0};
            const struct corner *const found =
                bsearch(&wanted, list, node->count, sizeof *list, by_source);
            o->corners[o->header.corner_count++] = found->point;
        }
    }
    free(list);
    return true;
}

/// The line of a node's object, or of the first object below.
static unsigned long line_of(const struct build *b, const struct output *o, uint32_t at) {
    uint32_t node = o->queue[at];
    while (b->nodes[node].object == BUILD_CLUSTER) {
        node = b->kids[b->nodes[node].child];
    }
    const uint32_t own = b->nodes[node].object, object = own != 0U ? own : o->object[at];
    return object != 0U ? b->scene->objects[object - 1U].line : 0UL;
}

/// A node of its own level begins. False: there are as many levels as there may be.
static bool begin_level(const struct build *b, struct output *o, uint32_t at) {
    o->header.level_count++;
    if (o->header.level_count > TREE_LEVELS_MAX && b->options->fault_line != NULL) {
        *b->options->fault_line = line_of(b, o, at);
    }
    return o->header.level_count <= TREE_LEVELS_MAX;
}

static bool write_nodes(const struct build *b, uint32_t root, struct output *o) {
    const uint32_t most = b->nodes[root].count;
    struct vec3 *const points = malloc(most * sizeof *points);
    void *const workspace = malloc(SOLID_SPHERE_WORKSPACE_BYTES(most));
    bool good = points != NULL && workspace != NULL;
    put_child(o, root, TREE_NONE, 0);
    uint32_t level_end = 0;
    for (uint32_t i = 0; i < o->header.node_count && good; i++) {
        if (i == level_end) {
            level_end = o->header.node_count;
            if (!begin_level(b, o, i)) {
                o->header.node_count = 0; // told by the number of levels
                break;
            }
        }
        const struct build_node *const node = &b->nodes[o->queue[i]];
        const uint32_t first = o->header.description_count;
        good = set_sphere(b, node, points, workspace, &o->nodes[i]);
        o->nodes[i].part = put_part(b, o, i, node);
        put_descriptions(b, o, node, i);
        o->nodes[i].first_description = first;
        o->nodes[i].description_count = o->header.description_count - first;
    }
    free(points);
    free(workspace);
    for (uint32_t i = 0; i < o->header.node_count && good; i++) { // all points have their places
        const struct build_node *const node = &b->nodes[o->queue[i]];
        if (node->detail != 0U && b->scene->details[node->detail - 1U].element_count != 0U) {
            good = put_shape(b, o, i, node);
        }
    }
    return good;
}

/// The lists one behind the other, with sum and counts.
static enum scene_build_status assemble(struct output *o, void **block, size_t *size_bytes) {
    struct tree_header *const h = &o->header;
    const struct {
        const void *from;
        uint64_t size;
    } list[] = {{o->nodes, (uint64_t)h->node_count * sizeof *o->nodes},
                {o->descriptions, (uint64_t)h->description_count * sizeof *o->descriptions},
                {o->points, (uint64_t)h->point_count * sizeof *o->points},
                {o->parts, (uint64_t)h->part_count * sizeof *o->parts},
                {o->shapes, (uint64_t)h->shape_count * sizeof *o->shapes},
                {o->elements, (uint64_t)h->element_count * sizeof *o->elements},
                {o->corners, (uint64_t)h->corner_count * sizeof *o->corners},
                {o->names, h->name_bytes}};
    const size_t lists = sizeof list / sizeof *list;
    uint64_t total = sizeof *h;
    for (size_t i = 0; i < lists; i++) {
        total += list[i].size;
    }
    if (total > UINT32_MAX) {
        return SCENE_BUILD_TOO_LARGE;
    }
    const size_t size = (size_t)total;
    unsigned char *const bytes = malloc(size);
    if (bytes == NULL) {
        return SCENE_BUILD_NO_MEMORY;
    }
    h->size_bytes = (uint32_t)size;
    unsigned char *at = bytes + sizeof *h;
    for (size_t i = 0; i < lists; i++) {
        if (list[i].size != 0U) {
            memcpy(at, list[i].from, (size_t)list[i].size);
            at += list[i].size;
        }
    }
    memcpy(bytes, h, sizeof *h);
    const size_t covered = offsetof(struct tree_header, node_count);
    h->crc32 = tree_crc32(0, bytes + covered, size - covered);
    memcpy(bytes, h, sizeof *h);
    *block = bytes;
    *size_bytes = size;
    return SCENE_BUILD_OK;
}

/// Room for as much as there can be. False: no memory.
static bool make_room(const struct build *b, struct output *o) {
    const struct scene_text *const s = b->scene;
    const size_t nodes = b->node_count;
    o->queue = malloc(nodes * sizeof *o->queue);
    o->parent = malloc(nodes * sizeof *o->parent);
    o->object = malloc(nodes * sizeof *o->object);
    o->nodes = malloc(nodes * sizeof *o->nodes);
    o->descriptions = malloc((2U * nodes + s->detail_count) * sizeof *o->descriptions);
    o->points = malloc((b->order_count + 1U) * sizeof *o->points);
    o->placed = malloc((b->order_count + 1U) * sizeof *o->placed);
    o->parts = malloc(nodes * sizeof *o->parts);
    o->shapes = malloc((s->detail_count + 1U) * sizeof *o->shapes);
    o->elements = malloc((s->element_count + 1U) * sizeof *o->elements);
    o->corners = malloc((s->corner_count + 1U) * sizeof *o->corners);
    o->names = malloc((size_t)s->name_bytes + s->object_count + 1U);
    return o->queue != NULL && o->parent != NULL && o->object != NULL && o->nodes != NULL &&
           o->descriptions != NULL && o->points != NULL && o->placed != NULL && o->parts != NULL &&
           o->shapes != NULL && o->elements != NULL && o->corners != NULL && o->names != NULL;
}

static void free_room(struct output *o) {
    free(o->queue);
    free(o->parent);
    free(o->object);
    free(o->nodes);
    free(o->descriptions);
    free(o->points);
    free(o->placed);
    free(o->parts);
    free(o->shapes);
    free(o->elements);
    free(o->corners);
    free(o->names);
}

enum scene_build_status scene_block_write(const struct build *b, uint32_t root, void **block,
                                          size_t *size_bytes) {
    struct output o = {.header = {.magic = TREE_MAGIC,
                                  .version = TREE_VERSION,
                                  .source_count = b->scene->vertices.count}};
    const double unit = (double)b->scene->vertices.unit;
    memcpy(o.header.unit_double, &unit, sizeof unit);
    enum scene_build_status status = SCENE_BUILD_OK;
    if (root != UINT32_MAX && !(make_room(b, &o) && write_nodes(b, root, &o))) {
        status = SCENE_BUILD_NO_MEMORY;
    }
    if (status == SCENE_BUILD_OK) {
        status = o.header.level_count <= TREE_LEVELS_MAX ? assemble(&o, block, size_bytes)
                                                         : SCENE_BUILD_TOO_DEEP;
    }
    free_room(&o);
    return status;
}
