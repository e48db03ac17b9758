/// solid_hull_find against the definition of the hull, in exact integers: random and degenerate
/// sets of all sizes, all three methods, and the cost of the default on large sets. COUNT=N sets a
/// class, SEED=N.
#include "check.h"
#include "property/support/solid_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static uint64_t seed;
static unsigned long set_count = 2000UL;
static unsigned char *workspace;

#define LARGE 10000U

static const char *solve(const struct vec3 *points, uint32_t count, enum solid_hull_method method,
                         struct solid_hull *hull) {
    if (solid_hull_find(points, count, method, workspace, SOLID_HULL_WORKSPACE_BYTES(count),
                        hull) != SOLID_HULL_OK) {
        return "no answer";
    }
    return solid_check_hull(points, count, hull);
}

static void small_sets(void) {
    struct vec3 points[40];
    unsigned long dimensions[4] = {0};
    for (unsigned long i = 0; i < set_count * SOLID_CLASS_COUNT && check_clean(); i++) {
        const enum solid_class class = (enum solid_class)(i % SOLID_CLASS_COUNT);
        const uint64_t before = seed;
        const uint32_t count = 1U + solid_below(&seed, i % 8U == 0U ? 40U : 12U);
        solid_draw(class, &seed, points, count);
        for (int method = SOLID_HULL_CAPS; method <= SOLID_HULL_WRAP; method++) {
            struct solid_hull hull;
            const char *const wrong = solve(points, count, (enum solid_hull_method)method, &hull);
            if (!CHECK(wrong == NULL)) {
                printf("  %s, method %d, %u points, seed %llu: %s\n", solid_class_names[class],
                       method, count, (unsigned long long)before, wrong);
            }
            dimensions[hull.dimension]++;
        }
    }
    printf("# answers by dimension: %lu %lu %lu %lu\n", dimensions[0], dimensions[1], dimensions[2],
           dimensions[3]);
}

static void larger_sets(void) {
    struct vec3 *const points = malloc(1000U * sizeof *points);
    for (unsigned i = 0; i < 8U * SOLID_CLASS_COUNT && check_clean(); i++) {
        const enum solid_class class = (enum solid_class)(i % SOLID_CLASS_COUNT);
        solid_draw(class, &seed, points, 1000);
        struct solid_hull hull;
        const char *wrong = solve(points, 1000, SOLID_HULL_CAPS, &hull);
        const uint32_t vertices = hull.vertex_count;
        for (int method = SOLID_HULL_LEVINE; method <= SOLID_HULL_WRAP && wrong == NULL; method++) {
            if (vertices < 200U) { // the others take vertices * points and more
                wrong = solve(points, 1000, (enum solid_hull_method)method, &hull);
                CHECK_EQ(hull.vertex_count, vertices);
            }
        }
        if (!CHECK(wrong == NULL)) {
            printf("  %s: %s\n", solid_class_names[class], wrong);
        }
    }
    free(points);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// Tests and time a point; the best of some runs, since the machine is shared.
static double measure(const char *name, enum solid_class class, uint32_t count) {
    struct vec3 *const points = malloc(count * sizeof *points);
    struct solid_hull hull;
    do {
        solid_draw(class, &seed, points, count);
    } while (points[0].x < 1000000 && points[0].x > -1000000); // of a size that leaves them apart
    double best = 1e9;
    for (int run = 0; run < 5; run++) {
        const double start = seconds();
        CHECK_EQ(solid_hull_find(points, count, SOLID_HULL_CAPS, workspace,
                                 SOLID_HULL_WORKSPACE_BYTES(count), &hull),
                 SOLID_HULL_OK);
        const double taken = seconds() - start;
        best = taken < best ? taken : best;
    }
    const double tests = (double)hull.side_tests / count;
    printf("# %-6s %7u points %6u vertices: %6.2f tests and %7.1f ns a point\n", name, count,
           hull.vertex_count, tests, best / count * 1e9);
    free(points);
    return tests;
}

static void cost(void) {
    // 50 ns a point is what is wanted of a cube with 10,000; tests do not hang on the machine.
    CHECK(measure("cube", SOLID_CUBE, LARGE) < 5.0);
    measure("ball", SOLID_BALL, LARGE);
    const double thousand = measure("sphere", SOLID_SHELL, 1000);
    const double ten = measure("sphere", SOLID_SHELL, 10000),
                 hundred = measure("sphere", SOLID_SHELL, 100000);
    // O(n log n): the same number more for each power of ten. As a power of n, n log n itself has
    // the exponent 1.11 over this range.
    CHECK(ten - thousand < 20.0);
    CHECK(hundred - ten < 20.0);
    const double exponent = 1.0 + log10(hundred / thousand) / 2.0;
    printf("MEASURED hull of points on a sphere, 10^3 to 10^5: tests grow as n^%.2f, %.1f and %.1f "
           "more "
           "a point for each power of ten\n",
           exponent, ten - thousand, hundred - ten);
    CHECK(exponent < 1.2);
}

/// All points of the curve (t, t^2, t^3) are vertices, and given in its order: a set to slow hulls
/// down.
static double tests_on_a_curve(uint32_t count) {
    struct vec3 *const points = malloc(count * sizeof *points);
    struct solid_hull hull;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t t = (int32_t)i - (int32_t)(count / 2U);
        points[i] = vec3(t, t * t, t * t * t);
    }
    CHECK_EQ(solid_hull_find(points, count, SOLID_HULL_CAPS, workspace,
                             SOLID_HULL_WORKSPACE_BYTES(count), &hull),
             SOLID_HULL_OK);
    CHECK_EQ(hull.vertex_count, count);
    free(points);
    return (double)hull.side_tests / count;
}

static void curve(void) {
    const double few = tests_on_a_curve(160), many = tests_on_a_curve(2560);
    printf("MEASURED hull of a curve in space: %.1f tests a point of 160, %.1f of 2,560\n", few,
           many);
    CHECK(many < 2.0 * few);
}

static void too_little_room(void) {
    const struct vec3 points[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    struct solid_hull hull;
    CHECK_EQ(solid_hull_find(points, 4, SOLID_HULL_CAPS, workspace,
                             SOLID_HULL_WORKSPACE_BYTES(4) - 1U, &hull),
             SOLID_HULL_ERROR_WORKSPACE);
    CHECK_EQ(solid_hull_find(points, SOLID_HULL_COUNT_MAX + 1U, SOLID_HULL_CAPS, workspace,
                             SIZE_MAX, &hull),
             SOLID_HULL_ERROR_COUNT);
    CHECK_EQ(solid_hull_find(points, 0, SOLID_HULL_CAPS, NULL, 0, &hull), SOLID_HULL_EMPTY);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750601U;
    set_count = count_text != NULL ? strtoul(count_text, NULL, 0) : set_count;
    printf("# seed %llu, %lu sets a class\n", (unsigned long long)seed, set_count);
    workspace = malloc(SOLID_HULL_WORKSPACE_BYTES(100000U));
    TEST(small_sets);
    TEST(larger_sets);
    TEST(cost);
    TEST(curve);
    TEST(too_little_room);
    free(workspace);
    return check_finish();
}
