#include "ini_edit.h"

#include "view/new_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// ---------------------------------------------------------------- a text that grows

struct buffer {
    char *text;
    size_t size, room;
    bool failed;
};

static void add(struct buffer *buffer, const char *text, size_t size) {
    if (buffer->size + size + 1U > buffer->room) {
        const size_t room = 2U * (buffer->size + size) + 256U;
        char *grown = realloc(buffer->text, room);
        buffer->failed = buffer->failed || grown == NULL;
        if (grown == NULL) {
            return;
        }
        buffer->text = grown;
        buffer->room = room;
    }
    memcpy(buffer->text + buffer->size, text, size);
    buffer->size += size;
    buffer->text[buffer->size] = '\0';
}

static void add_text(struct buffer *buffer, const char *text) {
    add(buffer, text, strlen(text));
}

// ---------------------------------------------------------------- lines

/// Where a change belongs.
struct place {
    unsigned long line; ///< of the key, or the one to go behind; 0: the end of the file
    bool replaces;
};

static struct place place_of(const struct ini *ini, const struct ini_change *change) {
    const int64_t section = ini_find_section(ini, change->section, "");
    if (section < 0) {
        return (struct place){0, false};
    }
    const struct ini_entry *entry = ini_find(ini, section, change->key);
    if (entry != NULL) {
        return (struct place){entry->line, true};
    }
    unsigned long last = ini->sections[section].line;
    for (uint32_t i = 0; i < ini->entry_count; i++) {
        last = ini->entries[i].section == section && ini->entries[i].line > last
                   ? ini->entries[i].line
                   : last;
    }
    return (struct place){last, false};
}

static void add_note(struct buffer *out, const struct ini_change *change) {
    if (change->note[0] != '\0') {
        add_text(out, " " INI_NOTE_MARK);
        add_text(out, change->note);
    }
}

/// Without an older note at its end, and the blanks before it.
static size_t without_note(const char *line, size_t from, size_t size) {
    const char *note = memmem(line + from, size - from, INI_NOTE_MARK, strlen(INI_NOTE_MARK));
    if (note == NULL) {
        return size;
    }
    size_t end = (size_t)(note - line);
    while (end > from && (line[end - 1U] == ' ' || line[end - 1U] == '\t')) {
        end--;
    }
    return end;
}

/// A line without its end; the value between `=` and the comment is another one.
static void add_replaced(struct buffer *out, const char *line, size_t size,
                         const struct ini_change *change) {
    size_t at = 0;
    while (at < size && line[at] != '=') {
        at++;
    }
    at += at < size;
    while (at < size && (line[at] == ' ' || line[at] == '\t')) {
        at++;
    }
    size_t end = at;
    while (end < size && !((line[end] == '#' || line[end] == ';') && end > 0U &&
                           (line[end - 1U] == ' ' || line[end - 1U] == '\t'))) {
        end++;
    }
    while (end > at && (line[end - 1U] == ' ' || line[end - 1U] == '\t')) {
        end--;
    }
    add(out, line, at);
    add_text(out, change->value);
    add(out, line + end, without_note(line, end, size) - end);
    add_note(out, change);
}

static void add_new(struct buffer *out, const struct ini_change *change, const char *line_end) {
    add_text(out, change->key);
    add_text(out, " = ");
    add_text(out, change->value);
    add_note(out, change);
    add_text(out, line_end);
}

/// A line, changed or not, and what goes behind it.
static void add_line(struct buffer *out, const char *line, size_t size, unsigned long number,
                     const struct ini *ini, const struct ini_change *changes, unsigned count,
                     const char *line_end) {
    const struct ini_change *change = NULL;
    bool inserts = false;
    for (unsigned i = 0; i < count; i++) {
        const struct place place = place_of(ini, &changes[i]);
        change = place.line == number && place.replaces ? &changes[i] : change;
        inserts = inserts || (place.line == number && !place.replaces);
    }
    size_t bare = size;
    while (bare > 0U && (line[bare - 1U] == '\n' || line[bare - 1U] == '\r')) {
        bare--;
    }
    if (change != NULL) {
        add_replaced(out, line, bare, change);
    } else {
        add(out, line, bare);
    }
    add(out, line + bare, size - bare);
    if (inserts && bare == size) { // the file's last line has no end
        add_text(out, line_end);
    }
    for (unsigned i = 0; i < count; i++) {
        const struct place place = place_of(ini, &changes[i]);
        if (place.line == number && !place.replaces) {
            add_new(out, &changes[i], line_end);
        }
    }
}

/// Sections that were not there.
static void add_sections(struct buffer *out, const struct ini *ini,
                         const struct ini_change *changes, unsigned count, const char *line_end) {
    const char *section = "";
    for (unsigned i = 0; i < count; i++) {
        if (place_of(ini, &changes[i]).line != 0U) {
            continue;
        }
        if (strcmp(section, changes[i].section) != 0) {
            section = changes[i].section;
            add_text(out, out->size > 0U && out->text[out->size - 1U] != '\n' ? line_end : "");
            add_text(out, line_end);
            add_text(out, "[");
            add_text(out, section);
            add_text(out, "]");
            add_text(out, line_end);
        }
        add_new(out, &changes[i], line_end);
    }
}

char *ini_edit_text(const char *text, size_t size, const struct ini *ini,
                    const struct ini_change *changes, unsigned count, size_t *size_out) {
    struct buffer out = {0};
    const char *line_end = memmem(text, size, "\r\n", 2) != NULL ? "\r\n" : "\n";
    unsigned long number = 0;
    add(&out, "", 0);
    for (size_t at = 0; at < size;) {
        const char *end = memchr(text + at, '\n', size - at);
        const size_t length = end != NULL ? (size_t)(end - (text + at)) + 1U : size - at;
        add_line(&out, text + at, length, ++number, ini, changes, count, line_end);
        at += length;
    }
    add_sections(&out, ini, changes, count, line_end);
    if (out.failed) {
        free(out.text);
        return NULL;
    }
    *size_out = out.size;
    return out.text;
}

// ---------------------------------------------------------------- files

static char *read_whole(const char *path, size_t *size) {
    FILE *file = fopen(path, "r");
    struct buffer text = {0};
    char part[4096];
    size_t count;
    add(&text, "", 0);
    while (file != NULL && (count = fread(part, 1, sizeof part, file)) > 0U) {
        add(&text, part, count);
    }
    const bool good = file != NULL && ferror(file) == 0 && !text.failed;
    if (file != NULL) {
        fclose(file);
    }
    if (!good) {
        free(text.text);
        return NULL;
    }
    *size = text.size;
    return text.text;
}

/// The file is still what was read: same sections, same keys, same values, on the same lines.
static bool is_unchanged(const struct ini *ini) {
    struct ini now = {0};
    bool same = ini_read(ini->file, &now) == EXIT_STATUS_OK &&
                now.entry_count == ini->entry_count && now.section_count == ini->section_count;
    for (uint32_t i = 0; same && i < now.entry_count; i++) {
        same = now.entries[i].line == ini->entries[i].line &&
               now.entries[i].section == ini->entries[i].section &&
               strcmp(now.entries[i].key, ini->entries[i].key) == 0 &&
               strcmp(now.entries[i].value, ini->entries[i].value) == 0;
    }
    ini_free(&now);
    return same;
}

/// Root may write anything; whoever took the file's permission to be written meant it.
bool ini_edit_allowed(const char *path) {
    struct stat about;
    const bool exists = stat(path, &about) == 0;
    if (exists &&
        ((about.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0U || (access(path, W_OK) != 0))) {
        message_at(path, 0, "is read-only: nothing is written");
        return false;
    }
    return true;
}

enum exit_status ini_edit_file(const struct ini *ini, const struct ini_change *changes,
                               unsigned count) {
    struct stat about;
    size_t size = 0, new_size = 0;
    if (!ini_edit_allowed(ini->file)) {
        return EXIT_STATUS_FAILURE;
    }
    if (!is_unchanged(ini)) {
        message_at(ini->file, 0, "was changed meanwhile: nothing is written");
        return EXIT_STATUS_FAILURE;
    }
    char *text = read_whole(ini->file, &size);
    char *edited = text == NULL ? NULL : ini_edit_text(text, size, ini, changes, count, &new_size);
    const bool good = edited != NULL && stat(ini->file, &about) == 0 &&
                      new_file_write(ini->file, edited, new_size) &&
                      chmod(ini->file, about.st_mode & 07777U) == 0;
    if (!good) {
        message_at(ini->file, 0, "can't be written: %s", strerror(errno));
    }
    free(text);
    free(edited);
    return good ? EXIT_STATUS_OK : EXIT_STATUS_FAILURE;
}
