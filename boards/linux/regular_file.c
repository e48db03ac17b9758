#include "regular_file.h"

#include "lines.h"
#include "points.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

bool regular_items_grow(struct regular_items *items, enum regular_problem problem, bool weighted) {
    if (items->count < items->room) {
        return true;
    }
    const uint32_t wanted = items->room == 0U ? 64U : 2U * items->room;
    struct vec3 *const points =
        realloc(items->points, sizeof *points * wanted * regular_points_of(problem));
    if (points == NULL) {
        return false;
    }
    items->points = points;
    unsigned long *const lines = realloc(items->lines, sizeof *lines * wanted);
    if (lines == NULL) {
        return false;
    }
    items->lines = lines;
    if (weighted) {
        uint32_t *const weights = realloc(items->weights, sizeof *weights * wanted);
        if (weights == NULL) {
            return false;
        }
        items->weights = weights;
    }
    items->room = wanted;
    return true;
}

void regular_file_free(struct regular_items *items) {
    free(items->points);
    free(items->weights);
    free(items->lines);
    *items = (struct regular_items){0};
}

/// A whole number of at most `most` in size.
static bool read_whole(const struct lines *lines, struct points_word word, int64_t most,
                       int64_t *out) {
    struct decimal decimal;
    const struct message_quote quote = message_quoted(word.text, word.size);
    if (decimal_read(word.text, word.size, &decimal) != DECIMAL_OK) {
        message_at(lines->name, lines->number, "%s is not a number", quote.text);
        return false;
    }
    if (decimal.digit_count != 0U && decimal.exponent < 0) {
        message_at(lines->name, lines->number, "%s is not a whole number", quote.text);
        return false;
    }
    if (!decimal_whole(&decimal, out) || *out > most || *out < -most) {
        message_at(lines->name, lines->number, "%s is beyond %" PRId64, quote.text, most);
        return false;
    }
    return true;
}

static bool read_coordinates(const struct lines *lines, const struct points_word *column,
                             bool planar, struct vec3 *out) {
    int64_t at[3] = {0, 0, 0};
    for (int k = 0; k < (planar ? 2 : 3); k++) {
        if (!read_whole(lines, column[k], REGULAR_COORDINATE_MAX, &at[k])) {
            return false;
        }
    }
    *out = vec3((int32_t)at[0], (int32_t)at[1], (int32_t)at[2]);
    return true;
}

static enum exit_status read_item(const struct lines *lines, const char *text, size_t size,
                                  enum regular_problem problem, bool weighted,
                                  struct regular_items *out) {
    const char *const comment = memchr(text, '#', size);
    struct points_word column[POINTS_COLUMNS_MOST];
    const int count = points_split(text, comment != NULL ? comment : text + size, column);
    if (count == 0) {
        return EXIT_STATUS_OK;
    }
    const bool planar = regular_is_planar(problem);
    const int of = (int)regular_points_of(problem), each = planar ? 2 : 3;
    const int wanted = of * each + (weighted ? 1 : 0);
    if (count != wanted) {
        message_at(lines->name, lines->number,
                   "%d column%s, not %d (%d point%s of %d coordinates%s)", count,
                   count == 1 ? "" : "s", wanted, of, of == 1 ? "" : "s", each,
                   weighted ? ", and a weight" : "");
        return EXIT_STATUS_USAGE;
    }
    if (!regular_items_grow(out, problem, weighted)) {
        message_at(lines->name, lines->number, "no memory for more");
        return EXIT_STATUS_FAILURE;
    }
    for (int k = 0; k < of; k++) {
        if (!read_coordinates(lines, column + k * each, planar,
                              &out->points[(size_t)of * out->count + (size_t)k])) {
            return EXIT_STATUS_USAGE;
        }
    }
    int64_t weight = 1;
    if (weighted && !read_whole(lines, column[wanted - 1], REGULAR_WEIGHT_MAX, &weight)) {
        return EXIT_STATUS_USAGE;
    }
    if (weight < 1) {
        message_at(lines->name, lines->number, "a weight is at least 1");
        return EXIT_STATUS_USAGE;
    }
    if (weighted) {
        out->weights[out->count] = (uint32_t)weight;
    }
    out->lines[out->count++] = lines->number;
    return EXIT_STATUS_OK;
}

enum exit_status regular_file_read(const char *path, enum regular_problem problem, bool weighted,
                                   bool obj, struct regular_items *out) {
    struct lines lines;
    *out = (struct regular_items){0};
    if (obj) {
        return regular_obj_read(path, problem, out);
    }
    if (!lines_open(&lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    while (status == EXIT_STATUS_OK) {
        const char *text;
        size_t size;
        const enum lines_status got = lines_next(&lines, &text, &size);
        if (got == LINES_END) {
            break;
        }
        status = got == LINES_ERROR ? EXIT_STATUS_USAGE
                                    : read_item(&lines, text, size, problem, weighted, out);
    }
    lines_close(&lines);
    return status;
}
