#include "regular_file.h"

#include "lines.h"
#include "points.h"

#include <stdlib.h>
#include <string.h>

/// A coordinate: an integer times a power of ten.
struct coordinate {
    int64_t digits;
    int32_t exponent;
};

struct vertex {
    struct coordinate at[3];
    unsigned long line;
};

struct reader {
    struct lines lines;
    enum regular_problem problem;
    struct regular_items *out;
    struct vertex *vertices;
    uint32_t vertex_count, vertex_room;
    /// The vertices of each item, by index: their places are known when the unit is.
    uint32_t *corners;
    size_t corner_count, corner_room;
    size_t *first; ///< of items, where their corners begin
    uint32_t item_count, item_room;
    unsigned long *item_line;
    bool out_of_memory;
};

static void *grow(struct reader *r, void *array, size_t count, size_t size) {
    // Twice as much whenever a power of two is full.
    if (count != 0U && (count & (count - 1U)) != 0U) {
        return array;
    }
    void *const grown = realloc(array, (count == 0U ? 1U : 2U * count) * size);
    r->out_of_memory = r->out_of_memory || grown == NULL;
    return grown == NULL ? array : grown;
}

static bool fault(const struct reader *r, const char *what, struct points_word word) {
    message_at(r->lines.name, r->lines.number, "%s%s", message_quoted(word.text, word.size).text,
               what);
    return false;
}

static bool read_coordinate(const struct reader *r, struct points_word word,
                            struct coordinate *out) {
    struct decimal decimal;
    if (decimal_read(word.text, word.size, &decimal) != DECIMAL_OK) {
        return fault(r, " is not a decimal number", word);
    }
    if (decimal.digit_count > 18U) {
        return fault(r, " has more digits than can be kept exactly", word);
    }
    out->digits = decimal.negative ? -(int64_t)decimal.head.lo : (int64_t)decimal.head.lo;
    out->exponent = decimal.exponent;
    return true;
}

static bool read_vertex(struct reader *r, const char *at, const char *end) {
    struct vertex vertex = {.line = r->lines.number};
    for (int k = 0; k < 3; k++) {
        struct points_word word;
        if (!points_next_word(&at, end, &word)) {
            message_at(r->lines.name, r->lines.number, "a vertex needs three coordinates");
            return false;
        }
        if (!read_coordinate(r, word, &vertex.at[k])) {
            return false;
        }
    }
    r->vertices = grow(r, r->vertices, r->vertex_count, sizeof *r->vertices);
    if (!r->out_of_memory) {
        r->vertices[r->vertex_count++] = vertex;
    }
    return !r->out_of_memory;
}

/// `7`, `-1`, `7/2/3`: a vertex that stands above.
static bool read_index(const struct reader *r, struct points_word word, uint32_t *out) {
    const char *const slash = memchr(word.text, '/', word.size);
    const size_t size = slash != NULL ? (size_t)(slash - word.text) : word.size;
    struct decimal decimal;
    int64_t value = 0;
    if (decimal_read(word.text, size, &decimal) != DECIMAL_OK || decimal.exponent < 0 ||
        !decimal_whole(&decimal, &value)) {
        return fault(r, " is not the number of a vertex", word);
    }
    value = value < 0 ? value + r->vertex_count : value - 1;
    if (value < 0 || value >= r->vertex_count) {
        return fault(r, ": there is no such vertex above", word);
    }
    *out = (uint32_t)value;
    return true;
}

static void add_corner(struct reader *r, uint32_t vertex) {
    r->corners = grow(r, r->corners, r->corner_count, sizeof *r->corners);
    if (!r->out_of_memory) {
        r->corners[r->corner_count++] = vertex;
    }
}

static void begin_item(struct reader *r) {
    r->first = grow(r, r->first, r->item_count, sizeof *r->first);
    r->item_line = grow(r, r->item_line, r->item_count, sizeof *r->item_line);
    if (!r->out_of_memory) {
        r->first[r->item_count] = r->corner_count;
        r->item_line[r->item_count++] = r->lines.number;
    }
}

static void add_side(struct reader *r, uint32_t a, uint32_t b) {
    begin_item(r);
    add_corner(r, a);
    add_corner(r, b);
}

/// A face or a line. Of a face its last side closes it.
static bool read_element(struct reader *r, const char *at, const char *end, bool face) {
    const bool whole = r->problem == REGULAR_FACES_VERTICAL;
    uint32_t first = 0, last = 0, count = 0;
    struct points_word word;
    if (whole && face) {
        begin_item(r);
    }
    while (points_next_word(&at, end, &word)) {
        uint32_t vertex;
        if (!read_index(r, word, &vertex)) {
            return false;
        }
        if (whole && face) {
            add_corner(r, vertex);
        } else if (!whole && count != 0U) {
            add_side(r, last, vertex);
        }
        first = count == 0U ? vertex : first;
        last = vertex;
        count++;
    }
    if (count < (face ? 3U : 2U)) {
        message_at(r->lines.name, r->lines.number, "a %s needs %s", face ? "face" : "line",
                   face ? "three vertices" : "two vertices");
        return false;
    }
    if (face && !whole) {
        add_side(r, last, first);
    }
    return !r->out_of_memory;
}

static bool read_line(struct reader *r, const char *text, size_t size) {
    const char *const comment = memchr(text, '#', size);
    const char *const end = comment != NULL ? comment : text + size;
    struct points_word word;
    if (!points_next_word(&text, end, &word)) {
        return true;
    }
    if (points_word_is(word, "v")) {
        return read_vertex(r, text, end);
    }
    const bool elements = regular_points_of(r->problem) != 1U;
    if (elements && (points_word_is(word, "f") || points_word_is(word, "l"))) {
        return read_element(r, text, end, word.text[0] == 'f');
    }
    return true;
}

// ---------------------------------------------------------------- in whole numbers

/// In units of 10^exponent.
static bool place(const struct reader *r, uint32_t index, struct vec3 *out) {
    const struct vertex *const vertex = &r->vertices[index];
    int64_t at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = vertex->at[k].digits;
        for (int32_t e = r->out->exponent; at[k] != 0 && e < vertex->at[k].exponent; e++) {
            at[k] = llabs(at[k]) > REGULAR_COORDINATE_MAX ? at[k] : at[k] * 10;
        }
        if (llabs(at[k]) > REGULAR_COORDINATE_MAX) {
            message_at(r->lines.name, vertex->line,
                       "in units of 1e%d, which all coordinates are whole multiples of, one is "
                       "beyond %d",
                       (int)r->out->exponent, REGULAR_COORDINATE_MAX);
            return false;
        }
    }
    *out = vec3((int32_t)at[0], (int32_t)at[1], (int32_t)at[2]);
    return true;
}

static bool add_item(struct reader *r, const struct vec3 *points, unsigned long line) {
    const uint32_t of = regular_points_of(r->problem);
    if (!regular_items_grow(r->out, r->problem, false)) {
        r->out_of_memory = true;
        return false;
    }
    memcpy(r->out->points + (size_t)of * r->out->count, points, of * sizeof *points);
    r->out->lines[r->out->count++] = line;
    return true;
}

static struct vec3_i64 normal_of(const struct vec3 p[3]) {
    return vec3_cross(vec3(p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z),
                      vec3(p[2].x - p[0].x, p[2].y - p[0].y, p[2].z - p[0].z));
}

/// Three corners of a face that are on no line; the others must lie in their plane.
static bool add_face(struct reader *r, uint32_t item) {
    const size_t end = item + 1U < r->item_count ? r->first[item + 1U] : r->corner_count;
    struct vec3 corner[3], other;
    struct vec3_i64 normal = {0, 0, 0};
    int known = 0;
    for (size_t i = r->first[item]; i < end; i++) {
        if (!place(r, r->corners[i], &other)) {
            return false;
        }
        if (known < 3) {
            corner[known] = other;
            normal = known == 2 ? normal_of(corner) : normal;
            known += known == 0 || (known == 1 && !vec3_equal(other, corner[0])) ||
                     (known == 2 && (normal.x | normal.y | normal.z) != 0);
        } else if (i128_sign(
                       vec3_i64_dot_vec3(normal, vec3(other.x - corner[0].x, other.y - corner[0].y,
                                                      other.z - corner[0].z))) != 0) {
            message_at(r->lines.name, r->item_line[item],
                       "the corners of the face are not in one plane");
            return false;
        }
    }
    if (known < 3) {
        message_at(r->lines.name, r->item_line[item], "the corners of the face are on one line");
        return false;
    }
    return add_item(r, corner, r->item_line[item]);
}

static int compare_points(struct vec3 a, struct vec3 b) {
    if (a.x != b.x) {
        return a.x < b.x ? -1 : 1;
    }
    return a.y != b.y ? (a.y < b.y ? -1 : 1) : (a.z > b.z) - (a.z < b.z);
}

struct side {
    struct vec3 end[2];
    uint32_t item;
};

static int compare_sides(const void *a, const void *b) {
    const struct side *const p = a, *const q = b;
    const int first = compare_points(p->end[0], q->end[0]);
    const int second = first != 0 ? first : compare_points(p->end[1], q->end[1]);
    return second != 0 ? second : (p->item > q->item) - (p->item < q->item);
}

static int compare_items(const void *a, const void *b) {
    const struct side *const p = a, *const q = b;
    return (p->item > q->item) - (p->item < q->item);
}

/// Sides that several faces share count once: the first.
static bool add_sides(struct reader *r) {
    struct side *const sides = malloc((r->item_count + 1U) * sizeof *sides);
    bool good = sides != NULL;
    r->out_of_memory = !good;
    for (uint32_t i = 0; good && i < r->item_count; i++) {
        sides[i].item = i;
        good = place(r, r->corners[r->first[i]], &sides[i].end[0]) &&
               place(r, r->corners[r->first[i] + 1U], &sides[i].end[1]);
        if (good && compare_points(sides[i].end[0], sides[i].end[1]) > 0) {
            const struct vec3 swap = sides[i].end[0];
            sides[i].end[0] = sides[i].end[1];
            sides[i].end[1] = swap;
        }
    }
    uint32_t kept = 0;
    if (good && r->item_count != 0U) {
        qsort(sides, r->item_count, sizeof *sides, compare_sides);
        for (uint32_t i = 0; i < r->item_count; i++) {
            if (kept == 0U || !vec3_equal(sides[kept - 1U].end[0], sides[i].end[0]) ||
                !vec3_equal(sides[kept - 1U].end[1], sides[i].end[1])) {
                sides[kept++] = sides[i];
            }
        }
        qsort(sides, kept, sizeof *sides, compare_items);
    }
    for (uint32_t i = 0; good && i < kept; i++) {
        good = add_item(r, sides[i].end, r->item_line[sides[i].item]);
    }
    free(sides);
    return good;
}

/// The unit: the last digit of any coordinate.
static bool finish(struct reader *r) {
    r->out->exponent = 0;
    for (uint32_t i = 0; i < r->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            const struct coordinate *const c = &r->vertices[i].at[k];
            if (c->digits != 0 && c->exponent < r->out->exponent) {
                r->out->exponent = c->exponent;
            }
        }
    }
    if (regular_points_of(r->problem) == 2U) {
        return add_sides(r);
    }
    bool good = true;
    if (r->problem == REGULAR_FACES_VERTICAL) {
        for (uint32_t i = 0; good && i < r->item_count; i++) {
            good = add_face(r, i);
        }
        return good;
    }
    for (uint32_t i = 0; good && i < r->vertex_count; i++) {
        struct vec3 at;
        good = place(r, i, &at) && add_item(r, &at, r->vertices[i].line);
    }
    return good;
}

enum exit_status regular_obj_read(const char *path, enum regular_problem problem,
                                  struct regular_items *out) {
    struct reader r = {.problem = problem, .out = out};
    if (!lines_open(&r.lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    bool good = true;
    enum lines_status got = LINES_OK;
    while (good) {
        const char *text;
        size_t size;
        got = lines_next(&r.lines, &text, &size);
        if (got != LINES_OK) {
            break;
        }
        good = read_line(&r, text, size);
    }
    good = good && got == LINES_END && finish(&r);
    if (r.out_of_memory) {
        message_at(r.lines.name, r.lines.number, "no memory for more");
    }
    lines_close(&r.lines);
    free(r.vertices);
    free(r.corners);
    free(r.first);
    free(r.item_line);
    return good ? EXIT_STATUS_OK : r.out_of_memory ? EXIT_STATUS_FAILURE : EXIT_STATUS_USAGE;
}
