#include "regular/lone.h"

#include "fixed/real.h"
#include "fixed/trig_fine.h"

bool lone_is_on(struct vec3 line, struct vec3_i64 normal) {
    return i128_sign(vec3_i64_dot_vec3(normal, line)) == 0;
}

void lone_list(struct lone *lone, lone_side *inward, const void *context, uint32_t side_count) {
    lone->inside_count = 0;
    for (uint32_t p = 0; p < 2U * lone->count; p++) {
        const struct vec3 line = lone->lines[p / 2U];
        const struct vec3 point = p % 2U == 0U ? line : vec3_neg(line);
        bool inside = true;
        for (uint32_t i = 0; i < side_count && inside; i++) {
            inside = i128_sign(vec3_i64_dot_vec3(inward(context, i, true), point)) > 0;
        }
        if (inside) {
            lone->inside[lone->inside_count++] = disc_unit_q61(vec3_widen(point));
        }
    }
}

uint64_t lone_distance(const struct lone *lone, struct vec3_i64 at) {
    uint64_t least = TURN64_QUARTER;
    for (uint32_t i = 0; i < lone->inside_count; i++) {
        const uint64_t angle = trig_fine_angle(at, lone->inside[i]);
        least = angle < least ? angle : least;
    }
    return least;
}

// ---------------------------------------------------------------- places

struct real3 {
    struct real x, y, z;
};

static struct real3 real3_from(struct vec3_i64 a) {
    return (struct real3){real(a.x, -61), real(a.y, -61), real(a.z, -61)};
}

static struct real3 real3_cross(const struct real3 *a, const struct real3 *b) {
    return (struct real3){real_sub(real_mul(a->y, b->z), real_mul(a->z, b->y)),
                          real_sub(real_mul(a->z, b->x), real_mul(a->x, b->z)),
                          real_sub(real_mul(a->x, b->y), real_mul(a->y, b->x))};
}

static struct real real3_dot(const struct real3 *a, const struct real3 *b) {
    return real_add(real_add(real_mul(a->x, b->x), real_mul(a->y, b->y)), real_mul(a->z, b->z));
}

static struct real3 real3_add(const struct real3 *a, struct real by, const struct real3 *b) {
    return (struct real3){real_add(a->x, real_mul(by, b->x)), real_add(a->y, real_mul(by, b->y)),
                          real_add(a->z, real_mul(by, b->z))};
}

/// What a place keeps its distance from.
enum kind {
    KIND_SIDE,  ///< the sine of the distance is the product with it
    KIND_POINT, ///< the cosine is
    KIND_PLANE  ///< the place is in this plane
};

struct cell {
    struct lone *lone;
    lone_side *inward;
    const void *context;
    uint32_t side_count;
    uint64_t best;
    struct vec3_i64 at;
};

static struct real3 thing(const struct cell *cell, uint32_t i, enum kind *kind) {
    *kind = i < cell->side_count ? KIND_SIDE : KIND_POINT;
    return real3_from(*kind == KIND_SIDE ? cell->inward(cell->context, i, false)
                                         : cell->lone->inside[i - cell->side_count]);
}

static void try_place(struct cell *cell, const struct real3 *place, int sign) {
    const struct real length = real_root(real3_dot(place, place));
    if (real_sign(length) == 0) {
        return;
    }
    const struct real scale = real_div(real(sign, 0), length);
    const struct vec3_i64 at = {real_to_i64(real_mul(place->x, scale), 60),
                                real_to_i64(real_mul(place->y, scale), 60),
                                real_to_i64(real_mul(place->z, scale), 60)};
    uint64_t least = lone_distance(cell->lone, at);
    for (uint32_t i = 0; i < cell->side_count && least > cell->best; i++) {
        const uint64_t off = trig_fine_angle(at, cell->inward(cell->context, i, false));
        const uint64_t distance = off < TURN64_QUARTER ? TURN64_QUARTER - off : 0U;
        least = distance < least ? distance : least;
    }
    if (least > cell->best) {
        cell->best = least;
        cell->at = at;
    }
}

/// All places v with row . v = s for sides, c for points and 0 for planes, where s / c is the
/// tangent of the distance: v is s U + c W for two vectors, by Cramer's rule, and of length 1 if
/// (U.U - D^2) t^2 + 2 U.W t + (W.W - D^2) = 0, t = s / c, D the determinant.
static void try_three(struct cell *cell, const struct real3 row[3], const enum kind kind[3]) {
    const struct real zero = real(0, 0), one = real(1, 0);
    struct real3 u = {zero, zero, zero}, w = u, cross[3];
    for (unsigned i = 0; i < 3U; i++) {
        cross[i] = real3_cross(&row[(i + 1U) % 3U], &row[(i + 2U) % 3U]);
        if (kind[i] == KIND_SIDE) {
            u = real3_add(&u, one, &cross[i]);
        } else if (kind[i] == KIND_POINT) {
            w = real3_add(&w, one, &cross[i]);
        }
    }
    const struct real det = real3_dot(&row[0], &cross[0]), det2 = real_mul(det, det);
    const int sign = real_sign(det) < 0 ? -1 : 1;
    const struct real a = real_sub(real3_dot(&u, &u), det2), b = real3_dot(&u, &w);
    const struct real c = real_sub(real3_dot(&w, &w), det2);
    const struct real root = real_root(real_sub(real_mul(b, b), real_mul(a, c)));
    if (real_sign(real3_dot(&u, &u)) == 0) { // points only: the centre of their circle
        try_place(cell, &w, 1);
        try_place(cell, &w, -1);
        return;
    }
    for (int k = -1; k <= 1; k += 2) {
        // Without cancellation: one root as q / a, the other as c / q.
        const struct real q =
            real_sign(b) < 0 ? real_add(real_neg(b), root) : real_sub(real_neg(b), root);
        const struct real t = k < 0 ? real_div(q, a) : real_div(c, q);
        if (real_sign(t) > 0) {
            const struct real3 place = real3_add(&w, t, &u);
            try_place(cell, &place, sign);
        }
    }
}

uint64_t lone_best(struct lone *lone, lone_side *inward, const void *context, uint32_t side_count,
                   struct vec3_i64 *at) {
    struct cell cell = {lone, inward, context, side_count, 0, {0, 0, 0}};
    const uint32_t things = side_count + lone->inside_count;
    for (uint32_t i = side_count; i < things; i++) {
        struct real3 row[3];
        enum kind kind[3];
        row[0] = thing(&cell, i, &kind[0]);
        for (uint32_t j = 0; j < i; j++) {
            row[1] = thing(&cell, j, &kind[1]);
            row[2] = real3_cross(&row[0], &row[1]);
            kind[2] = KIND_PLANE;
            try_three(&cell, row, kind);
            for (uint32_t k = 0; k < j; k++) {
                row[2] = thing(&cell, k, &kind[2]);
                try_three(&cell, row, kind);
            }
        }
    }
    *at = cell.at;
    return cell.best;
}
