/// Reading the words of a line: names and numbers, exactly, without a libc.
///
/// Shown: tests/unit/test_words.c.
#ifndef LINK_WORDS_H
#define LINK_WORDS_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

/// A part of a text; no terminator.
struct word {
    const char *text;
    uint32_t size_bytes;
};

struct words {
    const char *at, *end; ///< what is left
};

struct words words_of(const char *text, uint32_t size_bytes);

/// The next word; words are apart by blanks. False: none is left, *word is empty.
bool words_next(struct words *words, struct word *word) MUST_CHECK;

/// Is there no word left?
bool words_at_end(const struct words *words);

bool word_is(struct word word, const char *wanted);

/// Decimal digits only, 0 to most. False: anything else; *value is 0.
bool word_unsigned(struct word word, uint32_t most, uint32_t *value) MUST_CHECK;

/// A decimal number with a point or without, as an integer in units of 10^-digits: "-1.5" with 3
/// digits is -1500. No exponent. False: no number, more places than digits, or beyond +-most;
/// *value is 0. digits: at most 9; most: at most 10^17.
bool word_decimal(struct word word, unsigned digits, int64_t most, int64_t *value) MUST_CHECK;

/// Exactly so many hexadecimal digits in lower case, 1 to 8. False: anything else; *value is 0.
bool word_hex(struct word word, unsigned digits, uint32_t *value) MUST_CHECK;

#endif
