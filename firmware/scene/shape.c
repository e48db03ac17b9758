#include "scene/shape.h"

static bool in_range(const struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 p = points[i];
        if (p.x > SHAPE_COORDINATE_MAX || p.x < -SHAPE_COORDINATE_MAX ||
            p.y > SHAPE_COORDINATE_MAX || p.y < -SHAPE_COORDINATE_MAX ||
            p.z > SHAPE_COORDINATE_MAX || p.z < -SHAPE_COORDINATE_MAX) {
            return false;
        }
    }
    return true;
}

struct shape_plane shape_plane_through(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3 u = vec3(b.x - a.x, b.y - a.y, b.z - a.z);
    const struct vec3 v = vec3(c.x - a.x, c.y - a.y, c.z - a.z);
    struct shape_plane plane = {vec3_cross(u, v), {0, 0}};
    plane.offset = vec3_i64_dot_vec3(plane.normal, a);
    return plane;
}

static bool is_zero(struct vec3_i64 v) {
    return (v.x | v.y | v.z) == 0;
}

static bool has_room(const struct shape_set *set, uint32_t vertices, uint32_t corners,
                     uint32_t faces, uint32_t edges) {
    return set->object_count < set->object_room &&
           vertices <= set->vertex_room - set->vertex_count &&
           corners <= set->corner_room - set->corner_count &&
           faces <= set->face_room - set->face_count && edges <= set->edge_room - set->edge_count;
}

/// The object that comes next; its vertices are copied. Its other counts grow as it is built.
static struct shape_object begin(struct shape_set *set, enum shape_kind kind,
                                 const struct vec3 *points, uint32_t count) {
    const struct shape_object object = {kind, set->vertex_count, count, set->face_count,
                                        0,    set->edge_count,   0};
    for (uint32_t i = 0; i < count; i++) {
        set->vertices[set->vertex_count + i] = points[i];
    }
    return object;
}

static void finish(struct shape_set *set, const struct shape_object *object, uint32_t corners) {
    set->objects[set->object_count++] = *object;
    set->vertex_count += object->vertex_count;
    set->face_count += object->face_count;
    set->edge_count += object->edge_count;
    set->corner_count += corners;
}

/// Adds the edge from a to b, as the face runs, or gives the edge that is there its second face.
static enum shape_status add_edge(struct shape_set *set, struct shape_object *object, uint32_t a,
                                  uint32_t b, uint32_t face, bool drawn) {
    struct shape_edge *const edges = set->edges + object->first_edge;
    for (uint32_t i = 0; i < object->edge_count; i++) {
        if (edges[i].from == b && edges[i].to == a) {
            if (edges[i].right != SHAPE_NONE) {
                return SHAPE_ERROR_CLOSED;
            }
            edges[i].right = face;
            edges[i].drawn = edges[i].drawn && drawn;
            return SHAPE_OK;
        }
        if (edges[i].from == a && edges[i].to == b) {
            return SHAPE_ERROR_CLOSED;
        }
    }
    if (object->edge_count == set->edge_room - set->edge_count) {
        return SHAPE_ERROR_CAPACITY;
    }
    edges[object->edge_count++] = (struct shape_edge){a, b, face, SHAPE_NONE, drawn};
    return SHAPE_OK;
}

/// The plane of a face, from the first corners that are not collinear; the others must be in it.
static enum shape_status flat_plane(const struct vec3 *points, const uint32_t *corners,
                                    uint32_t count, struct shape_plane *plane) {
    *plane = (struct shape_plane){{0, 0, 0}, {0, 0}};
    for (uint32_t k = 2; k < count && is_zero(plane->normal); k++) {
        *plane =
            shape_plane_through(points[corners[0]], points[corners[k - 1U]], points[corners[k]]);
    }
    if (is_zero(plane->normal)) {
        return SHAPE_ERROR_OUTLINE;
    }
    for (uint32_t k = 0; k < count; k++) {
        if (shape_side(plane, points[corners[k]]) != 0) {
            return SHAPE_ERROR_FLAT;
        }
    }
    return SHAPE_OK;
}

/// Does every vertex lie on the face's plane or behind it, and one behind it?
static bool is_behind(const struct vec3 *points, uint32_t count, const struct shape_plane *plane) {
    bool any = false;
    for (uint32_t i = 0; i < count; i++) {
        const int side = shape_side(plane, points[i]);
        if (side > 0) {
            return false;
        }
        any = any || side < 0;
    }
    return any;
}

/// Each turn of a face's outline goes left or straight on, once round: together with flat faces
/// that all vertices are behind, and two faces an edge, this makes the solid convex.
static bool turns_left(const struct vec3 *points, const uint32_t *corners, uint32_t count,
                       struct vec3_i64 normal) {
    const struct shape_plane face = {normal, {0, 0}};
    for (uint32_t k = 0; k < count; k++) {
        const struct vec3 a = points[corners[k]], b = points[corners[(k + 1U) % count]],
                          c = points[corners[(k + 2U) % count]];
        const struct vec3_i64 turn = shape_plane_through(a, b, c).normal;
        const struct i128 along =
            i128_add(i128_add(i128_mul(turn.x, face.normal.x), i128_mul(turn.y, face.normal.y)),
                     i128_mul(turn.z, face.normal.z));
        if (i128_sign(along) < 0 || vec3_equal(a, b)) {
            return false;
        }
    }
    return true;
}

static enum shape_status add_face(struct shape_set *set, struct shape_object *object,
                                  const struct vec3 *points, const uint32_t *corners,
                                  uint32_t count, const bool *drawn) {
    const uint32_t face = object->first_face + object->face_count;
    struct shape_plane *const plane = &set->planes[face];
    for (uint32_t k = 0; k < count; k++) {
        if (corners[k] >= object->vertex_count) {
            return SHAPE_ERROR_RANGE;
        }
    }
    const enum shape_status status = flat_plane(points, corners, count, plane);
    if (status != SHAPE_OK) {
        return status;
    }
    if (!is_behind(points, object->vertex_count, plane) ||
        !turns_left(points, corners, count, plane->normal)) {
        return SHAPE_ERROR_CONVEX;
    }
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t a = object->first_vertex + corners[k],
                       b = object->first_vertex + corners[(k + 1U) % count];
        const enum shape_status edge = add_edge(set, object, a, b, face, drawn == NULL || drawn[k]);
        if (edge != SHAPE_OK) {
            return edge;
        }
    }
    object->face_count++;
    return SHAPE_OK;
}

enum shape_status shape_add_solid(struct shape_set *set, const struct vec3 *points, uint32_t count,
                                  const uint32_t *corners, const uint32_t *corner_counts,
                                  uint32_t face_count, const bool *drawn, uint32_t *fault_face) {
    uint32_t corner = 0;
    *fault_face = 0;
    if (!in_range(points, count)) {
        return SHAPE_ERROR_RANGE;
    }
    for (uint32_t f = 0; f < face_count; f++) {
        corner += corner_counts[f];
    }
    if (!has_room(set, count, corner, face_count, 0)) {
        return SHAPE_ERROR_CAPACITY;
    }
    struct shape_object object = begin(set, SHAPE_SOLID, points, count);
    corner = 0;
    for (uint32_t f = 0; f < face_count; f++) {
        *fault_face = f;
        set->faces[object.first_face + f] =
            (struct shape_face){set->corner_count + corner, corner_counts[f]};
        const enum shape_status status =
            add_face(set, &object, points, corners + corner, corner_counts[f],
                     drawn == NULL ? NULL : drawn + corner);
        if (status != SHAPE_OK) {
            return status;
        }
        for (uint32_t k = 0; k < corner_counts[f]; k++, corner++) {
            set->corners[set->corner_count + corner] = object.first_vertex + corners[corner];
        }
    }
    for (uint32_t e = 0; e < object.edge_count; e++) {
        if (set->edges[object.first_edge + e].right == SHAPE_NONE) {
            *fault_face = set->edges[object.first_edge + e].left - object.first_face;
            return SHAPE_ERROR_CLOSED;
        }
    }
    // A double cover of one polygon, or nothing, has no inside.
    if (object.face_count < 4U) {
        return SHAPE_ERROR_CONVEX;
    }
    finish(set, &object, corner);
    return SHAPE_OK;
}

enum shape_status shape_add_wire(struct shape_set *set, const struct vec3 *points, uint32_t count,
                                 const uint32_t *ends, uint32_t edge_count) {
    if (!in_range(points, count)) {
        return SHAPE_ERROR_RANGE;
    }
    if (!has_room(set, count, 0, 0, edge_count)) {
        return SHAPE_ERROR_CAPACITY;
    }
    struct shape_object object = begin(set, SHAPE_WIRE, points, count);
    for (uint32_t e = 0; e < edge_count; e++) {
        const uint32_t a = ends[2U * e], b = ends[2U * e + 1U];
        if (a >= count || b >= count || vec3_equal(points[a], points[b])) {
            return SHAPE_ERROR_RANGE;
        }
        set->edges[object.first_edge + e] = (struct shape_edge){
            object.first_vertex + a, object.first_vertex + b, SHAPE_NONE, SHAPE_NONE, true};
    }
    object.edge_count = edge_count;
    finish(set, &object, 0);
    return SHAPE_OK;
}
