#include "bench/levine/sums.h"

#include <math.h>
#include <stdlib.h>

double sums_mean(const double *values, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum / count;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

void sums_sort(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, compare);
}

double sums_part(const double *sorted, uint32_t count, double part) {
    const double at = ceil(part * count - 1e-9);
    return sorted[at < 1 ? 0U : (uint32_t)at - 1U];
}

double sums_exponent(const double *x, const double *y, uint32_t count) {
    double n = count, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double u = log10(x[i]), v = log10(y[i]);
        if (count < 2U || !isfinite(u) || !isfinite(v)) {
            return NAN;
        }
        sx += u;
        sy += v;
        sxx += u * u;
        sxy += u * v;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}
