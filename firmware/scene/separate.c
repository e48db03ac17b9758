#include "scene/separate.h"

/// On which sides of a plane an object has vertices.
struct sides {
    bool front, back;
};

static struct sides sides_of(const struct shape_set *set, uint32_t object,
                             const struct shape_plane *plane) {
    const struct shape_object *const o = &set->objects[object];
    struct sides sides = {false, false};
    for (uint32_t v = o->first_vertex;
         v < o->first_vertex + o->vertex_count && !(sides.front && sides.back); v++) {
        const int side = shape_side(plane, set->vertices[v]);
        sides.front = sides.front || side > 0;
        sides.back = sides.back || side < 0;
    }
    return sides;
}

/// Is one object in front of the plane or on it, the other behind it or on it, and one of them not
/// in it as a whole?
static bool is_between(const struct shape_set *set, uint32_t a, uint32_t b,
                       const struct shape_plane *plane) {
    if ((plane->normal.x | plane->normal.y | plane->normal.z) == 0) {
        return false;
    }
    const struct sides sa = sides_of(set, a, plane);
    if (sa.front && sa.back) {
        return false;
    }
    const struct sides sb = sides_of(set, b, plane);
    return !(sb.front && sb.back) && !(sa.front && sb.front) && !(sa.back && sb.back);
}

static struct vec3 way_between(struct vec3 from, struct vec3 to) {
    return vec3(to.x - from.x, to.y - from.y, to.z - from.z);
}

static bool face_between(const struct shape_set *set, uint32_t a, uint32_t b, uint32_t of,
                         struct shape_plane *out) {
    const struct shape_object *const o = &set->objects[of];
    for (uint32_t f = o->first_face; f < o->first_face + o->face_count; f++) {
        if (is_between(set, a, b, &set->planes[f])) {
            *out = set->planes[f];
            return true;
        }
    }
    return false;
}

/// The edges of an object's convex hull, and perhaps more: of a plane in pieces each two corners.
static uint32_t ways(const struct shape_object *o) {
    return o->kind == SHAPE_PLANE && o->face_count > 1U
               ? o->vertex_count * o->vertex_count // i * count + k; those with i >= k are empty
               : o->edge_count;
}

static bool way_at(const struct shape_set *set, const struct shape_object *o, uint32_t index,
                   struct vec3 *from, struct vec3 *way) {
    uint32_t a, b;
    if (o->kind == SHAPE_PLANE && o->face_count > 1U) {
        a = o->first_vertex + index / o->vertex_count;
        b = o->first_vertex + index % o->vertex_count;
    } else {
        a = set->edges[o->first_edge + index].from;
        b = set->edges[o->first_edge + index].to;
    }
    *from = set->vertices[a];
    *way = way_between(*from, set->vertices[b]);
    return o->kind != SHAPE_PLANE || o->face_count == 1U || a < b;
}

static bool edges_between(const struct shape_set *set, uint32_t a, uint32_t b,
                          struct shape_plane *out) {
    const struct shape_object *const p = &set->objects[a], *const q = &set->objects[b];
    struct vec3 from, way, other_from, other_way;
    for (uint32_t i = 0; i < ways(p); i++) {
        if (!way_at(set, p, i, &from, &way)) {
            continue;
        }
        for (uint32_t k = 0; k < ways(q); k++) {
            if (!way_at(set, q, k, &other_from, &other_way)) {
                continue;
            }
            out->normal = vec3_cross(way, other_way);
            out->offset = vec3_i64_dot_vec3(out->normal, from);
            if (is_between(set, a, b, out)) {
                return true;
            }
        }
    }
    return false;
}

static int32_t component(struct vec3 p, uint32_t axis) {
    return axis == 0U ? p.x : (axis == 1U ? p.y : p.z);
}

/// Lowest and highest coordinate of an object along an axis.
static void range_of(const struct shape_set *set, uint32_t object, uint32_t axis, int32_t *low,
                     int32_t *high) {
    const struct shape_object *const o = &set->objects[object];
    *low = INT32_MAX;
    *high = INT32_MIN;
    for (uint32_t v = o->first_vertex; v < o->first_vertex + o->vertex_count; v++) {
        const int32_t at = component(set->vertices[v], axis);
        *low = at < *low ? at : *low;
        *high = at > *high ? at : *high;
    }
}

/// A plane upright on an axis: these serve most other pairs, too.
static bool axis_between(const struct shape_set *set, uint32_t a, uint32_t b,
                         struct shape_plane *out) {
    for (uint32_t axis = 0; axis < 3U; axis++) {
        int32_t a_low, a_high, b_low, b_high;
        range_of(set, a, axis, &a_low, &a_high);
        range_of(set, b, axis, &b_low, &b_high);
        if (a_high <= b_low || b_high <= a_low) {
            out->normal = (struct vec3_i64){axis == 0U, axis == 1U, axis == 2U};
            out->offset = i128_from_i64(a_high <= b_low ? a_high : b_high);
            return true;
        }
    }
    return false;
}

bool separate_pair(const struct shape_set *set, uint32_t a, uint32_t b, struct shape_plane *out) {
    return axis_between(set, a, b, out) || face_between(set, a, b, a, out) ||
           face_between(set, a, b, b, out) || edges_between(set, a, b, out);
}

/// Do rows l and m differ in a plane that both are on one side of?
static bool are_apart(const struct separate *s, uint32_t l, uint32_t m) {
    const uint32_t *const pl = s->side + (size_t)l * s->row_words,
                          *const pm = s->side + (size_t)m * s->row_words,
                          *const bl = s->both + (size_t)l * s->row_words,
                          *const bm = s->both + (size_t)m * s->row_words;
    for (uint32_t w = 0; w < (s->plane_count + 31U) / 32U; w++) {
        if (((pl[w] ^ pm[w]) & bl[w] & bm[w]) != 0U) {
            return true;
        }
    }
    return false;
}

/// A column for each object.
static void add_plane(struct separate *s, const struct separate_plane *plane) {
    const uint32_t word = s->plane_count / 32U, bit = UINT32_C(1) << s->plane_count % 32U;
    s->planes[s->plane_count++] = *plane;
    for (uint32_t i = 0; i < s->set->object_count; i++) {
        const struct sides sides = sides_of(s->set, i, &plane->plane);
        const bool in_plane = !sides.front && !sides.back;
        if (sides.front ? !sides.back : in_plane && plane->inside_front) {
            s->side[(size_t)i * s->row_words + word] |= bit;
        }
        if (!(sides.front && sides.back)) {
            s->both[(size_t)i * s->row_words + word] |= bit;
        }
    }
}

static bool in_plane(const struct shape_set *set, uint32_t object,
                     const struct shape_plane *plane) {
    const struct sides sides = sides_of(set, object, plane);
    return !sides.front && !sides.back;
}

static enum separate_status separate_two(struct separate *s, uint32_t a, uint32_t b) {
    struct separate_plane found;
    if (are_apart(s, a, b)) {
        return SEPARATE_OK;
    }
    if (!separate_pair(s->set, a, b, &found.plane)) {
        return SEPARATE_ERROR_PAIR;
    }
    const bool a_in = in_plane(s->set, a, &found.plane), b_in = in_plane(s->set, b, &found.plane);
    if (a_in && b_in) {
        return SEPARATE_OK; // polygons in one plane: neither ever hides the other
    }
    if (s->plane_count == s->plane_room) {
        return SEPARATE_ERROR_CAPACITY;
    }
    found.inside_front =
        a_in ? !sides_of(s->set, b, &found.plane).front : !sides_of(s->set, a, &found.plane).front;
    add_plane(s, &found);
    return SEPARATE_OK;
}

enum separate_status separate_build(struct separate *separate, const struct shape_set *set,
                                    uint32_t plane_room, void *workspace, size_t workspace_bytes,
                                    uint32_t fault[2]) {
    const uint32_t words = (plane_room + 31U) / 32U;
    const size_t row_count = 2U * (size_t)set->object_count + 2U;
    fault[0] = fault[1] = 0;
    if (workspace_bytes < SEPARATE_WORKSPACE_BYTES(set->object_count, plane_room)) {
        return SEPARATE_ERROR_CAPACITY;
    }
    struct separate_plane *const planes = workspace;
    uint32_t *const rows = (uint32_t *)(void *)(planes + plane_room);
    for (size_t i = 0; i < row_count * words; i++) {
        rows[i] = 0;
    }
    *separate = (struct separate){
        .set = set,
        .planes = planes,
        .side = rows,
        .both = rows + (size_t)set->object_count * words,
        .eye = rows + 2U * (size_t)set->object_count * words,
        .level = rows + (2U * (size_t)set->object_count + 1U) * words,
        .plane_room = plane_room,
        .row_words = words,
        .workspace_bytes = SEPARATE_WORKSPACE_BYTES(set->object_count, plane_room),
    };
    for (uint32_t a = 0; a < set->object_count; a++) {
        for (uint32_t b = a + 1U; b < set->object_count; b++) {
            if (set->objects[a].kind == SHAPE_WIRE || set->objects[b].kind == SHAPE_WIRE) {
                continue;
            }
            const enum separate_status status = separate_two(separate, a, b);
            if (status != SEPARATE_OK) {
                fault[0] = a;
                fault[1] = b;
                return status;
            }
        }
    }
    return SEPARATE_OK;
}

void separate_look(struct separate *separate, struct vec3 eye) {
    for (uint32_t w = 0; w < separate->row_words; w++) {
        separate->eye[w] = separate->level[w] = 0;
    }
    for (uint32_t j = 0; j < separate->plane_count; j++) {
        const int side = shape_side(&separate->planes[j].plane, eye);
        const uint32_t bit = UINT32_C(1) << j % 32U;
        separate->eye[j / 32U] |= side > 0 ? bit : 0U;
        separate->level[j / 32U] |= side == 0 ? bit : 0U;
    }
}

enum separate_order separate_order(const struct separate *separate, uint32_t l, uint32_t m) {
    const size_t words = separate->row_words;
    const uint32_t *const pl = separate->side + l * words, *const pm = separate->side + m * words,
                          *const bl = separate->both + l * words,
                          *const bm = separate->both + m * words;
    uint32_t l_before = 0, m_before = 0, level = 0;
    for (uint32_t w = 0; w < (separate->plane_count + 31U) / 32U; w++) {
        const uint32_t apart = (pl[w] ^ pm[w]) & bl[w] & bm[w];
        const uint32_t l_marked = ~(pl[w] ^ separate->eye[w]); // on the eye's side
        level |= apart & separate->level[w];
        l_before |= l_marked & apart & ~separate->level[w];
        m_before |= ~l_marked & apart & ~separate->level[w];
    }
    if (level != 0U || (l_before != 0U && m_before != 0U)) {
        return SEPARATE_NEITHER;
    }
    return l_before != 0U ? SEPARATE_BEFORE : m_before != 0U ? SEPARATE_BEHIND : SEPARATE_UNKNOWN;
}
