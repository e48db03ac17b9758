/// solid_sphere_find and the search by trial against the conditions of the smallest sphere, in
/// rationals: random and degenerate sets of all sizes, and the cost on large sets. COUNT=N sets a
/// class, SEED=N.
#include "check.h"
#include "property/support/solid_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static uint64_t seed;
static unsigned long set_count = 1500UL;
static unsigned char *workspace;

static const char *solve(const struct vec3 *points, uint32_t count, int method,
                         struct solid_sphere *sphere) {
    const enum solid_sphere_status status =
        method == 0
            ? solid_sphere_find(points, count, workspace, SOLID_SPHERE_WORKSPACE_BYTES(count),
                                sphere)
            : solid_sphere_by_trial(
                  points, count, method == 1 ? SOLID_SPHERE_SHARPEST_FIRST : SOLID_SPHERE_AS_LISTED,
                  0, workspace, SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(count), sphere);
    return status == SOLID_SPHERE_OK ? solid_check_sphere(points, count, sphere) : "no answer";
}

static void small_sets(void) {
    struct vec3 points[40];
    unsigned long supports[5] = {0};
    for (unsigned long i = 0; i < set_count * SOLID_CLASS_COUNT && check_clean(); i++) {
        const enum solid_class class = (enum solid_class)(i % SOLID_CLASS_COUNT);
        const uint64_t before = seed;
        const uint32_t count = 1U + solid_below(&seed, i % 16U == 0U ? 25U : 8U);
        solid_draw(class, &seed, points, count);
        uint64_t radius = 0;
        for (int method = 0; method < 3; method++) {
            struct solid_sphere sphere;
            const char *const wrong = solve(points, count, method, &sphere);
            if (!CHECK(wrong == NULL)) {
                printf("  %s, method %d, %u points, seed %llu: %s\n", solid_class_names[class],
                       method, count, (unsigned long long)before, wrong);
            }
            radius = method == 0 ? sphere.radius_q30 : radius;
            CHECK_NEAR(sphere.radius_q30, radius, 5);
            supports[sphere.support_count]++;
        }
    }
    printf("# answers by support: %lu %lu %lu %lu\n", supports[1], supports[2], supports[3],
           supports[4]);
}

static uint64_t most_pivots;

/// How many pivots it takes, on sets that ask for many: on a curve that winds outward, where each
/// point is a bit farther out than all before, and on spheres' surfaces.
static void few_pivots(void) {
    static struct vec3 points[2000];
    for (unsigned i = 0; i < 600U && check_clean(); i++) {
        const uint32_t count = 5U + solid_below(&seed, 1995U);
        const double turn = 1e-3 * (1 + solid_below(&seed, 3000)), pitch = solid_below(&seed, 1000);
        if (i % 3U == 0U) {
            solid_draw(SOLID_SHELL, &seed, points, count);
        }
        for (uint32_t k = 0; k < count && i % 3U != 0U; k++) {
            const double far = i % 3U == 1U ? 1e6 + 100.0 * k : 1e8 * (1.0 - exp(-1e-3 * k));
            points[k] = vec3((int32_t)(far * cos(k * turn)), (int32_t)(far * sin(k * turn)),
                             (int32_t)(pitch * k));
        }
        struct solid_sphere sphere;
        CHECK(solve(points, count, 0, &sphere) == NULL);
        most_pivots = sphere.pivots > most_pivots ? sphere.pivots : most_pivots;
    }
    printf("# at most %llu pivots\n", (unsigned long long)most_pivots);
    CHECK(most_pivots <= 60U);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void large_sets(void) {
    static const uint32_t sizes[3] = {1000, 10000, 100000};
    struct vec3 *const points = malloc(100000U * sizeof *points);
    for (unsigned i = 0; i < 3U * SOLID_CLASS_COUNT && check_clean(); i++) {
        const enum solid_class class = (enum solid_class)(i / 3U);
        const uint32_t count = sizes[i % 3U];
        solid_draw(class, &seed, points, count);
        struct solid_sphere sphere;
        const double start = seconds();
        const char *wrong =
            solid_sphere_find(points, count, workspace, SOLID_SPHERE_WORKSPACE_BYTES(count),
                              &sphere) == SOLID_SPHERE_OK
                ? NULL
                : "no answer";
        const double taken = seconds() - start;
        if (wrong == NULL && count <= 10000U) {
            wrong = solid_check_sphere(points, count, &sphere);
        }
        if (!CHECK(wrong == NULL)) {
            printf("  %s: %s\n", solid_class_names[class], wrong);
        }
        const double tests = (double)sphere.point_tests / count;
        most_pivots = sphere.pivots > most_pivots ? sphere.pivots : most_pivots;
        printf("# %-11s %6u points: %5.2f tests and %6.1f ns a point\n", solid_class_names[class],
               count, tests, taken / count * 1e9);
        CHECK(count < 10000U || tests < 6.0);
    }
    free(points);
}

/// Is the sphere found early when the sharpest vertices come first? And given up when told so?
static void order_and_limit(void) {
    struct vec3 points[200];
    unsigned long with = 0, without = 0, early = 0;
    for (int i = 0; i < 20; i++) {
        struct solid_sphere sphere;
        solid_draw(SOLID_CUBE, &seed, points, 200);
        CHECK(solve(points, 200, 1, &sphere) == NULL);
        with += sphere.spheres_created;
        early += sphere.place[0] == 0U;
        CHECK(solve(points, 200, 2, &sphere) == NULL);
        without += sphere.spheres_created;
    }
    printf("# cubes of 200: %lu spheres with the order, %lu without; the sharpest point in %lu of "
           "20\n",
           with, without, early);
    CHECK(10U * with < without);
    unsigned found = 0;
    for (int i = 0; i < 20; i++) {
        struct solid_sphere sphere;
        solid_draw(SOLID_SHELL, &seed, points, 200);
        const enum solid_sphere_status status =
            solid_sphere_by_trial(points, 200, SOLID_SPHERE_SHARPEST_FIRST, 26, workspace,
                                  SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(200), &sphere);
        found += status == SOLID_SPHERE_OK;
        CHECK(status == SOLID_SPHERE_OK ? sphere.place[sphere.support_count - 1U] < 26U
                                        : status == SOLID_SPHERE_NOT_FOUND);
    }
    CHECK(found < 20U);
}

static void too_little_room(void) {
    const struct vec3 points[1] = {{1, 2, 3}};
    struct solid_sphere sphere;
    CHECK_EQ(solid_sphere_find(points, 1, workspace, SOLID_SPHERE_WORKSPACE_BYTES(1) - 1U, &sphere),
             SOLID_SPHERE_ERROR_WORKSPACE);
    CHECK_EQ(solid_sphere_by_trial(points, 1, SOLID_SPHERE_AS_LISTED, 0, workspace,
                                   SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(1) - 1U, &sphere),
             SOLID_SPHERE_ERROR_WORKSPACE);
    CHECK_EQ(solid_sphere_find(points, 0, NULL, 0, &sphere), SOLID_SPHERE_EMPTY);
    CHECK_EQ(solid_sphere_by_trial(points, 0, SOLID_SPHERE_AS_LISTED, 0, NULL, 0, &sphere),
             SOLID_SPHERE_EMPTY);
    CHECK_EQ(solid_sphere_find(points, SOLID_HULL_COUNT_MAX + 1U, workspace, SIZE_MAX, &sphere),
             SOLID_SPHERE_ERROR_COUNT);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750602U;
    set_count = count_text != NULL ? strtoul(count_text, NULL, 0) : set_count;
    printf("# seed %llu, %lu sets a class\n", (unsigned long long)seed, set_count);
    workspace =
        malloc(SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(1000U) + SOLID_SPHERE_WORKSPACE_BYTES(100000U));
    TEST(small_sets);
    TEST(large_sets);
    TEST(few_pivots);
    TEST(order_and_limit);
    TEST(too_little_room);
    free(workspace);
    return check_finish();
}
