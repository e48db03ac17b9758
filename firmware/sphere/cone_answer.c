#include "sphere/cone_answer.h"

#include "fixed/trig.h"

/// Signed square of the cosine of the angle between axis and point, times the point's squared
/// length.
static struct i128 signed_square(struct vec3 axis_q30, struct vec3 point) {
    const struct i128 dot = vec3_dot(axis_q30, point); // |axis| is 2^30, |point| below 2^32
    const int64_t ahead = (int64_t)dot.lo;
    return i128_mul(ahead, ahead < 0 ? -ahead : ahead);
}

/// Cosine of the angle between the axis and a near-unit point, Q2.60, within 2^5 units: the dot
/// product, corrected for the length, whose square is 2^60 + excess.
static int64_t near_unit_cosine(struct vec3 axis_q30, struct vec3 unit, int64_t excess) {
    const int64_t dot = vec3_dot_unit(axis_q30, unit);
    return dot - (((dot >> 31) * excess) >> 30);
}

/// Squared length less 2^60, if the point is a unit vector in Q1.30 but for 2^-29 of its length.
static bool is_near_unit(struct vec3 point, int64_t *excess) {
    *excess = (int64_t)(vec3_norm2(point) - (UINT64_C(1) << 60));
    return *excess < (int64_t)1 << 31 && *excess > -((int64_t)1 << 31);
}

bool cone_is_farther(struct vec3 axis_q30, struct vec3 a, struct vec3 b) {
    int64_t excess_a, excess_b;
    if (is_near_unit(a, &excess_a) && is_near_unit(b, &excess_b)) {
        const int64_t apart =
            near_unit_cosine(axis_q30, a, excess_a) - near_unit_cosine(axis_q30, b, excess_b);
        if (apart > 64 || apart < -64) {
            return apart < 0;
        }
    }
    // Cosines compared without a root: 189 bits.
    const struct i128 norm_a = {vec3_norm2(a), 0}, norm_b = {vec3_norm2(b), 0};
    return i256_sign(i256_sub(i256_mul(signed_square(axis_q30, a), norm_b),
                              i256_mul(signed_square(axis_q30, b), norm_a))) < 0;
}

uint64_t cone_angle_rounded_up(struct vec3 axis_q30, struct vec3 point) {
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
           (UINT64_C(1) << 9); // over 2^-55 turns: the arc tangent's 2^-57 and the lengths' 2^-61
}

struct min_norm_point cone_point(const struct vec3 *points, uint32_t index) {
    return (struct min_norm_point){
        .index = index, .given = points[index], .unit_q30 = vec3_normalise(points[index])};
}

void cone_report(const struct vec3 *points, struct vec3 axis_q30, const struct min_norm *support,
                 uint32_t farthest_index, struct cone_result *result) {
    result->axis_q30 = axis_q30;
    result->support_count = support->count;
    for (uint8_t i = 0; i < support->count; i++) {
        uint8_t at = i;
        for (; at > 0U && result->support[at - 1U] > support->point[i].index; at--) {
            result->support[at] = result->support[at - 1U];
        }
        result->support[at] = support->point[i].index;
    }
    result->farthest_index = farthest_index;
    result->half_angle_turn64 = cone_angle_rounded_up(axis_q30, points[farthest_index]);
    result->half_angle_bam32 = bam32((uint32_t)((result->half_angle_turn64 + UINT32_MAX) >> 32));
}

enum cone_status cone_answer(const struct vec3 *points, uint32_t count, const uint32_t *support,
                             uint8_t support_count, struct cone_result *result) {
    struct min_norm held;
    const struct min_norm_point first = cone_point(points, support[0]);
    min_norm_start(&held, &first, true);
    for (uint8_t i = 1; i < support_count; i++) {
        const struct min_norm_point next = cone_point(points, support[i]);
        if (min_norm_violated_by(&held, &next) && !min_norm_enter(&held, &next)) {
            return CONE_INFEASIBLE;
        }
    }
    const struct vec3 axis_q30 = vec3_i64_normalise(min_norm_direction(&held));
    uint32_t farthest = support[0];
    for (uint32_t i = 0; i < count; i++) {
        farthest = cone_is_farther(axis_q30, points[i], points[farthest]) ? i : farthest;
    }
    result->point_reads += count;
    cone_report(points, axis_q30, &held, farthest, result);
    return CONE_OK;
}
