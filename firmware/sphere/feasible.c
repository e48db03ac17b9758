#include "sphere/feasible.h"

#include "sphere/witness.h"

/// The point as a 64-bit vector of about 2^60, in exactly its direction: lengths within a factor of
/// 4 of each other keep the pivots on the raw integers few.
static struct min_norm_point long_direction(const struct vec3 *points, uint32_t index) {
    const struct vec3 point = points[index];
    const uint64_t size = u64_abs(point.x) | u64_abs(point.y) | u64_abs(point.z);
    const int64_t scale = (int64_t)1 << (u64_leading_zeros(size) - 4U);
    return (struct min_norm_point){.index = index,
                                   .exact = {point.x * scale, point.y * scale, point.z * scale}};
}

/// A rough measure of how far a long direction lies ahead: to pick a good point, not to decide.
static int64_t ahead_roughly(struct vec3 axis_q30, struct vec3_i64 direction) {
    return (direction.x >> 31) * axis_q30.x + (direction.y >> 31) * axis_q30.y +
           (direction.z >> 31) * axis_q30.z;
}

uint8_t feasible_witness(const struct vec3 *points, const struct min_norm *support, uint32_t last,
                         uint32_t witness[4]) {
    uint32_t candidates[4];
    for (uint8_t i = 0; i < support->count; i++) {
        candidates[i] = support->point[i].index;
    }
    candidates[support->count] = last;
    return witness_find(points, candidates, (uint8_t)(support->count + 1U), witness);
}

bool feasible_decide(const struct vec3 *points, uint32_t count, struct min_norm *support,
                     uint32_t witness[4], uint8_t *witness_count, uint64_t *point_reads) {
    const struct min_norm_point first = long_direction(points, 0);
    min_norm_start(support, &first, false);
    // Each pivot shortens the norm of the nearest point, so no support comes twice and the loop
    // ends.
    for (;;) {
        bool found = false;
        struct min_norm_point worst = first;
        int64_t least = INT64_MAX;
        const struct vec3 axis_q30 = vec3_i64_normalise(min_norm_direction(support));
        for (uint32_t i = 0; i < count; i++) {
            const struct min_norm_point point = long_direction(points, i);
            const int64_t ahead = ahead_roughly(axis_q30, point.exact);
            if (ahead < least && min_norm_violated_by(support, &point)) {
                found = true;
                worst = point;
                least = ahead;
            }
        }
        *point_reads += count;
        if (!found) {
            return true;
        }
        if (!min_norm_enter(support, &worst)) {
            *witness_count = feasible_witness(points, support, worst.index, witness);
            return false;
        }
    }
}
