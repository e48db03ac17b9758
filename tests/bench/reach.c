/// What the table says about Anderson's equations, and about what is to be reached.
#include "bench/table.h"

#include <math.h>
#include <stdio.h>

enum { AT_10 = 0, AT_1000 = 2, AT_10000, AT_100000, AT_1000000 };

static double figure(enum bench_set set, int size, int method, enum bench_column column) {
    const struct bench_figures *const f = &bench_table[set][size][method];
    return f->is_run ? f->of[column] : NAN;
}

// ---------------------------------------------------------------- equations 12 to 17

static const char *word(double value, bool holds) {
    return isnan(value) ? "" : holds ? "yes" : "no";
}

static void print_number(double value, const char *format, int width) {
    char text[32];
    snprintf(text, sizeof text, format, value);
    printf("%*s", width, isnan(value) ? "-" : text);
}

/// Sizes above 1,000 decide: for fewer points a hull is not yet what it will be.
static double exponent(int set, enum bench_column column, int sizes) {
    return bench_growth(set, BENCH_HULL, column, sizes > AT_1000 + 1 ? sizes - AT_1000 : sizes);
}

void bench_print_equations(int sizes) {
    const int last = sizes - 1;
    printf(
        "The hull's size h beside equations 12 to 17 of 1985. Exponents of n over the sizes from "
        "1,000 on; logarithms are natural. h is that of %u sets (%u of 100,000 points, %u of a "
        "million).\n"
        "12: E[h] = O(n^p), p < 1   13: E[h log h] = O(n^q), q < 1: algorithm B is then O(n)   14: "
        "p = 1/3, a disc (E[h] = 3.383 n^(1/3): Renyi and Sulanke 1963)\n"
        "15: E[h] = O(log^(1/2) n), normal in the plane   16: E[h^2] = Var(h) + E[h]^2: its share "
        "by Var   17: p <= 1/2 and Var(h) = O(n^v), v <= 1: algorithm C is then O(n)\n\n"
        "%-17s |%8s%8s |%8s%8s |%22s |%26s |%14s |%8s%10s%8s\n",
        bench_hull_sets(10), bench_hull_sets(100000), bench_hull_sets(1000000), "set", "p", "12?",
        "q", "13?", "14: E[h] / n^(1/3)", "15: E[h] / log^(1/2) n", "16: Var share", "v",
        "Var/E[h]", "17?");
    for (int set = 0; set < BENCH_SPHERE; set++) {
        const double p = exponent(set, BENCH_H, sizes), q = exponent(set, BENCH_H_LOG, sizes);
        const double v = exponent(set, BENCH_H_VARIANCE, sizes);
        // Where nothing varies, v has no exponent and Var(h) = 0 is O(n).
        const bool is_c_linear = p <= 0.5 && !(v > 1.0);
        const int early = sizes > AT_1000 + 1 ? AT_1000 : 0;
        printf("%-17s |", bench_set_names[set]);
        print_number(p, "%.3f", 8);
        printf("%8s |", word(p, p < 0.99));
        print_number(q, "%.3f", 8);
        printf("%8s |", word(q, q < 0.99));
        const double h[2] = {figure((enum bench_set)set, early, BENCH_HULL, BENCH_H),
                             figure((enum bench_set)set, last, BENCH_HULL, BENCH_H)};
        const double n[2] = {bench_size((enum bench_set)set, early),
                             bench_size((enum bench_set)set, last)};
        print_number(h[0] / cbrt(n[0]), "%.2f", 10);
        printf(" ..");
        print_number(h[1] / cbrt(n[1]), "%.2f", 9);
        printf(" |");
        print_number(h[0] / sqrt(log(n[0])), "%.2f", 12);
        printf(" ..");
        print_number(h[1] / sqrt(log(n[1])), "%.2f", 11);
        const double variance = figure((enum bench_set)set, last, BENCH_HULL, BENCH_H_VARIANCE);
        printf(" |");
        print_number(100.0 * variance /
                         figure((enum bench_set)set, last, BENCH_HULL, BENCH_H_SQUARE),
                     "%.2g%%", 14);
        printf(" |");
        print_number(v, "%.3f", 8);
        print_number(variance / h[1], "%.2f", 10);
        printf("%8s\n", word(p, is_c_linear));
    }
    printf("\n");
}

// ---------------------------------------------------------------- verdicts

static int reached, measured;

static void verdict(bool holds, double got, const char *relation, double bound, const char *what) {
    if (isnan(got)) {
        printf("%-13s %10s %8s %-7g %s\n", "not measured", "-", relation, bound, what);
        return;
    }
    measured++;
    reached += holds;
    printf("%-13s %10.4g %8s %-7g %s\n", holds ? "reached" : "FALLS SHORT", got, relation, bound,
           what);
}

static void at_most(double got, double bound, const char *what) {
    verdict(got <= bound, got, "<=", bound, what);
}

static void at_least(double got, double bound, const char *what) {
    verdict(got >= bound, got, ">=", bound, what);
}

static void reads(enum bench_set set) {
    const struct {
        int size;
        double cold;
    } bounds[] = {{AT_1000, 2.5}, {AT_100000, 1.2}, {AT_1000000, 1.2}};
    char what[96];
    for (unsigned i = 0; i < sizeof bounds / sizeof bounds[0]; i++) {
        const uint32_t n = bench_size(set, bounds[i].size);
        snprintf(what, sizeof what, "reads a point, cold: %s, n = %u", bench_set_names[set], n);
        at_most(figure(set, bounds[i].size, BENCH_PIVOT, BENCH_READS), bounds[i].cold, what);
        snprintf(what, sizeof what, "reads a point, warm: %s, n = %u", bench_set_names[set], n);
        at_most(figure(set, bounds[i].size, BENCH_PIVOT_WARM, BENCH_READS), 1.05, what);
    }
}

/// By how much a figure / (n log n) grows over a hundredfold, or tenfold, to the last size that has
/// it.
static double beyond_n_log_n(int set, int method, enum bench_column column) {
    int last = BENCH_SIZES - 1;
    while (last > 0 && isnan(figure((enum bench_set)set, last, method, column))) {
        last--;
    }
    const int first = last > AT_10000 ? last - 2 : last - 1;
    if (first < 1) {
        return NAN;
    }
    const double to =
        bench_table[set][last][method].of[column] / log(bench_size((enum bench_set)set, last));
    const double from =
        bench_table[set][first][method].of[column] / log(bench_size((enum bench_set)set, first));
    return to / from;
}

void bench_print_reach(int sizes) {
    printf("What is to be reached (Q1.30 input, uniform cap of 20 degrees unless it says so)\n\n"
           "%-13s %10s %16s %s\n",
           "", "measured", "bound", "");
    reads(BENCH_CAP);
    reads(BENCH_NORMAL);
    const double instructions = figure(BENCH_CAP, AT_100000, BENCH_PIVOT, BENCH_INSTRUCTIONS);
    at_most(instructions, 21.0, "instructions a point, cold, n = 100,000");
    at_most(instructions / figure(BENCH_CAP, AT_100000, BENCH_BARE, BENCH_INSTRUCTIONS), 1.5,
            "the same, times the bare pass");
    at_least(figure(BENCH_CAP, AT_100000, BENCH_CGAL_SPHERE, BENCH_INSTRUCTIONS) / instructions,
             10.0, "times fewer instructions than CGAL's Min_sphere_of_spheres_d, n = 100,000");
    at_most(figure(BENCH_CAP, AT_10, BENCH_PIVOT, BENCH_INSTRUCTIONS) *
                bench_size(BENCH_CAP, AT_10),
            3000.0, "instructions in all, n = 10 (firmware/ is built without the FPU)");
    for (int size = AT_1000; size < sizes; size++) {
        char what[96];
        snprintf(what, sizeof what, "of the points read until infeasible: whole sphere, n = %u",
                 bench_size(BENCH_SPHERE, size));
        at_most(figure(BENCH_SPHERE, size, BENCH_PIVOT, BENCH_READS), 0.1, what);
    }
    at_most(figure(BENCH_CAP, AT_10000, BENCH_HULL, BENCH_NS), 40.0,
            "nanoseconds a point of the hull, prefilter and all, n = 10,000");
    at_most(beyond_n_log_n(BENCH_CIRCLE, BENCH_HULL, BENCH_INSTRUCTIONS), 1.25,
            "growth of the hull's instructions / (n log n), on a circle");
    at_most(beyond_n_log_n(BENCH_EXACT_CIRCLE, BENCH_HULL, BENCH_INSTRUCTIONS), 1.25,
            "growth of the hull's instructions / (n log n), exact circle");
    at_most(beyond_n_log_n(BENCH_CIRCLE, BENCH_B, BENCH_TESTS), 1.25,
            "growth of algorithm B's tests / (n log n), on a circle");
    at_most(beyond_n_log_n(BENCH_EXACT_CIRCLE, BENCH_B, BENCH_TESTS), 1.25,
            "growth of algorithm B's tests / (n log n), exact circle");
    at_least(bench_growth(BENCH_EXACT_CIRCLE, BENCH_C, BENCH_READS, 2), 1.9,
             "exponent of n in algorithm C's reads, exact circle: the paper's quadratic case");
    at_most(figure(BENCH_CAP, AT_1000, BENCH_PIVOT, BENCH_SCRATCH), 16384.0,
            "bytes of scratch, n = 1,000");
    printf("\n%d of %d reached\n", reached, measured);
}
