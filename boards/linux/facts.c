#include "facts.h"

#include <inttypes.h>

/// Width of the column of names.
enum { NAME_WIDTH = 18 };

void facts_begin(struct facts *facts, FILE *stream, bool as_json) {
    *facts = (struct facts){.stream = stream, .as_json = as_json};
    json_start(&facts->json, stream);
    if (as_json) {
        json_begin_object(&facts->json);
    }
}

void facts_end(struct facts *facts) {
    if (facts->as_json) {
        json_end_object(&facts->json);
        fputc('\n', facts->stream);
    }
}

/// Starts a fact: a member, or a line that the caller ends.
static void start(struct facts *facts, const char *name) {
    if (facts->as_json) {
        json_key(&facts->json, name);
    } else {
        fprintf(facts->stream, "%-*s", NAME_WIDTH, name);
    }
}

/// A number or a word that stands in both forms as it is.
static void write_plain(struct facts *facts, const char *name, const char *value) {
    start(facts, name);
    if (facts->as_json) {
        json_number(&facts->json, value);
    } else {
        fprintf(facts->stream, "%s\n", value);
    }
}

void facts_bool(struct facts *facts, const char *name, bool value) {
    if (facts->as_json) {
        write_plain(facts, name, value ? "true" : "false");
    } else {
        write_plain(facts, name, value ? "yes" : "no");
    }
}

void facts_u64(struct facts *facts, const char *name, uint64_t value) {
    char text[24];
    snprintf(text, sizeof text, "%" PRIu64, value);
    write_plain(facts, name, text);
}

void facts_text(struct facts *facts, const char *name, const char *value) {
    start(facts, name);
    if (facts->as_json) {
        json_text(&facts->json, value);
    } else {
        fprintf(facts->stream, "%s\n", value);
    }
}

void facts_significant(struct facts *facts, const char *name, double value, int digits) {
    char text[64];
    snprintf(text, sizeof text, "%.*g", digits, value);
    write_plain(facts, name, text);
}

void facts_fixed(struct facts *facts, const char *name, double value, int places) {
    char text[400];
    snprintf(text, sizeof text, "%.*f", places, value);
    write_plain(facts, name, text);
}

void facts_trillionths(struct facts *facts, const char *name, uint64_t value) {
    const uint64_t unit = UINT64_C(1000000000000);
    char text[48];
    snprintf(text, sizeof text, "%" PRIu64 ".%012" PRIu64, value / unit, value % unit);
    write_plain(facts, name, text);
}

void facts_null(struct facts *facts, const char *name, const char *why) {
    start(facts, name);
    if (facts->as_json) {
        json_null(&facts->json);
    } else {
        fprintf(facts->stream, "none: %s\n", why);
    }
}

void facts_vec3(struct facts *facts, const char *name, struct vec3 value) {
    start(facts, name);
    if (facts->as_json) {
        json_begin_array(&facts->json);
        json_i64(&facts->json, value.x);
        json_i64(&facts->json, value.y);
        json_i64(&facts->json, value.z);
        json_end_array(&facts->json);
    } else {
        fprintf(facts->stream, "%" PRId32 " %" PRId32 " %" PRId32 "\n", value.x, value.y, value.z);
    }
}

void facts_reals(struct facts *facts, const char *name, const double *values, uint32_t count) {
    start(facts, name);
    if (facts->as_json) {
        json_begin_array(&facts->json);
    }
    for (uint32_t i = 0; i < count; i++) {
        char text[32];
        snprintf(text, sizeof text, "%.12g", values[i]);
        if (facts->as_json) {
            json_number(&facts->json, text);
        } else {
            fprintf(facts->stream, "%s%s", i == 0U ? "" : " ", text);
        }
    }
    if (facts->as_json) {
        json_end_array(&facts->json);
    } else {
        fputc('\n', facts->stream);
    }
}

void facts_indices(struct facts *facts, const char *name, const uint32_t *indices, uint32_t count,
                   const char *(*name_of)(const void *context, uint32_t index),
                   const void *context) {
    start(facts, name);
    if (facts->as_json) {
        json_begin_array(&facts->json);
        for (uint32_t i = 0; i < count; i++) {
            json_u64(&facts->json, indices[i]);
        }
        json_end_array(&facts->json);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        fprintf(facts->stream, "%s%" PRIu32, i == 0U ? "" : " ", indices[i]);
        const char *const point_name = name_of != NULL ? name_of(context, indices[i]) : NULL;
        if (point_name != NULL) {
            fprintf(facts->stream, " (%s)", point_name);
        }
    }
    fputs(count == 0U ? "none\n" : "\n", facts->stream);
}
