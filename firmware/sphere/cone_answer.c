#include "sphere/cone_answer.h"

#include "fixed/not_inline.h"
#include "fixed/trig.h"

/// Signed square of the cosine of the angle between axis and point, times the point's squared
/// length.
static struct i128 signed_square(struct vec3 axis_q30, struct vec3 point) {
    const int64_t ahead = vec3_dot_unit(axis_q30, point); // |axis| is 2^30, |point| below 2^32
    return i128_mul(ahead, ahead < 0 ? -ahead : ahead);
}

NOT_INLINE bool cone_is_farther(struct vec3 axis_q30, struct vec3 a, struct vec3 b) {
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
    const int64_t ahead = vec3_dot_unit(axis_q30, p); // below 2^62: |axis| is 2^30, |p| below 2^32
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
