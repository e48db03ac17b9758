/// Appendix I: points on the hull, tests by Levine's method and by Chand and Kapur's.
#include "bench/levine/clouds.h"
#include "bench/levine/levine.h"
#include "bench/levine/search.h"
#include "bench/levine/sums.h"

#include "check.h"

#include <math.h>
#include <stdio.h>

static struct vec3 points[LEVINE_COUNT_MOST];

/// Of the cases of one kind and size.
struct counts {
    double npth[LEVINE_CASES], nt[LEVINE_CASES], neq[LEVINE_CASES], nt_each[LEVINE_CASES],
        neq_each[LEVINE_CASES];
    uint32_t cases;
};

/// The averages of one size.
enum mean { MEAN_NPTH, MEAN_NT, MEAN_NEQ, MEAN_NT_EACH, MEAN_NEQ_EACH, MEAN_COUNT };

static void run_cases(enum cloud cloud, uint32_t count, uint32_t cases, struct counts *out) {
    out->cases = cases;
    for (uint32_t i = 0; i < cases; i++) {
        cloud_draw(cloud, count, i, points);
        const struct solid_hull hull = search_hull(points, count, SOLID_HULL_LEVINE);
        CHECK_EQ(hull.face_count, 2U * hull.vertex_count - 4U);
        out->npth[i] = hull.vertex_count;
        out->nt[i] = (double)hull.side_tests;
        out->neq[i] = 3.0 * count * hull.face_count;
        out->nt_each[i] = out->nt[i] / out->npth[i];
        out->neq_each[i] = out->neq[i] / out->npth[i];
    }
}

static void means_of(const struct counts *c, double mean[MEAN_COUNT]) {
    mean[MEAN_NPTH] = sums_mean(c->npth, c->cases);
    mean[MEAN_NT] = sums_mean(c->nt, c->cases);
    mean[MEAN_NEQ] = sums_mean(c->neq, c->cases);
    mean[MEAN_NT_EACH] = sums_mean(c->nt_each, c->cases);
    mean[MEAN_NEQ_EACH] = sums_mean(c->neq_each, c->cases);
}

static void print_row(enum cloud cloud, uint32_t count, const struct counts *c,
                      const double mean[MEAN_COUNT]) {
    double most = 0;
    for (uint32_t i = 0; i < c->cases; i++) {
        most = fmax(most, c->npth[i]);
    }
    printf("| %s | %u | %u |", cloud_name(cloud), count, c->cases);
    levine_cell(mean[MEAN_NPTH]);
    levine_cell(most);
    levine_cell(mean[MEAN_NT]);
    levine_cell(mean[MEAN_NEQ]);
    levine_cell(mean[MEAN_NT_EACH]);
    levine_cell(mean[MEAN_NEQ_EACH]);
    levine_cell(mean[MEAN_NEQ] / mean[MEAN_NT]);
    printf("\n");
    fflush(stdout);
}

/// The slopes of the last four sizes.
static void print_exponents(const char *name, const double mean[][MEAN_COUNT], uint32_t steps,
                            double exponent[MEAN_COUNT]) {
    printf("| %s |", name);
    for (int m = 0; m < MEAN_COUNT; m++) {
        double x[4], y[4];
        for (uint32_t k = 0; k < 4U; k++) {
            x[k] = levine_count(steps - 4U + k);
            y[k] = mean[steps - 4U + k][m];
        }
        exponent[m] = sums_exponent(x, y, 4);
        printf(" %.2f |", exponent[m]);
    }
    printf("\n");
}

/// Chand and Kapur's method itself, on some cases: the same vertices, and how many tests beside
/// NEQ.
static double share_of_neq(void) {
    double tests = 0, neq = 0;
    for (int cloud = 0; cloud < CLOUD_COUNT; cloud++) {
        for (uint32_t count = 25; count <= 200U; count *= 2U) {
            for (uint32_t i = 0; i < 3U; i++) {
                cloud_draw((enum cloud)cloud, count, i, points);
                const uint32_t vertices =
                    search_hull(points, count, SOLID_HULL_LEVINE).vertex_count;
                const struct solid_hull hull = search_hull(points, count, SOLID_HULL_WRAP);
                CHECK_EQ(hull.vertex_count, vertices);
                tests += (double)hull.side_tests;
                neq += 3.0 * count * hull.face_count;
            }
        }
    }
    return tests / neq;
}

static void eight_kinds(bool few) {
    static struct counts counts[CLOUD_COUNT];
    static double mean[CLOUD_COUNT][LEVINE_STEPS_MOST][MEAN_COUNT];
    double least_each = 9, most_each = 0, least_neq = 9, most_neq = 0, most_points = 0,
           least_ratio = 99, most_ratio = 0;
    levine_table("hull");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        const uint32_t steps = few ? LEVINE_STEPS_FEW : cloud_steps((enum cloud)k);
        for (uint32_t step = 0; step < steps; step++) {
            run_cases((enum cloud)k, levine_count(step), LEVINE_CASES, &counts[k]);
            means_of(&counts[k], mean[k][step]);
            print_row((enum cloud)k, levine_count(step), &counts[k], mean[k][step]);
            for (uint32_t i = 0; i < LEVINE_CASES; i++) {
                most_points = fmax(most_points, counts[k].npth[i]);
            }
        }
    }
    if (few) {
        return;
    }
    levine_table("hull-exponents");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        double exponent[MEAN_COUNT];
        print_exponents(cloud_name((enum cloud)k), (const double(*)[MEAN_COUNT])mean[k],
                        cloud_steps((enum cloud)k), exponent);
        least_each = fmin(least_each, exponent[MEAN_NT_EACH]);
        most_each = fmax(most_each, exponent[MEAN_NT_EACH]);
        least_neq = fmin(least_neq, exponent[MEAN_NEQ_EACH]);
        most_neq = fmax(most_neq, exponent[MEAN_NEQ_EACH]);
        const double *const last = mean[k][cloud_steps((enum cloud)k) - 1U];
        least_ratio = fmin(least_ratio, last[MEAN_NEQ] / last[MEAN_NT]);
        most_ratio = fmax(most_ratio, last[MEAN_NEQ] / last[MEAN_NT]);
        if (k == CLOUD_CUBE1 || k == CLOUD_CUBE4) {
            levine_value(k == CLOUD_CUBE1 ? "npth_cube1" : "npth_cube4", exponent[MEAN_NPTH]);
        }
    }
    levine_table("hull-bins");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        const uint32_t count = levine_count(cloud_steps((enum cloud)k) - 1U);
        printf("| %s %u, NPTH |", cloud_name((enum cloud)k), count);
        levine_bins(counts[k].npth, LEVINE_CASES);
        printf("\n| %s %u, NT/NPTH |", cloud_name((enum cloud)k), count);
        levine_bins(counts[k].nt_each, LEVINE_CASES);
        printf("\n");
    }
    levine_value("nt_each_least", least_each);
    levine_value("nt_each_most", most_each);
    levine_value("neq_each_least", least_neq);
    levine_value("neq_each_most", most_neq);
    levine_value("neq_nt_least", least_ratio);
    levine_value("neq_nt_most", most_ratio);
    levine_value("npth_most", most_points);
    levine_value("wrap_share", share_of_neq());
}

/// All points on the hull. Fewer cases where all 500 would take minutes: NT grows as n^2, and
/// hardly differs from case to case.
static void all_on_hull(bool few) {
    static const uint32_t cases[] = {500, 500, 500, 500, 100, 25, 6, 2};
    static struct counts counts;
    static double mean[LEVINE_STEPS_MOST][MEAN_COUNT];
    double exponent[MEAN_COUNT];
    const uint32_t steps = few ? LEVINE_STEPS_FEW : LEVINE_STEPS_MOST;
    levine_table("shell");
    for (uint32_t step = 0; step < steps; step++) {
        run_cases(CLOUD_SHELL, levine_count(step), cases[step], &counts);
        means_of(&counts, mean[step]);
        CHECK(mean[step][MEAN_NPTH] == levine_count(step));
        print_row(CLOUD_SHELL, levine_count(step), &counts, mean[step]);
    }
    if (!few) {
        levine_table("shell-exponents");
        print_exponents(cloud_name(CLOUD_SHELL), (const double(*)[MEAN_COUNT])mean, steps,
                        exponent);
        levine_value("shell_nt", exponent[MEAN_NT]);
        levine_value("shell_ratio", mean[steps - 1U][MEAN_NEQ] / mean[steps - 1U][MEAN_NT]);
    }
}

void levine_hull(bool few) {
    eight_kinds(few);
    all_on_hull(few);
}
