/// Planes with any simple outline, as convex pieces.
#include "scene/shape.h"

/// An outline as seen along one axis, turned so that it runs counter-clockwise.
struct outline {
    const struct vec3 *points;
    uint32_t count;
    uint32_t u, v; ///< axes of the picture
};

static int32_t component(struct vec3 p, uint32_t axis) {
    return axis == 0U ? p.x : (axis == 1U ? p.y : p.z);
}

/// 1: c is left of the way from a to b; 0: on the line.
static int turn(const struct outline *o, uint32_t a, uint32_t b, uint32_t c) {
    const struct vec3 p = o->points[a], q = o->points[b], r = o->points[c];
    const int64_t qu = component(q, o->u) - component(p, o->u),
                  qv = component(q, o->v) - component(p, o->v),
                  ru = component(r, o->u) - component(p, o->u),
                  rv = component(r, o->v) - component(p, o->v);
    const int64_t area = qu * rv - qv * ru; // differences of 2^29
    return (area > 0) - (area < 0);
}

/// Twice the area as seen along the axis that is neither u nor v.
static struct i128 area_along(const struct vec3 *points, uint32_t count, uint32_t u, uint32_t v) {
    struct i128 area = {0, 0};
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 p = points[i], q = points[(i + 1U) % count];
        area = i128_add(area, i128_mul(component(p, u), component(q, v)));
        area = i128_sub(area, i128_mul(component(p, v), component(q, u)));
    }
    return area;
}

static struct i128 size_of(struct i128 a) {
    return i128_sign(a) < 0 ? i128_neg(a) : a;
}

/// Looks at the outline from where it appears largest. False: it has no area.
static bool look_at(struct outline *o, const struct vec3 *points, uint32_t count) {
    struct i128 best = {0, 0};
    *o = (struct outline){points, count, 0, 0};
    for (uint32_t axis = 0; axis < 3U; axis++) {
        const uint32_t u = (axis + 1U) % 3U, v = (axis + 2U) % 3U;
        const struct i128 area = area_along(points, count, u, v);
        if (i128_cmp(size_of(area), best) > 0) {
            best = size_of(area);
            o->u = i128_sign(area) > 0 ? u : v;
            o->v = i128_sign(area) > 0 ? v : u;
        }
    }
    return i128_sign(best) > 0;
}

/// Is c, on the line through a and b, between them or at one?
static bool between(const struct outline *o, uint32_t a, uint32_t b, uint32_t c) {
    const int32_t au = component(o->points[a], o->u), av = component(o->points[a], o->v),
                  bu = component(o->points[b], o->u), bv = component(o->points[b], o->v),
                  cu = component(o->points[c], o->u), cv = component(o->points[c], o->v);
    return ((au <= cu && cu <= bu) || (bu <= cu && cu <= au)) &&
           ((av <= cv && cv <= bv) || (bv <= cv && cv <= av));
}

/// Do two sides of the outline have a point in common?
static bool touch(const struct outline *o, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const int abc = turn(o, a, b, c), abd = turn(o, a, b, d), cda = turn(o, c, d, a),
              cdb = turn(o, c, d, b);
    return (abc * abd < 0 && cda * cdb < 0) || (abc == 0 && between(o, a, b, c)) ||
           (abd == 0 && between(o, a, b, d)) || (cda == 0 && between(o, c, d, a)) ||
           (cdb == 0 && between(o, c, d, b));
}

static bool is_simple(const struct outline *o) {
    const uint32_t n = o->count;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t b = (i + 1U) % n, c = (i + 2U) % n;
        // A side that runs back over the one before it.
        if (turn(o, i, b, c) == 0 && (between(o, i, b, c) || between(o, b, c, i))) {
            return false;
        }
        for (uint32_t j = i + 2U; j < n && !(i == 0U && j == n - 1U); j++) {
            if (touch(o, i, b, j, (j + 1U) % n)) {
                return false;
            }
        }
    }
    return true;
}

static bool is_convex(const struct outline *o) {
    for (uint32_t i = 0; i < o->count; i++) {
        if (turn(o, i, (i + 1U) % o->count, (i + 2U) % o->count) < 0) {
            return false;
        }
    }
    return true;
}

static bool is_flat(const struct outline *o, struct shape_plane *plane) {
    *plane = (struct shape_plane){{0, 0, 0}, {0, 0}};
    const struct vec3 *const p = o->points;
    uint32_t corner = 0;
    for (uint32_t i = 0; i < o->count && corner == 0U; i++) {
        const uint32_t b = (i + 1U) % o->count, c = (i + 2U) % o->count;
        if (turn(o, i, b, c) > 0) {
            *plane = shape_plane_through(p[i], p[b], p[c]);
            corner = 1;
        }
    }
    for (uint32_t i = 0; i < o->count; i++) {
        if (shape_side(plane, p[i]) != 0) {
            return false;
        }
    }
    return true;
}

/// May the corner ring[k] be cut off: does it turn left, with no other corner in its triangle?
static bool is_ear(const struct outline *o, const uint32_t *ring, uint32_t left, uint32_t k) {
    const uint32_t a = ring[(k + left - 1U) % left], b = ring[k], c = ring[(k + 1U) % left];
    if (turn(o, a, b, c) <= 0) {
        return false;
    }
    for (uint32_t i = 0; i < left; i++) {
        const uint32_t p = ring[i];
        if (p != a && p != b && p != c && turn(o, a, b, p) >= 0 && turn(o, b, c, p) >= 0 &&
            turn(o, c, a, p) >= 0) {
            return false;
        }
    }
    return true;
}

static void add_piece(struct shape_set *set, struct shape_object *object, const uint32_t *corner,
                      uint32_t count, uint32_t *corners_used, bool last) {
    const uint32_t face = object->first_face + object->face_count++;
    const uint32_t first = set->corner_count + *corners_used;
    const struct vec3 *const p = set->vertices + object->first_vertex;
    set->faces[face] = (struct shape_face){first, count};
    for (uint32_t k = 0; k < count; k++) {
        set->corners[first + k] = object->first_vertex + corner[k];
    }
    if (!last) {
        set->corners[first + count - 1U] |= SHAPE_DIAGONAL;
    }
    *corners_used += count;
    for (uint32_t k = 1; k + 1U < count; k++) {
        set->planes[face] = shape_plane_through(p[corner[0]], p[corner[k]], p[corner[k + 1U]]);
        if ((set->planes[face].normal.x | set->planes[face].normal.y |
             set->planes[face].normal.z) != 0) {
            break;
        }
    }
}

/// Cuts off ears. Corners that are straight go first, without a piece. ring: o->count corners,
/// behind the room for the pieces'.
static void cut_up(struct shape_set *set, struct shape_object *object, const struct outline *o,
                   uint32_t *ring, uint32_t *corners_used) {
    uint32_t left = o->count;
    for (uint32_t k = 0; k < left; k++) {
        ring[k] = k;
    }
    for (uint32_t k = 0; left >= 3U;) {
        const uint32_t a = ring[(k + left - 1U) % left], c = ring[(k + 1U) % left];
        const bool straight = turn(o, a, ring[k], c) == 0;
        if (!straight && !is_ear(o, ring, left, k)) {
            k = (k + 1U) % left;
            continue;
        }
        if (!straight) {
            const uint32_t ear[3] = {a, ring[k], c};
            add_piece(set, object, ear, 3, corners_used, left == 3U);
        }
        left--;
        for (uint32_t i = k; i < left; i++) {
            ring[i] = ring[i + 1U];
        }
        k = left == 0U ? 0U : k % left;
    }
}

enum shape_status shape_add_plane(struct shape_set *set, const struct vec3 *outline, uint32_t count,
                                  bool bent) {
    struct outline o;
    struct shape_plane plane;
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 p = outline[i];
        const int64_t most = SHAPE_COORDINATE_MAX;
        if (p.x > most || p.x < -most || p.y > most || p.y < -most || p.z > most || p.z < -most) {
            return SHAPE_ERROR_RANGE;
        }
    }
    if (count < 3U || !look_at(&o, outline, count) || !is_simple(&o)) {
        return SHAPE_ERROR_OUTLINE;
    }
    const bool flat = is_flat(&o, &plane);
    if (!flat && !bent) {
        return SHAPE_ERROR_FLAT;
    }
    if (set->object_count == set->object_room || count > set->vertex_room - set->vertex_count ||
        4U * count > set->corner_room - set->corner_count ||
        count > set->face_room - set->face_count || count > set->edge_room - set->edge_count) {
        return SHAPE_ERROR_CAPACITY;
    }
    struct shape_object object = {SHAPE_PLANE, set->vertex_count, count, set->face_count,
                                  0,           set->edge_count,   count};
    uint32_t corners_used = 0;
    uint32_t *const ring = set->corners + set->corner_count + 3U * count;
    for (uint32_t i = 0; i < count; i++) {
        set->vertices[object.first_vertex + i] = outline[i];
        set->edges[object.first_edge + i] =
            (struct shape_edge){object.first_vertex + i, object.first_vertex + (i + 1U) % count,
                                SHAPE_NONE, SHAPE_NONE, true};
        ring[i] = i;
    }
    if (flat && is_convex(&o)) {
        add_piece(set, &object, ring, count, &corners_used, true);
    } else {
        cut_up(set, &object, &o, ring, &corners_used);
    }
    set->objects[set->object_count++] = object;
    set->vertex_count += count;
    set->edge_count += count;
    set->face_count += object.face_count;
    set->corner_count += corners_used;
    return SHAPE_OK;
}
