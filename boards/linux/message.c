#include "message.h"

#include "aside.h"
#include "utf8.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <string.h>

/// Of a path, with its line.
#define MESSAGE_FILE_BYTES 4200

static FILE *redirected;

static FILE *stream(void) {
    return redirected != NULL ? redirected : stderr;
}

void message_stream(FILE *new_stream) {
    redirected = new_stream;
}

// ---------------------------------------------------------------- lines

/// In the background, if messages go there.
static struct aside lines;
static bool has_aside;

static void write_line(void *context, const struct aside_line *line) {
    (void)context;
    fprintf(stream(), "%s\n", line->text);
}

void message_aside_begin(void) {
    has_aside = has_aside || aside_open(&lines, write_line, NULL);
}

void message_aside_end(void) {
    if (!has_aside) {
        return;
    }
    has_aside = false;
    const uint64_t dropped = aside_dropped(&lines);
    aside_close(&lines);
    if (dropped > 0U) {
        message_command(NULL, "%" PRIu64 " more lines are lost: nobody took them", dropped);
    }
}

static void print(const char *before, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));
static void print(const char *before, const char *format, va_list arguments) {
    if (!has_aside) {
        fflush(stdout);
        fputs(before, stream());
        vfprintf(stream(), format, arguments);
        fputc('\n', stream());
        return;
    }
    struct aside_line line = {.severe = false};
    const int size = snprintf(line.text, sizeof line.text, "%s", before);
    const size_t at = (size_t)size < sizeof line.text ? (size_t)size : sizeof line.text - 1U;
    vsnprintf(line.text + at, sizeof line.text - at, format, arguments);
    aside_push(&lines, &line);
}

void message_at(const char *file, unsigned long line, const char *format, ...) {
    char before[MESSAGE_FILE_BYTES];
    va_list arguments;
    if (line != 0U) {
        snprintf(before, sizeof before, "%s:%lu: ", file, line);
    } else {
        snprintf(before, sizeof before, "%s: ", file);
    }
    va_start(arguments, format);
    print(before, format, arguments);
    va_end(arguments);
}

void message_command(const char *command, const char *format, ...) {
    char before[64] = "boresight: ";
    va_list arguments;
    if (command != NULL) {
        snprintf(before, sizeof before, "boresight %s: ", command);
    }
    va_start(arguments, format);
    print(before, format, arguments);
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
