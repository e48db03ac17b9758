/// Unsigned integers of up to BIG_BITS bits: for decimals whose digits are too far apart for 128
/// bits.
///
/// Only the rare line of a points file comes here, so the plain methods will do.
/// Shown: tests/cli/decimals.c.
#ifndef LINUX_BIG_H
#define LINUX_BIG_H

#include <stdint.h>

/// Enough for the 1,502 digits that a difference of two decimals can span (decimal.h): 4,990 bits,
/// and a word for carries.
enum { BIG_WORDS = 80, BIG_BITS = BIG_WORDS * 64 };

/// word[0] is the least significant; the words from count on are not part of the number, and
/// word[count - 1] is not 0. count = 0: zero.
struct big {
    uint32_t count;
    uint64_t word[BIG_WORDS];
};

void big_set(struct big *a, uint64_t value);
/// a = a * factor + term. Asserts that the result fits, as every function here does.
void big_multiply_add(struct big *a, uint64_t factor, uint64_t term);
/// a = a * 10^exponent.
void big_multiply_power10(struct big *a, uint32_t exponent);
/// -1, 0 or 1.
int big_compare(const struct big *a, const struct big *b);
void big_add(struct big *a, const struct big *b);
/// a = a - b; a must not be less than b.
void big_subtract(struct big *a, const struct big *b);
uint32_t big_bit_length(const struct big *a);
/// Index of the lowest bit that is set; a must not be 0.
uint32_t big_trailing_zeros(const struct big *a);
void big_shift_right(struct big *a, uint32_t shift);
/// a / 2^shift rounded to nearest, halves up. The result must fit.
uint64_t big_round_shift(const struct big *a, uint32_t shift);
/// a = greatest common divisor of a and b; gcd(a, 0) = a. b is overwritten.
/// Cost: O(bits^2 / 64).
void big_gcd(struct big *a, struct big *b);
/// a = a / divisor for a divisor that divides a. Cost: O(bits^2 / 64).
void big_divide_exact(struct big *a, const struct big *divisor);

#endif
