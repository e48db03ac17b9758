#include "sphere/cone.h"

#include "fixed/root.h"
#include "fixed/trig.h"
#include "sphere/min_norm.h"
#include "sphere/witness.h"

#include <stdbool.h>

/// The search. `units` are the points in Q1.30 with a length within 2^-29 of one: the points
/// themselves, or copies in the workspace. Filters read units; decisions are made on the points,
/// normalised to Q2.61.
struct search {
    const struct vec3 *points;
    const struct vec3 *units;
    uint32_t count;
    struct min_norm support;
    struct vec3 axis_q30;
    bool all_ahead; // a pass has seen every point within 2^-7 rad of an axis of this search
    uint64_t point_reads;
};

#define NO_POINT UINT32_MAX

// ---------------------------------------------------------------- filters

/// A filter tells with 64-bit arithmetic which points are surely inside the cone of the support;
/// only the others are worth an exact test. Its measure falls as the angle from the axis grows.
struct filter {
    struct vec3 axis_q30;
    bool narrow;
    unsigned shift;
    int64_t surely_inside;  // measure at or above
    int64_t surely_outside; // measure below
};

/// How far two dot products (Q2.60) of points on one circle can be apart. Each unit's length is
/// good to 2^-29 and its direction to 2^-30; the axis is good to 2^-30: together below 2^-27.4.
#define DOT_BAND ((int64_t)1 << 33)

/// Below this sine (Q2.60) of the half-angle, 2^-8, the band of dot products is too wide beside 1 -
/// cos.
#define NARROW_SINE_Q60 (UINT64_C(1) << 52)

/// The wide filter: the dot product with the axis, Q2.60.
static inline int64_t measure_wide(const struct filter *filter, struct vec3 unit) {
    return vec3_dot_unit(filter->axis_q30, unit);
}

/// The narrow filter: minus the squared cross product with the axis, scaled so that the circle lies
/// near 2^57. Unlike the cosine, a small sine is not drowned by the rounding of the lengths. Only
/// right for points ahead.
static inline int64_t measure_narrow(const struct filter *filter, struct vec3 unit) {
    const struct vec3_i64 cross = vec3_cross(filter->axis_q30, unit);
    const int64_t x = cross.x >> filter->shift, y = cross.y >> filter->shift,
                  z = cross.z >> filter->shift;
    const int64_t far = (int64_t)1 << 30;
    if (x >= far || x < -far || y >= far || y < -far || z >= far || z < -far) {
        return INT64_MIN;
    }
    return -(x * x + y * y + z * z);
}

static int64_t square(uint64_t a) {
    return (int64_t)(a * a);
}

/// The filter that fits the support's cone: wide, or narrow once every point is known to be ahead.
/// *is_narrow tells whether the cone is too narrow for the wide filter to decide anything near the
/// circle.
static struct filter make_filter(const struct search *search, bool *is_narrow) {
    const struct vec3 on_circle = search->units[search->support.index[0]];
    struct filter filter = {.axis_q30 = search->axis_q30};
    const int64_t dot = measure_wide(&filter, on_circle);
    const uint64_t sine_q60 = vec3_i64_length(vec3_cross(search->axis_q30, on_circle));
    *is_narrow = dot > 0 && sine_q60 < NARROW_SINE_Q60;
    filter.narrow = *is_narrow && search->all_ahead;
    if (!filter.narrow) {
        filter.surely_inside = dot + DOT_BAND;
        filter.surely_outside = dot - DOT_BAND;
        return filter;
    }
    // Directions are good to 2^-30 twice, lengths to 2^-29 twice; the truncated shift costs 2
    // units.
    const uint64_t margin = (UINT64_C(1) << 32) + (sine_q60 >> 25);
    const uint64_t low = sine_q60 > margin ? sine_q60 - margin : 0U, high = sine_q60 + margin;
    while ((high >> filter.shift) >= (UINT64_C(1) << 29)) {
        filter.shift++;
    }
    const uint64_t inside = low >> filter.shift, outside = (high >> filter.shift) + 3U;
    filter.surely_inside = inside > 2U ? -square(inside - 2U) : 1; // 1: nothing is
    filter.surely_outside = -square(outside);
    return filter;
}

/// The first point at or after `from`, in steps of `stride`, whose measure is below the limit;
/// NO_POINT if there is none. This is the loop that reads every point; all else happens rarely.
static uint32_t next_below(struct search *search, const struct filter *filter, uint32_t from,
                           uint32_t stride, int64_t limit, int64_t *measure) {
    const struct vec3 *units = search->units;
    const uint32_t count = search->count;
    uint32_t i = from;
    if (filter->narrow) {
        for (; i < count; i += stride) {
            *measure = measure_narrow(filter, units[i]);
            if (*measure < limit) {
                break;
            }
        }
    } else {
        for (; i < count; i += stride) {
            *measure = measure_wide(filter, units[i]);
            if (*measure < limit) {
                break;
            }
        }
    }
    const bool found = i < count;
    search->point_reads += ((found ? i : count - 1U) - from) / stride + 1U;
    return found ? i : NO_POINT;
}

// ---------------------------------------------------------------- the pivot loop

static struct vec3_i64 fine(const struct search *search, uint32_t index) {
    return vec3_normalise_q61(search->points[index]);
}

static bool violates(const struct search *search, uint32_t index) {
    return min_norm_violated_by(&search->support, fine(search, index));
}

/// One pass: the farthest point that violates the support's cone, or NO_POINT.
/// decide: whether points in the filter's band are tested exactly, or let pass.
static uint32_t find_violator(struct search *search, const struct filter *filter, uint32_t stride,
                              bool decide) {
    int64_t limit = decide ? filter->surely_inside : filter->surely_outside, measure = 0;
    uint32_t worst = NO_POINT;
    for (uint32_t i = 0; i < search->count; i += stride) {
        i = next_below(search, filter, i, stride, limit, &measure);
        if (i == NO_POINT) {
            break;
        }
        if (measure < filter->surely_outside || violates(search, i)) {
            worst = i;
            limit = measure;
        }
    }
    return worst;
}

/// The slow way round a broken promise about the lengths: exact tests only.
static uint32_t find_violator_exactly(struct search *search, uint32_t stride) {
    for (uint32_t i = 0; i < search->count; i += stride) {
        search->point_reads++;
        if (violates(search, i)) {
            return i;
        }
    }
    return NO_POINT;
}

/// Pivots on every stride-th point until none violates. Each pivot shortens the norm of the
/// support's nearest point, so no support comes twice and the loop ends. Returns NO_POINT, or the
/// point that puts zero into the hull of itself and the support.
static uint32_t pivot(struct search *search, uint32_t stride) {
    for (;;) {
        bool is_narrow;
        const struct filter filter = make_filter(search, &is_narrow);
        uint32_t violator = find_violator(search, &filter, stride, filter.narrow == is_narrow);
        if (violator == NO_POINT && is_narrow && !filter.narrow) {
            search->all_ahead = stride == 1U;
            if (stride == 1U) {
                continue; // now with the narrow filter
            }
        }
        if (violator != NO_POINT && !violates(search, violator)) {
            violator = find_violator_exactly(search, stride);
        }
        if (violator == NO_POINT) {
            return NO_POINT;
        }
        if (!min_norm_enter(&search->support, violator, fine(search, violator))) {
            return violator;
        }
        search->axis_q30 = vec3_i64_normalise(min_norm_direction(&search->support));
    }
}

// ---------------------------------------------------------------- exact feasibility near 90
// degrees

/// The point as a 64-bit vector of about 2^60, in exactly its direction: lengths within a factor of
/// 4 of each other keep the pivots on the raw integers few.
static struct vec3_i64 long_direction(struct vec3 point) {
    const uint64_t size = u64_abs(point.x) | u64_abs(point.y) | u64_abs(point.z);
    const int64_t scale = (int64_t)1 << (u64_leading_zeros(size) - 4U);
    return (struct vec3_i64){point.x * scale, point.y * scale, point.z * scale};
}

/// Does the axis in Q1.30 see every point? Then the set is feasible, whatever else rounding did.
static bool axis_sees_all(struct search *search) {
    for (uint32_t i = 0; i < search->count; i++) {
        search->point_reads++;
        if (i128_sign(vec3_dot(search->axis_q30, search->points[i])) <= 0) {
            return false;
        }
    }
    return true;
}

/// Pivots on the integers as given: is zero in their closed convex hull? Exact.
/// Returns CONE_OK, leaving a support whose direction has every point strictly in front, or
/// CONE_INFEASIBLE.
static enum cone_status decide_on_integers(struct search *search, struct min_norm *support,
                                           uint32_t *last) {
    min_norm_start(support, 0, long_direction(search->points[0]));
    for (;;) {
        uint32_t worst = NO_POINT;
        int64_t least = INT64_MAX;
        const struct vec3 normal_q30 = vec3_i64_normalise(min_norm_direction(support));
        for (uint32_t i = 0; i < search->count; i++) {
            search->point_reads++;
            const int64_t ahead = vec3_dot_unit(normal_q30, search->units[i]);
            if (ahead < least && min_norm_violated_by(support, long_direction(search->points[i]))) {
                worst = i;
                least = ahead;
            }
        }
        if (worst == NO_POINT) {
            return CONE_OK;
        }
        if (!min_norm_enter(support, worst, long_direction(search->points[worst]))) {
            *last = worst;
            return CONE_INFEASIBLE;
        }
    }
}

static bool find_witness(const struct search *search, const struct min_norm *support, uint32_t last,
                         struct cone_result *result) {
    uint32_t candidates[4];
    for (uint8_t i = 0; i < support->count; i++) {
        candidates[i] = support->index[i];
    }
    candidates[support->count] = last;
    result->witness_count =
        witness_find(search->points, candidates, (uint8_t)(support->count + 1U), result->witness);
    return result->witness_count != 0U;
}

/// Settles what the rounded unit vectors leave open. `last`: the point that put zero into their
/// hull, or NO_POINT.
static enum cone_status settle_feasibility(struct search *search, uint32_t last,
                                           struct cone_result *result) {
    if (last != NO_POINT && find_witness(search, &search->support, last, result)) {
        return CONE_INFEASIBLE;
    }
    // 2^-20 of cosine is far above every rounding: all points are ahead of the axis.
    const struct vec3 on_circle = search->units[search->support.index[0]];
    if (last == NO_POINT &&
        (vec3_dot_unit(search->axis_q30, on_circle) > (int64_t)1 << 40 || axis_sees_all(search))) {
        return CONE_OK;
    }
    struct min_norm support = {0};
    uint32_t opposite = NO_POINT;
    if (decide_on_integers(search, &support, &opposite) == CONE_INFEASIBLE) {
        (void)find_witness(search, &support, opposite,
                           result); // zero is in their hull: there is one
        return CONE_INFEASIBLE;
    }
    if (last != NO_POINT) { // any axis that sees all is within 2^-59 rad of the best half-angle
        search->support = support;
        search->axis_q30 = vec3_i64_normalise(min_norm_direction(&support));
    }
    return CONE_OK;
}

// ---------------------------------------------------------------- the answer

/// Signed square of the cosine of the angle between axis and point, times the point's squared
/// length.
static struct i128 signed_square(struct vec3 axis_q30, struct vec3 point) {
    const struct i128 dot =
        vec3_dot(axis_q30, point); // below 2^62: |axis| is 2^30, |point| below 2^32
    const int64_t ahead = (int64_t)dot.lo;
    return i128_mul(ahead, ahead < 0 ? -ahead : ahead);
}

/// Is point a at a larger true angle from the axis than b? Exact: cosines compared without a root,
/// 189 bits.
static bool is_farther(struct vec3 axis_q30, struct vec3 a, struct vec3 b) {
    const struct i128 norm_a = {vec3_norm2(a), 0}, norm_b = {vec3_norm2(b), 0};
    return i256_sign(i256_sub(i256_mul(signed_square(axis_q30, a), norm_b),
                              i256_mul(signed_square(axis_q30, b), norm_a))) < 0;
}

/// A point at the largest true angle from the axis as printed.
static uint32_t find_farthest(struct search *search) {
    bool is_narrow;
    struct filter filter = make_filter(search, &is_narrow);
    uint32_t farthest = search->support.index[0];
    for (uint32_t i = 0; i < search->count; i++) {
        int64_t measure;
        i = next_below(search, &filter, i, 1, filter.surely_inside, &measure);
        if (i == NO_POINT) {
            break;
        }
        if (is_farther(search->axis_q30, search->points[i], search->points[farthest])) {
            farthest = i;
        }
    }
    return farthest;
}

/// True angle between the axis and a point, rounded up; 2^64 units a turn.
static uint64_t angle_rounded_up(struct vec3 axis_q30, struct vec3 point) {
    // Bring the point to 31 bits, so that the integer length of the cross product has 60 bits of
    // angle.
    const uint64_t size = u64_abs(point.x) | u64_abs(point.y) | u64_abs(point.z);
    const unsigned zeros = u64_leading_zeros(size);
    const int32_t scale = zeros > 34U ? (int32_t)1 << (zeros - 34U) : 1;
    const struct vec3 p = vec3(point.x * scale, point.y * scale, point.z * scale);
    const uint64_t across = vec3_i64_length(vec3_cross(axis_q30, p)) + 1U;
    const int64_t ahead = (int64_t)vec3_dot(axis_q30, p).lo;
    const uint64_t acute = trig_atan2_turn64(across, u64_abs(ahead));
    const uint64_t turn = ahead < 0 ? (UINT64_C(1) << 63) - acute : acute;
    return turn +
           (UINT64_C(1) << 9); // over 2^-55 turns: the arc tangent's 2^-56.6 and the lengths' 2^-61
}

static void report(struct search *search, struct cone_result *result) {
    const struct min_norm *support = &search->support;
    result->axis_q30 = search->axis_q30;
    result->support_count = support->count;
    for (uint8_t i = 0; i < support->count; i++) {
        uint8_t at = i;
        for (; at > 0U && result->support[at - 1U] > support->index[i]; at--) {
            result->support[at] = result->support[at - 1U];
        }
        result->support[at] = support->index[i];
    }
    result->farthest_index = find_farthest(search);
    result->half_angle_turn64 =
        angle_rounded_up(search->axis_q30, search->points[result->farthest_index]);
    const uint64_t up = (result->half_angle_turn64 + UINT32_MAX) >> 32;
    result->half_angle_bam32 = bam32((uint32_t)up);
}

/// About 4 sqrt(count) points, evenly strided, are solved first: the pivots then happen on a small
/// set, and the whole set is read a few times only, also when it winds outward.
static uint32_t sample_stride(uint32_t count) {
    return count < 256U ? 1U : count / (4U * root_u32(count));
}

enum cone_status cone_narrowest(const struct vec3 *points, uint32_t count,
                                enum cone_lengths lengths, void *workspace, size_t workspace_bytes,
                                struct cone_result *result) {
    *result = (struct cone_result){0};
    if (count == 0U) {
        return CONE_EMPTY;
    }
    if (lengths == CONE_LENGTHS_ANY && workspace_bytes < CONE_WORKSPACE_BYTES(count)) {
        return CONE_ERROR_WORKSPACE;
    }
    struct vec3 *copies = workspace;
    for (uint32_t i = 0; i < count && lengths == CONE_LENGTHS_ANY; i++) {
        if (vec3_is_zero(points[i])) {
            result->bad_index = i;
            return CONE_ERROR_ZERO_VECTOR;
        }
        copies[i] = vec3_normalise(points[i]);
        result->point_reads++;
    }
    struct search search = {.points = points,
                            .units = lengths == CONE_LENGTHS_ANY ? copies : points,
                            .count = count,
                            .point_reads = result->point_reads};
    min_norm_start(&search.support, 0, fine(&search, 0));
    search.axis_q30 = vec3_i64_normalise(search.support.point[0]);

    const uint32_t stride = sample_stride(count);
    uint32_t last = stride > 1U ? pivot(&search, stride) : NO_POINT;
    if (last == NO_POINT) {
        last = pivot(&search, 1);
    }
    const enum cone_status status = settle_feasibility(&search, last, result);
    if (status == CONE_OK) {
        report(&search, result);
    }
    result->point_reads = search.point_reads;
    return status;
}
