#include "message.h"

#include "utf8.h"

#include <stdarg.h>
#include <stdbool.h>
#include <string.h>

static FILE *redirected;

static FILE *stream(void) {
    return redirected != NULL ? redirected : stderr;
}

void message_stream(FILE *new_stream) {
    redirected = new_stream;
}

static void print(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));
static void print(const char *format, va_list arguments) {
    vfprintf(stream(), format, arguments);
    fputc('\n', stream());
}

void message_at(const char *file, unsigned long line, const char *format, ...) {
    fflush(stdout);
    if (line != 0U) {
        fprintf(stream(), "%s:%lu: ", file, line);
    } else {
        fprintf(stream(), "%s: ", file);
    }
    va_list arguments;
    va_start(arguments, format);
    print(format, arguments);
    va_end(arguments);
}

void message_command(const char *command, const char *format, ...) {
    fflush(stdout);
    if (command != NULL) {
        fprintf(stream(), "boresight %s: ", command);
    } else {
        fprintf(stream(), "boresight: ");
    }
    va_list arguments;
    va_start(arguments, format);
    print(format, arguments);
    va_end(arguments);
}

/// Bytes of the character at the start of word; 0 if a terminal should not get it.
static size_t printable_length(const char *word, size_t size) {
    const unsigned char first = (unsigned char)word[0];
    const size_t length = utf8_length(word, size);
    const unsigned char second = length > 1U ? (unsigned char)word[1] : 0U;
    const bool control = first < 0x20U || first == 0x7FU || (first == 0xC2U && second < 0xA0U);
    return control ? 0 : length;
}

struct message_quote message_quoted(const char *word, size_t size) {
    struct message_quote quote;
    size_t at = 0, out = 0;
    quote.text[out++] = '\'';
    while (at < size) {
        const size_t length = printable_length(word + at, size - at);
        const size_t taken = length == 0U ? 1U : length;
        if (out + taken > MESSAGE_QUOTE_BYTES) {
            memcpy(quote.text + out, "...", 3);
            out += 3;
            break;
        }
        if (length == 0U) {
            quote.text[out] = '?';
        } else {
            memcpy(quote.text + out, word + at, length);
        }
        out += taken;
        at += taken;
    }
    quote.text[out++] = '\'';
    quote.text[out] = '\0';
    return quote;
}
