/// Regular projections: every problem and step, on small lattices and in the whole range.
#include "mcu/digest/sets.h"

#include "regular/regular.h"

#define COUNT_MAX 7U

static struct vec3 points[3U * COUNT_MAX];
static uint64_t workspace[8192];

static void fold_vector(struct digest *d, const struct vec3_i128 *a) {
    digest_i128(d, a->x);
    digest_i128(d, a->y);
    digest_i128(d, a->z);
}

static void fold(struct digest *d, enum regular_status status,
                 const struct regular_result *result) {
    digest_i64(d, status);
    digest_u64(d, result->regular);
    digest_u64(d, result->conflict.count);
    for (uint8_t i = 0; i < result->conflict.count; i++) {
        digest_u64(d, result->conflict.index[i]);
    }
    fold_vector(d, &result->direction);
    for (unsigned k = 0; k < 3U; k++) {
        fold_vector(d, &result->rotation[k]);
    }
    digest_u64(d, result->tolerance_turn64);
    digest_u64(d, result->operations);
}

static struct regular_input draw(struct digest *d, enum regular_problem problem) {
    const uint32_t size = digest_below(d, 2) == 0U ? 3U : REGULAR_COORDINATE_MAX;
    const struct regular_input input = {problem, points, 2U + digest_below(d, COUNT_MAX - 1U)};
    for (uint32_t i = 0; i < regular_points_of(problem) * input.count; i++) {
        points[i].x = digest_within(d, size);
        points[i].y = digest_within(d, size);
        points[i].z = regular_is_planar(problem) ? 0 : digest_within(d, size);
    }
    return input;
}

static void decisions_and_directions(void) {
    struct digest d = digest_start(61);
    struct regular_result result;
    for (unsigned problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        for (int i = 0; i < 12; i++) {
            const struct regular_options options = {.buckets = i % 2 == 0, .small = i % 3 == 0};
            const struct regular_input input = draw(&d, (enum regular_problem)problem);
            enum regular_status status =
                regular_decide(&input, &options, workspace, sizeof workspace, &result);
            fold(&d, status, &result);
            status = regular_compute(&input, &options, workspace, sizeof workspace, &result);
            fold(&d, status, &result);
        }
    }
    digest_finish(&d, "digest regular/directions");
}

static void optima(void) {
    struct digest d = digest_start(67);
    struct regular_result result;
    for (unsigned problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        for (int i = 0; i < 6; i++) {
            const uint32_t weights[COUNT_MAX] = {1, 5, 2, 9, 1, 3, 7};
            const struct regular_options options = {.buckets = i % 2 == 0,
                                                    .cylinder = i % 3 == 0,
                                                    .above = i == 2,
                                                    .weights = i == 3 ? weights : NULL};
            struct regular_input input = draw(&d, (enum regular_problem)problem);
            input.count = input.count > 5U ? 5U : input.count;
            const enum regular_status status =
                regular_optimize(&input, &options, workspace, sizeof workspace, &result);
            fold(&d, status, &result);
        }
    }
    digest_finish(&d, "digest regular/optima");
}

int main(void) {
    TEST(decisions_and_directions);
    TEST(optima);
    return check_finish();
}
