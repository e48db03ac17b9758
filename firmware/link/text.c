#include "link/text.h"

void text_begin(struct text *text, char *buffer, uint32_t capacity_bytes) {
    *text = (struct text){buffer, capacity_bytes, 0, false};
}

void text_character(struct text *text, char character) {
    if (text->size_bytes == text->capacity_bytes) {
        text->cut = true;
    } else {
        text->buffer[text->size_bytes++] = character;
    }
}

void text_string(struct text *text, const char *string) {
    while (*string != '\0') {
        text_character(text, *string++);
    }
}

void text_characters(struct text *text, const char *characters, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        text_character(text, characters[i]);
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
        text_character(text, ' ');
    }
    while (size != 0U) {
        text_character(text, reversed[--size]);
    }
}

void text_unsigned(struct text *text, uint32_t value, unsigned width) {
    put_number(text, value, false, false, width);
}

void text_hex(struct text *text, uint32_t value) {
    text_string(text, "0x");
    text_hex_digits(text, value, 8);
}

void text_hundredths(struct text *text, int64_t value, unsigned width) {
    const int64_t within = value > INT32_MAX ? INT32_MAX : value < -INT32_MAX ? -INT32_MAX : value;
    put_number(text, (uint32_t)(within < 0 ? -within : within), within < 0, true, width);
}

void text_hex_digits(struct text *text, uint32_t value, unsigned digits) {
    for (unsigned left = digits; left != 0U; left--) {
        text_character(text, "0123456789abcdef"[value >> (4U * (left - 1U)) & 15U]);
    }
}

void text_decimal(struct text *text, int64_t value, unsigned digits) {
    uint64_t rest = value < 0 ? 0U - (uint64_t)value : (uint64_t)value;
    char reversed[24];
    unsigned size = 0;
    for (unsigned place = 0; place < digits || rest != 0U || place == digits; place++) {
        const char digit = (char)('0' + rest % 10U);
        rest /= 10U;
        if (place == digits && size != 0U) {
            reversed[size++] = '.';
        }
        if (place >= digits || size != 0U || digit != '0') {
            reversed[size++] = digit;
        }
    }
    if (value < 0) {
        text_character(text, '-');
    }
    while (size != 0U) {
        text_character(text, reversed[--size]);
    }
}
