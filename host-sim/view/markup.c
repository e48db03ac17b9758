#include "view/markup.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

size_t markup_character_bytes(const char *characters) {
    const unsigned char *text = (const unsigned char *)characters;
    static const unsigned char lead_min[] = {0xC2, 0xE0, 0xF0};
    static const unsigned char lead_max[] = {0xDF, 0xEF, 0xF4};
    if (text[0] < 0x80) {
        return text[0] != 0;
    }
    for (size_t more = 1; more <= 3; more++) {
        if (text[0] < lead_min[more - 1] || text[0] > lead_max[more - 1]) {
            continue;
        }
        for (size_t i = 1; i <= more; i++) {
            if ((text[i] & 0xC0) != 0x80) {
                return 0;
            }
        }
        // Overlong forms, surrogates and what lies beyond U+10FFFF show in the second byte.
        bool bad = (text[0] == 0xE0 && text[1] < 0xA0) || (text[0] == 0xED && text[1] > 0x9F) ||
                   (text[0] == 0xF0 && text[1] < 0x90) || (text[0] == 0xF4 && text[1] > 0x8F);
        // U+FFFE and U+FFFF are no characters of XML.
        bad = bad || (text[0] == 0xEF && text[1] == 0xBF && text[2] >= 0xBE);
        return bad ? 0 : more + 1;
    }
    return 0;
}

void markup_text(FILE *out, const char *text) {
    for (const char *at = text; *at != '\0';) {
        size_t bytes = markup_character_bytes(at);
        switch (*at) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        case '\'':
            fputs("&#39;", out);
            break;
        default:
            if (bytes == 0) {
                fputs("\uFFFD", out);
            } else if ((unsigned char)*at < 0x20 || *at == 0x7F) {
                fputc(' ', out);
            } else {
                fwrite(at, 1, bytes, out);
            }
        }
        at += bytes == 0 ? 1 : bytes;
    }
}

size_t markup_length(const char *text) {
    size_t length = 0;
    for (const char *at = text; *at != '\0';) {
        size_t bytes = markup_character_bytes(at);
        at += bytes == 0 ? 1 : bytes;
        length++;
    }
    return length;
}

void markup_copy(char *field, size_t capacity, const char *text) {
    size_t kept = 0;
    while (text[kept] != '\0') {
        size_t bytes = markup_character_bytes(text + kept);
        bytes = bytes == 0 ? 1 : bytes;
        if (kept + bytes >= capacity) {
            break;
        }
        kept += bytes;
    }
    memcpy(field, text, kept);
    field[kept] = '\0';
}

void markup_number(FILE *out, double value, int decimals) {
    if (!isfinite(value)) {
        fputs("\u2013", out);
        return;
    }
    char digits[340];
    snprintf(digits, sizeof digits, "%.*f", decimals, fabs(value));
    if (value < 0 && strspn(digits, "0.") != strlen(digits)) {
        fputs("\u2212", out);
    }
    fputs(digits, out);
}

void markup_px(FILE *out, double px) {
    if (!isfinite(px)) {
        px = 0;
    }
    long tenths = lround(fmin(fmax(px, -1e6), 1e6) * 10);
    if (tenths < 0) {
        fputc('-', out);
        tenths = -tenths;
    }
    fprintf(out, "%ld", tenths / 10);
    if (tenths % 10 != 0) {
        fprintf(out, ".%ld", tenths % 10);
    }
}
