#include "bench/table.h"

#include <math.h>
#include <stdio.h>

struct bench_figures bench_table[BENCH_SETS][BENCH_SIZES][BENCH_METHODS];

uint32_t bench_size(enum bench_set set, int size) {
    const uint32_t squares[BENCH_SIZES] = {16, 100, 1600, 10000, 99856, 1000000};
    const uint32_t tens[BENCH_SIZES] = {10, 100, 1000, 10000, 100000, 1000000};
    return set == BENCH_SURFACE ? squares[size] : tens[size];
}

// ---------------------------------------------------------------- what is worth a run

double bench_expected(int set, int size, int method) {
    double before = 0.0, total = 0.0, exponent = 1.0, tenfold = 1.0;
    for (int s = 0;; s++) {
        const double n = bench_size((enum bench_set)set, s);
        if (before > 0.0 && total > before) {
            exponent = fmax(1.0, log(total / before) / log(tenfold));
        }
        tenfold = s == 0 ? 1.0 : n / bench_size((enum bench_set)set, s - 1);
        const double expected = total * pow(tenfold, exponent);
        if (s == size) {
            return expected;
        }
        const double counted = bench_table[set][s][method].of[BENCH_INSTRUCTIONS] * n;
        before = total;
        total = counted > 0.0 ? counted : expected;
    }
}

bool bench_is_run(int set, int size, int method) {
    return bench_methods[method].run != NULL &&
           !(bench_methods[method].needs_feasible && set == BENCH_SPHERE) &&
           bench_expected(set, size, method) <= BENCH_RUN_MOST;
}

// ---------------------------------------------------------------- growth

static bool is_a_point(enum bench_column column) {
    return column == BENCH_READS || column == BENCH_INSTRUCTIONS || column == BENCH_NS ||
           column == BENCH_TESTS;
}

double bench_growth(int set, int method, enum bench_column column, int sizes) {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    int found = 0;
    for (int size = BENCH_SIZES - 1; size >= 0 && found < sizes; size--) {
        const double figure = bench_table[set][size][method].of[column];
        if (figure > 0.0) {
            const double n = bench_size((enum bench_set)set, size);
            const double x = log(n), y = log(is_a_point(column) ? figure * n : figure);
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
            found++;
        }
    }
    return found < 2 ? NAN : (found * sxy - sx * sy) / (found * sxx - sx * sx);
}

// ---------------------------------------------------------------- print

static void print_figure(double value, int digits, int width) {
    if (isnan(value)) {
        printf(" %*s", width, "-");
    } else {
        value = fabs(value) < 5e-4 ? 0.0 : value; // no minus before what is rounded away
        const double size = fabs(value);
        printf(" %*.*f", width,
               digits < 0 ? (size < 10.0     ? 3
                             : size < 1000.0 ? 1
                                             : 0)
                          : digits,
               value);
    }
}

static void print_line(const double *of, const double *bare) {
    print_figure(of[BENCH_READS], -1, 8);
    print_figure(of[BENCH_INSTRUCTIONS], -1, 9);
    print_figure(bare == NULL ? NAN : of[BENCH_INSTRUCTIONS] / bare[BENCH_INSTRUCTIONS], 2, 9);
    print_figure(of[BENCH_NS], -1, 9);
    print_figure(bare == NULL ? NAN : of[BENCH_NS] / bare[BENCH_NS], 2, 9);
    print_figure(of[BENCH_SCRATCH], bare == NULL ? -1 : 0, 10);
    printf(" |");
    print_figure(of[BENCH_ROUNDS], -1, 7);
    print_figure(of[BENCH_FACES], -1, 7);
    print_figure(of[BENCH_TESTS], -1, 7);
    print_figure(of[BENCH_BY_TWO], bare == NULL ? -1 : 0, 5);
    printf(" |");
    print_figure(of[BENCH_WIDER], -1, 6);
    print_figure(of[BENCH_WIDER_MOST], -1, 6);
    printf(" |");
    print_figure(of[BENCH_H], -1, 8);
    print_figure(of[BENCH_H_VARIANCE], -1, 8);
    print_figure(of[BENCH_H_SQUARE], -1, 12);
    print_figure(of[BENCH_H_LOG], -1, 10);
    printf("\n");
}

static void print_growth(int set) {
    for (int m = 0; m < BENCH_METHODS; m++) {
        double growth[BENCH_COLUMNS];
        for (enum bench_column c = 0; c < BENCH_COLUMNS; c++) {
            const bool grows = c != BENCH_BY_TWO && c != BENCH_WIDER && c != BENCH_WIDER_MOST;
            growth[c] = grows ? bench_growth(set, m, c, 3) : NAN;
        }
        if (!isnan(growth[BENCH_NS])) {
            printf("%-17s %8s %-15s|", bench_set_names[set], "growth", bench_methods[m].name);
            print_line(growth, NULL);
        }
    }
}

void bench_print_table(int sizes) {
    printf(
        "reads, instr(uctions, x86-64, -O2), ns, tests: a point. /bare: beside one pass of dot "
        "products over the same points.\n"
        "scratch: bytes. rounds: of a loop whose every round reads all that is left. faces: most "
        "that the pyramid had.\n"
        "tests: of a point and a face (pyramid), a site and a circle (A, B), two angles (hulls).\n"
        "two: sets decided by two points, percent. wider, most: how much wider a cone than the "
        "narrowest, mean and worst, percent.\n"
        "h: extreme directions. '-': no such figure. Lines \"growth\": exponents of n, of "
        "the whole set, over the three largest sizes that have a figure.\n"
        "Methods stop before the size at which a run would take more than %.0e instructions, as "
        "their cost grows; beyond %.0e they are timed, not counted.\n\n"
        "%-17s %8s %-15s|%9s%10s%10s%10s%10s%11s |%8s%8s%8s%6s |%7s%7s |%9s%9s%13s%11s\n",
        BENCH_RUN_MOST, BENCH_COUNT_MOST, "set", "n", "method", "reads", "instr", "/bare", "ns",
        "/bare", "scratch", "rounds", "faces", "tests", "two", "wider", "most", "E[h]", "Var(h)",
        "E[h^2]", "E[h log h]");
    for (int set = 0; set < BENCH_SETS; set++) {
        for (int size = 0; size < sizes; size++) {
            for (int m = 0; m < BENCH_METHODS; m++) {
                const struct bench_figures *const f = &bench_table[set][size][m];
                if (f->is_run) {
                    printf("%-17s %8u %-15s|", bench_set_names[set],
                           bench_size((enum bench_set)set, size), bench_methods[m].name);
                    print_line(f->of, bench_table[set][size][BENCH_BARE].of);
                } else if (size > 0 && bench_table[set][size - 1][m].is_run) {
                    printf("%-17s %8u %-15s| stops: about %.0e instructions\n",
                           bench_set_names[set], bench_size((enum bench_set)set, size),
                           bench_methods[m].name, bench_expected(set, size, m));
                }
            }
            printf("\n");
        }
        print_growth(set);
        printf("\n");
    }
}
