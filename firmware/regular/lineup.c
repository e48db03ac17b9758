#include "regular/lineup.h"

#include "fixed/sort.h"
#include "regular/primitive.h"
#include "regular/rotation.h"

/// More than are ever needed; a bound, so that the search ends.
#define TURNS_MAX 2048U

/// p / q with q > 0; 0 / 0: the same direction, or the opposite one.
struct slope {
    int64_t p, q;
};

struct search {
    const struct vec3 *given;
    uint32_t count;
    struct slope *slopes; ///< by target: of the line to it
    struct vec3 *turned;
    uint32_t *order, *spare, *later;
    struct rotation rotation;
    struct lineup_result *result;
};

// ---------------------------------------------------------------- general position

/// x / z of a is less than that of b; z is not zero.
static bool has_less_x(const void *context, uint32_t a, uint32_t b) {
    const struct vec3 *const d = context;
    const int64_t left = (int64_t)d[a].x * d[b].z, right = (int64_t)d[b].x * d[a].z;
    return (d[a].z < 0) != (d[b].z < 0) ? left > right : left < right;
}

/// Section 2.1: sort by x; neighbours with the same x must be the same target in the picture.
static bool is_general(const struct search *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        s->order[i] = i;
        if (s->turned[i].z == 0) {
            return false;
        }
    }
    sort_indices(s->order, s->spare, s->count, has_less_x, s->turned);
    for (uint32_t i = 1; i < s->count; i++) {
        const struct vec3_i64 cross =
            vec3_cross(s->turned[s->order[i - 1U]], s->turned[s->order[i]]);
        if (cross.y == 0 && (cross.x | cross.z) != 0) {
            return false;
        }
    }
    return true;
}

/// Turns all of them. False: one does not fit.
static bool turn_all(struct search *s, const struct rotation *rotation) {
    s->rotation = *rotation;
    for (uint32_t i = 0; i < s->count; i++) {
        // As short as it can be, so that there is room for more rotations.
        const struct vec3 a = primitive_vec3(s->given[i]);
        if (!rotation_fits(rotation, a)) {
            return false;
        }
        s->turned[i] = rotation_apply(rotation, a);
    }
    return true;
}

static bool find_turn(struct search *s) {
    for (uint32_t number = 0; number < TURNS_MAX; number++) {
        const struct rotation rotation = rotation_try(number);
        s->result->turns = number;
        if (turn_all(s, &rotation) && is_general(s)) {
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------- slopes

/// Of the line in the picture through two targets.
static struct slope slope_between(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    const bool negative = cross.y < 0;
    return (struct slope){negative ? cross.x : -cross.x, negative ? -cross.y : cross.y};
}

/// Sign of the difference of two slopes.
static int slope_cmp(struct slope a, struct slope b) {
    return i128_cmp(i128_mul(a.p, b.q), i128_mul(b.p, a.q));
}

static bool is_less_steep(const void *context, uint32_t a, uint32_t b) {
    const struct slope *const slopes = context;
    return slope_cmp(slopes[a], slopes[b]) < 0;
}

static void note(struct search *s, uint32_t i, uint32_t j, uint32_t k) {
    struct lineup_result *const r = s->result;
    if (r->triples == 0U || i < r->first[0] ||
        (i == r->first[0] && (j < r->first[1] || (j == r->first[1] && k < r->first[2])))) {
        r->first[0] = i;
        r->first[1] = j;
        r->first[2] = k;
    }
}

/// Later targets of one slope, or in the same direction: a run of an ascending list, and all pairs
/// of it.
static void count_run(struct search *s, uint32_t i, const uint32_t *run, uint64_t size) {
    if (size > 1U) {
        note(s, i, run[0], run[1]);
        s->result->triples += size * (size - 1U) / 2U;
    }
}

/// All triples whose first target is i.
static void count_from(struct search *s, uint32_t i) {
    uint32_t sloped = 0, same = 0;
    for (uint32_t j = i + 1U; j < s->count; j++) {
        s->slopes[j] = slope_between(s->turned[i], s->turned[j]);
        if (s->slopes[j].q == 0) { // in general position: the same direction, or the opposite one
            s->later[same++] = j;
        } else {
            s->order[sloped++] = j;
        }
    }
    s->result->pairs += same;
    count_run(s, i, s->later, same);
    if (same > 0U && sloped > 0U) { // with each of these, any other one is in a plane
        const uint32_t a = s->later[0], b = s->order[0];
        note(s, i, a < b ? a : b, a < b ? b : a);
        s->result->triples += (uint64_t)same * sloped;
    }
    // Stable: the targets of a run ascend.
    sort_indices(s->order, s->spare, sloped, is_less_steep, s->slopes);
    for (uint32_t from = 0, to; from < sloped; from = to) {
        to = from + 1U;
        while (to < sloped && slope_cmp(s->slopes[s->order[from]], s->slopes[s->order[to]]) == 0) {
            to++;
        }
        count_run(s, i, s->order + from, to - from);
    }
}

/// The plane of the first triple, found among the turned ones.
static void find_normal(struct search *s) {
    static const unsigned pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    const uint32_t *const first = s->result->first;
    for (unsigned p = 0; p < 3U && s->result->triples != 0U; p++) {
        const struct vec3_i64 cross =
            vec3_cross(s->turned[first[pairs[p][0]]], s->turned[first[pairs[p][1]]]);
        if ((cross.x | cross.y | cross.z) != 0) {
            s->result->normal = rotation_back(&s->rotation, cross);
            return;
        }
    }
}

// ---------------------------------------------------------------- the whole

enum lineup_status lineup_find(const struct vec3 *directions, uint32_t count, bool turn,
                               void *workspace, size_t workspace_bytes,
                               struct lineup_result *result) {
    *result = (struct lineup_result){0};
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(directions[i])) {
            result->first[0] = i;
            return LINEUP_ERROR_ZERO_VECTOR;
        }
    }
    if (workspace_bytes < LINEUP_WORKSPACE_BYTES(count)) {
        return LINEUP_ERROR_WORKSPACE;
    }
    struct slope *const slopes = workspace;
    struct vec3 *const turned = (struct vec3 *)(void *)(slopes + count);
    uint32_t *const order = (uint32_t *)(void *)(turned + count);
    struct search search = {.given = directions,
                            .count = count,
                            .slopes = slopes,
                            .turned = turned,
                            .order = order,
                            .spare = order + count,
                            .later = order + 2U * (size_t)count,
                            .result = result};
    const struct rotation none = rotation_try(0);
    if (turn ? !find_turn(&search) : !turn_all(&search, &none)) {
        return LINEUP_ERROR_POSITION;
    }
    for (uint32_t i = 0; i < count; i++) {
        count_from(&search, i);
    }
    find_normal(&search);
    return LINEUP_OK;
}
