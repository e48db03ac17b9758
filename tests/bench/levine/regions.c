#include "bench/levine/regions.h"

#include "check.h"
#include "scene_build.h"

#include <stdlib.h>

#define NONE        UINT32_MAX
#define CELL_LEVELS 12U

struct region_cell {
    struct region_box box;
    uint32_t child[8];
    uint32_t first, count; ///< references of a leaf
};

// ---------------------------------------------------------------- clusters

static struct region_box box_of(const struct vec3 *points, uint32_t count) {
    struct region_box box = {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
    for (uint32_t i = 0; i < count; i++) {
        const int32_t p[3] = {points[i].x, points[i].y, points[i].z};
        for (int k = 0; k < 3; k++) {
            box.low[k] = p[k] < box.low[k] ? p[k] : box.low[k];
            box.high[k] = p[k] > box.high[k] ? p[k] : box.high[k];
        }
    }
    return box;
}

static struct region_box box_around(struct region_box a, struct region_box b) {
    for (int k = 0; k < 3; k++) {
        a.low[k] = b.low[k] < a.low[k] ? b.low[k] : a.low[k];
        a.high[k] = b.high[k] > a.high[k] ? b.high[k] : a.high[k];
    }
    return a;
}

/// scene_build's tree of the objects, each a leaf with its vertices.
static void build_tree(struct regions *r) {
    const uint32_t objects = r->set->object_count, vertices = r->set->vertex_count;
    struct scene_text text = {.object_count = objects,
                              .detail_count = objects,
                              .point_count = vertices,
                              .objects = calloc(objects, sizeof *text.objects),
                              .details = calloc(objects, sizeof *text.details),
                              .points = calloc(vertices, sizeof *text.points)};
    text.vertices.directions = r->set->vertices;
    text.vertices.count = vertices;
    text.vertices.unit = 1.0L;
    uint32_t most = 1;
    for (uint32_t i = 0; i < objects; i++) {
        const struct shape_object *const o = &r->set->objects[i];
        text.objects[i] = (struct scene_object){
            .group = -1, .first_detail = i, .detail_count = 1, .name = SCENE_NONE};
        text.details[i] = (struct scene_detail){.first = o->first_vertex, .count = o->vertex_count};
        most = o->vertex_count > most ? o->vertex_count : most;
    }
    for (uint32_t v = 0; v < vertices; v++) {
        text.points[v] = v;
    }
    const struct scene_build_options options = {.points_a_leaf = most};
    size_t bytes = 0, fault;
    CHECK_EQ(scene_build(&text, &options, &r->block, &bytes), SCENE_BUILD_OK);
    CHECK_EQ(tree_open(r->block, bytes, &r->tree, &fault), TREE_OK);
    free(text.objects);
    free(text.details);
    free(text.points);
}

static const struct tree_description *description_of(const struct regions *r, uint32_t node) {
    const struct tree_node *const n = &r->tree.nodes[node];
    return &r->tree.descriptions[n->first_description + n->description_count - 1U];
}

/// Children stand behind their parents.
static void box_clusters(struct regions *r) {
    const uint32_t count = r->tree.header->node_count;
    r->boxes = malloc(count * sizeof *r->boxes);
    for (uint32_t node = count; node-- != 0U;) {
        const struct tree_description *const d = description_of(r, node);
        r->boxes[node] = box_of(NULL, 0);
        for (uint32_t k = d->first; k < d->first + d->count; k++) {
            const struct vec3 p =
                tree_kind(d) == TREE_POINTS
                    ? vec3(r->tree.points[k].x, r->tree.points[k].y, r->tree.points[k].z)
                    : vec3(0, 0, 0);
            r->boxes[node] = box_around(r->boxes[node],
                                        tree_kind(d) == TREE_POINTS ? box_of(&p, 1) : r->boxes[k]);
        }
    }
}

// ---------------------------------------------------------------- cells

static bool boxes_meet(const struct region_box *a, const struct region_box *b) {
    bool meet = true;
    for (int k = 0; k < 3; k++) {
        meet = meet && a->low[k] <= b->high[k] && b->low[k] <= a->high[k];
    }
    return meet;
}

static uint32_t add_cell(struct regions *r, struct region_box box) {
    if (r->cell_count == r->cell_room) {
        r->cell_room = r->cell_room == 0U ? 1024U : 2U * r->cell_room;
        r->cells = realloc(r->cells, r->cell_room * sizeof *r->cells);
    }
    r->cells[r->cell_count] =
        (struct region_cell){.box = box, .child = {NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE}};
    return r->cell_count++;
}

static void keep(struct regions *r, uint32_t cell, const uint32_t *objects, uint32_t count) {
    if (r->reference_count + count > r->reference_room) {
        r->reference_room = 2U * (r->reference_count + count);
        r->references = realloc(r->references, r->reference_room * sizeof *r->references);
    }
    r->cells[cell].first = r->reference_count;
    r->cells[cell].count = count;
    for (uint32_t i = 0; i < count; i++) {
        r->references[r->reference_count++] = objects[i];
    }
}

static struct region_box octant_of(const struct region_box *box, unsigned octant) {
    struct region_box part = *box;
    for (unsigned k = 0; k < 3U; k++) {
        const int32_t middle = box->low[k] + (box->high[k] - box->low[k]) / 2;
        *((octant >> k & 1U) != 0U ? &part.low[k] : &part.high[k]) = middle;
    }
    return part;
}

/// Cuts a cell until each part has one object, or is no larger than the smallest.
static uint32_t divide(struct regions *r, struct region_box box, const uint32_t *objects,
                       uint32_t count, int32_t smallest, unsigned level) {
    const uint32_t cell = add_cell(r, box);
    if (count <= 1U || level == CELL_LEVELS || box.high[0] - box.low[0] <= smallest) {
        keep(r, cell, objects, count);
        return cell;
    }
    uint32_t *const part = malloc(count * sizeof *part);
    for (unsigned octant = 0; octant < 8U; octant++) {
        const struct region_box sub = octant_of(&box, octant);
        uint32_t found = 0;
        for (uint32_t i = 0; i < count; i++) {
            if (boxes_meet(&sub, &r->objects[objects[i]])) {
                part[found++] = objects[i];
            }
        }
        if (found != 0U) {
            const uint32_t child = divide(r, sub, part, found, smallest, level + 1U);
            r->cells[cell].child[octant] = child;
        }
    }
    free(part);
    return cell;
}

static void build_cells(struct regions *r) {
    const uint32_t count = r->set->object_count;
    struct region_box all = r->objects[0];
    uint32_t *const every = malloc(count * sizeof *every);
    int32_t smallest = INT32_MAX, size = 0;
    for (uint32_t i = 0; i < count; i++) {
        every[i] = i;
        all = box_around(all, r->objects[i]);
        for (int k = 0; k < 3; k++) {
            const int32_t side = r->objects[i].high[k] - r->objects[i].low[k];
            smallest = side < smallest ? side : smallest;
        }
    }
    for (int k = 0; k < 3; k++) {
        size = all.high[k] - all.low[k] > size ? all.high[k] - all.low[k] : size;
    }
    for (int k = 0; k < 3; k++) {
        all.high[k] = all.low[k] + size;
    }
    (void)divide(r, all, every, count, smallest, 1);
    free(every);
}

void regions_open(struct regions *regions, const struct shape_set *set) {
    *regions = (struct regions){.set = set};
    regions->objects = malloc(set->object_count * sizeof *regions->objects);
    regions->mark = calloc(set->object_count, sizeof *regions->mark);
    for (uint32_t i = 0; i < set->object_count; i++) {
        regions->objects[i] =
            box_of(&set->vertices[set->objects[i].first_vertex], set->objects[i].vertex_count);
    }
    build_tree(regions);
    box_clusters(regions);
    build_cells(regions);
}

void regions_close(struct regions *regions) {
    free(regions->objects);
    free(regions->mark);
    free(regions->block);
    free(regions->boxes);
    free(regions->cells);
    free(regions->references);
}

static uint32_t cell_levels(const struct regions *r) {
    int32_t least = INT32_MAX;
    for (uint32_t c = 0; c < r->cell_count; c++) {
        const int32_t side = r->cells[c].box.high[0] - r->cells[c].box.low[0];
        least = side < least ? side : least;
    }
    uint32_t levels = 1;
    for (int32_t side = r->cells[0].box.high[0] - r->cells[0].box.low[0]; side > least + 1;
         side /= 2) {
        levels++;
    }
    return levels;
}

uint32_t regions_nodes(const struct regions *regions, enum region_tree tree, uint32_t *levels) {
    *levels = tree == REGION_OCTREE ? cell_levels(regions) : regions->tree.header->level_count;
    return tree == REGION_OCTREE ? regions->cell_count : regions->tree.header->node_count;
}

// ---------------------------------------------------------------- looking

static int64_t distance(struct vec3 normal, struct vec3 eye, int32_t x, int32_t y, int32_t z) {
    return (int64_t)normal.x * ((int64_t)x - eye.x) + (int64_t)normal.y * ((int64_t)y - eye.y) +
           (int64_t)normal.z * ((int64_t)z - eye.z);
}

/// Eight corners against up to four planes: outside if all are beyond one.
static enum view_place place_box(const struct view *view, const struct region_box *box,
                                 struct region_counts *counts) {
    bool inside = true;
    for (unsigned side = 0; side < 4U; side++) {
        unsigned beyond = 0;
        for (unsigned corner = 0; corner < 8U; corner++) {
            beyond += distance(view->inward[side], view->eye,
                               (corner & 1U) != 0U ? box->high[0] : box->low[0],
                               (corner & 2U) != 0U ? box->high[1] : box->low[1],
                               (corner & 4U) != 0U ? box->high[2] : box->low[2]) < 0;
        }
        counts->distances += 8U;
        if (beyond == 8U) {
            return VIEW_OUTSIDE;
        }
        inside = inside && beyond == 0U;
    }
    return inside ? VIEW_INSIDE : VIEW_CROSSING;
}

/// The firmware's answer, and as many distances as it takes.
static enum view_place place_sphere(const struct view *view, struct vec3 center, uint32_t radius,
                                    struct region_counts *counts) {
    const enum view_place place = view_place(view, center, radius);
    const int64_t reach = ((int64_t)radius + 8) << 30;
    counts->distances++; // from the plane of the eye
    if (distance(view->ahead, view->eye, center.x, center.y, center.z) < -reach) {
        CHECK_EQ(place, VIEW_OUTSIDE);
        return place;
    }
    for (unsigned side = 0; side < 4U; side++) {
        counts->distances++;
        if (distance(view->inward[side], view->eye, center.x, center.y, center.z) < -reach) {
            CHECK_EQ(place, VIEW_OUTSIDE);
            return place;
        }
    }
    CHECK(place != VIEW_OUTSIDE);
    return place;
}

static void find(struct regions *r, uint32_t object, struct region_counts *counts, bool *found) {
    counts->read++;
    counts->objects += r->mark[object] != r->stamp;
    r->mark[object] = r->stamp;
    found[object] = true;
}

/// A region and whether its parent is inside.
struct pending {
    uint32_t index;
    bool inside;
};

static bool enters(struct regions *r, enum region_tree tree, const struct view *view,
                   struct pending *at, struct region_counts *counts) {
    enum view_place place = VIEW_INSIDE;
    if (!at->inside) {
        counts->tested++;
        place = tree == REGION_OCTREE  ? place_box(view, &r->cells[at->index].box, counts)
                : tree == REGION_BOXES ? place_box(view, &r->boxes[at->index], counts)
                                       : place_sphere(view, tree_center(&r->tree.nodes[at->index]),
                                                      r->tree.nodes[at->index].radius, counts);
    }
    at->inside = place == VIEW_INSIDE;
    counts->size += place == VIEW_OUTSIDE ? 0U : tree == REGION_SPHERES ? 1U : 8U;
    return place != VIEW_OUTSIDE;
}

struct region_counts regions_look(struct regions *regions, enum region_tree tree,
                                  const struct view *view, bool *found) {
    struct region_counts counts = {0, 0, 0, 0, 0};
    struct pending stack[8U * TREE_LEVELS_MAX];
    uint32_t depth = 1;
    stack[0] = (struct pending){0, false};
    regions->stamp++;
    while (depth != 0U) {
        struct pending at = stack[--depth];
        if (!enters(regions, tree, view, &at, &counts)) {
            continue;
        }
        if (tree == REGION_OCTREE) {
            const struct region_cell *const cell = &regions->cells[at.index];
            for (unsigned k = 0; k < 8U; k++) {
                if (cell->child[k] != NONE) {
                    stack[depth++] = (struct pending){cell->child[k], at.inside};
                }
            }
            for (uint32_t k = cell->first; k < cell->first + cell->count; k++) {
                find(regions, regions->references[k], &counts, found);
            }
            continue;
        }
        const struct tree_description *const d = description_of(regions, at.index);
        if (tree_kind(d) == TREE_POINTS) { // an object: all have as many vertices
            const uint32_t vertex = regions->tree.points[d->first].source;
            find(regions, vertex / regions->set->objects[0].vertex_count, &counts, found);
            continue;
        }
        for (uint32_t k = d->first; k < d->first + d->count; k++) {
            stack[depth++] = (struct pending){k, at.inside};
        }
    }
    return counts;
}

bool regions_is_near(const struct regions *regions, uint32_t object, const struct view *view) {
    struct region_counts unused = {0, 0, 0, 0, 0};
    return place_box(view, &regions->objects[object], &unused) != VIEW_OUTSIDE;
}
