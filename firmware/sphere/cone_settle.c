#include "sphere/cone_settle.h"

#include "sphere/certify.h"
#include "sphere/cone_answer.h"
#include "sphere/site_axis.h"

enum cone_status cone_settle_start(const struct vec3 *points, uint32_t count,
                                   struct cone_result *result) {
    *result = (struct cone_result){0};
    if (count == 0U) {
        return CONE_EMPTY;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(points[i])) {
            result->bad_index = i;
            return CONE_ERROR_ZERO_VECTOR;
        }
    }
    result->point_reads = count;
    return CONE_OK;
}

enum cone_status cone_settle_support(const struct vec3 *points, uint32_t count,
                                     const uint32_t *support, uint8_t support_count,
                                     struct cone_result *result) {
    CERTIFY(certify_support(points, count, support, support_count));
    struct site site[3];
    struct min_norm held = {.count = support_count}; // only the indices are asked for
    for (uint8_t i = 0; i < support_count; i++) {
        site[i] = site_from(points[support[i]]);
        held.point[i].index = support[i];
    }
    const struct vec3 axis_q30 = site_cone_axis(site, support_count);
    struct cone_farthest farthest;
    cone_farthest_start(&farthest, points, axis_q30, support[0]);
    for (uint32_t i = 0; i < count; i++) {
        cone_farthest_add(&farthest, i);
    }
    result->point_reads += count;
    cone_report(points, axis_q30, &held, farthest.index, result);
    return CONE_OK;
}

enum cone_status cone_settle_witness(const struct vec3 *points, const uint32_t *witness,
                                     uint8_t witness_count, struct cone_result *result) {
    CERTIFY(certify_witness(points, witness, witness_count));
    (void)points;
    result->witness_count = witness_count;
    for (uint8_t i = 0; i < witness_count; i++) {
        result->witness[i] = witness[i];
    }
    return CONE_INFEASIBLE;
}
