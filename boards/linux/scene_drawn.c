#include "scene_drawn.h"

#include <stdlib.h>
#include <string.h>

static bool no_memory(const char *file) {
    message_at(file, 0, "no memory for this scene");
    return false;
}

/// A polygon in pieces needs four corners for one.
bool scene_drawn_room(struct scene_drawn *d, const struct tree *tree) {
    static const struct tree_header none = {0};
    const struct tree_header *const h = tree != NULL ? tree->header : &none;
    const size_t corners = (size_t)h->corner_count + 24U * (size_t)d->extra_boxes + 1U,
                 elements = (size_t)h->element_count + d->extra_boxes + 1U;
    d->set = (struct shape_set){
        .vertices = malloc(corners * sizeof *d->set.vertices),
        .corners = malloc(4U * corners * sizeof *d->set.corners),
        .faces = malloc(corners * sizeof *d->set.faces),
        .planes = malloc(corners * sizeof *d->set.planes),
        .edges = malloc(corners * sizeof *d->set.edges),
        .objects = malloc(elements * sizeof *d->set.objects),
        .vertex_room = (uint32_t)corners,
        .corner_room = (uint32_t)(4U * corners),
        .face_room = (uint32_t)corners,
        .edge_room = (uint32_t)corners,
        .object_room = (uint32_t)elements,
    };
    d->part = malloc(elements * sizeof *d->part);
    d->point_room = h->point_count + h->node_count + 1U;
    d->points = malloc(d->point_room * sizeof *d->points);
    d->shape = (struct tree_shape_memory){
        .points = malloc(corners * sizeof *d->shape.points),
        .source = malloc(corners * sizeof *d->shape.source),
        .corners = malloc(2U * corners * sizeof *d->shape.corners),
        .counts = malloc(elements * sizeof *d->shape.counts),
        .point_room = (uint32_t)corners,
        .corner_room = (uint32_t)(2U * corners),
        .face_room = (uint32_t)elements,
        .place = malloc(((size_t)h->point_count + 1U) * sizeof *d->shape.place),
    };
    d->bytes = corners * (sizeof *d->set.vertices + 4U * sizeof *d->set.corners +
                          sizeof *d->set.faces + sizeof *d->set.planes + sizeof *d->set.edges) +
               elements * (sizeof *d->set.objects + sizeof *d->part) +
               d->point_room * sizeof *d->points;
    if (d->shape.place != NULL) {
        memset(d->shape.place, 0xff, ((size_t)h->point_count + 1U) * sizeof *d->shape.place);
    }
    return d->set.vertices != NULL && d->set.corners != NULL && d->set.faces != NULL &&
           d->set.planes != NULL && d->set.edges != NULL && d->set.objects != NULL &&
           d->part != NULL && d->points != NULL && d->shape.points != NULL &&
           d->shape.source != NULL && d->shape.corners != NULL && d->shape.counts != NULL &&
           d->shape.place != NULL;
}

/// The part that each node is, or is below of. NULL: no memory.
static uint32_t *find_parts(const struct tree *tree) {
    const uint32_t count = tree->header->node_count;
    uint32_t *const part = malloc(((size_t)count + 1U) * sizeof *part);
    if (part == NULL) {
        return NULL;
    }
    memset(part, 0xff, ((size_t)count + 1U) * sizeof *part);
    for (uint32_t i = 0; i < count; i++) { // parents come before their children
        const struct tree_node *const node = &tree->nodes[i];
        part[i] = node->part != TREE_NONE ? node->part : part[i];
        for (uint32_t k = 0; k < node->description_count; k++) {
            const struct tree_description *const d =
                &tree->descriptions[node->first_description + k];
            for (uint32_t c = 0; tree_kind(d) == TREE_NODES && c < d->count; c++) {
                part[d->first + c] = part[i];
            }
        }
    }
    return part;
}

/// The lines of a shape, as one wire frame; pairs of equal points are left out.
static enum shape_status add_lines(struct scene_drawn *d, const struct tree *tree,
                                   const struct tree_shape *shape) {
    uint32_t points = 0, ends = 0;
    for (uint32_t i = 0; i < shape->element_count; i++) {
        const struct tree_element *const e = &tree->elements[shape->first_element + i];
        for (uint32_t k = 0; e->kind == TREE_LINE && k < e->corner_count; k++) {
            d->shape.points[points] =
                tree_shape_point(tree, tree->corners[e->first_corner + k], d->finer);
            if (k != 0U && !vec3_equal(d->shape.points[points - 1U], d->shape.points[points])) {
                d->shape.corners[ends++] = points - 1U;
                d->shape.corners[ends++] = points;
            }
            points++;
        }
    }
    return ends == 0U
               ? SHAPE_OK
               : shape_add_wire(&d->set, d->shape.points, points, d->shape.corners, ends / 2U);
}

static bool told(enum shape_status status, const struct tree *tree, uint32_t part,
                 const char *file) {
    static const char *const why[] = {"",
                                      "is larger than its file says",
                                      "has a coordinate beyond 2^28 units",
                                      "has a face that is not planar",
                                      "is not convex",
                                      "does not close up",
                                      "has a face whose outline has no area or crosses itself"};
    if (status == SHAPE_OK) {
        return true;
    }
    const bool known = part != TREE_NONE && tree->parts[part].name != TREE_NONE;
    const char *const name = known ? tree->names + tree->parts[part].name : "";
    message_at(file, part != TREE_NONE ? tree->parts[part].line : 0U, "the object %s %s",
               message_quoted(name, strlen(name)).text, why[-(int)status]);
    return false;
}

static bool add_shape(struct scene_drawn *d, const struct tree *tree,
                      const struct tree_shape *shape, uint32_t part, const char *file) {
    uint32_t first = d->set.object_count;
    enum shape_status status = SHAPE_OK;
    if (shape->kind == TREE_SOLID) {
        status = tree_shape_add_solid(&d->set, tree, shape, d->finer, &d->shape);
    }
    for (uint32_t i = 0; shape->kind == TREE_FACES && i < shape->element_count; i++) {
        const struct tree_element *const e = &tree->elements[shape->first_element + i];
        if (status == SHAPE_OK && e->kind == TREE_FACE) {
            status = tree_shape_add_face(&d->set, tree, e, d->finer, &d->shape);
        }
    }
    if (status == SHAPE_OK) {
        status = add_lines(d, tree, shape);
    }
    for (; first < d->set.object_count; first++) {
        d->part[first] = part;
    }
    return told(status, tree, part, file);
}

enum exit_status scene_drawn_gather(struct scene_drawn *drawn, const struct tree *tree,
                                    const struct view *view, const char *file) {
    struct walk walk;
    struct walk_item item;
    uint32_t *const part = find_parts(tree);
    if (part == NULL || !scene_drawn_room(drawn, tree)) {
        free(part);
        (void)no_memory(file);
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    walk_start(&walk, tree, NULL, view);
    walk.shapes = true;
    while (status == EXIT_STATUS_OK && walk_next(&walk, &item)) {
        if (item.shape != NULL) {
            status = add_shape(drawn, tree, item.shape, part[item.shape->node], file)
                         ? EXIT_STATUS_OK
                         : EXIT_STATUS_USAGE;
            continue;
        }
        for (uint32_t i = 0; i < (item.points != NULL ? item.point_count : 1U); i++) {
            drawn->points[drawn->point_count++] =
                item.points != NULL ? vec3(item.points[i].x, item.points[i].y, item.points[i].z)
                                    : item.center;
        }
    }
    free(part);
    return status;
}

// ---------------------------------------------------------------- are they apart

struct box {
    int32_t low[3], high[3];
    uint32_t object;
};

static struct box box_of(const struct shape_set *set, uint32_t object) {
    const struct shape_object *const o = &set->objects[object];
    struct box box = {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}, object};
    for (uint32_t v = o->first_vertex; v < o->first_vertex + o->vertex_count; v++) {
        const int32_t at[3] = {set->vertices[v].x, set->vertices[v].y, set->vertices[v].z};
        for (int i = 0; i < 3; i++) {
            box.low[i] = at[i] < box.low[i] ? at[i] : box.low[i];
            box.high[i] = at[i] > box.high[i] ? at[i] : box.high[i];
        }
    }
    return box;
}

static int by_low(const void *a, const void *b) {
    const struct box *const p = a, *const q = b;
    return p->low[0] < q->low[0] ? -1 : p->low[0] > q->low[0];
}

static enum exit_status tell_pair(const struct scene_drawn *d, const struct tree *tree,
                                  const char *file, uint32_t a, uint32_t b) {
    const uint32_t part[2] = {d->part[a], d->part[b]};
    const char *name[2] = {"", ""};
    uint32_t line[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        if (part[i] != TREE_NONE) {
            name[i] = tree->parts[part[i]].name != TREE_NONE
                          ? tree->names + tree->parts[part[i]].name
                          : "";
            line[i] = tree->parts[part[i]].line;
        }
    }
    const int first = line[0] <= line[1] ? 0 : 1;
    message_at(file, line[1 - first],
               "the object %s and the object %s of line %u are not linearly separable: no plane "
               "is between them",
               message_quoted(name[1 - first], strlen(name[1 - first])).text,
               message_quoted(name[first], strlen(name[first])).text, line[first]);
    return EXIT_STATUS_USAGE;
}

enum exit_status scene_drawn_check(const struct scene_drawn *drawn, const struct tree *tree,
                                   const char *file) {
    const struct shape_set *const set = &drawn->set;
    struct box *const boxes = malloc(((size_t)set->object_count + 1U) * sizeof *boxes);
    uint32_t count = 0;
    enum exit_status status = EXIT_STATUS_OK;
    if (boxes == NULL) {
        (void)no_memory(file);
        return EXIT_STATUS_FAILURE;
    }
    for (uint32_t i = 0; i < set->object_count; i++) {
        if (set->objects[i].kind != SHAPE_WIRE) {
            boxes[count++] = box_of(set, i);
        }
    }
    qsort(boxes, count, sizeof *boxes, by_low);
    for (uint32_t i = 0; i < count && status == EXIT_STATUS_OK; i++) {
        for (uint32_t k = i + 1U; k < count && boxes[k].low[0] < boxes[i].high[0]; k++) {
            const uint32_t a = boxes[i].object, b = boxes[k].object;
            struct shape_plane plane;
            const bool meet =
                boxes[i].low[1] < boxes[k].high[1] && boxes[k].low[1] < boxes[i].high[1] &&
                boxes[i].low[2] < boxes[k].high[2] && boxes[k].low[2] < boxes[i].high[2];
            if (meet && drawn->part[a] != drawn->part[b] && !separate_pair(set, a, b, &plane)) {
                status = tell_pair(drawn, tree, file, a, b);
                break;
            }
        }
    }
    free(boxes);
    return status;
}

// ---------------------------------------------------------------- memory of the methods

/// More planes, until they suffice.
static enum exit_status find_planes(struct scene_drawn *d, const struct tree *tree,
                                    const char *file) {
    const uint32_t count = d->set.object_count;
    uint32_t fault[2];
    for (uint32_t room = 64;; room *= 4U) {
        const size_t bytes = SEPARATE_WORKSPACE_BYTES(count, room);
        free(d->planes);
        d->planes = malloc(bytes);
        if (d->planes == NULL) {
            (void)no_memory(file);
            return EXIT_STATUS_FAILURE;
        }
        switch (separate_build(&d->separate, &d->set, room, d->planes, bytes, fault)) {
        case SEPARATE_OK:
            d->bytes += bytes;
            return EXIT_STATUS_OK;
        case SEPARATE_ERROR_PAIR:
            return tell_pair(d, tree, file, fault[0], fault[1]);
        default:
            break;
        }
    }
}

enum exit_status scene_drawn_open(struct scene_drawn *drawn, const struct tree *tree,
                                  const char *file, bool levine) {
    const size_t bytes = hidden_workspace_bytes(&drawn->set);
    drawn->workspace = malloc(bytes);
    drawn->bytes += bytes;
    if (drawn->workspace == NULL ||
        hidden_open(&drawn->hidden, &drawn->set, drawn->workspace, bytes) != HIDDEN_OK) {
        (void)no_memory(file);
        return EXIT_STATUS_FAILURE;
    }
    return levine ? find_planes(drawn, tree, file) : EXIT_STATUS_OK;
}

void scene_drawn_free(struct scene_drawn *drawn) {
    free(drawn->set.vertices);
    free(drawn->set.corners);
    free(drawn->set.faces);
    free(drawn->set.planes);
    free(drawn->set.edges);
    free(drawn->set.objects);
    free(drawn->part);
    free(drawn->points);
    free(drawn->shape.points);
    free(drawn->shape.source);
    free(drawn->shape.corners);
    free(drawn->shape.counts);
    free(drawn->shape.place);
    free(drawn->workspace);
    free(drawn->planes);
    *drawn = (struct scene_drawn){0};
}
