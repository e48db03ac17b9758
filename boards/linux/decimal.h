/// Decimal numbers exactly as written: no binary fraction comes near them.
///
/// Grammar: [+-] digits [. digits] [(e|E) [+-] digits], with a digit on at least one side of the
/// point. No hexadecimal, no `nan`, no `inf`, no blanks or digit separators.
/// Shown: tests/cli/decimals.c.
#ifndef LINUX_DECIMAL_H
#define LINUX_DECIMAL_H

#include "big.h"
#include "u128.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Every digit that is not zero stands between 10^DECIMAL_HIGHEST and 10^DECIMAL_LOWEST. Each
/// double that is written out exactly fits (767 digits, the last at 10^-1074).
enum { DECIMAL_HIGHEST = 400, DECIMAL_LOWEST = -1100 };
/// The longest coefficient that is kept in an integer; longer ones stay text.
enum { DECIMAL_HEAD_DIGITS = 37 };

/// (negative ? -1 : 1) * digits * 10^exponent; the digits have no zeros at either end.
struct decimal {
    bool negative;
    uint32_t digit_count; ///< 0: the number is zero
    int32_t exponent;     ///< power of ten of the last digit; 0 for zero
    struct u128 head;     ///< the first DECIMAL_HEAD_DIGITS digits at most, as an integer
    const char *first;    ///< the first digit in the text, which must outlive this
};

enum decimal_status { DECIMAL_OK = 0, DECIMAL_ERROR_SYNTAX = -1, DECIMAL_ERROR_RANGE = -2 };

/// Reads the whole of text[0..size).
enum decimal_status decimal_read(const char *text, size_t size, struct decimal *out);

/// -1, 0 or 1.
int decimal_sign(const struct decimal *a);

/// Compares the values: -1, 0 or 1.
int decimal_compare(const struct decimal *a, const struct decimal *b);

/// |a| * 10^shift as an integer; a's last digit must not stand below 10^-shift.
void decimal_magnitude(const struct decimal *a, int32_t shift, struct big *out);

/// a * numerator / denominator, rounded to nearest, half away from zero.
/// Returns: whether the result fits int64. numerator and denominator: above 0.
bool decimal_scale(const struct decimal *a, uint64_t numerator, uint64_t denominator, int64_t *out);

/// a in units of 10^-places; digits below are cut off.
/// Returns: whether |a| is below 10^(DECIMAL_HEAD_DIGITS - places). places: 0 to 36.
bool decimal_fixed(const struct decimal *a, int32_t places, struct i128 *out);

/// a as an integer; digits after the point are cut off. Returns: whether it is within int64.
bool decimal_whole(const struct decimal *a, int64_t *out);

/// The value as a floating-point number; infinite beyond its range.
long double decimal_value(const struct decimal *a);

/// 10^exponent; exponent: 0 to 38.
struct u128 decimal_power10(uint32_t exponent);

#endif
