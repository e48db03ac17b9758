/// The typed values of ini.h.
#include "ini.h"

#include "decimal.h"
#include "suggest.h"

#include <assert.h>
#include <string.h>

static struct message_quote quoted(const struct ini_value *value) {
    return message_quoted(value->text, strlen(value->text));
}

/// The bound is our own text, so it reads.
static struct decimal bound(const char *text) {
    struct decimal value;
    const enum decimal_status status = decimal_read(text, strlen(text), &value);
    assert(status == DECIMAL_OK);
    (void)status;
    return value;
}

static uint64_t or_one(uint64_t factor) {
    return factor == 0U ? 1U : factor;
}

bool ini_value_number(const struct ini_value *value, const struct ini_number *number,
                      int64_t *out) {
    struct decimal decimal;
    if (decimal_read(value->text, strlen(value->text), &decimal) != DECIMAL_OK) {
        message_at(value->file, value->line, "key '%s': %s is not a decimal number", value->key,
                   quoted(value).text);
        return false;
    }
    if (number->whole && decimal.exponent < 0) {
        message_at(value->file, value->line, "key '%s': %s is not a whole number", value->key,
                   quoted(value).text);
        return false;
    }
    if (number->min != NULL) {
        const struct decimal min = bound(number->min);
        if (decimal_compare(&decimal, &min) < 0) {
            message_at(value->file, value->line, "key '%s': %s is below %s", value->key,
                       quoted(value).text, number->min);
            return false;
        }
    }
    if (number->max != NULL) {
        const struct decimal max = bound(number->max);
        if (decimal_compare(&decimal, &max) > 0) {
            message_at(value->file, value->line, "key '%s': %s is above %s", value->key,
                       quoted(value).text, number->max);
            return false;
        }
    }
    if (!decimal_scale(&decimal, or_one(number->numerator), or_one(number->denominator), out)) {
        message_at(value->file, value->line, "key '%s': %s is too large", value->key,
                   quoted(value).text);
        return false;
    }
    return true;
}

bool ini_value_yes_no(const struct ini_value *value, bool *out) {
    *out = strcmp(value->text, "yes") == 0;
    if (!*out && strcmp(value->text, "no") != 0) {
        message_at(value->file, value->line, "key '%s': %s is neither yes nor no", value->key,
                   quoted(value).text);
        return false;
    }
    return true;
}

bool ini_value_choice(const struct ini_value *value, const char *const *choices, int *out) {
    char all[256] = "";
    size_t at = 0;
    for (int i = 0; choices[i] != NULL; i++) {
        if (strcmp(value->text, choices[i]) == 0) {
            *out = i;
            return true;
        }
        if (at < sizeof all) {
            at +=
                (size_t)snprintf(all + at, sizeof all - at, "%s%s", i == 0 ? "" : ", ", choices[i]);
        }
    }
    message_at(value->file, value->line, "key '%s': %s is none of %s", value->key,
               quoted(value).text, all);
    return false;
}

bool ini_value_texts(struct ini *ini, const struct ini_value *value, struct ini_texts *out) {
    out->count = 0;
    if (value->line == 0U && value->text[0] == '\0') { // the default
        return true;
    }
    for (const char *at = value->text;; at++) {
        at += strspn(at, " \t");
        const size_t length = strcspn(at, ",");
        size_t size = length;
        while (size != 0U && (at[size - 1U] == ' ' || at[size - 1U] == '\t')) {
            size--;
        }
        if (size == 0U) {
            message_at(value->file, value->line, "key '%s': an empty item in the list", value->key);
            return false;
        }
        if (out->count == INI_LIST_MOST) {
            message_at(value->file, value->line, "key '%s': more than %d items", value->key,
                       INI_LIST_MOST);
            return false;
        }
        const char *const kept = ini_keep(ini, at, size);
        if (kept == NULL) {
            message_at(value->file, value->line, "key '%s': no memory", value->key);
            return false;
        }
        out->item[out->count++] = kept;
        at += length;
        if (*at == '\0') {
            return true;
        }
    }
}

bool ini_value_numbers(struct ini *ini, const struct ini_value *value,
                       const struct ini_number *number, struct ini_numbers *out) {
    struct ini_texts texts;
    out->count = 0;
    if (!ini_value_texts(ini, value, &texts)) {
        return false;
    }
    for (uint32_t i = 0; i < texts.count; i++) {
        struct ini_value item = *value;
        item.text = texts.item[i];
        if (!ini_value_number(&item, number, &out->item[i])) {
            return false;
        }
    }
    out->count = texts.count;
    return true;
}
