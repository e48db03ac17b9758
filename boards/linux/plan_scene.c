#include "plan_scene.h"

#include <stdlib.h>

/// The finest description of an object; NULL: it has no faces.
static const struct scene_detail *faces_of(const struct scene_text *text, uint32_t first_detail,
                                           uint32_t object) {
    const uint32_t count = text->objects[object].detail_count;
    if (count == 0U) {
        return NULL;
    }
    const struct scene_detail *const detail = &text->details[first_detail + count - 1U];
    return detail->element_count == 0U || detail->shape == TREE_LINES ? NULL : detail;
}

static int compare_u32(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

// ---------------------------------------------------------------- memory

static bool take_shapes(struct plan_scene *scene, size_t corners, size_t points, size_t elements) {
    struct shape_set *const s = &scene->shapes;
    // A face of n corners is at most n pieces of three, and is cut with the outline beside them.
    s->vertex_room = (uint32_t)(corners + points + 1U);
    s->corner_room = (uint32_t)(4U * corners + 1U);
    s->face_room = s->edge_room = (uint32_t)(2U * corners + 1U);
    s->object_room = (uint32_t)(elements + 1U);
    s->vertices = malloc(s->vertex_room * sizeof *s->vertices);
    s->corners = malloc(s->corner_room * sizeof *s->corners);
    s->faces = malloc(s->face_room * sizeof *s->faces);
    s->planes = malloc(s->face_room * sizeof *s->planes);
    s->edges = malloc(s->edge_room * sizeof *s->edges);
    s->objects = malloc(s->object_room * sizeof *s->objects);
    scene->object = malloc(s->object_room * sizeof *scene->object);
    return s->vertices != NULL && s->corners != NULL && s->faces != NULL && s->planes != NULL &&
           s->edges != NULL && s->objects != NULL && scene->object != NULL;
}

static bool take_sight(struct plan_scene *scene) {
    const struct shape_set *const s = &scene->shapes;
    size_t bounds = 1, pieces = 1;
    for (uint32_t i = 0; i < s->object_count; i++) {
        const struct shape_object *const o = &s->objects[i];
        size_t corners = 0;
        for (uint32_t f = o->first_face; f < o->first_face + o->face_count; f++) {
            corners += s->faces[f].corner_count;
        }
        const size_t wanted = SIGHT_BOUNDS_MAX(o->face_count, o->edge_count, corners);
        bounds = wanted > bounds ? wanted : bounds;
        pieces = o->face_count > pieces ? o->face_count : pieces;
    }
    scene->sight.bound_room = (uint32_t)bounds;
    scene->sight.piece_room = (uint32_t)pieces;
    scene->sight.bounds = malloc(bounds * sizeof *scene->sight.bounds);
    scene->sight.pieces = malloc(pieces * sizeof *scene->sight.pieces);
    return scene->sight.bounds != NULL && scene->sight.pieces != NULL;
}

void plan_scene_free(struct plan_scene *scene) {
    struct shape_set *const s = &scene->shapes;
    free(s->vertices);
    free(s->corners);
    free(s->faces);
    free(s->planes);
    free(s->edges);
    free(s->objects);
    free(scene->object);
    free(scene->sight.bounds);
    free(scene->sight.pieces);
    *scene = (struct plan_scene){0};
}

// ---------------------------------------------------------------- shapes

struct builder {
    struct plan_scene *scene;
    const struct scene_text *text;
    const struct vec3 *vertices;
    bool bent;
    struct vec3 *points;        ///< of one object
    uint32_t *corners, *counts; ///< of its faces
};

static enum shape_status add_solid(struct builder *b, const struct scene_detail *detail) {
    const struct scene_text *const t = b->text;
    uint32_t corner_count = 0, face_count = 0, fault;
    const uint32_t *const list = t->points + detail->first;
    for (uint32_t i = 0; i < detail->count; i++) {
        b->points[i] = b->vertices[list[i]];
    }
    for (uint32_t e = 0; e < detail->element_count; e++) {
        const struct scene_element *const element = &t->elements[detail->first_element + e];
        if (element->kind != TREE_FACE) {
            continue;
        }
        b->counts[face_count++] = element->count;
        for (uint32_t k = 0; k < element->count; k++) {
            const uint32_t *const at = bsearch(&t->corners[element->first + k], list, detail->count,
                                               sizeof *list, compare_u32);
            b->corners[corner_count++] = (uint32_t)(at - list);
        }
    }
    return shape_add_solid(&b->scene->shapes, b->points, detail->count, b->corners, b->counts,
                           face_count, NULL, &fault);
}

static enum shape_status add_faces(struct builder *b, const struct scene_detail *detail) {
    const struct scene_text *const t = b->text;
    enum shape_status status = SHAPE_OK;
    for (uint32_t e = 0; e < detail->element_count && status == SHAPE_OK; e++) {
        const struct scene_element *const element = &t->elements[detail->first_element + e];
        for (uint32_t k = 0; k < element->count; k++) {
            b->points[k] = b->vertices[t->corners[element->first + k]];
        }
        if (element->kind == TREE_FACE) {
            status = shape_add_plane(&b->scene->shapes, b->points, element->count, b->bent);
        }
    }
    return status;
}

static enum exit_status add_all(struct builder *b, const char *file) {
    struct shape_set *const shapes = &b->scene->shapes;
    uint32_t first_detail = 0;
    for (uint32_t o = 0; o < b->text->object_count; o++) {
        const struct scene_detail *const detail = faces_of(b->text, first_detail, o);
        first_detail += b->text->objects[o].detail_count;
        const uint32_t before = shapes->object_count;
        const enum shape_status status = detail == NULL                ? SHAPE_OK
                                         : detail->shape == TREE_SOLID ? add_solid(b, detail)
                                                                       : add_faces(b, detail);
        if (status != SHAPE_OK) {
            message_at(file, detail->line, "%s",
                       status == SHAPE_ERROR_CAPACITY || !b->bent
                           ? "this object can't be used as it is"
                           : "this object loses its shape when rounded to the grid of targets and "
                             "mounts");
            return EXIT_STATUS_USAGE;
        }
        for (uint32_t i = before; i < shapes->object_count; i++) {
            b->scene->object[i] = o;
        }
    }
    return EXIT_STATUS_OK;
}

enum exit_status plan_scene_set(struct plan_scene *scene, const struct scene_text *text,
                                const char *file, const struct vec3 *vertices, bool exact) {
    *scene = (struct plan_scene){0};
    const size_t corners = text->corner_count, points = text->point_count,
                 elements = text->element_count;
    struct builder b = {.scene = scene, .text = text, .vertices = vertices, .bent = !exact};
    b.points = malloc((corners + points + 1U) * sizeof *b.points);
    b.corners = malloc((corners + 1U) * sizeof *b.corners);
    b.counts = malloc((elements + 1U) * sizeof *b.counts);
    enum exit_status status = EXIT_STATUS_FAILURE;
    if (corners < UINT32_MAX / 4U && b.points != NULL && b.corners != NULL && b.counts != NULL &&
        take_shapes(scene, corners, points, elements)) {
        status = add_all(&b, file);
        if (status == EXIT_STATUS_OK && !take_sight(scene)) {
            status = EXIT_STATUS_FAILURE;
        }
    }
    if (status == EXIT_STATUS_FAILURE) {
        message_at(file, 0, "no memory for its shapes");
    }
    free(b.points);
    free(b.corners);
    free(b.counts);
    return status;
}

// ---------------------------------------------------------------- what is hidden

uint32_t plan_scene_hidden(struct plan_scene *scene, struct vec3 from, const struct vec3 *targets,
                           uint32_t count, uint32_t *hidden, uint32_t *by) {
    struct sight *const sight = &scene->sight;
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        by[i] = SCENE_NONE;
    }
    for (uint32_t o = 0; o < scene->shapes.object_count; o++) {
        sight->eye = from;
        sight->bound_count = sight->piece_count = 0;
        const uint32_t pieces = sight_add(sight, &scene->shapes, o);
        for (uint32_t i = 0; i < count; i++) {
            const struct vec3 p = sight_from_eye(from, targets[i]);
            for (uint32_t k = 0; k < pieces && by[i] == SCENE_NONE; k++) {
                by[i] = sight_hides(sight, &sight->pieces[k], p) ? scene->object[o] : SCENE_NONE;
            }
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (by[i] != SCENE_NONE) {
            hidden[found] = i;
            by[found++] = by[i];
        }
    }
    return found;
}
