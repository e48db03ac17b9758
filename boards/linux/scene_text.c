#include "scene_text.h"

#include "lines.h"
#include "places.h"
#include "scene_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// An eighth of the range: the eye may be farther away.
#define PLACES_MOST (TREE_COORDINATE_MAX / 8)

struct reader {
    struct scene_text *scene;
    const char *file;
    unsigned long line;
    int32_t group; ///< that new objects belong to
    uint32_t depth;
    unsigned long group_line[SCENE_DEPTH_MOST];
    bool shapes; ///< wanted
    bool in_object;
    bool has_elements;  ///< the description that is being read
    bool any_detail;    ///< the object has a `detail` line
    bool failed;        ///< no memory
    uint32_t first_own; ///< vertices from here on stand in the description
};

/// Room for one more element of an array. Without memory it stays as it is: r->failed, and told so.
static void *grow(struct reader *r, void *array, uint32_t count, uint32_t *room, size_t size) {
    if (count < *room) {
        return array;
    }
    const uint32_t wanted = *room == 0U ? 256U : *room * 2U;
    void *const grown = *room > UINT32_MAX / 2U ? NULL : realloc(array, wanted * size);
    if (grown == NULL) {
        message_at(r->file, r->line, "no memory for more");
        r->failed = true;
        return array;
    }
    *room = wanted;
    return grown;
}

static bool add_point(struct reader *r, uint32_t vertex) {
    struct scene_text *const s = r->scene;
    s->points = grow(r, s->points, s->point_count, &s->point_room, sizeof *s->points);
    if (r->failed) {
        return false;
    }
    s->points[s->point_count++] = vertex;
    return true;
}

static bool add_corner(struct reader *r, uint32_t vertex) {
    struct scene_text *const s = r->scene;
    s->corners = grow(r, s->corners, s->corner_count, &s->corner_room, sizeof *s->corners);
    if (r->failed) {
        return false;
    }
    s->corners[s->corner_count++] = vertex;
    return true;
}

static bool add_element(struct reader *r, enum tree_element_kind kind, uint32_t first_corner) {
    struct scene_text *const s = r->scene;
    s->elements = grow(r, s->elements, s->element_count, &s->element_room, sizeof *s->elements);
    if (r->failed) {
        return false;
    }
    s->elements[s->element_count++] =
        (struct scene_element){kind, first_corner, s->corner_count - first_corner, r->line};
    s->details[s->detail_count - 1U].element_count++;
    return true;
}

/// Keeps the rest of a line as a name. Returns: its offset; SCENE_NONE without memory.
static uint32_t keep_name(struct reader *r, const char *at, const char *end) {
    struct scene_text *const s = r->scene;
    const uint32_t offset = s->name_bytes;
    while (at < end && (*at == ' ' || *at == '\t')) {
        at++;
    }
    while (at < end && (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r')) {
        end--;
    }
    for (; at <= end; at++) {
        s->names = grow(r, s->names, s->name_bytes, &s->name_room, 1);
        if (r->failed) {
            return SCENE_NONE;
        }
        s->names[s->name_bytes++] = '\0';
        if (at < end) {
            s->names[s->name_bytes - 1U] = *at != '\0' ? *at : '?';
        }
    }
    return offset;
}

static int compare_u32(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/// Ends a description: its points are known, each once.
static bool end_detail(struct reader *r) {
    struct scene_text *const s = r->scene;
    if (!r->in_object || s->objects[s->object_count - 1U].detail_count == 0U) {
        return true;
    }
    struct scene_detail *const d = &s->details[s->detail_count - 1U];
    if (!r->has_elements) {
        for (uint32_t v = r->first_own; v < s->vertices.count; v++) {
            if (!add_point(r, v)) {
                return false;
            }
        }
    }
    const uint32_t count = s->point_count - d->first;
    if (count == 0U && r->any_detail) {
        message_at(r->file, d->line, "the description has no points");
        return false;
    }
    uint32_t *const list = s->points + d->first;
    if (r->has_elements) {
        qsort(list, count, sizeof *list, compare_u32);
        for (uint32_t i = 0; i < count; i++) {
            if (d->count == 0U || list[i] != list[d->count - 1U]) {
                list[d->count++] = list[i];
            }
        }
        s->point_count = d->first + d->count;
    } else {
        d->count = count;
    }
    return true;
}

/// An object without any point is none.
static bool end_object(struct reader *r) {
    struct scene_text *const s = r->scene;
    if (!end_detail(r)) {
        return false;
    }
    if (r->in_object && !r->any_detail && s->details[s->detail_count - 1U].count == 0U) {
        s->detail_count--;
        s->object_count--;
    }
    r->in_object = false;
    return true;
}

/// distance: 0: the description goes by the radius.
static bool begin_detail(struct reader *r, uint32_t radius_px_q8, double distance) {
    struct scene_text *const s = r->scene;
    s->details = grow(r, s->details, s->detail_count, &s->detail_room, sizeof *s->details);
    if (r->failed) {
        return false;
    }
    s->details[s->detail_count++] = (struct scene_detail){.radius_px_q8 = radius_px_q8,
                                                          .distance = distance,
                                                          .first = s->point_count,
                                                          .line = r->line,
                                                          .first_element = s->element_count};
    s->objects[s->object_count - 1U].detail_count++;
    r->has_elements = false;
    r->first_own = s->vertices.count;
    return true;
}

/// at, end: its name.
static bool begin_object(struct reader *r, const char *at, const char *end) {
    struct scene_text *const s = r->scene;
    const uint32_t name = end_object(r) ? keep_name(r, at, end) : SCENE_NONE;
    if (name == SCENE_NONE) {
        return false;
    }
    s->objects = grow(r, s->objects, s->object_count, &s->object_room, sizeof *s->objects);
    if (r->failed) {
        return false;
    }
    s->objects[s->object_count++] =
        (struct scene_object){r->group, s->detail_count, 0, r->line, name};
    r->in_object = true;
    r->any_detail = false;
    return begin_detail(r, 0, 0);
}

static bool read_vertex(struct reader *r, const char *at, const char *end) {
    struct points_word word, columns[3];
    for (int i = 0; i < 3; i++) {
        struct decimal value;
        if (!points_next_word(&at, end, &word)) {
            message_at(r->file, r->line, "a vertex has three coordinates");
            return false;
        }
        if (decimal_read(word.text, word.size, &value) != DECIMAL_OK) {
            message_at(r->file, r->line, "%s is not a decimal number",
                       message_quoted(word.text, word.size).text);
            return false;
        }
        columns[i] = word;
    }
    if (points_next_word(&at, end, &word)) {
        message_at(r->file, r->line, "a vertex has three coordinates");
        return false;
    }
    if (!points_add_place(&r->scene->vertices, columns)) {
        message_at(r->file, r->line, "no memory for more points");
        return false;
    }
    return true;
}

/// The vertex that a word names. False: told that it names none.
static bool read_index(const struct reader *r, struct points_word word, uint32_t *vertex) {
    const char *const slash = memchr(word.text, '/', word.size);
    const size_t size = slash != NULL ? (size_t)(slash - word.text) : word.size;
    const int64_t count = (int64_t)r->scene->vertices.count;
    struct decimal value;
    int64_t number = 0;
    if (decimal_read(word.text, size, &value) != DECIMAL_OK || value.exponent < 0 ||
        !decimal_scale(&value, 1, 1, &number) || number == 0 || number > count || number < -count) {
        message_at(r->file, r->line, "%s is no vertex so far",
                   message_quoted(word.text, word.size).text);
        return false;
    }
    *vertex = (uint32_t)(number > 0 ? number - 1 : count + number);
    return true;
}

/// sort: f, l or p.
static bool read_element(struct reader *r, char sort, const char *at, const char *end) {
    static const char none[] = "";
    struct points_word word;
    uint32_t count = 0;
    if (!r->in_object && !begin_object(r, none, none)) {
        return false;
    }
    const uint32_t first = r->scene->corner_count;
    const bool shape = r->shapes && sort != 'p';
    for (; points_next_word(&at, end, &word); count++) {
        uint32_t vertex;
        if (!read_index(r, word, &vertex) || !add_point(r, vertex) ||
            (shape && !add_corner(r, vertex))) {
            return false;
        }
    }
    if (count < (sort == 'f' ? 3U : sort == 'l' ? 2U : 1U)) {
        message_at(r->file, r->line,
                   sort == 'f'   ? "a face has at least three corners"
                   : sort == 'l' ? "a line has at least two ends"
                                 : "an element without vertices");
        return false;
    }
    r->has_elements = true;
    return !shape || add_element(r, sort == 'f' ? TREE_FACE : TREE_LINE, first);
}

/// `RADIUS_PX` or `within DISTANCE`, of which one is 0.
static bool read_threshold(const struct reader *r, const char *at, const char *end,
                           uint32_t *radius_px_q8, double *distance) {
    struct points_word word, more;
    struct decimal value;
    int64_t scaled = -1;
    *radius_px_q8 = 0;
    *distance = 0;
    bool good = points_next_word(&at, end, &word);
    if (good && points_word_is(word, "within")) {
        good = points_next_word(&at, end, &word) && !points_next_word(&at, end, &more) &&
               decimal_read(word.text, word.size, &value) == DECIMAL_OK;
        *distance = good ? (double)decimal_value(&value) : 0;
        if (!good || !(*distance > 0) || isinf(*distance)) {
            message_at(r->file, r->line, "detail within needs a distance above 0");
            return false;
        }
        return true;
    }
    if (!good || points_next_word(&at, end, &more) ||
        decimal_read(word.text, word.size, &value) != DECIMAL_OK ||
        !decimal_scale(&value, 256, 1, &scaled) || scaled < 0 || scaled > INT32_MAX) {
        message_at(r->file, r->line, "detail needs a radius in pixels from 0 to 8000000");
        return false;
    }
    *radius_px_q8 = (uint32_t)scaled;
    return true;
}

static bool read_detail(struct reader *r, const char *at, const char *end) {
    struct scene_text *const s = r->scene;
    uint32_t px_q8;
    double distance;
    if (!read_threshold(r, at, end, &px_q8, &distance)) {
        return false;
    }
    if (!r->in_object) {
        message_at(r->file, r->line, "detail outside of an object");
        return false;
    }
    struct scene_detail *const last = &s->details[s->detail_count - 1U];
    if (!r->any_detail) { // what stood before the first detail is none
        if (s->point_count != last->first || s->vertices.count != r->first_own) {
            message_at(r->file, r->line, "the object has points before its first detail");
            return false;
        }
        last->line = r->line;
        last->radius_px_q8 = px_q8;
        last->distance = distance;
        r->any_detail = true;
        return true;
    }
    if ((distance > 0) != (last->distance > 0)) {
        message_at(r->file, r->line, "details of one object go by radius or by distance, not both");
        return false;
    }
    if (distance > 0 ? distance >= last->distance : px_q8 <= last->radius_px_q8) {
        message_at(r->file, r->line, "details go from coarse to fine: the %s",
                   distance > 0 ? "distance has to shrink" : "radius has to grow");
        return false;
    }
    return end_detail(r) && begin_detail(r, px_q8, distance);
}

static bool begin_group(struct reader *r) {
    struct scene_text *const s = r->scene;
    if (r->depth == SCENE_DEPTH_MOST) {
        message_at(r->file, r->line, "groups nested deeper than %d", SCENE_DEPTH_MOST);
        return false;
    }
    if (!end_object(r)) {
        return false;
    }
    s->groups = grow(r, s->groups, s->group_count, &s->group_room, sizeof *s->groups);
    if (r->failed) {
        return false;
    }
    s->groups[s->group_count] = (struct scene_group){r->group};
    r->group = (int32_t)s->group_count++;
    r->group_line[r->depth++] = r->line;
    return true;
}

static bool end_group(struct reader *r) {
    if (r->depth == 0U) {
        message_at(r->file, r->line, "end without a group");
        return false;
    }
    if (!end_object(r)) {
        return false;
    }
    r->depth--;
    r->group = r->scene->groups[r->group].parent;
    return true;
}

static bool read_line(struct reader *r, const char *at, const char *end) {
    static const char *const skipped[] = {"vn", "vt", "vp", "s", "usemtl", "mtllib"};
    struct points_word word;
    if (!points_next_word(&at, end, &word)) {
        return true;
    }
    if (points_word_is(word, "v")) {
        return read_vertex(r, at, end);
    }
    if (points_word_is(word, "f") || points_word_is(word, "l") || points_word_is(word, "p")) {
        return read_element(r, *word.text, at, end);
    }
    if (points_word_is(word, "o") || points_word_is(word, "g")) {
        return begin_object(r, at, end);
    }
    if (points_word_is(word, "detail")) {
        return read_detail(r, at, end);
    }
    if (points_word_is(word, "group")) {
        return begin_group(r);
    }
    if (points_word_is(word, "end")) {
        return end_group(r);
    }
    for (size_t i = 0; i < sizeof skipped / sizeof *skipped; i++) {
        if (points_word_is(word, skipped[i])) {
            return true;
        }
    }
    message_at(r->file, r->line, "%s is no line of a scene",
               message_quoted(word.text, word.size).text);
    return false;
}

static enum exit_status read_all(struct reader *r, struct lines *lines) {
    for (;;) {
        const char *text;
        size_t size;
        const enum lines_status got = lines_next(lines, &text, &size);
        r->line = lines->number;
        if (got == LINES_ERROR) {
            return EXIT_STATUS_USAGE;
        }
        if (got == LINES_END) {
            break;
        }
        const char *const comment = memchr(text, '#', size);
        if (!read_line(r, text, comment != NULL ? comment : text + size)) {
            return EXIT_STATUS_USAGE;
        }
    }
    if (r->depth != 0U) {
        message_at(r->file, r->group_line[r->depth - 1U], "the group has no end");
        return EXIT_STATUS_USAGE;
    }
    // A file of nothing but vertices is one object.
    if (r->scene->object_count == 0U && !r->in_object && r->scene->vertices.count != 0U) {
        if (!begin_object(r, r->file, r->file)) {
            return EXIT_STATUS_FAILURE;
        }
        r->first_own = 0;
    }
    if (!end_object(r)) {
        return EXIT_STATUS_USAGE;
    }
    places_finish(&r->scene->vertices, true, PLACES_MOST);
    places_spread(&r->scene->vertices, PLACES_MOST);
    return scene_shape_check(r->scene, r->file);
}

enum exit_status scene_text_read(const char *path, bool shapes, struct scene_text *out) {
    struct lines lines;
    *out = (struct scene_text){0};
    if (!lines_open(&lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    struct reader reader = {.scene = out, .file = lines.name, .group = -1, .shapes = shapes};
    const enum exit_status status = read_all(&reader, &lines);
    lines_close(&lines);
    return status;
}

void scene_text_free(struct scene_text *scene) {
    points_free(&scene->vertices);
    free(scene->objects);
    free(scene->details);
    free(scene->groups);
    free(scene->points);
    free(scene->elements);
    free(scene->corners);
    free(scene->names);
    *scene = (struct scene_text){0};
}
