/// A command's results: the same facts as one JSON object or as aligned lines of text.
///
/// As text, each fact is a line `name   value`, in the order of the calls; with JSON, a member of
/// the object. Nothing is written before the command knows all of its results.
/// Shown: tests/cli/json.c.
#ifndef LINUX_FACTS_H
#define LINUX_FACTS_H

#include "json.h"

#include "fixed/vec3.h"

struct facts {
    struct json json;
    FILE *stream;
    bool as_json;
};

void facts_begin(struct facts *facts, FILE *stream, bool as_json);
void facts_end(struct facts *facts);

/// `yes` or `no` as text.
void facts_bool(struct facts *facts, const char *name, bool value);
void facts_u64(struct facts *facts, const char *name, uint64_t value);
void facts_text(struct facts *facts, const char *name, const char *value);
/// A value with digits: as printf's %.*g and %.*f.
void facts_significant(struct facts *facts, const char *name, double value, int digits);
void facts_fixed(struct facts *facts, const char *name, double value, int places);
/// value / 10^12 with all its digits.
void facts_trillionths(struct facts *facts, const char *name, uint64_t value);
/// null; as text, `none` and why.
void facts_null(struct facts *facts, const char *name, const char *why);
void facts_vec3(struct facts *facts, const char *name, struct vec3 value);
/// A list of numbers with up to 12 digits.
void facts_reals(struct facts *facts, const char *name, const double *values, uint32_t count);
/// Indices of points; as text their names follow, where name_of (may be NULL) gives one.
void facts_indices(struct facts *facts, const char *name, const uint32_t *indices, uint32_t count,
                   const char *(*name_of)(const void *context, uint32_t index),
                   const void *context);

#endif
