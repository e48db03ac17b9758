#include "ini.h"

#include "lines.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 1 << 14 };

struct ini_block {
    struct ini_block *next;
    size_t used, room;
    char text[];
};

const char *ini_keep(struct ini *ini, const char *text, size_t size) {
    struct ini_block *block = ini->blocks;
    if (block == NULL || block->room - block->used <= size) {
        const size_t room = size < BLOCK_BYTES ? BLOCK_BYTES : size + 1U;
        block = malloc(sizeof *block + room);
        if (block == NULL) {
            return NULL;
        }
        *block = (struct ini_block){.next = ini->blocks, .room = room};
        ini->blocks = block;
    }
    char *const kept = block->text + block->used;
    memcpy(kept, text, size);
    kept[size] = '\0';
    block->used += size + 1U;
    return kept;
}

void ini_free(struct ini *ini) {
    while (ini->blocks != NULL) {
        struct ini_block *const next = ini->blocks->next;
        free(ini->blocks);
        ini->blocks = next;
    }
    free(ini->sections);
    free(ini->entries);
    *ini = (struct ini){0};
}

/// The next entry from *at that is not in that section; NULL: there is none.
static const struct ini_entry *next_outside(const struct ini *ini, const char *section,
                                            uint32_t *at) {
    while (*at < ini->entry_count) {
        const struct ini_entry *entry = &ini->entries[(*at)++];
        if (section == NULL || strcmp(ini->sections[entry->section].name, section) != 0) {
            return entry;
        }
    }
    return NULL;
}

bool ini_same_but(const struct ini *a, const struct ini *b, const char *section) {
    uint32_t i = 0, k = 0;
    for (;;) {
        const struct ini_entry *x = next_outside(a, section, &i), *y = next_outside(b, section, &k);
        if (x == NULL || y == NULL) {
            return x == y;
        }
        const struct ini_section_line *of_x = &a->sections[x->section];
        const struct ini_section_line *of_y = &b->sections[y->section];
        if (strcmp(of_x->name, of_y->name) != 0 || strcmp(of_x->label, of_y->label) != 0 ||
            strcmp(x->key, y->key) != 0 || strcmp(x->value, y->value) != 0) {
            return false;
        }
    }
}

int64_t ini_find_section(const struct ini *ini, const char *name, const char *label) {
    for (uint32_t i = 0; i < ini->section_count; i++) {
        if (strcmp(ini->sections[i].name, name) == 0 &&
            strcmp(ini->sections[i].label, label) == 0) {
            return i;
        }
    }
    return -1;
}

const struct ini_entry *ini_find(const struct ini *ini, int64_t section, const char *key) {
    for (uint32_t i = 0; i < ini->entry_count; i++) {
        if (ini->entries[i].section == section && strcmp(ini->entries[i].key, key) == 0) {
            return &ini->entries[i];
        }
    }
    return NULL;
}

void ini_complain(const struct ini *ini, const char *section, const char *label, const char *key,
                  const char *format, ...) {
    const int64_t index = ini_find_section(ini, section, label);
    const struct ini_entry *const entry = ini_find(ini, index, key);
    const unsigned long line =
        entry != NULL ? entry->line : (index >= 0 ? ini->sections[index].line : 0U);
    char what[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    message_at(ini->file, line, "key '%s': %s", key, what);
}

// ---------------------------------------------------------------- lines

struct span {
    const char *at, *end;
};

static struct span trim(const char *at, const char *end) {
    while (at < end && (*at == ' ' || *at == '\t')) {
        at++;
    }
    while (end > at && (end[-1] == ' ' || end[-1] == '\t')) {
        end--;
    }
    return (struct span){at, end};
}

/// The line without its comment and the blanks around it.
static struct span without_comment(const char *text, size_t size) {
    for (size_t i = 0; i < size; i++) {
        const bool starts = i == 0U || text[i - 1U] == ' ' || text[i - 1U] == '\t';
        if (starts && (text[i] == '#' || text[i] == ';')) {
            size = i;
        }
    }
    return trim(text, text + size);
}

/// Makes room for one more item. False: no memory.
static bool grow(void **items, uint32_t *room, uint32_t count, size_t item_bytes) {
    if (count < *room) {
        return true;
    }
    const uint32_t more = *room == 0U ? 64U : *room * 2U;
    void *const grown = realloc(*items, more * item_bytes);
    if (grown == NULL) {
        return false;
    }
    *items = grown;
    *room = more;
    return true;
}

/// What a line of the file came to.
enum line_status { LINE_GOOD, LINE_BAD, LINE_NO_MEMORY };

static enum line_status read_section(struct ini *ini, unsigned long line, struct span text) {
    if (text.end[-1] != ']') {
        message_at(ini->file, line, "a section ends with ]");
        return LINE_BAD;
    }
    const struct span inner = trim(text.at + 1, text.end - 1);
    const char *split = inner.at;
    while (split < inner.end && *split != ' ' && *split != '\t') {
        split++;
    }
    const struct span label = trim(split, inner.end);
    if (split == inner.at) {
        message_at(ini->file, line, "a section without a name");
        return LINE_BAD;
    }
    void *sections = ini->sections;
    if (!grow(&sections, &ini->section_room, ini->section_count, sizeof *ini->sections)) {
        return LINE_NO_MEMORY;
    }
    ini->sections = sections;
    const struct ini_section_line section = {
        ini_keep(ini, inner.at, (size_t)(split - inner.at)),
        ini_keep(ini, label.at, (size_t)(label.end - label.at)), line};
    if (section.name == NULL || section.label == NULL) {
        return LINE_NO_MEMORY;
    }
    const int64_t first = ini_find_section(ini, section.name, section.label);
    ini->sections[ini->section_count++] = section; // also when it is a double: keys follow
    if (first >= 0) {
        message_at(ini->file, line, "section %s is there twice, first on line %lu",
                   message_quoted(inner.at, (size_t)(inner.end - inner.at)).text,
                   ini->sections[first].line);
        return LINE_BAD;
    }
    return LINE_GOOD;
}

static enum line_status read_entry(struct ini *ini, unsigned long line, struct span text) {
    const char *const equals = memchr(text.at, '=', (size_t)(text.end - text.at));
    if (equals == NULL || equals == text.at) {
        message_at(ini->file, line, "%s is neither [section] nor key = value",
                   message_quoted(text.at, (size_t)(text.end - text.at)).text);
        return LINE_BAD;
    }
    const struct span key = trim(text.at, equals), value = trim(equals + 1, text.end);
    void *entries = ini->entries;
    if (!grow(&entries, &ini->entry_room, ini->entry_count, sizeof *ini->entries)) {
        return LINE_NO_MEMORY;
    }
    ini->entries = entries;
    struct ini_entry entry = {.key = ini_keep(ini, key.at, (size_t)(key.end - key.at)),
                              .value = ini_keep(ini, value.at, (size_t)(value.end - value.at)),
                              .line = line};
    if (entry.key == NULL || entry.value == NULL) {
        return LINE_NO_MEMORY;
    }
    const struct message_quote quote = message_quoted(entry.key, strlen(entry.key));
    if (ini->section_count == 0U) {
        message_at(ini->file, line, "key %s before the first [section]", quote.text);
        return LINE_BAD;
    }
    if (value.at == value.end) {
        message_at(ini->file, line, "key %s: there is no value", quote.text);
        return LINE_BAD;
    }
    entry.section = ini->section_count - 1U;
    const struct ini_entry *const first = ini_find(ini, entry.section, entry.key);
    if (first != NULL) {
        message_at(ini->file, line, "key %s is there twice, first on line %lu", quote.text,
                   first->line);
        return LINE_BAD;
    }
    ini->entries[ini->entry_count++] = entry;
    return LINE_GOOD;
}

static enum exit_status read_all(struct lines *lines, struct ini *out) {
    *out = (struct ini){.file = lines->name};
    enum exit_status status = EXIT_STATUS_OK;
    for (;;) {
        const char *text;
        size_t size;
        const enum lines_status got = lines_next(lines, &text, &size);
        if (got == LINES_END) {
            return status;
        }
        if (got == LINES_ERROR) {
            return EXIT_STATUS_USAGE;
        }
        const struct span span = without_comment(text, size);
        if (span.at == span.end) {
            continue;
        }
        const enum line_status line = span.at[0] == '[' ? read_section(out, lines->number, span)
                                                        : read_entry(out, lines->number, span);
        if (out->section_count > INI_KEYS_MOST || out->entry_count > INI_KEYS_MOST) {
            message_at(out->file, lines->number, "more than %d keys or sections", INI_KEYS_MOST);
            return EXIT_STATUS_USAGE;
        }
        if (line == LINE_NO_MEMORY) {
            message_at(out->file, lines->number, "no memory");
            return EXIT_STATUS_FAILURE;
        }
        status = line == LINE_BAD ? EXIT_STATUS_USAGE : status;
    }
}

enum exit_status ini_read_stream(FILE *stream, const char *name, struct ini *out) {
    struct lines lines;
    lines_from_stream(&lines, stream, name);
    return read_all(&lines, out);
}

enum exit_status ini_read(const char *path, struct ini *out) {
    struct lines lines;
    *out = (struct ini){0};
    if (!lines_open(&lines, path)) {
        return EXIT_STATUS_USAGE;
    }
    const enum exit_status status = read_all(&lines, out);
    lines_close(&lines);
    return status;
}

const char *ini_beside(struct ini *ini, const char *path) {
    const char *const slash = strrchr(ini->file, '/');
    if (path[0] == '/' || slash == NULL) {
        return path;
    }
    char joined[4096];
    const int size =
        snprintf(joined, sizeof joined, "%.*s/%s", (int)(slash - ini->file), ini->file, path);
    return size < 0 || (size_t)size >= sizeof joined ? path : ini_keep(ini, joined, (size_t)size);
}
