/// The table of `make bench-cone`: a line for each set, size and method.
#ifndef BENCH_TABLE_H
#define BENCH_TABLE_H

#include "bench/methods.h"
#include "bench/sets.h"

#include <stdbool.h>

#define BENCH_SIZES 6

/// A method of worse than linear growth stops before the size at which one run would take more
/// instructions than this (about three seconds), as its cost has grown so far; and is timed, but no
/// longer counted under callgrind, beyond the second figure. For the third there are several sets
/// and rounds.
#define BENCH_RUN_MOST     1e10
#define BENCH_COUNT_MOST   4e8
#define BENCH_REPEATS_MOST 1e9

/// Means over the sets of one size; NAN: no such figure.
enum bench_column {
    BENCH_READS,        ///< a point
    BENCH_INSTRUCTIONS, ///< a point
    BENCH_NS,           ///< a point
    BENCH_SCRATCH,      ///< bytes
    BENCH_ROUNDS,
    BENCH_FACES,
    BENCH_TESTS, ///< a point
    BENCH_H,
    BENCH_H_VARIANCE,
    BENCH_H_SQUARE,
    BENCH_H_LOG,
    BENCH_BY_TWO,     ///< percent
    BENCH_WIDER,      ///< percent beyond the narrowest cone
    BENCH_WIDER_MOST, ///< the worst of the sets
    BENCH_COLUMNS
};

struct bench_figures {
    bool is_run;
    double of[BENCH_COLUMNS];
};

extern struct bench_figures bench_table[BENCH_SETS][BENCH_SIZES][BENCH_METHODS];

uint32_t bench_size(enum bench_set set, int size);

/// Instructions of one run, from the counts of smaller sizes; 0: unknown, nothing was counted yet.
double bench_expected(int set, int size, int method);
/// Is a run of this size worth it?
bool bench_is_run(int set, int size, int method);

/// Exponent of n in a figure of the whole set: least squares over the last sizes that have it, at
/// most so many; NAN if there are fewer than two.
double bench_growth(int set, int method, enum bench_column column, int sizes);

/// On how many sets of n points the hull's size is measured.
uint32_t bench_hull_sets(uint32_t n);
/// Sets of a size at most, for all else.
extern uint32_t bench_sets;

/// sizes: how many were run.
void bench_print_table(int sizes);
/// reach.c: equations 12 to 17 of 1985 on the hull's size, and what is to be reached.
void bench_print_equations(int sizes);
void bench_print_reach(int sizes);

#endif
