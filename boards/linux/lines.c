#include "lines.h"

#include <errno.h>
#include <string.h>

void lines_from_stream(struct lines *lines, FILE *stream, const char *name) {
    lines->stream = stream;
    lines->name = name;
    lines->number = 0;
    lines->begin = 0;
    lines->end = 0;
    lines->at_end = false;
    lines->opened = false;
}

bool lines_open(struct lines *lines, const char *path) {
    if (path == NULL || strcmp(path, "-") == 0) {
        lines_from_stream(lines, stdin, "stdin");
        return true;
    }
    FILE *const stream = fopen(path, "rb");
    if (stream == NULL) {
        message_at(path, 0, "%s", strerror(errno));
        return false;
    }
    lines_from_stream(lines, stream, path);
    lines->opened = true;
    return true;
}

void lines_close(struct lines *lines) {
    if (lines->opened) {
        fclose(lines->stream);
        lines->opened = false;
    }
}

/// Moves what is left to the front of the buffer and fills up behind it. False: read error, told.
static bool refill(struct lines *lines) {
    memmove(lines->buffer, lines->buffer + lines->begin, lines->end - lines->begin);
    lines->end -= lines->begin;
    lines->begin = 0;
    const size_t got =
        fread(lines->buffer + lines->end, 1, sizeof lines->buffer - lines->end, lines->stream);
    lines->end += got;
    if (got == 0U) {
        if (ferror(lines->stream)) {
            message_at(lines->name, 0, "%s", strerror(errno));
            return false;
        }
        lines->at_end = true;
    }
    return true;
}

enum lines_status lines_next(struct lines *lines, const char **text, size_t *size) {
    const char *newline;
    size_t searched = 0;
    for (;;) {
        const char *const from = lines->buffer + lines->begin;
        const size_t held = lines->end - lines->begin;
        newline = held > searched ? memchr(from + searched, '\n', held - searched) : NULL;
        searched = held;
        if (newline != NULL || lines->at_end || held > LINES_MOST + 2U) {
            break;
        }
        if (!refill(lines)) {
            return LINES_ERROR;
        }
    }
    const char *from = lines->buffer + lines->begin;
    size_t length = newline != NULL ? (size_t)(newline - from) : lines->end - lines->begin;
    if (newline == NULL && length == 0U) {
        return LINES_END;
    }
    lines->number++;
    lines->begin += length + (newline != NULL ? 1U : 0U);
    if (lines->number == 1U && length >= 3U && memcmp(from, "\xEF\xBB\xBF", 3) == 0) {
        from += 3;
        length -= 3U;
    }
    if (length != 0U && from[length - 1U] == '\r') {
        length--;
    }
    if (length > LINES_MOST) {
        message_at(lines->name, lines->number, "the line is longer than %d bytes", LINES_MOST);
        return LINES_ERROR;
    }
    if (memchr(from, '\0', length) != NULL) {
        message_at(lines->name, lines->number, "a NUL byte: this is no text file");
        return LINES_ERROR;
    }
    *text = from;
    *size = length;
    return LINES_OK;
}
