/// Text into a buffer of fixed size, without a libc. What no longer fits is left out.
#ifndef LINK_TEXT_H
#define LINK_TEXT_H

#include <stdbool.h>
#include <stdint.h>

struct text {
    char *buffer;
    uint32_t capacity_bytes;
    uint32_t size_bytes; ///< so far; no terminator
    bool cut;            ///< something did not fit
};

void text_begin(struct text *text, char *buffer, uint32_t capacity_bytes);

void text_character(struct text *text, char character);
void text_string(struct text *text, const char *string);
/// Characters that need no terminator.
void text_characters(struct text *text, const char *characters, uint32_t count);
/// At least width characters, blanks in front.
void text_unsigned(struct text *text, uint32_t value, unsigned width);
/// "0x" and eight digits.
void text_hex(struct text *text, uint32_t value);
/// 1234 as "12.34"; at least width characters, blanks in front. Beyond +-2^31 the nearest that fits
/// 32 bits.
void text_hundredths(struct text *text, int64_t value, unsigned width);
/// The last `digits` hexadecimal digits, lower case.
void text_hex_digits(struct text *text, uint32_t value, unsigned digits);
/// value / 10^digits without needless zeros: -1500 with 3 digits is "-1.5", 2000 is "2". digits: at
/// most 9. Any value.
void text_decimal(struct text *text, int64_t value, unsigned digits);

#endif
