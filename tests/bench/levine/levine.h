/// The tables of Levine 1975 again: each part prints the rows of its tables for docs/levine.md.
///
/// `@table NAME` begins the rows of a table, `@value NAME NUMBER` is a number that stands beside
/// one of the thesis'. tests/bench/levine/doc.awk puts both into the text. Everything is counted
/// from fixed seeds, and so the same on every machine, but for the tables whose names end in
/// `-time`.
#ifndef BENCH_LEVINE_H
#define BENCH_LEVINE_H

#include <stdbool.h>
#include <stdint.h>

/// few: only those rows that `make check` compares; they are the same as in a full run.
void levine_hull(bool few);       ///< appendix I
void levine_sphere(bool few);     ///< appendix II
void levine_trials(bool few);     ///< the same without the order, and with other limits
void levine_dimensions(bool few); ///< chapter VIII asks for it
void levine_hidden(bool few);     ///< appendix III
void levine_sweep(bool few);      ///< the same for each degree
void levine_large(bool few);      ///< hidden lines up to 4,096 cubes
void levine_retrieval(bool few);  ///< chapter II: octree, box tree and sphere tree

#define LEVINE_CASES      500U
#define LEVINE_STEPS_MOST 8U
#define LEVINE_STEPS_FEW  2U ///< with `few`: 25 and 50 points
#define LEVINE_COUNT_MOST 3200U

static inline uint32_t levine_count(uint32_t step) {
    return UINT32_C(25) << step;
}

void levine_table(const char *name);
void levine_value(const char *name, double value);

/// ` 1.23`, with about three digits; ` -` for what is not finite.
void levine_number(double value);
/// The same and ` |`.
void levine_cell(double value);

/// A cell with how many values fall in each of a row of bins: the first bin's start, the bins'
/// width (1, 2 or 5 times a power of ten, so that there are 20 bins at most), and the counts.
void levine_bins(const double *values, uint32_t count);

/// The processor time of this program in seconds.
double levine_seconds(void);

#endif
