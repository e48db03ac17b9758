#include "points.h"

#include "lines.h"
#include "places.h"

#include <stdlib.h>
#include <string.h>

/// Where a line stands, for messages, and what is wrong with it.
struct place {
    const char *file;
    unsigned long line;
};

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

bool points_next_word(const char **at, const char *end, struct points_word *out) {
    while (*at < end && (**at == ' ' || **at == '\t')) {
        (*at)++;
    }
    out->text = *at;
    while (*at < end && **at != ' ' && **at != '\t') {
        (*at)++;
    }
    out->size = (size_t)(*at - out->text);
    return out->size != 0U;
}

bool points_word_is(struct points_word word, const char *text) {
    return word.size == strlen(text) && memcmp(word.text, text, word.size) == 0;
}

int points_split(const char *at, const char *end, struct points_word columns[POINTS_COLUMNS_MOST]) {
    int count = 0;
    bool after_comma = false;
    for (;;) {
        while (at < end && is_blank(*at)) {
            at++;
        }
        if (at == end) {
            return after_comma ? -1 : count;
        }
        if (*at == ',') {
            if (after_comma || count == 0) {
                return -1;
            }
            after_comma = true;
            at++;
            continue;
        }
        const char *const start = at;
        while (at < end && *at != ',' && !is_blank(*at)) {
            at++;
        }
        if (count < POINTS_COLUMNS_MOST) {
            columns[count] = (struct points_word){start, (size_t)(at - start)};
        }
        count++;
        after_comma = false;
    }
}

static bool read_decimal(struct place place, struct points_word column, struct decimal *out) {
    switch (decimal_read(column.text, column.size, out)) {
    case DECIMAL_OK:
        return true;
    case DECIMAL_ERROR_SYNTAX:
        message_at(place.file, place.line, "%s is not a decimal number",
                   message_quoted(column.text, column.size).text);
        return false;
    default:
        message_at(place.file, place.line, "%s has digits above 10^%d or below 10^%d",
                   message_quoted(column.text, column.size).text, DECIMAL_HIGHEST, DECIMAL_LOWEST);
        return false;
    }
}

static bool read_xyz(struct place place, const struct points_word *columns,
                     const struct points_format *format, struct direction *out) {
    struct decimal point[3];
    for (int i = 0; i < 3; i++) {
        if (!read_decimal(place, columns[i], &point[i])) {
            return false;
        }
        if (format->bounds != NULL &&
            !bounds_add(format->bounds, i, columns[i].text, columns[i].size, &point[i])) {
            message_at(place.file, place.line, "no memory");
            return false;
        }
    }
    if (!direction_from_decimals(point, format->viewpoint, out)) {
        message_at(place.file, place.line, "the point is at the viewpoint: it has no direction");
        return false;
    }
    return true;
}

static bool read_int32(struct place place, struct points_word column, int32_t *out) {
    size_t at = 0;
    const bool negative = column.text[0] == '-';
    if (negative || column.text[0] == '+') {
        at++;
    }
    int64_t value = 0;
    bool good = at < column.size;
    for (; at < column.size && good; at++) {
        good = column.text[at] >= '0' && column.text[at] <= '9';
        if (value <= INT32_MAX) { // more digits change nothing: it is out of range
            value = value * 10 + (column.text[at] - '0');
        }
    }
    if (!good) {
        message_at(place.file, place.line, "%s is not an integer",
                   message_quoted(column.text, column.size).text);
        return false;
    }
    value = negative ? -value : value;
    if (value < INT32_MIN || value > INT32_MAX) {
        message_at(place.file, place.line, "%s does not fit int32 (-2147483648 to 2147483647)",
                   message_quoted(column.text, column.size).text);
        return false;
    }
    *out = (int32_t)value;
    return true;
}

static bool read_q30(struct place place, const struct points_word *columns, bool may_be_zero,
                     struct direction *out) {
    struct vec3 *const v = &out->coarse;
    if (!read_int32(place, columns[0], &v->x) || !read_int32(place, columns[1], &v->y) ||
        !read_int32(place, columns[2], &v->z)) {
        return false;
    }
    if (vec3_is_zero(*v) && !may_be_zero) {
        message_at(place.file, place.line, "the zero vector has no direction");
        return false;
    }
    out->fine = vec3_widen(*v);
    out->fine_exact = true;
    return true;
}

static bool read_radec(struct place place, const struct points_word *columns,
                       struct direction *out) {
    static const struct decimal limit = {
        .digit_count = 1, .exponent = 1, .head = {9, 0}, .first = "9"};
    struct decimal value[2];
    if (!read_decimal(place, columns[0], &value[0]) ||
        !read_decimal(place, columns[1], &value[1])) {
        return false;
    }
    struct i128 angle[2];
    if (!decimal_fixed(&value[0], DIRECTION_DEGREE_PLACES, &angle[0])) {
        message_at(place.file, place.line, "right ascension %s is beyond 10^%d degrees",
                   message_quoted(columns[0].text, columns[0].size).text,
                   DECIMAL_HEAD_DIGITS - DIRECTION_DEGREE_PLACES);
        return false;
    }
    struct decimal size = value[1];
    size.negative = false;
    if (decimal_compare(&size, &limit) > 0 ||
        !decimal_fixed(&value[1], DIRECTION_DEGREE_PLACES, &angle[1])) {
        message_at(place.file, place.line, "declination %s is beyond 90 degrees",
                   message_quoted(columns[1].text, columns[1].size).text);
        return false;
    }
    direction_from_degrees(angle[0], angle[1], out);
    return true;
}

/// Room for one more point, with a name or a line's number. False: no memory.
static bool grow(struct points *points, bool named, bool lined) {
    if (points->count < points->room) {
        return true;
    }
    if (points->room > UINT32_MAX / 2U) {
        return false;
    }
    const uint32_t room = points->room == 0U ? 1024U : points->room * 2U;
    void *const directions = realloc(points->directions, room * sizeof *points->directions);
    points->directions = directions != NULL ? directions : points->directions;
    void *const fine = realloc(points->fine, room * sizeof *points->fine);
    points->fine = fine != NULL ? fine : points->fine;
    void *const names = named ? realloc(points->names, room * sizeof *points->names) : NULL;
    points->names = names != NULL ? names : points->names;
    void *const lines = lined ? realloc(points->lines, room * sizeof *points->lines) : NULL;
    points->lines = lines != NULL ? lines : points->lines;
    if (directions == NULL || fine == NULL || (named && names == NULL) ||
        (lined && lines == NULL)) {
        return false;
    }
    points->room = room;
    return true;
}

/// Appends a word and a NUL to a buffer. False: no memory.
static bool add_word(char **text, size_t *used, size_t *room, struct points_word word) {
    if (*room - *used <= word.size) {
        const size_t wanted = *room * 2U + word.size + 1U;
        char *const grown = realloc(*text, wanted);
        if (grown == NULL) {
            return false;
        }
        *text = grown;
        *room = wanted;
    }
    memcpy(*text + *used, word.text, word.size);
    *used += word.size;
    (*text)[(*used)++] = '\0';
    return true;
}

/// Keeps the name of the point that is being added. False: no memory.
static bool add_name(struct points *points, struct points_word name) {
    points->names[points->count] = points->name_used;
    return add_word(&points->name_text, &points->name_used, &points->name_room, name);
}

/// Keeps coordinates as written until all are known.
static bool add_place(struct points *points, const struct points_word *columns) {
    for (int i = 0; i < 3; i++) {
        if (!add_word(&points->place_text, &points->place_used, &points->place_room, columns[i])) {
            return false;
        }
    }
    return true;
}

/// A coordinate each that decimal_read takes.
static bool are_decimals(struct place place, const struct points_word *columns) {
    struct decimal ignored;
    return read_decimal(place, columns[0], &ignored) && read_decimal(place, columns[1], &ignored) &&
           read_decimal(place, columns[2], &ignored);
}

static bool read_columns(struct place place, const struct points_word *columns,
                         const struct points_format *format, struct direction *out) {
    switch (format->input) {
    case POINTS_Q30:
        return read_q30(place, columns, format->places, out);
    case POINTS_RADEC:
        return read_radec(place, columns, out);
    default:
        return format->places ? are_decimals(place, columns)
                              : read_xyz(place, columns, format, out);
    }
}

/// What the columns of a line must be, in words.
static const char *wanted_columns(const struct points_format *format) {
    if (format->input == POINTS_RADEC) {
        return format->segments ? "4 (right ascension, declination, twice)"
               : format->named  ? "3 (name, right ascension, declination)"
                                : "2 (right ascension, declination)";
    }
    return format->segments ? "6 (x y z x y z)" : format->named ? "4 (name x y z)" : "3 (x y z)";
}

static enum exit_status add_point(struct place place, const struct points_word *columns, int first,
                                  const struct points_format *format, struct points *out) {
    struct direction direction = {0};
    if (!read_columns(place, columns + first, format, &direction)) {
        return EXIT_STATUS_USAGE;
    }
    if (!grow(out, format->named, format->places) ||
        (format->named && !add_name(out, columns[0])) ||
        (format->places && format->input == POINTS_XYZ && !add_place(out, columns + first))) {
        message_at(place.file, place.line, "no memory for more than %lu points",
                   (unsigned long)out->count);
        return EXIT_STATUS_FAILURE;
    }
    out->directions[out->count] = direction.coarse;
    out->fine[out->count] = direction.fine;
    out->fine_exact = out->fine_exact && direction.fine_exact;
    if (format->places) {
        out->lines[out->count] = (uint32_t)place.line;
    }
    out->count++;
    return EXIT_STATUS_OK;
}

static enum exit_status read_line(struct place place, const char *text, size_t size,
                                  const struct points_format *format, struct points *out) {
    const char *const comment = memchr(text, '#', size);
    struct points_word columns[POINTS_COLUMNS_MOST];
    const int count = points_split(text, comment != NULL ? comment : text + size, columns);
    if (count == 0) {
        return EXIT_STATUS_OK;
    }
    const int first = format->named ? 1 : 0, of_point = format->input == POINTS_RADEC ? 2 : 3;
    const int wanted = first + of_point * (format->segments ? 2 : 1);
    if (count < 0) {
        message_at(place.file, place.line, "an empty column: a comma without a value beside it");
        return EXIT_STATUS_USAGE;
    }
    if (count != wanted) {
        message_at(place.file, place.line, "%d column%s, not %s", count, count == 1 ? "" : "s",
                   wanted_columns(format));
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    for (int at = first; at < wanted && status == EXIT_STATUS_OK; at += of_point) {
        status = add_point(place, columns, at, format, out);
    }
    return status;
}

static enum exit_status read_all(struct lines *lines, const struct points_format *format,
                                 struct points *out) {
    *out = (struct points){.fine_exact = true};
    for (;;) {
        const char *text;
        size_t size;
        const enum lines_status got = lines_next(lines, &text, &size);
        if (got == LINES_END) {
            break;
        }
        if (got == LINES_ERROR) {
            return EXIT_STATUS_USAGE;
        }
        const enum exit_status status =
            read_line((struct place){lines->name, lines->number}, text, size, format, out);
        if (status != EXIT_STATUS_OK) {
            return status;
        }
    }
    if (format->places) {
        places_finish(out, format->input == POINTS_XYZ, INT32_MAX);
    } else if (!out->fine_exact) {
        out->fine_error_rad = format->input == POINTS_RADEC ? direction_degrees_error_rad
                                                            : direction_decimals_error_rad;
    }
    return EXIT_STATUS_OK;
}

bool points_add_place(struct points *points, const struct points_word word[3]) {
    if (!grow(points, false, false) || !add_place(points, word)) {
        return false;
    }
    points->count++;
    return true;
}

enum exit_status points_read_stream(FILE *stream, const char *name,
                                    const struct points_format *format, struct points *out) {
    struct lines lines;
    lines_from_stream(&lines, stream, name);
    return read_all(&lines, format, out);
}

enum exit_status points_read(const char *path, const struct points_format *format,
                             struct points *out) {
    struct lines lines;
    *out = (struct points){0};
    if (!lines_open(&lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    const enum exit_status status = read_all(&lines, format, out);
    lines_close(&lines);
    return status;
}

const char *points_name(const struct points *points, uint32_t index) {
    return points->names == NULL ? NULL : points->name_text + points->names[index];
}

void points_free(struct points *points) {
    free(points->directions);
    free(points->fine);
    free(points->lines);
    free(points->names);
    free(points->name_text);
    free(points->place_text);
    *points = (struct points){0};
}

const char *points_read_triple(const char *text, struct triple *out) {
    struct points_word columns[POINTS_COLUMNS_MOST];
    const char *const end = text + strlen(text);
    if (points_split(text, end, columns) != 3) {
        return "needs three decimals, X,Y,Z";
    }
    for (int i = 0; i < 3; i++) {
        if (decimal_read(columns[i].text, columns[i].size, &out->component[i]) != DECIMAL_OK) {
            return "needs three decimals, X,Y,Z";
        }
    }
    out->given = true;
    return NULL;
}
