#include "scene/tree_shape.h"

static int32_t enlarged(int32_t coordinate, unsigned finer) {
    const int64_t large = (int64_t)((uint64_t)(int64_t)coordinate << finer);
    return large > INT32_MAX ? INT32_MAX : large < -INT32_MAX ? -INT32_MAX : (int32_t)large;
}

struct vec3 tree_shape_point(const struct tree *tree, uint32_t point, unsigned finer) {
    const struct tree_point *const p = &tree->points[point];
    return vec3(enlarged(p->x, finer), enlarged(p->y, finer), enlarged(p->z, finer));
}

/// Where a point of the tree stands among those of the shape; `count`: not yet.
static uint32_t place_of(const struct tree_shape_memory *memory, uint32_t point, uint32_t count) {
    if (memory->place != NULL) {
        return memory->place[point] == SHAPE_NONE ? count : memory->place[point];
    }
    uint32_t i = 0;
    while (i < count && memory->source[i] != point) {
        i++;
    }
    return i;
}

/// The corners of a solid's faces, by its own points. False: there is no room.
static bool list_corners(const struct tree *tree, const struct tree_shape *shape, unsigned finer,
                         const struct tree_shape_memory *memory, uint32_t *points,
                         uint32_t *faces) {
    uint32_t corners = 0;
    for (uint32_t i = 0; i < shape->element_count; i++) {
        const struct tree_element *const e = &tree->elements[shape->first_element + i];
        if (e->kind != TREE_FACE) {
            continue;
        }
        if (*faces == memory->face_room || e->corner_count > memory->corner_room - corners) {
            return false;
        }
        memory->counts[(*faces)++] = e->corner_count;
        for (uint32_t k = 0; k < e->corner_count; k++) {
            const uint32_t point = tree->corners[e->first_corner + k];
            const uint32_t at = place_of(memory, point, *points);
            if (at == *points) {
                if (*points == memory->point_room) {
                    return false;
                }
                memory->points[at] = tree_shape_point(tree, point, finer);
                memory->source[(*points)++] = point;
                if (memory->place != NULL) {
                    memory->place[point] = at;
                }
            }
            memory->corners[corners++] = at;
        }
    }
    return true;
}

enum shape_status tree_shape_add_solid(struct shape_set *set, const struct tree *tree,
                                       const struct tree_shape *shape, unsigned finer,
                                       const struct tree_shape_memory *memory) {
    uint32_t points = 0, faces = 0, fault;
    const bool fits = list_corners(tree, shape, finer, memory, &points, &faces);
    for (uint32_t i = 0; memory->place != NULL && i < points; i++) {
        memory->place[memory->source[i]] = SHAPE_NONE;
    }
    return fits ? shape_add_solid(set, memory->points, points, memory->corners, memory->counts,
                                  faces, NULL, &fault)
                : SHAPE_ERROR_CAPACITY;
}

enum shape_status tree_shape_add_face(struct shape_set *set, const struct tree *tree,
                                      const struct tree_element *face, unsigned finer,
                                      const struct tree_shape_memory *memory) {
    if (face->corner_count > memory->point_room) {
        return SHAPE_ERROR_CAPACITY;
    }
    for (uint32_t k = 0; k < face->corner_count; k++) {
        memory->points[k] = tree_shape_point(tree, tree->corners[face->first_corner + k], finer);
    }
    return shape_add_plane(set, memory->points, face->corner_count, false);
}
