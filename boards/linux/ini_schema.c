#include "ini_schema.h"

#include "suggest.h"

#include <string.h>

static const struct ini_section *find_section(const struct ini_schema *schema, const char *name) {
    for (size_t i = 0; i < schema->section_count; i++) {
        if (strcmp(schema->sections[i].name, name) == 0) {
            return &schema->sections[i];
        }
    }
    return NULL;
}

static const struct ini_key *find_key(const struct ini_section *section, const char *name) {
    for (size_t i = 0; i < section->key_count; i++) {
        if (strcmp(section->keys[i].name, name) == 0) {
            return &section->keys[i];
        }
    }
    return NULL;
}

// ---------------------------------------------------------------- what is in the file

static bool check_section(const struct ini *ini, const struct ini_schema *schema,
                          const struct ini_section_line *line) {
    const struct ini_section *const section = find_section(schema, line->name);
    if (section == NULL) {
        struct suggestion suggestion = suggest_start(line->name);
        for (size_t i = 0; i < schema->section_count; i++) {
            suggest_offer(&suggestion, schema->sections[i].name);
        }
        message_at(ini->file, line->line, "unknown section %s%s",
                   message_quoted(line->name, strlen(line->name)).text,
                   suggest_tail(&suggestion).text);
        return false;
    }
    if (section->presence == INI_MANY && line->label[0] == '\0') {
        message_at(ini->file, line->line, "section [%s NAME] needs a name", section->name);
        return false;
    }
    if (section->presence != INI_MANY && line->label[0] != '\0') {
        message_at(ini->file, line->line, "section [%s] takes no name", section->name);
        return false;
    }
    return true;
}

static bool check_key(const struct ini *ini, const struct ini_schema *schema,
                      const struct ini_entry *entry) {
    const struct ini_section *const section =
        find_section(schema, ini->sections[entry->section].name);
    if (section == NULL || find_key(section, entry->key) != NULL) {
        return true; // an unknown section has been told of
    }
    struct suggestion suggestion = suggest_start(entry->key);
    for (size_t i = 0; i < section->key_count; i++) {
        suggest_offer(&suggestion, section->keys[i].name);
    }
    message_at(ini->file, entry->line, "unknown key %s in [%s]%s",
               message_quoted(entry->key, strlen(entry->key)).text, section->name,
               suggest_tail(&suggestion).text);
    return false;
}

static bool check_names(const struct ini *ini, const struct ini_schema *schema) {
    bool good = true;
    for (uint32_t i = 0; i < ini->section_count; i++) {
        good = check_section(ini, schema, &ini->sections[i]) && good;
    }
    for (uint32_t i = 0; i < ini->entry_count; i++) {
        good = check_key(ini, schema, &ini->entries[i]) && good;
    }
    return good;
}

// ---------------------------------------------------------------- values

static bool store(struct ini *ini, const struct ini_key *key, const struct ini_value *value,
                  void *place) {
    const struct ini_number number = {key->min, key->max, key->numerator, key->denominator,
                                      key->type == INI_WHOLE};
    switch (key->type) {
    case INI_YES_NO:
        return ini_value_yes_no(value, place);
    case INI_CHOICE:
        return ini_value_choice(value, key->choices, place);
    case INI_TEXT:
        *(const char **)place = value->text;
        return true;
    case INI_TEXT_LIST:
        return ini_value_texts(ini, value, place);
    case INI_DECIMAL_LIST:
        return ini_value_numbers(ini, value, &number, place);
    default:
        return ini_value_number(value, &number, place);
    }
}

/// Stores one section's values; at: its index in the file, or -1.
static bool apply_section(struct ini *ini, const struct ini_section *section, int64_t at,
                          char *place) {
    bool good = true;
    for (size_t i = 0; i < section->key_count; i++) {
        const struct ini_key *const key = &section->keys[i];
        const struct ini_entry *const entry = ini_find(ini, at, key->name);
        if (entry == NULL && key->fallback == NULL) {
            if (at >= 0) {
                message_at(ini->file, ini->sections[at].line, "key '%s' is missing in [%s]: %s",
                           key->name, section->name, key->help);
                good = false;
            }
            continue;
        }
        const struct ini_value value = {ini->file, entry != NULL ? entry->line : 0U, key->name,
                                        entry != NULL ? entry->value : key->fallback};
        good = store(ini, key, &value, place + key->offset) && good;
    }
    return good;
}

static bool apply_many(struct ini *ini, const struct ini_section *section, char *target) {
    bool good = true;
    uint32_t count = 0;
    for (uint32_t i = 0; i < ini->section_count; i++) {
        const struct ini_section_line *const line = &ini->sections[i];
        if (strcmp(line->name, section->name) != 0 || line->label[0] == '\0') {
            continue;
        }
        if (count == section->most) {
            message_at(ini->file, line->line, "more than %lu sections [%s NAME]",
                       (unsigned long)section->most, section->name);
            return false;
        }
        char *const item = target + section->offset + count++ * section->stride;
        *(const char **)(void *)(item + section->label_offset) = line->label;
        good = apply_section(ini, section, i, item) && good;
    }
    *(uint32_t *)(void *)(target + section->seen_offset) = count;
    return good;
}

enum exit_status ini_apply(struct ini *ini, const struct ini_schema *schema, void *target) {
    bool good = check_names(ini, schema);
    for (size_t i = 0; i < schema->section_count; i++) {
        const struct ini_section *const section = &schema->sections[i];
        if (section->presence == INI_MANY) {
            good = apply_many(ini, section, target) && good;
            continue;
        }
        const int64_t at = ini_find_section(ini, section->name, "");
        if (section->presence == INI_OPTIONAL) {
            *(bool *)((char *)target + section->seen_offset) = at >= 0;
        } else if (at < 0) {
            message_at(ini->file, 0, "section [%s] is missing: %s", section->name, section->help);
            good = false;
        }
        good = apply_section(ini, section, at, (char *)target + section->offset) && good;
    }
    return good ? EXIT_STATUS_OK : EXIT_STATUS_USAGE;
}

// ---------------------------------------------------------------- explanation

/// at: the section's index in the file; -1: it is not there, and all of its values are defaults.
static void visit_section(const struct ini *ini, const struct ini_section *section, int64_t at,
                          void (*see)(void *context, const struct ini_explained *value),
                          void *context) {
    for (size_t k = 0; k < section->key_count; k++) {
        const struct ini_key *const key = &section->keys[k];
        const struct ini_entry *const entry = at < 0 ? NULL : ini_find(ini, at, key->name);
        const struct ini_explained value = {section, at < 0 ? "" : ini->sections[at].label, key,
                                            entry != NULL ? entry->value : key->fallback,
                                            entry != NULL ? entry->line : 0U};
        see(context, &value);
    }
}

static bool has_all_defaults(const struct ini_section *section) {
    for (size_t k = 0; k < section->key_count; k++) {
        if (section->keys[k].fallback == NULL) {
            return false;
        }
    }
    return true;
}

void ini_visit(const struct ini *ini, const struct ini_schema *schema,
               void (*see)(void *context, const struct ini_explained *value), void *context) {
    for (size_t i = 0; i < schema->section_count; i++) {
        const struct ini_section *const section = &schema->sections[i];
        bool found = false;
        for (uint32_t at = 0; at < ini->section_count; at++) {
            if (strcmp(ini->sections[at].name, section->name) == 0) {
                visit_section(ini, section, at, see, context);
                found = true;
            }
        }
        // An absent section whose values all have defaults is in force all the same.
        if (!found && section->presence == INI_OPTIONAL && has_all_defaults(section)) {
            visit_section(ini, section, -1, see, context);
        }
    }
}

struct explanation {
    FILE *stream;
    const struct ini_section *section;
    const char *label;
};

static void print_allowed(FILE *stream, const struct ini_key *key) {
    if (key->type == INI_YES_NO) {
        fputs("; yes or no", stream);
    }
    if (key->type == INI_CHOICE) {
        for (int i = 0; key->choices[i] != NULL; i++) {
            fprintf(stream, "%s %s", i == 0 ? "; one of" : ",", key->choices[i]);
        }
    }
    if (key->min != NULL && key->max != NULL) {
        fprintf(stream, "; %s to %s", key->min, key->max);
    } else if (key->min != NULL) {
        fprintf(stream, "; %s or more", key->min);
    } else if (key->max != NULL) {
        fprintf(stream, "; %s or less", key->max);
    }
}

static void explain(void *context, const struct ini_explained *value) {
    struct explanation *const state = context;
    FILE *const stream = state->stream;
    if (value->section != state->section || value->label != state->label) {
        fprintf(stream, "%s[%s%s%s]  %s\n", state->section == NULL ? "" : "\n",
                value->section->name, value->label[0] != '\0' ? " " : "", value->label,
                value->section->help);
        state->section = value->section;
        state->label = value->label;
    }
    char from[32] = "default";
    if (value->line != 0U) {
        snprintf(from, sizeof from, "line %lu", value->line);
    }
    fprintf(stream, "  %-24s = %-16s %-9s  %s", value->key->name,
            value->text[0] != '\0' ? value->text : "(none)", from, value->key->help);
    print_allowed(stream, value->key);
    fputc('\n', stream);
}

void ini_explain(const struct ini *ini, const struct ini_schema *schema, FILE *stream) {
    struct explanation state = {.stream = stream};
    ini_visit(ini, schema, explain, &state);
}
