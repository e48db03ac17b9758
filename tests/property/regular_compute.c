/// Computed directions and axes against the definitions, in integers of any size.
#include "check.h"
#include "property/support/regular_check.h"

enum { COUNT_MOST = 10, BYTES = 1 << 16 };
static struct vec3 points[3 * COUNT_MOST];
static uint64_t workspace[BYTES / 8];

static bool answer_is_regular(const struct regular_input *in, const struct regular_result *result) {
    struct check_vector v[3];
    const bool axes = in->problem == REGULAR_POINTS3_XY || in->problem == REGULAR_POINTS3_XYZ;
    for (int i = 0; i < 3; i++) {
        check_vector_init(&v[i]);
        check_vector_set(&v[i], axes ? result->rotation[i] : result->direction);
    }
    const bool good = axes ? check_axes(in, v) : check_direction(in, &v[0]);
    for (int i = 0; i < 3; i++) {
        check_vector_clear(&v[i]);
    }
    return good;
}

static bool compute(const struct regular_input *in, const struct regular_options *options,
                    bool exists) {
    struct regular_result result;
    const enum regular_status status =
        regular_compute(in, options, workspace, sizeof workspace, &result);
    const bool good =
        CHECK_EQ(status, exists ? REGULAR_OK : REGULAR_NONE) &&
        (exists ? CHECK(result.regular) && CHECK(answer_is_regular(in, &result))
                : CHECK(!result.regular) && CHECK(check_conflict(in, &result.conflict)));
    if (!good) {
        check_note(check_problem_name(in->problem), in->count);
    }
    return good;
}

static void compute_sets(enum regular_problem problem, int rounds) {
    uint64_t seed = 91 + (uint64_t)problem;
    int64_t none = 0;
    for (int i = 0; i < rounds; i++) {
        const uint32_t count = (uint32_t)(check_random(&seed) % (COUNT_MOST + 1U));
        const int32_t sizes[] = {1, 2, 4, 9, 40, REGULAR_COORDINATE_MAX};
        const int32_t size = sizes[check_random(&seed) % 6U];
        if (!check_draw(&seed, problem, count, size, points)) {
            continue;
        }
        const struct regular_input in = {problem, points, count};
        const bool exists = check_exists(&in);
        const struct regular_options other = {.buckets = true, .small = true};
        none += !exists;
        if (!compute(&in, NULL, exists) || !compute(&in, &other, exists)) {
            check_note("round", i);
            return;
        }
    }
    check_note(check_problem_name(problem), none);
}

static void directions(void) {
    for (int problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        compute_sets((enum regular_problem)problem, 1500);
    }
}

/// Points at the corners of the range, where the numbers are largest: few in each column.
static void largest_numbers(void) {
    const int32_t m = REGULAR_COORDINATE_MAX;
    for (int problem = 0; problem < REGULAR_PROBLEMS; problem++) {
        const enum regular_problem p = (enum regular_problem)problem;
        uint64_t seed = 3;
        for (int round = 0; round < 200; round++) {
            const uint32_t of = regular_points_of(p), count = 6;
            if (!check_draw(&seed, p, count, 1, points)) {
                continue;
            }
            for (uint32_t i = 0; i < of * count; i++) {
                const int32_t off = (int32_t)(check_random(&seed) % 3U);
                points[i].x = points[i].x * (m - 1) + (points[i].x == 0 ? off : 0);
                points[i].y *= m;
                points[i].z *= m;
            }
            const struct regular_input in = {p, points, count};
            struct regular_result result;
            if (regular_decide(&in, NULL, workspace, sizeof workspace, &result) == REGULAR_OK &&
                !compute(&in, NULL, check_exists(&in))) {
                return;
            }
        }
    }
}

/// The slope 1/4 is that of two of the points, so the bound of section 2.2 must not be attained.
static void attained_bound(void) {
    points[0] = vec3(-2, 0, 0);
    points[1] = vec3(2, 0, 0);
    points[2] = vec3(-2, -1, 0);
    const struct regular_input in = {REGULAR_POINTS2_LINE, points, 3};
    struct check_vector v;
    check_vector_init(&v);
    check_vector_set_small(&v, 4, 1, 0);
    CHECK(!check_direction(&in, &v));
    struct regular_result result;
    CHECK_EQ(regular_compute(&in, NULL, workspace, sizeof workspace, &result), REGULAR_OK);
    CHECK_EQ(result.direction.x.lo, 4);
    CHECK_EQ(result.direction.y.lo, 2);
    check_vector_clear(&v);
}

int main(void) {
    check_note("seed 91 + problem", 91);
    TEST(directions);
    TEST(largest_numbers);
    TEST(attained_bound);
    return check_finish();
}
