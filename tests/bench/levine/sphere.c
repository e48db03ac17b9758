/// Appendix II: the search for the smallest sphere, by the solid angles of the hull's vertices.
#include "bench/levine/clouds.h"
#include "bench/levine/levine.h"
#include "bench/levine/search.h"
#include "bench/levine/sums.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PLACES_MOST 26U ///< the thesis gives up by this point

static struct vec3 points[LEVINE_COUNT_MOST];

/// What percentiles are taken of.
enum quantity {
    NT,
    NT_EACH,
    NSC,
    NST,
    NST_SHARE,
    ESC,
    GAIN,
    FIRST,
    SECOND,
    THIRD,
    FOURTH,
    QUANTITIES
};

/// Of the cases of one kind and size; INFINITY where no sphere was found, and for the third and
/// fourth points of spheres that have none; of that many cases.
struct counts {
    double value[QUANTITIES][LEVINE_CASES];
    uint32_t filled[QUANTITIES];
    double npth;
    uint32_t of_type[5], none, first_used, last_used;
    uint32_t place[PLACES_MOST];
};

static void put(struct counts *c, enum quantity quantity, double value) {
    c->value[quantity][c->filled[quantity]++] = value;
}

static void run_case(struct counts *c, uint32_t count) {
    struct solid_sphere s;
    const bool found = search_sphere(points, count, SOLID_SPHERE_SHARPEST_FIRST, PLACES_MOST, &s) ==
                       SOLID_SPHERE_OK;
    const uint32_t npth = search_hull(points, count, SOLID_HULL_CAPS).vertex_count;
    const double lost = found ? 0 : INFINITY;
    c->npth += npth;
    put(c, NT, (double)s.point_tests + lost);
    put(c, NT_EACH, (double)s.point_tests / npth + lost);
    put(c, NSC, (double)s.spheres_created + lost);
    put(c, NST, (double)s.spheres_tested + lost);
    put(c, NST_SHARE, (double)s.spheres_tested / (double)s.spheres_created + lost);
    put(c, ESC, search_expected(npth));
    put(c, GAIN, found ? search_expected(npth) / (double)s.spheres_created : 0);
    if (!found) {
        c->none++;
        return;
    }
    c->of_type[s.support_count]++;
    c->first_used += s.place[0] == 0U;
    c->last_used += s.support_count == 3U && s.place[2] + 1U == npth;
    for (unsigned k = 0; k < s.support_count; k++) {
        put(c, (enum quantity)(FIRST + k), s.place[k] + 1U);
        // The two points farthest apart may stand anywhere in the order.
        c->place[s.place[k] < PLACES_MOST ? s.place[k] : PLACES_MOST - 1U]++;
    }
}

static void run_cases(enum cloud cloud, uint32_t count, struct counts *c) {
    memset(c, 0, sizeof *c);
    for (uint32_t i = 0; i < LEVINE_CASES; i++) {
        cloud_draw(cloud, count, i, points);
        run_case(c, count);
    }
    for (int q = 0; q < QUANTITIES; q++) {
        sums_sort(c->value[q], c->filled[q]);
    }
}

static double part(const struct counts *c, enum quantity quantity, double share) {
    return c->filled[quantity] == 0U ? NAN
                                     : sums_part(c->value[quantity], c->filled[quantity], share);
}

static void print_row(enum cloud cloud, uint32_t count, const struct counts *c) {
    const double percent = 100.0 / LEVINE_CASES;
    printf("| %s | %u |", cloud_name(cloud), count);
    levine_cell(c->npth / LEVINE_CASES);
    levine_cell(c->none * percent);
    levine_cell(c->of_type[2] * percent);
    levine_cell(c->of_type[3] * percent);
    levine_cell(c->of_type[4] * percent);
    levine_cell(c->first_used * percent);
    for (int k = FIRST; k <= FOURTH; k++) {
        levine_cell(part(c, (enum quantity)k, 0.5));
    }
    printf("\n");
    fflush(stdout);
}

static const double shares[4] = {0.5, 0.6, 0.7, 0.8};

/// Four percentiles of each quantity of the search.
static void print_parts(enum cloud cloud, uint32_t count, const struct counts *c) {
    printf("| %s | %u |", cloud_name(cloud), count);
    for (int q = NT; q <= GAIN; q++) {
        for (int k = 0; k < 4; k++) {
            // Of the gain the smallest of the best.
            levine_number(part(c, (enum quantity)q, q == GAIN ? 1 - shares[k] : shares[k]));
            printf(k < 3 ? " /" : " |");
        }
    }
    printf("\n");
}

static struct counts counts[CLOUD_COUNT][LEVINE_STEPS_MOST];

/// The slope of the last four sizes.
static double exponent_of(enum cloud cloud, enum quantity quantity, double share) {
    const uint32_t steps = cloud_steps(cloud);
    double x[4], y[4];
    for (uint32_t i = 0; i < 4U; i++) {
        x[i] = levine_count(steps - 4U + i);
        y[i] = part(&counts[cloud][steps - 4U + i], quantity, share);
    }
    return sums_exponent(x, y, 4);
}

static void print_exponents(enum cloud cloud) {
    printf("| %s |", cloud_name(cloud));
    for (int q = NT; q <= ESC; q++) {
        for (int k = 0; k < 4; k++) {
            const double exponent = exponent_of(cloud, (enum quantity)q, shares[k]);
            printf(isfinite(exponent) ? " %.2f" : " -", exponent);
            printf(k < 3 ? " /" : " |");
        }
    }
    printf("\n");
}

/// The cases whose histograms the thesis shows.
static const struct {
    enum cloud cloud;
    uint32_t step;
} shown[] = {{CLOUD_CUBE1, 7},   {CLOUD_POLYHEDRON, 2}, {CLOUD_POLYHEDRON, 6},
             {CLOUD_SPHERE1, 2}, {CLOUD_SPHERE1, 5},    {CLOUD_SPHERE2, 5},
             {CLOUD_SPHERE4, 2}, {CLOUD_SPHERE4, 5},    {CLOUD_ELLIPSE, 6}};

static void print_histograms(void) {
    levine_table("sphere-bins");
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
        const struct counts *const c = &counts[shown[i].cloud][shown[i].step];
        printf("| %s %u |", cloud_name(shown[i].cloud), levine_count(shown[i].step));
        uint32_t bins[16] = {0}; // 1, 2 to 3, 4 to 7, ...
        for (uint32_t k = 0; k + c->none < LEVINE_CASES; k++) {
            bins[(uint32_t)log2(c->value[NSC][k])]++;
        }
        for (int k = 0; k < 16; k++) {
            printf(" %u", bins[k]);
        }
        printf(" | %u |", c->none);
        for (uint32_t k = 0; k < PLACES_MOST; k++) {
            printf(" %u", c->place[k]);
        }
        printf(" |\n");
    }
}

static void print_values(void) {
    const struct counts *const ellipse = &counts[CLOUD_ELLIPSE][6];
    double most = 0, least_first = 100, last_used = 0, cases = 0;
    for (int k = 0; k < CLOUD_COUNT; k++) {
        for (uint32_t step = 0; step < cloud_steps((enum cloud)k); step++) {
            most = fmax(most, part(&counts[k][step], GAIN, 1));
            last_used += counts[k][step].last_used;
            cases += LEVINE_CASES;
        }
    }
    for (uint32_t step = 0; step < LEVINE_STEPS_MOST; step++) {
        least_first =
            fmin(least_first, 100.0 * counts[CLOUD_CUBE1][step].first_used / LEVINE_CASES);
    }
    levine_value("none_sphere1_800", 100.0 * counts[CLOUD_SPHERE1][5].none / LEVINE_CASES);
    levine_value("none_sphere2_800", 100.0 * counts[CLOUD_SPHERE2][5].none / LEVINE_CASES);
    levine_value("nsc_ellipse", part(ellipse, NSC, 0.5));
    levine_value("esc_ellipse", part(ellipse, ESC, 0.5));
    levine_value("gain_most", log10(most));
    levine_value("first_cube1", least_first);
    levine_value("last_used", last_used);
    levine_value("cases", cases);
    levine_value("nt_sphere1", exponent_of(CLOUD_SPHERE1, NT_EACH, 0.5));
    levine_value("nt_sphere4", exponent_of(CLOUD_SPHERE4, NT_EACH, 0.5));
    levine_value("nt_ellipse", exponent_of(CLOUD_ELLIPSE, NT_EACH, 0.5));
    levine_value("nt_cube1", exponent_of(CLOUD_CUBE1, NT_EACH, 0.5));
    levine_value("nt_cube2", exponent_of(CLOUD_CUBE2, NT_EACH, 0.5));
    levine_value("nt_cube4", exponent_of(CLOUD_CUBE4, NT_EACH, 0.5));
    levine_value("spheres_100", 2 * search_expected(100));
    levine_value("spheres_400", search_expected(400));
}

void levine_sphere(bool few) {
    levine_table("sphere");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        const uint32_t steps = few ? LEVINE_STEPS_FEW : cloud_steps((enum cloud)k);
        for (uint32_t step = 0; step < steps; step++) {
            run_cases((enum cloud)k, levine_count(step), &counts[k][step]);
            print_row((enum cloud)k, levine_count(step), &counts[k][step]);
        }
    }
    levine_table("sphere-parts");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        const uint32_t steps = few ? LEVINE_STEPS_FEW : cloud_steps((enum cloud)k);
        for (uint32_t step = 0; step < steps; step++) {
            print_parts((enum cloud)k, levine_count(step), &counts[k][step]);
        }
    }
    if (few) {
        return;
    }
    levine_table("sphere-exponents");
    for (int k = 0; k < CLOUD_COUNT; k++) {
        print_exponents((enum cloud)k);
    }
    print_histograms();
    print_values();
}
