/// How the cost of each problem and step grows: operations counted, not time, for two sizes each
/// and the exponent between them; and the reach: the seconds of a few large problems.
///
/// Operations are comparisons, determinants, dot products and steps along edges
/// (regular_result.operations), and bytes the workspace. Random points, whose costs are those of
/// general position, and a lattice, where all kinds of coincidences come together.
#include "check.h"
#include "property/support/regular_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static struct vec3 *points;

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/// Points of a cube's lattice, in order of size; else random ones.
static void fill(enum regular_problem problem, uint32_t count, bool lattice) {
    uint64_t seed = 17;
    const uint32_t total = count * regular_points_of(problem);
    uint32_t side = 2;
    while ((uint64_t)side * side * (regular_is_planar(problem) ? 1U : side) < total) {
        side++;
    }
    for (uint32_t i = 0; i < total; i++) {
        const uint32_t at = i / (side * side);
        points[i] = vec3((int32_t)(i % side), (int32_t)(i / side % side),
                         regular_is_planar(problem) ? 0 : (int32_t)at);
        if (!lattice) {
            points[i].x = (int32_t)(check_random(&seed) >> 44) - (1 << 19);
            points[i].y = (int32_t)(check_random(&seed) >> 44) - (1 << 19);
            points[i].z = (int32_t)(check_random(&seed) >> 44) - (1 << 19);
            points[i].z = regular_is_planar(problem) ? 0 : points[i].z;
        }
    }
}

/// A wire frame: segments between neighbours of a random path, so that each shares planes with two
/// others.
static void fill_path(uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        points[2U * i] = points[2U * i - 1U];
    }
}

static double run(const struct regular_input *in, enum regular_step step,
                  const struct regular_options *options, struct regular_result *result,
                  uint64_t *bytes) {
    *bytes = regular_workspace_bytes(in->problem, step, in->count, options);
    void *const workspace = malloc(*bytes + 1U);
    const double before = now_s();
    const enum regular_status status =
        step == REGULAR_DECIDE    ? regular_decide(in, options, workspace, *bytes, result)
        : step == REGULAR_COMPUTE ? regular_compute(in, options, workspace, *bytes, result)
                                  : regular_optimize(in, options, workspace, *bytes, result);
    const double seconds = now_s() - before;
    free(workspace);
    if (status != REGULAR_OK) {
        printf("  status %d\n", (int)status);
        exit(1);
    }
    return seconds;
}

static const char *const step_names[] = {"decide", "compute", "optimize"};

struct row {
    enum regular_problem problem;
    enum regular_step step;
    uint32_t small, large;
    bool lattice;
    struct regular_options options;
    const char *note, *claim;
};

static const struct row rows[] = {
    {REGULAR_POINTS2_LINE, REGULAR_DECIDE, 20000, 320000, false, {0}, "", "n log n"},
    {REGULAR_POINTS2_LINE, REGULAR_DECIDE, 20000, 320000, false, {.buckets = true}, "buckets", "n"},
    {REGULAR_POINTS2_LINE, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n log n"},
    {REGULAR_POINTS2_LINE, REGULAR_OPTIMIZE, 100, 800, false, {0}, "", "n^2 log n"},
    {REGULAR_POINTS2_LINE, REGULAR_OPTIMIZE, 100, 800, false, {.buckets = true}, "buckets", "n^2"},
    {REGULAR_POINTS3_LINE, REGULAR_DECIDE, 20000, 320000, false, {0}, "", "n log n"},
    {REGULAR_POINTS3_LINE, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n log n"},
    {REGULAR_POINTS3_LINE, REGULAR_OPTIMIZE, 30, 240, false, {0}, "", "n^2 log n"},
    {REGULAR_POINTS3_X, REGULAR_DECIDE, 20000, 320000, false, {0}, "", "n log n"},
    {REGULAR_POINTS3_X, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n log n"},
    {REGULAR_POINTS3_X, REGULAR_OPTIMIZE, 12, 48, false, {0}, "", "n^4"},
    {REGULAR_POINTS3_X,
     REGULAR_OPTIMIZE,
     12,
     48,
     false,
     {.cylinder = true},
     "cylinder",
     "n^4 log n, n^2 space"},
    {REGULAR_POINTS3_XY, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n log n"},
    {REGULAR_POINTS3_XYZ, REGULAR_DECIDE, 20000, 320000, false, {0}, "", "n log n"},
    {REGULAR_POINTS3_XYZ, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n log n"},
    {REGULAR_POINTS3_PLANE, REGULAR_DECIDE, 250, 2000, false, {0}, "", "n^2"},
    {REGULAR_POINTS3_PLANE, REGULAR_COMPUTE, 250, 2000, false, {0}, "a vertical pair", "n^2"},
    {REGULAR_POINTS3_PLANE,
     REGULAR_COMPUTE,
     50,
     400,
     false,
     {.small = true},
     "a vertical pair, small",
     "n^3, n space"},
    {REGULAR_POINTS3_PLANE, REGULAR_OPTIMIZE, 10, 20, false, {0}, "", "n^6"},
    {REGULAR_POINTS3_PLANE,
     REGULAR_OPTIMIZE,
     9,
     18,
     false,
     {.cylinder = true},
     "cylinder",
     "n^6 log n, n^3 space"},
    {REGULAR_POINTS3_COCIRCULAR, REGULAR_DECIDE, 30, 120, false, {0}, "", "n^3"},
    {REGULAR_SEGMENTS2_VERTICAL, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n"},
    {REGULAR_SEGMENTS2_VERTICAL, REGULAR_OPTIMIZE, 2000, 64000, false, {0}, "", "n log n"},
    {REGULAR_SEGMENTS3_VERTICAL, REGULAR_COMPUTE, 20000, 320000, true, {0}, "lattice", "n"},
    {REGULAR_SEGMENTS3_VERTICAL, REGULAR_OPTIMIZE, 500, 8000, false, {0}, "", "n log n"},
    {REGULAR_SEGMENTS3_PLANE, REGULAR_DECIDE, 2000, 64000, false, {0}, "", "n log n"},
    {REGULAR_SEGMENTS3_PLANE, REGULAR_COMPUTE, 100, 1600, false, {0}, "one vertical", "n^2"},
    {REGULAR_SEGMENTS3_PLANE, REGULAR_OPTIMIZE, 12, 48, true, {0}, "in one plane each", "n^4"},
    {REGULAR_FACES_VERTICAL, REGULAR_COMPUTE, 20000, 320000, false, {0}, "one vertical", "n"},
    {REGULAR_FACES_VERTICAL, REGULAR_OPTIMIZE, 100, 800, false, {0}, "", "n^2"},
    {REGULAR_FACES_VERTICAL,
     REGULAR_OPTIMIZE,
     100,
     800,
     false,
     {.cylinder = true},
     "cylinder",
     "n^2 log n, n space"},
    {REGULAR_FACES_VERTICAL, REGULAR_OPTIMIZE, 1000, 64000, false, {.above = true}, "above", "n"},
};

/// How many directions or circles are forbidden at most.
static double forbidden(const struct row *row, double n) {
    return row->problem == REGULAR_POINTS3_PLANE ? n * (n - 1) * (n - 2) / 6
           : regular_points_of(row->problem) == 1U || row->problem == REGULAR_SEGMENTS3_PLANE
               ? n * (n - 1) / 2
               : n;
}

static struct regular_input input_of(const struct row *row, uint32_t count) {
    const struct regular_input in = {row->problem, points, count};
    fill(row->problem, count, row->lattice && row->problem != REGULAR_SEGMENTS3_PLANE);
    if (row->problem == REGULAR_SEGMENTS3_PLANE && row->step != REGULAR_DECIDE) {
        fill_path(count);
    }
    if (row->problem == REGULAR_SEGMENTS3_PLANE && row->step == REGULAR_OPTIMIZE) {
        // All meet in a point, so every two are in a plane.
        for (uint32_t i = 0; i < count; i++) {
            points[2U * i] = vec3(1, 2, 3);
        }
    } else if (strstr(row->note, "vertical") != NULL) {
        points[1] = vec3(points[0].x, points[0].y, points[0].z + 5);
        if (regular_points_of(row->problem) == 2U) {
            points[2] = points[1];
        }
    }
    return in;
}

static void growth(const struct row *row) {
    double operations[2], bytes[2];
    for (int i = 0; i < 2; i++) {
        const struct regular_input in = input_of(row, i == 0 ? row->small : row->large);
        struct regular_result result;
        uint64_t size;
        run(&in, row->step, &row->options, &result, &size);
        operations[i] = (double)result.operations;
        bytes[i] = (double)size;
    }
    const double factor = log((double)row->large / row->small);
    printf("%-19s %-9s %-24s %7u %7u %12.0f %6.2f", check_problem_name(row->problem),
           step_names[row->step], row->note, row->small, row->large, operations[1],
           log(operations[1] / operations[0]) / factor);
    if (bytes[1] > 0) {
        printf(" %6.2f", log(bytes[1] / bytes[0]) / factor);
    } else {
        printf(" %6s", "none");
    }
    if (row->step == REGULAR_OPTIMIZE) {
        printf(" %6.2f", log(operations[1] / operations[0]) /
                             log(forbidden(row, row->large) / forbidden(row, row->small)));
    } else {
        printf(" %6s", "");
    }
    printf("  %s\n", row->claim);
    fflush(stdout);
}

static void reach(enum regular_problem problem, uint32_t count, bool lattice,
                  const struct regular_options *options, const char *note) {
    const struct row row = {.problem = problem, .step = REGULAR_OPTIMIZE, .note = ""};
    const struct regular_input in = input_of(&row, count);
    fill(problem, count, lattice);
    struct regular_result result;
    uint64_t bytes;
    const double seconds = run(&in, REGULAR_OPTIMIZE, options, &result, &bytes);
    printf("%-19s %-9s %-24s %7u %8.1f s %8.0f MB  tolerance %.3g rad\n",
           check_problem_name(problem), "optimize", note, count, seconds, (double)bytes / 1e6,
           (double)result.tolerance_turn64 * 3.4061215800934164e-19);
    fflush(stdout);
}

int main(void) {
    points = malloc(3U * 320000U * sizeof *points);
    printf("growth: operations at the larger size, and the exponents of operations and bytes\n");
    printf("time by m: against the number of forbidden directions or circles\n");
    printf("%-19s %-9s %-24s %7s %7s %12s %6s %6s %6s  %s\n", "problem", "step", "", "n", "to n",
           "operations", "time", "space", "by m", "claim");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        growth(&rows[i]);
    }
    printf("\nreach: seconds of processor time\n");
    const struct regular_options plain = {0}, buckets = {.buckets = true},
                                 slender = {.cylinder = true};
    reach(REGULAR_POINTS2_LINE, 1000, false, &plain, "");
    reach(REGULAR_POINTS2_LINE, 1000, false, &buckets, "buckets");
    reach(REGULAR_POINTS3_LINE, 1000, false, &plain, "");
    reach(REGULAR_POINTS3_X, 60, false, &plain, "");
    reach(REGULAR_POINTS3_X, 60, false, &slender, "cylinder");
    reach(REGULAR_POINTS3_X, 60, true, &plain, "lattice");
    reach(REGULAR_POINTS3_PLANE, 24, false, &plain, "");
    reach(REGULAR_POINTS3_PLANE, 24, false, &slender, "cylinder");
    reach(REGULAR_FACES_VERTICAL, 2000, false, &plain, "");
    free(points);
    return 0;
}
