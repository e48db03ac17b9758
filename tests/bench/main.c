/// `make bench-cone` (cone.sh). Under callgrind only instructions are counted: `cone count SIZE
/// COUNTS PART PARTS`, each figure a dump of callgrind's. COUNTS holds those of smaller sizes,
/// which tell what is worth a run. Then, natively, all else is measured, and everything printed:
/// `cone table COUNTS SIZES SETS`. The benchmark fails if a method gives a wrong answer.
#include "bench/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_ZERO_STATS
#define CALLGRIND_TOGGLE_COLLECT
#define CALLGRIND_DUMP_STATS_AT(name) ((void)(name))
#endif

/// Sets of a size at most: timed (chosen by the caller, up to), and under callgrind.
#define TIMED_SETS   300U
#define COUNTED_SETS 30U
/// Of two answers to one question; a unit is 1.5 nrad.
#define ALIKE_BAM 4

uint32_t bench_sets = TIMED_SETS;

static struct vec3 points[BENCH_MOST_POINTS];

/// Different sets a size: at most so many, a million points in all, and as many as a method runs
/// through in its limit of instructions.
static uint32_t sets_of(int set, int size, int method, uint32_t most, double instructions_most) {
    const uint32_t n = bench_size((enum bench_set)set, size);
    const bool is_one = set == BENCH_SURFACE || set == BENCH_EXACT_CIRCLE;
    const double counted = bench_table[set][size][method].of[BENCH_INSTRUCTIONS] * n;
    const double each = counted > 0.0 ? counted : bench_expected(set, size, method);
    double sets = fmin(is_one ? 1U : most, BENCH_MOST_POINTS / n);
    sets = each > 0.0 ? fmin(sets, instructions_most / each) : sets;
    return sets < 1.0 ? 1U : (uint32_t)sets;
}

static void fill(int set, uint32_t n, uint32_t sets) {
    for (uint32_t t = 0; t < sets; t++) {
        bench_fill((enum bench_set)set, n, t, points + (size_t)t * n);
    }
}

// ---------------------------------------------------------------- instructions

static void count(int set, int size, int m) {
    const struct bench_method *const method = &bench_methods[m];
    const uint32_t n = bench_size((enum bench_set)set, size);
    const uint32_t sets = sets_of(set, size, m, COUNTED_SETS, BENCH_COUNT_MOST / 4.0);
    char name[64];
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    for (uint32_t t = 0; t < sets; t++) {
        const struct vec3 *const of_set = points + (size_t)t * n;
        struct bench_run run = {0};
        if (method->prepare != NULL) {
            method->prepare(of_set, n);
        }
        CALLGRIND_TOGGLE_COLLECT;
        method->run(of_set, n, &run);
        CALLGRIND_TOGGLE_COLLECT;
    }
    snprintf(name, sizeof name, "count %d %d %d %u", set, size, m, sets * n);
    CALLGRIND_DUMP_STATS_AT(name);
    CALLGRIND_STOP_INSTRUMENTATION;
}

static void count_all(int size, int part, int parts) {
    for (int set = part; set < BENCH_SETS; set += parts) {
        fill(set, bench_size((enum bench_set)set, size),
             sets_of(set, size, BENCH_BARE, COUNTED_SETS, INFINITY));
        for (int m = 0; m < BENCH_METHODS; m++) {
            if (bench_is_run(set, size, m) && bench_expected(set, size, m) <= BENCH_COUNT_MOST) {
                count(set, size, m);
            }
        }
    }
}

/// Lines "set size method points instructions".
static bool read_counts(const char *path) {
    FILE *const file = fopen(path, "r");
    int set, size, m;
    double of_points, instructions;
    for (set = 0; set < BENCH_SETS; set++) {
        for (size = 0; size < BENCH_SIZES; size++) {
            for (m = 0; m < BENCH_METHODS; m++) {
                for (int c = 0; c < BENCH_COLUMNS; c++) {
                    bench_table[set][size][m].of[c] = NAN;
                }
            }
        }
    }
    if (file == NULL) {
        return false;
    }
    while (fscanf(file, "%d %d %d %lf %lf", &set, &size, &m, &of_points, &instructions) == 5) {
        bench_table[set][size][m].of[BENCH_INSTRUCTIONS] = instructions / of_points;
    }
    fclose(file);
    return true;
}

// ---------------------------------------------------------------- how much wider

static double dot(const double a[3], struct vec3 b) {
    return a[0] * b.x + a[1] * b.y + a[2] * b.z;
}

static double largest_angle(const struct vec3 *set, uint32_t n, struct vec3 axis_q30) {
    const double axis[3] = {axis_q30.x, axis_q30.y, axis_q30.z}, length = sqrt(dot(axis, axis_q30));
    double least = 1.0;
    for (uint32_t i = 0; i < n; i++) {
        const double p[3] = {set[i].x, set[i].y, set[i].z};
        least = fmin(least, dot(axis, set[i]) / length / sqrt(dot(p, set[i])));
    }
    return acos(fmax(least, -1.0));
}

/// Than the narrowest cone, percent of its half-angle.
static double wider(const struct vec3 *set, uint32_t n, struct vec3 axis_q30) {
    struct bench_run best = {0};
    bench_methods[BENCH_PIVOT].prepare(set, n);
    bench_methods[BENCH_PIVOT].run(set, n, &best);
    return 100.0 * (largest_angle(set, n, axis_q30) / largest_angle(set, n, best.axis_q30) - 1.0);
}

/// A benchmark of wrong answers would be worth nothing.
static void check_answer(int set, uint32_t n, uint32_t t, int m, const struct bench_run *run) {
    static uint64_t of_pivot[TIMED_SETS];
    static uint32_t known; // sets of this size that pivot ran on
    if (m == BENCH_PIVOT) {
        of_pivot[t] = run->half_angle_bam32;
        known = t + 1U;
    }
    const int64_t off = (int64_t)run->half_angle_bam32 - (int64_t)of_pivot[t];
    const bool sees_none = set == BENCH_SPHERE && n >= 1000U; // of ten points one in eleven does
    if ((set != BENCH_SPHERE || sees_none) && run->infeasible != sees_none && m != BENCH_BARE &&
        m != BENCH_CGAL_SPHERE) {
        printf("FAIL %s, n = %u: %s is wrong on what is feasible\n", bench_set_names[set], n,
               bench_methods[m].name);
        exit(1);
    }
    if (run->half_angle_bam32 != 0U && t < known && llabs(off) > ALIKE_BAM) {
        printf("FAIL %s, n = %u: %s is off by %lld BAM\n", bench_set_names[set], n,
               bench_methods[m].name, (long long)off);
        exit(1);
    }
}

// ---------------------------------------------------------------- one method, set and size

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/// Adds to a mean that is NAN as long as there is no such figure.
static void add(double *mean, double figure, uint32_t sets) {
    *mean = (isnan(*mean) ? 0.0 : *mean) + figure / sets;
}

static void add_known(double *mean, double figure, uint32_t sets) {
    if (figure > 0.0) {
        add(mean, figure, sets);
    }
}

/// Runs a method over all sets; of several rounds the fastest counts.
static void measure(int set, int size, int m) {
    const struct bench_method *const method = &bench_methods[m];
    struct bench_figures *const f = &bench_table[set][size][m];
    const uint32_t n = bench_size((enum bench_set)set, size);
    const bool is_long = bench_expected(set, size, m) > BENCH_REPEATS_MOST;
    const int rounds = is_long ? 1 : n <= 10000U ? 10 : 3;
    const uint32_t sets = sets_of(set, size, m, bench_sets, BENCH_REPEATS_MOST / rounds);
    f->is_run = true;
    for (uint32_t t = 0; t < sets; t++) {
        const struct vec3 *const of_set = points + (size_t)t * n;
        struct bench_run run = {0};
        double fastest = INFINITY;
        if (method->prepare != NULL) {
            method->prepare(of_set, n);
        }
        for (int round = 0; round < rounds; round++) {
            run = (struct bench_run){0};
            const double start = now_ns();
            method->run(of_set, n, &run);
            fastest = fmin(fastest, now_ns() - start);
        }
        check_answer(set, n, t, m, &run);
        add(&f->of[BENCH_NS], fastest / n, sets);
        add_known(&f->of[BENCH_READS], (double)run.point_reads / n, sets);
        add_known(&f->of[BENCH_SCRATCH], (double)run.scratch_bytes, sets);
        add_known(&f->of[BENCH_ROUNDS], run.iterations, sets);
        add_known(&f->of[BENCH_FACES], run.faces, sets);
        add_known(&f->of[BENCH_TESTS], (double)run.tests / n, sets);
        if (run.support_count != 0U && set != BENCH_SPHERE) {
            add(&f->of[BENCH_BY_TWO], run.support_count == 2U ? 100.0 : 0.0, sets);
        }
        if (method->is_other_axis && set != BENCH_SPHERE) {
            const double percent = wider(of_set, n, run.axis_q30);
            add(&f->of[BENCH_WIDER], percent, sets);
            f->of[BENCH_WIDER_MOST] = fmax(f->of[BENCH_WIDER_MOST], percent);
        }
    }
}

// ---------------------------------------------------------------- the size of the hull

uint32_t bench_hull_sets(uint32_t n) {
    const uint32_t most = bench_sets < TIMED_SETS ? bench_sets : 1000U;
    return n <= 10000U ? most : n <= 100000U ? 100U : 30U;
}

/// More sets than are timed: a variance takes many.
static void measure_hulls(int set, int size) {
    double *const of = bench_table[set][size][BENCH_HULL].of;
    const uint32_t n = bench_size((enum bench_set)set, size);
    uint32_t sets = set == BENCH_SURFACE || set == BENCH_EXACT_CIRCLE ? 1U : bench_hull_sets(n);
    double sum = 0.0, squares = 0.0, logs = 0.0;
    for (uint32_t t = 0; t < sets; t++) {
        struct bench_run run = {0};
        bench_fill((enum bench_set)set, n, t, points);
        bench_methods[BENCH_HULL].run(points, n, &run);
        const double h = run.hull_size;
        sets = h > 0.9 * n && n > 1000U && sets > 10U ? 10U : sets; // it hardly varies
        sum += h;
        squares += h * h;
        logs += h * log(h);
    }
    of[BENCH_H] = sum / sets;
    of[BENCH_H_SQUARE] = squares / sets;
    of[BENCH_H_LOG] = logs / sets;
    of[BENCH_H_VARIANCE] = sets == 1U ? NAN : (squares - sum * sum / sets) / (sets - 1.0);
}

static void measure_all(int sizes) {
    for (int set = 0; set < BENCH_SETS; set++) {
        fprintf(stderr, "Measuring %s\n", bench_set_names[set]);
        for (int size = 0; size < sizes; size++) {
            const uint32_t n = bench_size((enum bench_set)set, size);
            fill(set, n, sets_of(set, size, BENCH_BARE, bench_sets, INFINITY));
            for (int m = 0; m < BENCH_METHODS; m++) {
                if (bench_is_run(set, size, m)) {
                    measure(set, size, m);
                }
            }
            if (set != BENCH_SPHERE) {
                measure_hulls(set, size);
            }
        }
    }
}

int main(int argc, char **argv) {
    if (argc == 6 && strcmp(argv[1], "count") == 0 && read_counts(argv[3])) {
        count_all(atoi(argv[2]), atoi(argv[4]), atoi(argv[5]));
        return 0;
    }
    if (argc != 5 || strcmp(argv[1], "table") != 0 || !read_counts(argv[2])) {
        fprintf(stderr, "usage: %s count SIZE COUNTS PART PARTS | table COUNTS SIZES SETS\n",
                argv[0]);
        return 2;
    }
    const int sizes = atoi(argv[3]);
    bench_sets = (uint32_t)atoi(argv[4]);
    if (sizes < 1 || sizes > BENCH_SIZES || bench_sets < 1U || bench_sets > TIMED_SETS) {
        return 2;
    }
    measure_all(sizes);
    bench_print_table(sizes);
    bench_print_equations(sizes);
    bench_print_reach(sizes);
    return 0;
}
