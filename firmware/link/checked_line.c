#include "link/checked_line.h"

/// `*`, four digits.
#define TAIL_BYTES 5U
/// Host, sequence, type.
#define HEAD_BYTES 5U

/// Bytewise without a table: x^16 + x^12 + x^5 + 1 is sparse enough for a few shifts.
uint16_t checked_line_crc(const char *text, uint32_t size_bytes) {
    uint32_t crc = 0xFFFF;
    for (uint32_t i = 0; i < size_bytes; i++) {
        uint32_t x = (crc >> 8 ^ (uint8_t)text[i]) & 0xFFU;
        x ^= x >> 4;
        crc = (crc << 8 ^ x << 12 ^ x << 5 ^ x) & 0xFFFFU;
    }
    return (uint16_t)crc;
}

static bool is_plain(const char *text, uint32_t size_bytes) {
    for (uint32_t i = 0; i < size_bytes; i++) {
        if (text[i] < ' ' || text[i] > '~' || text[i] == '$' || text[i] == '*') {
            return false;
        }
    }
    return true;
}

bool checked_line_read(const char *text, uint32_t size_bytes, struct checked_line *line) {
    uint32_t crc, host, sequence;
    if (size_bytes < HEAD_BYTES + TAIL_BYTES || size_bytes > CHECKED_LINE_BYTES_MAX - 2U) {
        return false;
    }
    const uint32_t covered = size_bytes - TAIL_BYTES;
    if (text[covered] != '*' || !word_hex((struct word){text + covered + 1, 4}, 4, &crc) ||
        crc != checked_line_crc(text, covered) || !is_plain(text, covered) ||
        !word_hex((struct word){text, 2}, 2, &host) ||
        !word_hex((struct word){text + 2, 2}, 2, &sequence)) {
        return false;
    }
    *line = (struct checked_line){.host = (uint8_t)host,
                                  .sequence = (uint8_t)sequence,
                                  .type = text[4],
                                  .body = {text + HEAD_BYTES, covered - HEAD_BYTES}};
    return true;
}

void checked_line_begin(struct text *text, uint8_t host, uint8_t sequence, char type) {
    text_character(text, '$');
    text_hex_digits(text, host, 2);
    text_hex_digits(text, sequence, 2);
    text_character(text, type);
}

bool checked_line_end(struct text *text) {
    const uint16_t crc = checked_line_crc(text->buffer + 1, text->size_bytes - 1U);
    text_character(text, '*');
    text_hex_digits(text, crc, 4);
    text_character(text, '\n');
    return !text->cut && text->size_bytes <= CHECKED_LINE_BYTES_MAX;
}
