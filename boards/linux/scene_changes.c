#include "scene_changes.h"

#include "lines.h"
#include "scene_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum change_kind { CHANGE_AWAY, CHANGE_BACK, CHANGE_MOVE, CHANGE_COPY, CHANGE_POINT, CHANGE_KINDS };

struct change {
    enum change_kind kind;
    uint32_t part;
    struct vec3 by;
    unsigned long line;
};

struct reader {
    const struct tree *tree;
    const char *file;
    unsigned long line;
    struct change *list;
    uint32_t count, room;
};

static bool read_number(const struct reader *r, const char **at, const char *end, int32_t *out) {
    struct points_word word;
    struct decimal value;
    double unit;
    memcpy(&unit, r->tree->header->unit_double, sizeof unit);
    if (!points_next_word(at, end, &word) ||
        decimal_read(word.text, word.size, &value) != DECIMAL_OK) {
        message_at(r->file, r->line, "needs three numbers");
        return false;
    }
    const long double units = decimal_value(&value) / (long double)unit;
    if (!(fabsl(units) <= (long double)TREE_COORDINATE_MAX)) {
        message_at(r->file, r->line, "%s is beyond what this scene has room for",
                   message_quoted(word.text, word.size).text);
        return false;
    }
    *out = (int32_t)lroundl(units);
    return true;
}

/// The rest of the line is the name of an object.
static bool read_name(const struct reader *r, const char *at, const char *end, uint32_t *part) {
    while (at < end && (*at == ' ' || *at == '\t')) {
        at++;
    }
    while (at < end && (end[-1] == ' ' || end[-1] == '\t')) {
        end--;
    }
    const size_t size = (size_t)(end - at);
    char *const name = malloc(size + 1U);
    if (name == NULL) {
        message_at(r->file, r->line, "no memory");
        return false;
    }
    memcpy(name, at, size);
    name[size] = '\0';
    *part = tree_find_part(r->tree, name);
    free(name);
    if (*part == TREE_NONE) {
        message_at(r->file, r->line, "the scene has no object %s", message_quoted(at, size).text);
    }
    return *part != TREE_NONE;
}

static bool read_change(struct reader *r, const char *at, const char *end) {
    static const char *const kinds[CHANGE_KINDS] = {"away", "back", "move", "copy", "point"};
    struct points_word word;
    struct change change = {.part = TREE_NONE, .line = r->line};
    if (!points_next_word(&at, end, &word)) {
        return true;
    }
    unsigned kind = 0;
    while (kind < CHANGE_KINDS && !points_word_is(word, kinds[kind])) {
        kind++;
    }
    if (kind == CHANGE_KINDS) {
        message_at(r->file, r->line, "%s is no change: away, back, move, copy or point",
                   message_quoted(word.text, word.size).text);
        return false;
    }
    change.kind = (enum change_kind)kind;
    if (kind >= CHANGE_MOVE &&
        !(read_number(r, &at, end, &change.by.x) && read_number(r, &at, end, &change.by.y) &&
          read_number(r, &at, end, &change.by.z))) {
        return false;
    }
    if (kind == CHANGE_POINT && points_next_word(&at, end, &word)) {
        message_at(r->file, r->line, "a point has three coordinates");
        return false;
    }
    if (kind != CHANGE_POINT && !read_name(r, at, end, &change.part)) {
        return false;
    }
    if (r->count == r->room) {
        const uint32_t room = r->room == 0U ? 256U : 2U * r->room;
        struct change *const grown = realloc(r->list, room * sizeof *grown);
        if (grown == NULL) {
            message_at(r->file, r->line, "no memory for more changes");
            return false;
        }
        r->list = grown;
        r->room = room;
    }
    r->list[r->count++] = change;
    return true;
}

static bool read_all(struct reader *r, struct lines *lines) {
    for (;;) {
        const char *text;
        size_t size;
        const enum lines_status got = lines_next(lines, &text, &size);
        r->line = lines->number;
        if (got != LINES_OK) {
            return got == LINES_END;
        }
        const char *const comment = memchr(text, '#', size);
        if (!read_change(r, text, comment != NULL ? comment : text + size)) {
            return false;
        }
    }
}

/// Points of the finest description of a part.
static uint64_t points_of(const struct tree *tree, uint32_t part) {
    struct {
        uint32_t next, end;
    } level[TREE_LEVELS_MAX];
    uint64_t count = 0;
    uint32_t depth = 1;
    level[0].next = tree->parts[part].node;
    level[0].end = level[0].next + 1U;
    while (depth != 0U) {
        if (level[depth - 1U].next == level[depth - 1U].end) {
            depth--;
            continue;
        }
        const struct tree_node *const node = &tree->nodes[level[depth - 1U].next++];
        const struct tree_description *const d =
            &tree->descriptions[node->first_description + node->description_count - 1U];
        if (tree_kind(d) == TREE_NODES) {
            level[depth].next = d->first;
            level[depth++].end = d->first + d->count;
        } else if (tree_kind(d) == TREE_POINTS) {
            count += d->count;
        }
    }
    return count;
}

/// item: by part, of an object that was moved.
static enum overlay_status apply(struct scene_changes *out, const struct tree *tree,
                                 const struct change *c, uint32_t *item) {
    struct overlay *const o = &out->overlay;
    const bool was_away = c->part != TREE_NONE && overlay_is_away(o, c->part);
    const uint64_t points = c->part != TREE_NONE ? points_of(tree, c->part) : 1U;
    uint32_t added;
    enum overlay_status status = OVERLAY_OK;
    switch (c->kind) {
    case CHANGE_COPY:
        out->count += points;
        return overlay_add_object(o, c->part, c->by, &added);
    case CHANGE_POINT: {
        struct tree_point *const p = &out->points[out->point_count];
        *p = (struct tree_point){c->by.x, c->by.y, c->by.z,
                                 tree->header->source_count + out->point_count};
        out->point_count++;
        out->count++;
        return overlay_add_points(o, p, 1, vec3(0, 0, 0), &added);
    }
    case CHANGE_MOVE:
        if (item[c->part] != OVERLAY_NONE) {
            return overlay_move(o, item[c->part], c->by);
        }
        status = overlay_add_object(o, c->part, c->by, &item[c->part]);
        out->count += points;
        break;
    default: // what was moved is away from there, too
        if (item[c->part] != OVERLAY_NONE) {
            status = overlay_remove(o, item[c->part]);
            item[c->part] = OVERLAY_NONE;
            out->count -= points;
        }
        break;
    }
    const bool away = c->kind != CHANGE_BACK;
    if (status == OVERLAY_OK) {
        status = overlay_set_away(o, c->part, away);
        out->count += was_away && !away ? points : 0U;
        out->count -= !was_away && away ? points : 0U;
    }
    return status;
}

static enum exit_status apply_all(const struct reader *r, struct scene_changes *out) {
    const uint32_t parts = r->tree->header->part_count;
    const size_t room = OVERLAY_WORKSPACE_BYTES(parts, r->count);
    uint32_t *const item = malloc((parts + 1U) * sizeof *item);
    out->workspace = malloc(room + 8U);
    out->points = malloc((r->count + 1U) * sizeof *out->points);
    enum exit_status status = EXIT_STATUS_OK;
    if (item == NULL || out->workspace == NULL || out->points == NULL ||
        overlay_open(&out->overlay, r->tree, r->count, out->workspace, room) != OVERLAY_OK) {
        message_at(r->file, 0, "no memory for its %u changes", r->count);
        status = EXIT_STATUS_FAILURE;
    }
    for (uint32_t i = 0; i < parts && status == EXIT_STATUS_OK; i++) {
        item[i] = OVERLAY_NONE;
    }
    for (uint32_t i = 0; i < r->count && status == EXIT_STATUS_OK; i++) {
        if (apply(out, r->tree, &r->list[i], item) != OVERLAY_OK) {
            message_at(r->file, r->list[i].line, "would be beyond what this scene has room for");
            status = EXIT_STATUS_USAGE;
        }
    }
    free(item);
    return status;
}

enum exit_status scene_changes_read(const char *path, const struct tree *tree, uint64_t count,
                                    struct scene_changes *out) {
    struct lines lines;
    *out = (struct scene_changes){.count = count};
    if (!lines_open(&lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    struct reader reader = {.tree = tree, .file = lines.name};
    const bool good = read_all(&reader, &lines);
    lines_close(&lines);
    const enum exit_status status = good ? apply_all(&reader, out) : EXIT_STATUS_USAGE;
    free(reader.list);
    return status;
}

void scene_changes_free(struct scene_changes *changes) {
    free(changes->workspace);
    free(changes->points);
    *changes = (struct scene_changes){.count = 0};
}
