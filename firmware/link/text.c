#include "link/text.h"

void text_begin(struct text *text, char *buffer, uint32_t capacity_bytes) {
    *text = (struct text){buffer, capacity_bytes, 0, false};
}

static void put(struct text *text, char character) {
    if (text->size_bytes == text->capacity_bytes) {
        text->cut = true;
    } else {
        text->buffer[text->size_bytes++] = character;
    }
}

void text_string(struct text *text, const char *string) {
    while (*string != '\0') {
        put(text, *string++);
    }
}

/// Digits from the last one; a point before the last two if wanted; sign and blanks in front.
static void put_number(struct text *text, uint32_t magnitude, bool negative, bool hundredths,
                       unsigned width) {
    char reversed[16];
    unsigned size = 0;
    do {
        if (hundredths && size == 2U) {
            reversed[size++] = '.';
        }
        reversed[size++] = (char)('0' + magnitude % 10U);
        magnitude /= 10U;
    } while (magnitude != 0U || (hundredths && size < 4U));
    if (negative) {
        reversed[size++] = '-';
    }
    for (unsigned i = size; i < width; i++) {
        put(text, ' ');
    }
    while (size != 0U) {
        put(text, reversed[--size]);
    }
}

void text_unsigned(struct text *text, uint32_t value, unsigned width) {
    put_number(text, value, false, false, width);
}

void text_hex(struct text *text, uint32_t value) {
    text_string(text, "0x");
    for (int shift = 28; shift >= 0; shift -= 4) {
        put(text, "0123456789abcdef"[value >> shift & 15U]);
    }
}

void text_hundredths(struct text *text, int64_t value, unsigned width) {
    const int64_t within = value > INT32_MAX ? INT32_MAX : value < -INT32_MAX ? -INT32_MAX : value;
    put_number(text, (uint32_t)(within < 0 ? -within : within), within < 0, true, width);
}
