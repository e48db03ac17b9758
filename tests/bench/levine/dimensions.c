/// Chapter VIII: the hull's behaviour as a function of the dimension, two to five.
#include "bench/levine/caps.h"
#include "bench/levine/clouds.h"
#include "bench/levine/levine.h"
#include "bench/levine/sums.h"

#include "check.h"

#include "solid/solid_hull.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum kind { CUBE, NORMAL, SHELL, KINDS };
static const char *const names[KINDS] = {"cube 1", "sphere 4", "shell"};

static int32_t places[LEVINE_COUNT_MOST][CAPS_DIMENSIONS];

/// The kinds of clouds.h in any dimension: normal numbers below 1 each, or of a length below 4, or
/// brought to one length.
static void draw(enum kind kind, uint32_t dimension, uint32_t count, uint32_t index) {
    uint64_t random =
        cloud_seed((enum cloud)(CLOUD_SHELL + 1 + kind), count * 8U + dimension, index);
    double spare = NAN;
    for (uint32_t i = 0; i < count; i++) {
        double p[CAPS_DIMENSIONS], square;
        do {
            square = 0;
            for (uint32_t k = 0; k < dimension; k++) {
                do {
                    p[k] = cloud_normal(&random, &spare);
                } while (kind == CUBE && fabs(p[k]) >= 1);
                square += p[k] * p[k];
            }
        } while (kind == NORMAL ? square > 16 : square == 0);
        const double scale = caps_coordinate_max(dimension) / (kind == CUBE     ? 1.0
                                                               : kind == NORMAL ? 4.0
                                                                                : sqrt(square));
        for (uint32_t k = 0; k < dimension; k++) {
            places[i][k] = (int32_t)lrint(p[k] * scale);
        }
    }
}

/// In three dimensions the firmware's hull has as many vertices.
static void compare(uint32_t count, const struct caps_hull *hull) {
    static struct vec3 points[LEVINE_COUNT_MOST];
    void *const workspace = malloc(SOLID_HULL_WORKSPACE_BYTES(count));
    struct solid_hull other;
    for (uint32_t i = 0; i < count; i++) {
        points[i] = vec3(places[i][0], places[i][1], places[i][2]);
    }
    CHECK_EQ(solid_hull_find(points, count, SOLID_HULL_LEVINE, workspace,
                             SOLID_HULL_WORKSPACE_BYTES(count), &other),
             SOLID_HULL_OK);
    CHECK_EQ(other.vertex_count, hull->vertex_count);
    CHECK_EQ(other.face_count, hull->facet_count);
    // The same rounds; only which face is met first differs.
    CHECK((double)other.side_tests < 1.3 * (double)hull->tests &&
          (double)hull->tests < 1.3 * (double)other.side_tests);
    free(workspace);
}

struct row {
    double npth, nph, nt, neq, nt_each, made;
};

static struct row run(enum kind kind, uint32_t dimension, uint32_t count, uint32_t cases) {
    struct row row = {0, 0, 0, 0, 0, 0};
    for (uint32_t i = 0; i < cases; i++) {
        struct caps_hull hull;
        draw(kind, dimension, count, i);
        if (!CHECK(caps_hull_find(places, count, dimension, i < 2U, &hull))) {
            return row;
        }
        if (dimension == 3U && i < 20U) {
            compare(count, &hull);
        }
        CHECK(dimension != 2U || hull.facet_count == hull.vertex_count);
        row.npth += (double)hull.vertex_count / cases;
        row.nph += (double)hull.facet_count / cases;
        row.made += (double)hull.facets_made / cases;
        row.nt += (double)hull.tests / cases;
        row.nt_each += (double)hull.tests / hull.vertex_count / cases;
        // An edge of the thesis is here what two facets share: dimension / 2 for each facet.
        row.neq += (double)dimension * count * hull.facet_count / cases;
    }
    return row;
}

static void print_row(enum kind kind, uint32_t dimension, uint32_t count, uint32_t cases,
                      const struct row *r) {
    printf("| %s | %u | %u | %u |", names[kind], dimension, count, cases);
    levine_cell(r->npth);
    levine_cell(r->nph);
    levine_cell(r->made / r->nph);
    levine_cell(r->nt);
    levine_cell(r->nt_each);
    levine_cell(r->neq);
    levine_cell(r->neq / r->nt);
    printf("\n");
    fflush(stdout);
}

/// The slopes of the last four sizes, or of all.
static void print_exponents(enum kind kind, uint32_t dimension, uint32_t steps,
                            const struct row *rows) {
    const uint32_t used = steps < 4U ? steps : 4U;
    double x[4], y[5][4];
    for (uint32_t i = 0; i < used; i++) {
        const struct row *const r = &rows[steps - used + i];
        const double values[5] = {r->npth, r->nph, r->nt, r->nt_each, r->neq};
        x[i] = levine_count(steps - used + i);
        for (int q = 0; q < 5; q++) {
            y[q][i] = values[q];
        }
    }
    printf("| %s | %u |", names[kind], dimension);
    for (int q = 0; q < 5; q++) {
        printf(" %.2f |", sums_exponent(x, y[q], used));
    }
    printf("\n");
}

/// How many sizes, from 25 points on, and how many of them with 500 cases; the others have 50. Cut
/// where a row would take more than about ten seconds.
static const struct {
    uint32_t steps, full;
} sizes[KINDS][CAPS_DIMENSIONS + 1U] = {
    [CUBE] = {[2] = {8, 8}, [3] = {8, 7}, [4] = {7, 5}, [5] = {5, 3}},
    [NORMAL] = {[2] = {8, 8}, [3] = {8, 7}, [4] = {7, 5}, [5] = {5, 3}},
    [SHELL] = {[2] = {8, 5}, [3] = {6, 4}, [4] = {5, 3}, [5] = {4, 2}},
};

void levine_dimensions(bool few) {
    static struct row rows[KINDS][CAPS_DIMENSIONS + 1U][LEVINE_STEPS_MOST];
    levine_table("dimensions");
    for (int kind = 0; kind < (few ? 1 : KINDS); kind++) {
        for (uint32_t d = 2; d <= CAPS_DIMENSIONS; d++) {
            for (uint32_t step = 0; step < (few ? 1U : sizes[kind][d].steps); step++) {
                const uint32_t cases = step < sizes[kind][d].full ? LEVINE_CASES : 50U;
                rows[kind][d][step] = run((enum kind)kind, d, levine_count(step), cases);
                print_row((enum kind)kind, d, levine_count(step), cases, &rows[kind][d][step]);
            }
        }
    }
    if (few) {
        return;
    }
    levine_table("dimensions-exponents");
    for (int kind = 0; kind < KINDS; kind++) {
        for (uint32_t d = 2; d <= CAPS_DIMENSIONS; d++) {
            print_exponents((enum kind)kind, d, sizes[kind][d].steps, rows[kind][d]);
        }
    }
}
