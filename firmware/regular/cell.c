#include "regular/cell.h"

#include "fixed/trig_fine.h"
#include "sphere/min_norm.h"

#include <stddef.h>

#define ONE_Q60 ((int64_t)1 << 60)

struct cell_circle cell_circle_from(struct vec3_i64 normal) {
    const struct vec3_i64 unit = disc_unit_q61(normal);
    return (struct cell_circle){
        normal, unit,
        vec3((int32_t)(unit.x >> 31), (int32_t)(unit.y >> 31), (int32_t)(unit.z >> 31))};
}

static struct vec3_i64 turned(struct vec3_i64 a, cell_side side) {
    return (side & 1U) != 0U ? (struct vec3_i64){-a.x, -a.y, -a.z} : a;
}

/// The unit normal toward the cell.
static struct vec3_i64 inward(const struct cell_circle *circles, cell_side side) {
    return turned(circles[side / 2U].unit_q61, side);
}

/// Two sides alone: the disc's sine is at most |a + b| / 2, its square (1 + a.b) / 2.
static bool too_narrow(const struct cell_best *best, const struct cell_circle *circles, cell_side a,
                       cell_side b) {
    const int64_t cosine = vec3_dot_unit(circles[a / 2U].unit_q30, circles[b / 2U].unit_q30);
    const int64_t most = (ONE_Q60 + (((a ^ b) & 1U) != 0U ? -cosine : cosine)) / 2;
    return most + (INT64_C(1) << 34) < best->square_q60;
}

static int64_t sine_of(const struct cell_circle *circles, cell_side side, struct vec3_i64 axis) {
    const struct i128 product = vec3_i64_dot(inward(circles, side), axis);
    return (int64_t)((uint64_t)product.hi << 3 | product.lo >> 61);
}

static struct min_norm_point point_of(const struct cell_circle *circles, cell_side side) {
    return (struct min_norm_point){.index = side, .exact = inward(circles, side)};
}

/// The support of the narrowest cap of the rounded normals.
static void solve(struct cell_best *best, const struct cell_circle *circles, const cell_side *sides,
                  uint32_t count, struct min_norm *support) {
    struct min_norm_point point = point_of(circles, sides[0]);
    min_norm_start(support, &point, false);
    uint32_t clean = 1;
    for (uint32_t i = 1; clean < count; i = i + 1U == count ? 0U : i + 1U) {
        point = point_of(circles, sides[i]);
        best->operations++;
        clean++;
        // A cell has an inside, so zero is not in the hull of its normals.
        if (min_norm_violated_by(support, &point) && min_norm_enter(support, &point)) {
            clean = 1;
        }
    }
}

static struct disc disc_from(const struct cell_circle *circles, const cell_side *sides,
                             uint8_t count) {
    struct disc disc = {.count = count};
    for (uint8_t i = 0; i < count; i++) {
        disc.support[i] = turned(circles[sides[i] / 2U].normal, sides[i]);
    }
    return disc;
}

/// The sides that touch the disc, as far as 2^-49 tells.
enum { TOUCHING_MOST = 12 };
struct touching {
    uint32_t count;
    cell_side side[TOUCHING_MOST];
};

static bool holds_all(const struct disc *disc, const struct cell_circle *circles,
                      const struct touching *touching) {
    if (disc->count == 3U && !disc_is_held(disc)) {
        return false;
    }
    for (uint32_t i = 0; i < touching->count; i++) {
        const cell_side side = touching->side[i];
        if (disc_excludes(disc, turned(circles[side / 2U].normal, side))) {
            return false;
        }
    }
    return true;
}

/// Which of the touching sides hold the disc, exactly: what the rounded normals say in almost all
/// cases, else every pair and triple.
static struct disc exact_disc(const struct cell_circle *circles, const struct touching *touching,
                              const struct min_norm *support) {
    cell_side sides[3];
    for (uint8_t i = 0; i < support->count; i++) {
        sides[i] = support->point[i].index;
    }
    const struct disc rounded = disc_from(circles, sides, support->count);
    if (holds_all(&rounded, circles, touching)) {
        return rounded;
    }
    for (uint32_t i = 0; i < touching->count; i++) {
        for (uint32_t j = i + 1U; j < touching->count; j++) {
            const cell_side pair[2] = {touching->side[i], touching->side[j]};
            const struct disc disc = disc_from(circles, pair, 2);
            if (holds_all(&disc, circles, touching)) {
                return disc;
            }
            for (uint32_t k = j + 1U; k < touching->count; k++) {
                const cell_side triple[3] = {pair[0], pair[1], touching->side[k]};
                const struct disc larger = disc_from(circles, triple, 3);
                if (holds_all(&larger, circles, touching)) {
                    return larger;
                }
            }
        }
    }
    return rounded; // more sides than TOUCHING_MOST touch it
}

static void take(struct cell_best *best, int64_t sine_q61) {
    best->any = true;
    best->sine_q61 = sine_q61;
    const int64_t low = (sine_q61 - 2 * CELL_ERROR) >> 31;
    best->square_q60 = low > 0 ? low * low : 0;
}

struct cell_sides {
    const struct cell_circle *circles;
    const cell_side *sides;
};

static struct vec3_i64 side_of(const void *context, uint32_t i, bool exact) {
    const struct cell_sides *const cell = context;
    const cell_side side = cell->sides[i];
    return exact ? turned(cell->circles[side / 2U].normal, side) : inward(cell->circles, side);
}

/// Is a point nearer than the sides are, in the middle of the disc? Then the best place is another
/// one: it is taken if it is better than the best. False: no point is in the way.
static bool consider_points(struct cell_best *best, const struct cell_circle *circles,
                            const cell_side *sides, uint32_t count, struct vec3_i64 axis,
                            int64_t sine_q61) {
    const struct cell_sides cell = {circles, sides};
    lone_list(best->lone, side_of, &cell, count);
    best->operations += 2U * best->lone->count;
    const int64_t clear =
        trig_fine_sincos(lone_distance(best->lone, axis)).sin_q62 / 2 + CELL_ERROR;
    if (clear >= sine_q61) {
        return false;
    }
    struct vec3_i64 at;
    const uint64_t distance = lone_best(best->lone, side_of, &cell, count, &at);
    const int64_t sine = trig_fine_sincos(distance).sin_q62 / 2;
    if (distance != 0U && (!best->any || sine > best->sine_q61)) {
        best->beside_points = true;
        best->at = at;
        take(best, sine);
    }
    return true;
}

void cell_consider(struct cell_best *best, const struct cell_circle *circles,
                   const cell_side *sides, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        best->operations++;
        if (best->any &&
            too_narrow(best, circles, sides[i], sides[i + 1U == count ? 0U : i + 1U])) {
            return;
        }
    }
    struct min_norm support;
    solve(best, circles, sides, count, &support);
    const struct vec3_i64 axis = disc_unit_q61(min_norm_direction(&support));
    int64_t sine = INT64_MAX;
    for (uint32_t i = 0; i < count; i++) {
        const int64_t here = sine_of(circles, sides[i], axis);
        sine = here < sine ? here : sine;
    }
    if (best->any && sine + 2 * CELL_ERROR < best->sine_q61) {
        return;
    }
    if (best->lone != NULL && consider_points(best, circles, sides, count, axis, sine)) {
        return;
    }
    struct touching touching = {0};
    for (uint32_t i = 0; i < count && touching.count < TOUCHING_MOST; i++) {
        if (sine_of(circles, sides[i], axis) < sine + CELL_ERROR) {
            touching.side[touching.count++] = sides[i];
        }
    }
    const struct disc disc = exact_disc(circles, &touching, &support);
    const bool better =
        !best->any || sine > best->sine_q61 + 2 * CELL_ERROR ||
        (best->beside_points ? sine > best->sine_q61 : disc_compare(&disc, &best->disc) > 0);
    if (better) {
        best->disc = disc;
        best->beside_points = false;
        take(best, sine);
    }
}
