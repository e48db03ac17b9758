#include "property/support/ray.h"

void ray_point_init(struct ray_point *point) {
    for (int i = 0; i < 3; i++) {
        mpz_init(point->x[i]);
    }
    mpz_init(point->w);
}

void ray_point_clear(struct ray_point *point) {
    for (int i = 0; i < 3; i++) {
        mpz_clear(point->x[i]);
    }
    mpz_clear(point->w);
}

/// Newell's normal of a face.
static void face_normal(const struct ray_body *body, uint32_t face, mpz_t normal[3]) {
    const uint32_t from = body->first[face], count = body->first[face + 1U] - from;
    mpz_t p, q;
    mpz_inits(p, q, NULL);
    for (int i = 0; i < 3; i++) {
        const int u = (i + 1) % 3, v = (i + 2) % 3;
        mpz_set_ui(normal[i], 0);
        for (uint32_t k = 0; k < count; k++) {
            const int32_t *const a = body->corners[body->faces[from + k]];
            const int32_t *const b = body->corners[body->faces[from + (k + 1U) % count]];
            mpz_set_si(p, a[u]);
            mpz_mul_si(p, p, b[v]);
            mpz_set_si(q, a[v]);
            mpz_mul_si(q, q, b[u]);
            mpz_add(normal[i], normal[i], p);
            mpz_sub(normal[i], normal[i], q);
        }
    }
    mpz_clears(p, q, NULL);
}

/// height: normal . (place - corner) of a face, for the eye (at s = 0) and the point (s = 1); the
/// height along the way is from + s (to - from).
static void heights(const struct ray_body *body, uint32_t face, const int32_t eye[3],
                    const struct ray_point *point, mpq_t from, mpq_t to) {
    const int32_t *const corner = body->corners[body->faces[body->first[face]]];
    mpz_t normal[3], part, sum;
    mpz_inits(normal[0], normal[1], normal[2], part, sum, NULL);
    face_normal(body, face, normal);
    for (int i = 0; i < 3; i++) {
        mpz_mul_si(part, normal[i], (long)eye[i] - corner[i]);
        mpz_add(sum, sum, part);
    }
    mpq_set_z(from, sum);
    mpz_set_ui(sum, 0);
    for (int i = 0; i < 3; i++) {
        mpz_mul_si(part, point->w, corner[i]);
        mpz_sub(part, point->x[i], part);
        mpz_mul(part, part, normal[i]);
        mpz_add(sum, sum, part);
    }
    mpq_set_num(to, sum);
    mpq_set_den(to, point->w);
    mpq_canonicalize(to);
    mpz_clears(normal[0], normal[1], normal[2], part, sum, NULL);
}

/// The open interval of s where the way is below every face.
static bool solid_stops(const struct ray_body *body, const int32_t eye[3],
                        const struct ray_point *point) {
    mpq_t low, high, from, to, at;
    bool stopped = true;
    mpq_inits(low, high, from, to, at, NULL);
    mpq_set_ui(high, 1, 1);
    for (uint32_t f = 0; f < body->face_count && stopped; f++) {
        heights(body, f, eye, point, from, to);
        mpq_sub(to, to, from);
        const int slope = mpq_sgn(to);
        if (slope == 0) {
            stopped = mpq_sgn(from) < 0;
            continue;
        }
        mpq_div(at, from, to); // from + s slope < 0
        mpq_neg(at, at);
        if (slope > 0 && mpq_cmp(at, high) < 0) {
            mpq_set(high, at);
        }
        if (slope < 0 && mpq_cmp(at, low) > 0) {
            mpq_set(low, at);
        }
        stopped = mpq_cmp(low, high) < 0;
    }
    mpq_clears(low, high, from, to, at, NULL);
    return stopped;
}

/// Is a point of a polygon's plane strictly inside, looking along the axis where the polygon has
/// area?
static bool outline_holds(const struct ray_body *body, mpq_t at[3]) {
    mpz_t normal[3];
    mpz_inits(normal[0], normal[1], normal[2], NULL);
    face_normal(body, 0, normal);
    int axis = 0;
    while (mpz_sgn(normal[axis]) == 0) {
        axis++;
    }
    mpz_clears(normal[0], normal[1], normal[2], NULL);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const uint32_t count = body->first[1];
    bool inside = false, on = false;
    mpq_t a[2], b[2], p, q;
    mpq_inits(a[0], a[1], b[0], b[1], p, q, NULL);
    for (uint32_t k = 0; k < count && !on; k++) {
        const int32_t *const from = body->corners[body->faces[k]];
        const int32_t *const to = body->corners[body->faces[(k + 1U) % count]];
        mpq_set_si(a[0], from[u], 1);
        mpq_set_si(a[1], from[v], 1);
        mpq_set_si(b[0], to[u], 1);
        mpq_set_si(b[1], to[v], 1);
        for (int i = 0; i < 2; i++) {
            mpq_sub(a[i], a[i], at[i == 0 ? u : v]);
            mpq_sub(b[i], b[i], at[i == 0 ? u : v]);
        }
        mpq_mul(p, a[0], b[1]);
        mpq_mul(q, a[1], b[0]);
        const int turn = mpq_cmp(p, q);
        mpq_mul(p, a[0], b[0]);
        mpq_mul(q, a[1], b[1]);
        on = turn == 0 && mpq_sgn(p) <= 0 && mpq_sgn(q) <= 0;
        const bool a_up = mpq_sgn(a[1]) > 0, b_up = mpq_sgn(b[1]) > 0;
        if (a_up != b_up && (b_up ? turn > 0 : turn < 0)) {
            inside = !inside;
        }
    }
    mpq_clears(a[0], a[1], b[0], b[1], p, q, NULL);
    return inside && !on;
}

static bool plane_stops(const struct ray_body *body, const int32_t eye[3],
                        const struct ray_point *point) {
    mpq_t from, to, at[3], place, origin;
    bool stopped = false;
    mpq_inits(from, to, at[0], at[1], at[2], place, origin, NULL);
    heights(body, 0, eye, point, from, to);
    if (mpq_sgn(from) * mpq_sgn(to) < 0) {
        mpq_sub(to, from, to);
        mpq_div(from, from, to); // s
        for (int i = 0; i < 3; i++) {
            mpq_set_num(place, point->x[i]);
            mpq_set_den(place, point->w);
            mpq_canonicalize(place);
            mpq_set_si(origin, eye[i], 1);
            mpq_sub(at[i], place, origin);
            mpq_mul(at[i], at[i], from);
            mpq_add(at[i], at[i], origin);
        }
        stopped = outline_holds(body, at);
    }
    mpq_clears(from, to, at[0], at[1], at[2], place, origin, NULL);
    return stopped;
}

bool ray_is_stopped(const struct ray_body *body, const int32_t eye[3],
                    const struct ray_point *point) {
    return body->flat ? plane_stops(body, eye, point) : solid_stops(body, eye, point);
}
