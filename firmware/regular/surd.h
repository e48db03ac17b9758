/// The sign of a sum of square roots with integer factors. For the files of regular/ only.
///
/// Whether the sum is 0 is decided exactly: roots whose radicands differ by more than a square
/// factor are linearly independent over the rationals (Besicovitch 1940), so it is 0 only if each
/// class is. Else the sign comes from roots to so many digits that it is certain. A sum that is not
/// 0 but below 2^-500, with terms up to 2^528, counts as 0; no input is known to make one.
#ifndef REGULAR_SURD_H
#define REGULAR_SURD_H

#include "fixed/huge.h"

#define SURD_TERMS_MAX 9U

/// sign * factor * root of radicand: factor^2 * radicand must be below 2^1080, factor * radicand of
/// another term, too. The radicand is not 0.
struct surd_term {
    int sign; ///< -1, 0 or 1
    struct huge factor, radicand;
};

struct surd {
    uint32_t count;
    struct surd_term term[SURD_TERMS_MAX];
};

/// Adds sign * factor * root of radicand; nothing if either factor is 0.
void surd_add(struct surd *surd, int sign, const struct huge *factor, const struct huge *radicand);

/// -1, 0 or 1.
/// Cost: a root of up to 1,100 bits for each term, by digits: some 50,000 instructions; a second
///       round where the sum is below 2^4.
int surd_sign(const struct surd *surd);

/// The sum times 2^shift: sign and size. The size is off by less than the number of terms. Roots
/// times 2^shift are below 2^1080.
int surd_value(const struct surd *surd, unsigned shift, struct huge *size);

#endif
