/// Appendix II: what the order of the trials is worth, and what hangs on giving up.
#include "bench/levine/clouds.h"
#include "bench/levine/levine.h"
#include "bench/levine/search.h"

#include "check.h"

#include <stdio.h>

static struct vec3 points[LEVINE_COUNT_MOST];

/// The search without the heuristic, where it can be waited for.
static void without_heuristic(bool few) {
    levine_table("sphere-plain");
    for (int k = 0; k < (few ? 1 : CLOUD_COUNT); k++) {
        for (uint32_t count = 25; count <= (few ? 25U : 50U); count *= 2U) {
            const uint32_t cases = count == 25U ? LEVINE_CASES : 100U; // 10,000 spheres a case
            double plain = 0, expected = 0, sharp = 0;
            for (uint32_t i = 0; i < cases; i++) {
                struct solid_sphere s;
                cloud_draw((enum cloud)k, count, i, points);
                CHECK_EQ(search_sphere(points, count, SOLID_SPHERE_AS_LISTED, 0, &s),
                         SOLID_SPHERE_OK);
                plain += (double)s.spheres_created / cases;
                CHECK_EQ(search_sphere(points, count, SOLID_SPHERE_SHARPEST_FIRST, 0, &s),
                         SOLID_SPHERE_OK);
                sharp += (double)s.spheres_created / cases;
                expected +=
                    search_expected(search_hull(points, count, SOLID_HULL_CAPS).vertex_count) /
                    cases;
            }
            printf("| %s | %u | %u |", cloud_name((enum cloud)k), count, cases);
            levine_cell(expected);
            levine_cell(plain);
            levine_cell(sharp);
            levine_cell(plain / sharp);
            printf("\n");
            fflush(stdout);
        }
    }
}

/// How many of the worst kind have no sphere by other points than the 26th. Twice, with other sets,
/// to see how much is chance.
static void by_limit(void) {
    static const uint32_t limits[] = {22, 24, 26, 28, 30, 32};
    const uint32_t count = levine_count(5);
    levine_table("sphere-limit");
    for (uint32_t first = 0; first <= LEVINE_CASES; first += LEVINE_CASES) {
        uint32_t none[sizeof limits / sizeof *limits] = {0};
        for (uint32_t i = first; i < first + LEVINE_CASES; i++) {
            struct solid_sphere s;
            cloud_draw(CLOUD_SPHERE1, count, i, points);
            const bool found = search_sphere(points, count, SOLID_SPHERE_SHARPEST_FIRST, 32, &s) ==
                               SOLID_SPHERE_OK;
            const uint32_t last = found ? s.place[s.support_count - 1U] : UINT32_MAX;
            for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
                // A sphere of three is tried when the next point comes up.
                none[k] += !found || last + (s.support_count == 3U) >= limits[k] ? 1U : 0U;
            }
        }
        printf("| %s %u, cases %u to %u |", cloud_name(CLOUD_SPHERE1), count, first + 1U,
               first + LEVINE_CASES);
        for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
            levine_cell(100.0 * none[k] / LEVINE_CASES);
        }
        printf("\n");
    }
}

/// The default methods beside the thesis', at a size that all kinds have: tests a point.
static void by_method(bool few) {
    static uint32_t workspace[SOLID_SPHERE_WORKSPACE_BYTES(LEVINE_COUNT_MOST) / sizeof(uint32_t)];
    const uint32_t count = levine_count(5), cases = 100;
    levine_table("methods");
    for (int k = 0; k < (few ? 1 : CLOUD_COUNT); k++) {
        double levine = 0, caps = 0, pivot = 0, pivots = 0;
        for (uint32_t i = 0; i < cases; i++) {
            struct solid_sphere s;
            cloud_draw((enum cloud)k, count, i, points);
            levine += (double)search_hull(points, count, SOLID_HULL_LEVINE).side_tests;
            caps += (double)search_hull(points, count, SOLID_HULL_CAPS).side_tests;
            CHECK_EQ(solid_sphere_find(points, count, workspace, sizeof workspace, &s),
                     SOLID_SPHERE_OK);
            pivot += (double)s.point_tests;
            pivots += (double)s.pivots;
        }
        printf("| %s | %u | %u |", cloud_name((enum cloud)k), count, cases);
        levine_cell(levine / cases / count);
        levine_cell(caps / cases / count);
        levine_cell(pivot / cases / count);
        levine_cell(pivots / cases);
        printf("\n");
    }
}

void levine_trials(bool few) {
    without_heuristic(few);
    by_method(few);
    if (!few) {
        by_limit();
    }
}
