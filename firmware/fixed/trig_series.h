/// The series behind sine and cosine, for trig.c and trig_fine.c: Taylor's, for angles t in units
/// of 1/8 turn (pi/4), 0 <= t <= 1.
#ifndef FIXED_TRIG_SERIES_H
#define FIXED_TRIG_SERIES_H

#include "fixed/wide.h"

#include <stdint.h>

#define TRIG_TERMS 10U

/// (pi/4)^n / n! in Q63, for n = 1, 3, ... 19 and n = 0, 2, ... 18.
extern const uint64_t trig_sin_terms[TRIG_TERMS], trig_cos_terms[TRIG_TERMS];

/// Product of two Q63 fractions in [0, 1], rounded down. Cost: one product of 64 x 64 bits.
static inline uint64_t trig_mul_q63(uint64_t a, uint64_t b) {
    return u64_mul_high(a, b) << 1;
}

/// terms[0] - t2 (terms[1] - t2 (terms[2] - ...)): an alternating series, each bracket positive.
/// Cost:     count - 1 products.
/// Accuracy: the first term left out, and 2^-60 of rounding.
uint64_t trig_series(const uint64_t *terms, unsigned count, uint64_t t2);

#endif
