/// The sign of a sum of square roots of integers, exactly.
///
/// The unit vector along an integer vector v is v / sqrt(v.v). Any polynomial of the coordinates of
/// such unit vectors is, but for a positive factor, a sum of few square roots of integers with
/// signs. Its sign is found by squaring until no root is left, so the tests of sphere/site.h hold
/// for the directions themselves, not for rounded unit vectors.
#ifndef FIXED_ROOT_SUM_H
#define FIXED_ROOT_SUM_H

#include "fixed/huge.h"

/// sign * sqrt(square); sign is -1, 0 or 1, and 0 if and only if square is 0.
struct root_term {
    int sign;
    struct huge square;
};

/// A term factor * sqrt(radicand), with the sign of `sign`. sign * size is the factor.
void root_term_set(struct root_term *term, int sign, struct u128 size, struct u128 radicand);

/// Sign of the sum of two, three or four terms: -1, 0 or 1.
/// Ranges:    squares below 2^1088 (two), 2^514 (three), 2^256 (four).
/// Cost:      a comparison (two); up to 4 products (three), 7 (four) of the size of the squares
///            and their squares.
/// Source:    elementary; for four: P + Q with two roots each has the sign of the larger one,
///            and P^2 - Q^2 is a sum of three roots.
/// Shown:     tests/property/site_exact.c.
int root_sum_2(const struct root_term *a, const struct root_term *b);
int root_sum_3(const struct root_term *a, const struct root_term *b, const struct root_term *c);
int root_sum_4(const struct root_term *a, const struct root_term *b, const struct root_term *c,
               const struct root_term *d);

#endif
