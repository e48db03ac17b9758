/// Sets of directions: narrowest cone and hull, of the recorded and of random sets.
#include "mcu/digest/sets.h"
#include "vectors/cones/table.h"

#include "sphere/cone.h"
#include "sphere/hull.h"

static struct vec3 points[DIGEST_POINTS_MAX];
static uint64_t workspace[HULL_WORKSPACE_BYTES(DIGEST_POINTS_MAX) / sizeof(uint64_t) + 1U];

static void fold_cone(struct digest *d, enum cone_status status, const struct cone_result *result) {
    digest_i64(d, status);
    if (status == CONE_OK) {
        digest_vec3(d, result->axis_q30);
        digest_u64(d, result->half_angle_turn64);
        digest_u64(d, result->half_angle_bam32.bam);
        digest_u64(d, result->farthest_index);
        digest_u64(d, result->point_reads);
    }
    if (status == CONE_OK || status == CONE_UNFINISHED) {
        for (uint8_t i = 0; i < result->support_count; i++) {
            digest_u64(d, result->support[i]);
        }
    } else if (status == CONE_INFEASIBLE) {
        for (uint8_t i = 0; i < result->witness_count; i++) {
            digest_u64(d, result->witness[i]);
        }
    }
}

/// From scratch, with and without notes; then from an earlier support, and with few reads at a
/// time.
static void fold_set(struct digest *d, const struct vec3 *set, uint32_t count, bool unit) {
    struct cone_result result;
    struct cone_options options = {.lengths = unit ? CONE_LENGTHS_UNIT : CONE_LENGTHS_ANY,
                                   .workspace = workspace,
                                   .workspace_bytes = sizeof workspace};
    enum cone_status status = cone_narrowest(set, count, &options, &result);
    fold_cone(d, status, &result);
    if (unit) {
        options.workspace_bytes = 0;
        status = cone_narrowest(set, count, &options, &result);
        fold_cone(d, status, &result);
    }
    const uint32_t other = digest_below(d, count);
    options.warm = &other;
    options.warm_count = 1;
    options.workspace_bytes = sizeof workspace;
    options.read_limit = 1U + digest_below(d, 3U * count);
    status = cone_narrowest(set, count, &options, &result);
    fold_cone(d, status, &result);
}

static void cone(void) {
    struct digest d = digest_start(21);
    for (size_t i = 0; i < CONE_VECTOR_COUNT; i++) {
        const struct cone_vector *vector = &cone_vectors[i];
        fold_set(&d, &cone_vector_points[vector->first], vector->count, false);
    }
    for (int i = 0; i < 1500; i++) {
        const uint32_t count = i % 500 == 0 ? DIGEST_POINTS_MAX : 1U + digest_below(&d, 20);
        digest_draw_set(&d, points, count);
        fold_set(&d, points, count, false);
        for (uint32_t k = 0; k < count; k++) {
            points[k] = vec3_normalise(points[k]);
        }
        fold_set(&d, points, count, true);
    }
    digest_finish(&d, "digest sphere/cone");
}

static void fold_hull(struct digest *d, const struct vec3 *set, uint32_t count) {
    struct hull_result result;
    const enum hull_status status =
        hull_spherical(set, count, workspace, sizeof workspace, &result);
    digest_i64(d, status);
    if (status == HULL_OK) {
        for (uint32_t i = 0; i < result.vertex_count; i++) {
            digest_u64(d, result.vertices[i]);
        }
    } else if (status == HULL_NOT_HEMISPHERICAL) {
        for (uint8_t i = 0; i < result.witness_count; i++) {
            digest_u64(d, result.witness[i]);
        }
    }
}

static void hull(void) {
    struct digest d = digest_start(22);
    for (size_t i = 0; i < CONE_VECTOR_COUNT; i++) {
        const struct cone_vector *vector = &cone_vectors[i];
        fold_hull(&d, &cone_vector_points[vector->first], vector->count);
    }
    for (int i = 0; i < 1500; i++) {
        const uint32_t count = i % 500 == 0 ? DIGEST_POINTS_MAX : 1U + digest_below(&d, 20);
        digest_draw_set(&d, points, count);
        fold_hull(&d, points, count);
    }
    digest_finish(&d, "digest sphere/hull");
}

int main(void) {
    TEST(cone);
    TEST(hull);
    return check_finish();
}
