/// What an INI file may hold, as a table: read by it, checked by it, explained by it.
///
/// A file's format is one `struct ini_schema`, made of constant tables:
///
///     struct axis { int64_t limit_min_q48; bool reversed; };
///     struct rig { bool has_zoom; struct axis pan, zoom; };
///     static const struct ini_key axis_keys[] = {
///         {.name = "limit_min_deg", .type = INI_DECIMAL, .min = "-360", .max = "360",
///          .numerator = UINT64_C(1) << 48, .denominator = 360,
///          .offset = offsetof(struct axis, limit_min_q48), .help = "lowest angle"},
///         {.name = "reversed", .type = INI_YES_NO, .fallback = "no",
///          .offset = offsetof(struct axis, reversed), .help = "the drive turns the other way"}};
///     static const struct ini_section sections[] = {
///         {.name = "pan", .keys = axis_keys, .key_count = 2, .offset = offsetof(struct rig, pan),
///          .help = "the pan axis"},
///         {.name = "zoom", .presence = INI_OPTIONAL, .seen_offset = offsetof(struct rig,
///         has_zoom),
///          .keys = axis_keys, .key_count = 2, .offset = offsetof(struct rig, zoom),
///          .help = "the zoom lens"}};
/// Shown: tests/cli/ini.c.
#ifndef LINUX_INI_SCHEMA_H
#define LINUX_INI_SCHEMA_H

#include "ini.h"

enum ini_type {
    INI_WHOLE,        ///< int64_t
    INI_DECIMAL,      ///< int64_t, scaled by numerator / denominator
    INI_YES_NO,       ///< bool
    INI_CHOICE,       ///< int: an index into choices
    INI_TEXT,         ///< const char *, valid until ini_free
    INI_TEXT_LIST,    ///< struct ini_texts
    INI_DECIMAL_LIST, ///< struct ini_numbers, each scaled
};

struct ini_key {
    const char *name;
    enum ini_type type;
    /// The default, read as if it stood in the file; NULL: the key is required. Of a text
    /// or a list, "" is good too.
    const char *fallback;
    /// Numbers, and each of a list: bounds in the file's unit, and the factor to the stored one.
    const char *min, *max;
    uint64_t numerator, denominator;
    const char *const *choices; ///< INI_CHOICE; ends with NULL
    size_t offset;              ///< where to store, in the section's struct
    const char *help;           ///< one line; the unit is in the name
};

enum ini_presence {
    INI_REQUIRED,
    INI_OPTIONAL, ///< without it, the keys that have defaults get them
    INI_MANY      ///< [name LABEL], any number of times up to `most`
};

struct ini_section {
    const char *name;
    enum ini_presence presence;
    const struct ini_key *keys;
    size_t key_count;
    size_t offset; ///< of the section's struct in the target; INI_MANY: of the first of an array
    /// INI_OPTIONAL: of a bool, whether it is there. INI_MANY: of a uint32_t, how many are there.
    size_t seen_offset;
    // INI_MANY only.
    size_t stride;       ///< sizeof the array's items
    uint32_t most;       ///< room in the array
    size_t label_offset; ///< of a const char * in the item
    const char *help;    ///< one line
};

struct ini_schema {
    const struct ini_section *sections;
    size_t section_count;
};

/// Fills the target from the file and the defaults; the target's texts live until ini_free.
/// Every fault is told on stderr in a line of its own: an unknown section or key (with the nearest
/// one that is known), a missing one, a value that is wrong.
/// Returns: EXIT_STATUS_OK, or EXIT_STATUS_USAGE: then the target must not be used.
enum exit_status ini_apply(struct ini *ini, const struct ini_schema *schema, void *target);

/// A value of a file that ini_apply accepted, with where it comes from.
struct ini_explained {
    const struct ini_section *section;
    const char *label; ///< of [section LABEL]; "" without
    const struct ini_key *key;
    const char *text;   ///< as in the file, or the default
    unsigned long line; ///< 0: the default
};

/// Calls see for every value that is in force, in the schema's order: of every section that is
/// there, and of optional ones that are not but have defaults for everything.
void ini_visit(const struct ini *ini, const struct ini_schema *schema,
               void (*see)(void *context, const struct ini_explained *value), void *context);

/// Explains every value of the file, defaults included, a line each.
void ini_explain(const struct ini *ini, const struct ini_schema *schema, FILE *stream);

#endif
