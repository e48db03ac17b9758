/// Reads INI files: sections, keys and values, each with its line. ini_schema.h gives them meaning.
///
/// `[section]`, `[section NAME]`, `key = value`. A line that starts with # or ; is a comment, and
/// so is what follows a # or ; behind a blank. Blanks around names and values don't count; a value
/// is the rest of its line, without quotes. Lines: see lines.h.
/// Shown: tests/cli/ini.c.
#ifndef LINUX_INI_H
#define LINUX_INI_H

#include "message.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct ini_entry {
    const char *key, *value;
    unsigned long line;
    uint32_t section; ///< index
};

struct ini_section_line {
    const char *name;
    const char *label; ///< the NAME of [section NAME]; "" if it has none
    unsigned long line;
};

/// Most keys in a file, and most sections.
enum { INI_KEYS_MOST = 4096 };

struct ini_block; ///< keeps texts

struct ini {
    const char *file; ///< as it stands in messages
    struct ini_section_line *sections;
    struct ini_entry *entries; ///< in the order of the file
    uint32_t section_count, entry_count;
    uint32_t section_room, entry_room;
    struct ini_block *blocks;
};

/// Reads the file at path; NULL or "-": stdin. path must outlive the result.
/// Every faulty line is told on stderr: no section or key on it, a key before the first section, a
/// key or section that is there twice, a key without a value, more than INI_KEYS_MOST of them.
/// Returns: EXIT_STATUS_OK, EXIT_STATUS_USAGE, EXIT_STATUS_FAILURE (no memory). Free with ini_free
///          in any case.
enum exit_status ini_read(const char *path, struct ini *out);

/// The same from an open stream; name stands in the messages.
enum exit_status ini_read_stream(FILE *stream, const char *name, struct ini *out);

void ini_free(struct ini *ini);

/// The section's index; -1 if the file does not have it.
int64_t ini_find_section(const struct ini *ini, const char *name, const char *label);

/// The key's line in that section (index as above); NULL if it is not there.
const struct ini_entry *ini_find(const struct ini *ini, int64_t section, const char *key);

/// `FILE:LINE: key 'KEY': what is wrong`, for checks across keys: at the key's line, or at its
/// section's where the value is a default.
void ini_complain(const struct ini *ini, const char *section, const char *label, const char *key,
                  const char *format, ...) __attribute__((format(printf, 5, 6)));

/// Do both files say the same, whatever their comments and blanks? section: is not looked at; NULL:
/// all are. Their order counts.
bool ini_same_but(const struct ini *a, const struct ini *b, const char *section);

/// Keeps a copy of text[0..size) until ini_free. NULL: no memory.
const char *ini_keep(struct ini *ini, const char *text, size_t size);

/// A path in the file, which counts from the file's own folder. Kept until ini_free; NULL: no
/// memory.
const char *ini_beside(struct ini *ini, const char *path);

// ---------------------------------------------------------------- values

/// A value and where it stands. line 0: it is the default.
struct ini_value {
    const char *file;
    unsigned long line;
    const char *key;
    const char *text;
};

/// What a number may be, in the unit of the file, and how it is stored.
struct ini_number {
    const char *min, *max; ///< decimals; NULL: no bound
    /// Stored: the value * numerator / denominator, exact before it is rounded to nearest, half
    /// away from zero. 0 stands for 1.
    uint64_t numerator, denominator;
    bool whole; ///< only integers are good
};

// Each returns false after one line on stderr.

bool ini_value_number(const struct ini_value *value, const struct ini_number *number, int64_t *out);
/// `yes` or `no`.
bool ini_value_yes_no(const struct ini_value *value, bool *out);
/// One of choices, which ends with NULL: its index.
bool ini_value_choice(const struct ini_value *value, const char *const *choices, int *out);

/// The parts of a list: separated by commas, none of them empty.
enum { INI_LIST_MOST = 64 };
struct ini_texts {
    uint32_t count;
    const char *item[INI_LIST_MOST];
};
struct ini_numbers {
    uint32_t count;
    int64_t item[INI_LIST_MOST];
};

/// ini keeps the items.
bool ini_value_texts(struct ini *ini, const struct ini_value *value, struct ini_texts *out);
bool ini_value_numbers(struct ini *ini, const struct ini_value *value,
                       const struct ini_number *number, struct ini_numbers *out);

#endif
