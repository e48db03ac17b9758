#include "regular/gap.h"

#include "fixed/sort.h"
#include "fixed/trig.h"
#include "fixed/trig_fine.h"

#define NONE UINT32_MAX
/// Lines have directions modulo half a turn, of 2^64 a turn.
#define HALF_TURN (UINT64_C(1) << 63)

void gap_open(struct gap *gap, uint32_t count, bool buckets, bool weighted, struct arena *arena) {
    const uint64_t words = buckets ? 2U * (uint64_t)count + 1U : count;
    *gap = (struct gap){.count = count};
    gap->list = arena_take(arena, words, sizeof *gap->list);
    gap->spare = arena_take(arena, words, sizeof *gap->spare);
    gap->start = arena_take(arena, weighted ? count : 0U, sizeof *gap->start);
}

static int64_t cross(struct vec3 a, struct vec3 b) {
    return (int64_t)a.x * b.y - (int64_t)a.y * b.x;
}

static int64_t dot(struct vec3 a, struct vec3 b) {
    return (int64_t)a.x * b.x + (int64_t)a.y * b.y;
}

// Primitive lines point to the right, or up: from -y, exclusive, to +y they are in order.
static bool before(const void *context, uint32_t a, uint32_t b) {
    const struct gap *const gap = context;
    return cross(gap->lines[a], gap->lines[b]) > 0;
}

static bool counted_before(const void *context, uint32_t a, uint32_t b) {
    struct gap *const gap = *(struct gap *const *)context;
    gap->operations++;
    return before(gap, a, b);
}

/// Takes the gap between two lines if it is wider: by the cotangents. to may be half a turn from
/// from, no more.
static void consider(struct gap *gap, struct vec3 from, struct vec3 to) {
    gap->operations++;
    const int64_t sine = cross(from, to), sine_so_far = cross(gap->from, gap->to);
    if (sine == 0) {
        // The same direction is no gap, the opposite one the widest.
        if (dot(from, to) < 0) {
            gap->from = from;
            gap->to = to;
        }
    } else if (vec3_is_zero(gap->from) ||
               (sine_so_far != 0 && i128_cmp(i128_mul(dot(from, to), sine_so_far),
                                             i128_mul(dot(gap->from, gap->to), sine)) < 0)) {
        gap->from = from;
        gap->to = to;
    }
}

static void widest_sorted(struct gap *gap) {
    for (uint32_t i = 0; i < gap->count; i++) {
        gap->list[i] = i;
    }
    struct gap *const self = gap;
    sort_indices(gap->list, gap->spare, gap->count, counted_before, &self);
    for (uint32_t i = 1; i < gap->count; i++) {
        consider(gap, gap->lines[gap->list[i - 1U]], gap->lines[gap->list[i]]);
    }
    consider(gap, gap->lines[gap->list[gap->count - 1U]], vec3_neg(gap->lines[gap->list[0]]));
}

/// A measure that grows with the angle: x / (x - y) below the x axis, 1 + y / (x + y) above. Its
/// slope is between 1 and 1/2 a radian, so 1 / count of it is at most 2 / count rad: less than the
/// mean gap, pi / count.
static uint32_t bucket_of(struct vec3 line, uint32_t count) {
    const uint64_t x = u64_abs(line.x), y = u64_abs(line.y);
    return line.y < 0 ? (uint32_t)(x * count / (x + y)) : count + (uint32_t)(y * count / (x + y));
}

static void widest_by_buckets(struct gap *gap) {
    const uint32_t buckets = 2U * gap->count + 1U;
    uint32_t *const first = gap->list, *const last = gap->spare;
    for (uint32_t b = 0; b < buckets; b++) {
        first[b] = NONE;
    }
    for (uint32_t i = 0; i < gap->count; i++) {
        const uint32_t b = bucket_of(gap->lines[i], gap->count);
        gap->operations++;
        if (first[b] == NONE || before(gap, i, first[b])) {
            last[b] = first[b] == NONE ? i : last[b];
            first[b] = i;
        } else if (before(gap, last[b], i)) {
            last[b] = i;
        }
    }
    uint32_t lowest = NONE, so_far = NONE;
    for (uint32_t b = 0; b < buckets; b++) {
        if (first[b] == NONE) {
            continue;
        }
        if (so_far == NONE) {
            lowest = first[b];
        } else {
            consider(gap, gap->lines[so_far], gap->lines[first[b]]);
        }
        so_far = last[b];
    }
    consider(gap, gap->lines[so_far], vec3_neg(gap->lines[lowest]));
}

void gap_widest(struct gap *gap, bool buckets) {
    gap->from = vec3(0, 0, 0);
    gap->to = vec3(0, 0, 0);
    if (buckets) {
        widest_by_buckets(gap);
    } else {
        widest_sorted(gap);
    }
}

// ---------------------------------------------------------------- weighted

static uint64_t angle_of(struct vec3 line) {
    const uint64_t size = trig_atan2_turn64(u64_abs(line.y), u64_abs(line.x));
    return line.y < 0 ? HALF_TURN - size : size;
}

static bool start_before(const void *context, uint32_t a, uint32_t b) {
    const struct gap *const gap = context;
    return gap->start[a] < gap->start[b];
}

/// Is there an angle that is weight * margin away from every line? *at gets one.
static bool is_free(struct gap *gap, const uint32_t *weights, uint64_t margin, uint64_t *at) {
    uint64_t reach = 0; // everything below is taken
    for (uint32_t i = 0; i < gap->count; i++) {
        const uint64_t half = weights[i] * margin;
        gap->list[i] = i;
        gap->start[i] = (angle_of(gap->lines[i]) - half) & (HALF_TURN - 1U);
        const uint64_t end = gap->start[i] + 2U * half;
        if (end > HALF_TURN && end - HALF_TURN > reach) {
            reach = end - HALF_TURN;
        }
    }
    gap->operations += gap->count;
    sort_indices(gap->list, gap->spare, gap->count, start_before, gap);
    for (uint32_t i = 0; i < gap->count; i++) {
        const uint32_t line = gap->list[i];
        if (gap->start[line] > reach) {
            break;
        }
        const uint64_t end = gap->start[line] + 2U * weights[line] * margin;
        reach = end > reach ? end : reach;
    }
    *at = reach;
    return reach < HALF_TURN;
}

void gap_weighted(struct gap *gap, const uint32_t *weights, struct vec3_i64 *direction) {
    uint32_t heaviest = 1;
    for (uint32_t i = 0; i < gap->count; i++) {
        heaviest = weights[i] > heaviest ? weights[i] : heaviest;
    }
    // A quarter turn is as far as anything can be from a line.
    uint64_t low = 0, high = TURN64_QUARTER / heaviest + 1U, best = 0, at;
    if (!is_free(gap, weights, 0, &best)) {
        best = 0;
    }
    while (high - low > 1U) {
        const uint64_t middle = low + (high - low) / 2U;
        if (is_free(gap, weights, middle, &at)) {
            low = middle;
            best = at;
        } else {
            high = middle;
        }
    }
    const struct sincos_q62 along = trig_fine_sincos(best);
    *direction = (struct vec3_i64){along.cos_q62 / 2, along.sin_q62 / 2, 0};
}
