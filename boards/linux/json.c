#include "json.h"

#include "utf8.h"

#include <assert.h>
#include <inttypes.h>
#include <string.h>

void json_start(struct json *json, FILE *stream) {
    *json = (struct json){.stream = stream};
}

/// What stands before a value or a key.
static void separate(struct json *json) {
    if (json->after_key) {
        json->after_key = false;
        return;
    }
    const uint32_t bit = UINT32_C(1) << json->depth;
    if ((json->has_items & bit) != 0U) {
        fputs(", ", json->stream);
    }
    json->has_items |= bit;
}

static void begin(struct json *json, char bracket) {
    separate(json);
    fputc(bracket, json->stream);
    assert(json->depth < JSON_DEPTH_MOST);
    json->depth++;
    json->has_items &= ~(UINT32_C(1) << json->depth);
}

static void end(struct json *json, char bracket) {
    assert(json->depth != 0U && !json->after_key);
    json->depth--;
    fputc(bracket, json->stream);
}

void json_begin_object(struct json *json) {
    begin(json, '{');
}

void json_end_object(struct json *json) {
    end(json, '}');
}

void json_begin_array(struct json *json) {
    begin(json, '[');
}

void json_end_array(struct json *json) {
    end(json, ']');
}

static void write_string(struct json *json, const char *text) {
    fputc('"', json->stream);
    const char *const stop = text + strlen(text);
    while (text < stop) {
        const unsigned char c = (unsigned char)*text;
        const size_t length = utf8_length(text, (size_t)(stop - text));
        if (c == '"' || c == '\\') {
            fprintf(json->stream, "\\%c", c);
        } else if (c < 0x20U || c == 0x7FU) {
            fprintf(json->stream, "\\u%04x", c);
        } else if (length == 0U) {
            fputs("\\ufffd", json->stream);
        } else {
            fwrite(text, 1, length, json->stream);
        }
        text += length == 0U ? 1U : length;
    }
    fputc('"', json->stream);
}

void json_key(struct json *json, const char *name) {
    separate(json);
    write_string(json, name);
    fputs(": ", json->stream);
    json->after_key = true;
}

void json_null(struct json *json) {
    json_number(json, "null");
}

void json_bool(struct json *json, bool value) {
    json_number(json, value ? "true" : "false");
}

void json_i64(struct json *json, int64_t value) {
    separate(json);
    fprintf(json->stream, "%" PRId64, value);
}

void json_u64(struct json *json, uint64_t value) {
    separate(json);
    fprintf(json->stream, "%" PRIu64, value);
}

void json_number(struct json *json, const char *text) {
    separate(json);
    fputs(text, json->stream);
}

void json_text(struct json *json, const char *text) {
    separate(json);
    write_string(json, text);
}
