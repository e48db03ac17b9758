#include "scene/sight.h"

static struct vec3_i64 reversed(struct vec3_i64 v) {
    return (struct vec3_i64){-v.x, -v.y, -v.z};
}

static bool add_bound(struct sight *s, struct sight_piece *piece, struct vec3_i64 normal,
                      struct i128 offset, bool closed) {
    if (s->bound_count == s->bound_room) {
        return false;
    }
    s->bounds[s->bound_count++] = (struct sight_bound){normal, offset, closed};
    piece->count++;
    return true;
}

/// Behind the face. front: the eye's side of it.
static bool add_face(struct sight *s, struct sight_piece *piece, const struct shape_plane *plane,
                     int front) {
    const struct i128 offset =
        i128_sub(plane->offset, vec3_i64_dot_vec3(plane->normal, s->eye)); // of the eye's frame
    return front >= 0 ? add_bound(s, piece, plane->normal, offset, false)
                      : add_bound(s, piece, reversed(plane->normal), i128_neg(offset), false);
}

/// The side of an outline that runs from a to b with the inside to its left as the eye sees it:
/// inward is b x a, as the eye is at the origin.
static bool add_silhouette(struct sight *s, struct sight_piece *piece, const struct shape_set *set,
                           uint32_t a, uint32_t b, bool closed) {
    const struct vec3 u = sight_from_eye(s->eye, set->vertices[a]),
                      v = sight_from_eye(s->eye, set->vertices[b]);
    return add_bound(s, piece, vec3_cross(u, v), i128_from_i64(0), closed);
}

static bool add_piece(struct sight *s, struct sight_piece piece) {
    if (s->piece_count == s->piece_room) {
        return false;
    }
    s->pieces[s->piece_count++] = piece;
    return true;
}

static uint32_t add_solid(struct sight *s, const struct shape_set *set,
                          const struct shape_object *object) {
    struct sight_piece piece = {s->bound_count, 0};
    for (uint32_t f = object->first_face; f < object->first_face + object->face_count; f++) {
        const int front = shape_side(&set->planes[f], s->eye);
        if (front >= 0 && !add_face(s, &piece, &set->planes[f], front)) {
            return UINT32_MAX;
        }
    }
    for (uint32_t e = object->first_edge; e < object->first_edge + object->edge_count; e++) {
        const struct shape_edge *const edge = &set->edges[e];
        const bool left = shape_side(&set->planes[edge->left], s->eye) > 0,
                   right = shape_side(&set->planes[edge->right], s->eye) > 0;
        const uint32_t a = left ? edge->from : edge->to, b = left ? edge->to : edge->from;
        if (left != right && !add_silhouette(s, &piece, set, a, b, false)) {
            return UINT32_MAX;
        }
    }
    return add_piece(s, piece) ? 1U : UINT32_MAX;
}

static uint32_t add_plane(struct sight *s, const struct shape_set *set,
                          const struct shape_object *object) {
    uint32_t pieces = 0;
    for (uint32_t f = object->first_face; f < object->first_face + object->face_count; f++) {
        struct sight_piece piece = {s->bound_count, 0};
        const struct shape_face *const face = &set->faces[f];
        const int front = shape_side(&set->planes[f], s->eye);
        if (front == 0) {
            continue;
        }
        if (!add_face(s, &piece, &set->planes[f], front)) {
            return UINT32_MAX;
        }
        for (uint32_t k = 0; k < face->corner_count; k++) {
            const uint32_t corner = set->corners[face->first_corner + k];
            const uint32_t next = set->corners[face->first_corner + (k + 1U) % face->corner_count];
            const uint32_t a = corner & ~SHAPE_DIAGONAL, b = next & ~SHAPE_DIAGONAL;
            if (!add_silhouette(s, &piece, set, front > 0 ? a : b, front > 0 ? b : a,
                                (corner & SHAPE_DIAGONAL) != 0U)) {
                return UINT32_MAX;
            }
        }
        if (!add_piece(s, piece)) {
            return UINT32_MAX;
        }
        pieces++;
    }
    return pieces;
}

uint32_t sight_add(struct sight *sight, const struct shape_set *set, uint32_t object) {
    const struct shape_object *const o = &set->objects[object];
    return o->kind == SHAPE_SOLID   ? add_solid(sight, set, o)
           : o->kind == SHAPE_PLANE ? add_plane(sight, set, o)
                                    : 0U;
}

/// normal . p - offset: negative inside.
static struct i128 beyond(const struct sight_bound *bound, struct vec3 p) {
    return i128_sub(vec3_i64_dot_vec3(bound->normal, p), bound->offset);
}

bool sight_clip(const struct sight *sight, const struct sight_piece *piece, struct vec3 a,
                struct vec3 b, struct span *out) {
    *out = (struct span){fraction_whole(0), fraction_whole(1)};
    for (uint32_t i = piece->first; i < piece->first + piece->count; i++) {
        const struct sight_bound *const bound = &sight->bounds[i];
        const struct i128 at_a = beyond(bound, a), at_b = beyond(bound, b);
        const int sa = i128_sign(at_a), sb = i128_sign(at_b);
        if (sa >= 0 && sb >= 0) {
            if (sa == 0 && sb == 0 && bound->closed) {
                continue;
            }
            return false;
        }
        if (sa > 0) { // comes in at a / (a - b)
            const struct fraction in = {at_a, i128_sub(at_a, at_b)};
            if (fraction_cmp(in, out->from) > 0) {
                out->from = in;
            }
        } else if (sb > 0) { // goes out
            const struct fraction beyond_b = {i128_neg(at_a), i128_sub(at_b, at_a)};
            if (fraction_cmp(beyond_b, out->to) < 0) {
                out->to = beyond_b;
            }
        }
    }
    return fraction_cmp(out->from, out->to) < 0;
}

bool sight_hides(const struct sight *sight, const struct sight_piece *piece, struct vec3 p) {
    for (uint32_t i = piece->first; i < piece->first + piece->count; i++) {
        const int sign = i128_sign(beyond(&sight->bounds[i], p));
        if (sign > 0 || (sign == 0 && !sight->bounds[i].closed)) {
            return false;
        }
    }
    return true;
}

/// No less than |normal| * radius: a vector is at most 7 / 4 of its largest component, and that is
/// below the next power of two. radius: below 2^30; components below 2^62.
static struct i128 no_farther(struct vec3_i64 normal, uint32_t radius) {
    const unsigned bits =
        64U - u64_leading_zeros(u64_abs(normal.x) | u64_abs(normal.y) | u64_abs(normal.z));
    return i128_mul((int64_t)(((uint64_t)radius * 7U >> 2) + 1U), INT64_C(1) << bits);
}

bool sight_may_hide(const struct sight *sight, const struct sight_piece *piece, struct vec3 centre,
                    uint32_t radius) {
    for (uint32_t i = piece->first; i < piece->first + piece->count; i++) {
        const struct sight_bound *const bound = &sight->bounds[i];
        const struct i128 at = beyond(bound, centre);
        if (i128_sign(at) > 0 && i128_cmp(at, no_farther(bound->normal, radius)) > 0) {
            return false;
        }
    }
    return true;
}
