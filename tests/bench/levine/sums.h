/// Averages, percentiles and exponents of growth.
#ifndef BENCH_LEVINE_SUMS_H
#define BENCH_LEVINE_SUMS_H

#include <stdint.h>

double sums_mean(const double *values, uint32_t count);

/// The largest of the smallest part of the values, as the thesis has its 50 % and so on. The values
/// must be sorted: sums_sort.
double sums_part(const double *sorted, uint32_t count, double part);
void sums_sort(double *values, uint32_t count);

/// The slope of the straight line through log10 y over log10 x, by least squares. NAN unless there
/// are two values or more, all above 0.
double sums_exponent(const double *x, const double *y, uint32_t count);

#endif
