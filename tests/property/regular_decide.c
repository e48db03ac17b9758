/// Decisions against the definitions, on small lattices full of coincidences, and at the limits of
/// the coordinates.
#include "check.h"
#include "property/support/regular_check.h"

#include <stdlib.h>

enum { COUNT_MOST = 9, BYTES = 1 << 16 };
static struct vec3 points[3 * COUNT_MOST];
static uint64_t workspace[BYTES / 8];

static bool decide_both(const struct regular_input *in, bool expected) {
    for (int buckets = 0; buckets < 2; buckets++) {
        const struct regular_options options = {.buckets = buckets != 0};
        struct regular_result result;
        const enum regular_status status =
            regular_decide(in, &options, workspace, sizeof workspace, &result);
        if (!CHECK_EQ(status, REGULAR_OK) || !CHECK_EQ(result.regular, expected) ||
            (!expected && !CHECK(check_conflict(in, &result.conflict)))) {
            check_note(check_problem_name(in->problem), in->count);
            return false;
        }
    }
    return true;
}

static void decide_sets(enum regular_problem problem, int rounds) {
    uint64_t seed = 71 + (uint64_t)problem;
    int64_t regular = 0, done = 0;
    for (int i = 0; i < rounds; i++) {
        const uint32_t count = (uint32_t)(check_random(&seed) % (COUNT_MOST + 1U));
        const int32_t sizes[] = {1, 2, 4, 9, 40, REGULAR_COORDINATE_MAX};
        const int32_t size = sizes[check_random(&seed) % 6U];
        if (!check_draw(&seed, problem, count, size, points)) {
            continue;
        }
        const struct regular_input in = {problem, points, count};
        const bool expected = check_as_given(&in);
        if (!decide_both(&in, expected)) {
            check_note("round", i);
            return;
        }
        regular += expected;
        done++;
    }
    // Both answers must have come up often.
    CHECK(regular > rounds / 20 && done - regular > rounds / 20);
    check_note(check_problem_name(problem), regular);
}

static void decisions(void) {
    for (int problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        decide_sets((enum regular_problem)problem, 2000);
    }
}

static enum regular_status status_of(enum regular_problem problem, uint32_t count,
                                     struct regular_result *result) {
    const struct regular_input in = {problem, points, count};
    return regular_decide(&in, NULL, workspace, sizeof workspace, result);
}

static void bad_input(void) {
    struct regular_result result;
    points[0] = vec3(1, 2, 3);
    points[1] = vec3(4, 5, REGULAR_COORDINATE_MAX + 1);
    points[2] = vec3(1, 2, 3);
    CHECK_EQ(status_of(REGULAR_POINTS3_LINE, 3, &result), REGULAR_ERROR_RANGE);
    CHECK_EQ(result.conflict.index[0], 1);
    CHECK_EQ(status_of(REGULAR_POINTS2_LINE, 1, &result), REGULAR_ERROR_RANGE);
    points[1].z = -REGULAR_COORDINATE_MAX;
    CHECK_EQ(status_of(REGULAR_POINTS3_PLANE, 3, &result), REGULAR_ERROR_REPEATED);
    CHECK_EQ(result.conflict.count, 2);
    CHECK_EQ(result.conflict.index[0], 0);
    CHECK_EQ(result.conflict.index[1], 2);
    points[3] = points[2];
    CHECK_EQ(status_of(REGULAR_SEGMENTS3_PLANE, 2, &result), REGULAR_ERROR_DEGENERATE);
    CHECK_EQ(result.conflict.index[0], 1);
    CHECK_EQ(status_of(REGULAR_FACES_VERTICAL, 1, &result), REGULAR_ERROR_DEGENERATE);
    CHECK_EQ(status_of(REGULAR_POINTS3_LINE, UINT32_MAX, &result), REGULAR_ERROR_COUNT);
    const struct regular_input in = {REGULAR_POINTS3_LINE, points, 2};
    const uint64_t bytes = regular_workspace_bytes(REGULAR_POINTS3_LINE, REGULAR_DECIDE, 2, NULL);
    CHECK_EQ(regular_decide(&in, NULL, workspace, bytes - 1U, &result), REGULAR_ERROR_WORKSPACE);
    CHECK_EQ(regular_decide(&in, NULL, workspace, bytes, &result), REGULAR_OK);
}

/// The workspace that is asked for is enough: the sanitizers watch its end.
static void workspace_sizes(void) {
    uint64_t seed = 5;
    for (int problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        for (uint32_t count = 0; count <= COUNT_MOST; count++) {
            const struct regular_input in = {(enum regular_problem)problem, points, count};
            const uint64_t bytes = regular_workspace_bytes(in.problem, REGULAR_DECIDE, count, NULL);
            void *const exact = malloc(bytes == 0 ? 1 : bytes);
            struct regular_result result;
            CHECK(check_draw(&seed, in.problem, count, 1000, points));
            CHECK_EQ(regular_decide(&in, NULL, exact, bytes, &result), REGULAR_OK);
            free(exact);
        }
    }
}

int main(void) {
    check_note("seed 71 + problem", 71);
    TEST(decisions);
    TEST(bad_input);
    TEST(workspace_sizes);
    return check_finish();
}
