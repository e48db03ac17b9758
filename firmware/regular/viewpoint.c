#include "regular/viewpoint.h"

#include <stddef.h>

// Widths, with differences d of at most 2^24 a component: cross products 2^49, their squared length
// below 2^100, determinants below 2^75 and their squares below 2^150.

static struct vec3 between(struct vec3 from, struct vec3 to) {
    return vec3(to.x - from.x, to.y - from.y, to.z - from.z);
}

static bool in_range(struct vec3 a) {
    const int32_t most = VIEWPOINT_COORDINATE_MAX;
    return a.x >= -most && a.x <= most && a.y >= -most && a.y <= most && a.z >= -most &&
           a.z <= most;
}

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

/// Takes the ratio if it is less than the margin's. denominator > 0.
static bool take_if_less(struct viewpoint_margin *margin, struct i256 numerator,
                         struct i128 denominator) {
    if (i128_sign(margin->denominator) != 0) {
        const struct i256 here = i256_product(numerator, i256_from_i128(margin->denominator)),
                          best = i256_product(margin->numerator, i256_from_i128(denominator));
        if (i256_sign(i256_sub(here, best)) >= 0) {
            return false;
        }
    }
    margin->numerator = numerator;
    margin->denominator = denominator;
    return true;
}

// ---------------------------------------------------------------- lines

/// The line through two targets, seen from the viewpoint in the directions a and b.
static void try_line(struct viewpoint_margin *margin, struct vec3 a, struct vec3 b, uint32_t i,
                     uint32_t j) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    margin->through += is_zero(cross) ? 1U : 0U;
    const struct i128 length2 = i128_from_i64((int64_t)vec3_norm2(between(a, b)));
    if (take_if_less(margin, i256_from_i128(vec3_i64_dot(cross, cross)), length2)) {
        margin->target[0] = i;
        margin->target[1] = j;
    }
}

// ---------------------------------------------------------------- planes

/// The square root of the ratio, rounded up: the smallest r with r^2 denominator >= numerator.
static uint64_t root_up(struct i256 numerator, struct i128 denominator) {
    // By bits, from the top; the root is below 2^26.
    uint64_t root = 0;
    for (uint64_t bit = UINT64_C(1) << 26; bit != 0U; bit >>= 1) {
        const int64_t trial = (int64_t)(root | bit);
        const struct i256 square = i256_mul(i128_mul(trial, trial), denominator);
        if (i256_sign(i256_sub(square, numerator)) < 0) {
            root |= bit;
        }
    }
    return i256_sign(numerator) == 0 ? 0U : root + 1U;
}

struct plane_search {
    const struct vec3 *targets;
    uint32_t count;
    struct vec3 viewpoint;
    uint64_t reach; ///< rounded up: the nearest plane so far is not farther than that
    struct viewpoint_result *result;
};

static void try_plane(struct plane_search *s, struct vec3_i64 normal, struct i128 det, uint32_t i,
                      uint32_t j, uint32_t k) {
    struct viewpoint_margin *const margin = &s->result->plane;
    const struct i128 size = i128_sign(det) < 0 ? i128_neg(det) : det;
    margin->through += i128_sign(size) == 0 ? 1U : 0U;
    // No plane is nearer than |det| / (|x| + |y| + |z|) of its normal: that tells most apart.
    const uint64_t sum = u64_abs(normal.x) + u64_abs(normal.y) + u64_abs(normal.z);
    const struct u128 most = u128_mul(sum, s->reach);
    if (u128_cmp((struct u128){size.lo, (uint64_t)size.hi}, most) > 0) {
        return;
    }
    if (take_if_less(margin, i256_mul(size, size), vec3_i64_dot(normal, normal))) {
        margin->target[0] = i;
        margin->target[1] = j;
        margin->target[2] = k;
        s->reach = root_up(margin->numerator, margin->denominator);
    }
}

/// All planes through two targets and a later one.
static void try_planes_of(struct plane_search *s, uint32_t i, uint32_t j) {
    struct viewpoint_result *const result = s->result;
    const struct vec3 a = s->targets[i], ab = between(a, s->targets[j]),
                      away = between(a, s->viewpoint);
    for (uint32_t k = j + 1U; k < s->count; k++) {
        const struct vec3_i64 normal = vec3_cross(ab, between(a, s->targets[k]));
        if (is_zero(normal)) {
            if (result->collinear++ == 0U) {
                result->collinear_first[0] = i;
                result->collinear_first[1] = j;
                result->collinear_first[2] = k;
            }
            continue;
        }
        try_plane(s, normal, vec3_i64_dot_vec3(normal, away), i, j, k);
    }
}

// ---------------------------------------------------------------- the whole

static enum viewpoint_status check(const struct vec3 *targets, uint32_t count,
                                   struct vec3 viewpoint, struct viewpoint_result *result) {
    for (uint32_t i = 0; i <= count; i++) {
        const bool is_target = i < count;
        result->bad[0] = i;
        if (!in_range(is_target ? targets[i] : viewpoint)) {
            return VIEWPOINT_ERROR_RANGE;
        }
        if (is_target && vec3_equal(targets[i], viewpoint)) {
            return VIEWPOINT_AT_TARGET;
        }
        for (uint32_t j = i + 1U; j < count; j++) {
            if (vec3_equal(targets[i], targets[j])) {
                result->bad[1] = j;
                return VIEWPOINT_ERROR_EQUAL;
            }
        }
    }
    result->bad[0] = 0;
    return VIEWPOINT_OK;
}

enum viewpoint_status viewpoint_margins(const struct vec3 *targets, uint32_t count,
                                        struct vec3 viewpoint, bool planes,
                                        struct viewpoint_result *result) {
    *result = (struct viewpoint_result){0};
    const enum viewpoint_status status = check(targets, count, viewpoint, result);
    if (status != VIEWPOINT_OK) {
        return status;
    }
    struct plane_search search = {targets, count, viewpoint, UINT64_C(1) << 27, result};
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i + 1U; j < count; j++) {
            try_line(&result->line, between(viewpoint, targets[i]), between(viewpoint, targets[j]),
                     i, j);
            if (planes) {
                try_planes_of(&search, i, j);
            }
        }
    }
    return VIEWPOINT_OK;
}
