#include "link/words.h"

struct words words_of(const char *text, uint32_t size_bytes) {
    return (struct words){text, text + size_bytes};
}

static void skip_blanks(struct words *words) {
    while (words->at != words->end && *words->at == ' ') {
        words->at++;
    }
}

bool words_next(struct words *words, struct word *word) {
    skip_blanks(words);
    *word = (struct word){words->at, 0};
    while (words->at != words->end && *words->at != ' ') {
        words->at++;
        word->size_bytes++;
    }
    return word->size_bytes != 0U;
}

bool words_at_end(const struct words *words) {
    struct words rest = *words;
    skip_blanks(&rest);
    return rest.at == rest.end;
}

bool word_is(struct word word, const char *wanted) {
    uint32_t i = 0;
    while (i < word.size_bytes && wanted[i] != '\0' && word.text[i] == wanted[i]) {
        i++;
    }
    return i == word.size_bytes && wanted[i] == '\0';
}

static bool is_digit(char character) {
    return character >= '0' && character <= '9';
}

bool word_unsigned(struct word word, uint32_t most, uint32_t *value) {
    int64_t number;
    *value = 0;
    if (word.size_bytes == 0U || !is_digit(word.text[0]) || !word_decimal(word, 0, most, &number) ||
        !is_digit(word.text[word.size_bytes - 1U])) {
        return false;
    }
    *value = (uint32_t)number;
    return true;
}

/// The digits of a number without its sign, padded with zeros to `digits` places. Negative: wrong.
static int64_t read_magnitude(struct word word, uint32_t first, unsigned digits, int64_t most) {
    int64_t magnitude = 0;
    unsigned places = 0, seen = 0;
    bool point = false;
    for (uint32_t i = first; i < word.size_bytes; i++) {
        if (word.text[i] == '.' && !point) {
            point = true;
            continue;
        }
        places += point;
        seen++;
        if (!is_digit(word.text[i]) || places > digits) {
            return -1;
        }
        magnitude = magnitude * 10 + (word.text[i] - '0');
        if (magnitude > most) {
            return -1;
        }
    }
    for (; places < digits; places++) {
        magnitude *= 10;
        if (magnitude > most) {
            return -1;
        }
    }
    return seen != 0U ? magnitude : -1;
}

bool word_decimal(struct word word, unsigned digits, int64_t most, int64_t *value) {
    const bool negative = word.size_bytes != 0U && word.text[0] == '-';
    const bool has_sign = negative || (word.size_bytes != 0U && word.text[0] == '+');
    const int64_t magnitude = read_magnitude(word, has_sign, digits, most);
    *value = magnitude < 0 ? 0 : negative ? -magnitude : magnitude;
    return magnitude >= 0;
}

bool word_hex(struct word word, unsigned digits, uint32_t *value) {
    uint32_t read = 0;
    *value = 0;
    if (word.size_bytes != digits) {
        return false;
    }
    for (uint32_t i = 0; i < digits; i++) {
        const char c = word.text[i];
        if (!is_digit(c) && (c < 'a' || c > 'f')) {
            return false;
        }
        read = read << 4 | (uint32_t)(is_digit(c) ? c - '0' : c - 'a' + 10);
    }
    *value = read;
    return true;
}
