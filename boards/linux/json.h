/// Writes JSON. The caller opens and closes what it nests; commas and quoting are done here.
/// Shown: tests/cli/json.c.
#ifndef LINUX_JSON_H
#define LINUX_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct json {
    FILE *stream;
    unsigned depth;
    bool after_key;
    uint32_t has_items; ///< bit d: the container at depth d is not empty
};

/// Deepest nesting.
enum { JSON_DEPTH_MOST = 31 };

void json_start(struct json *json, FILE *stream);

void json_begin_object(struct json *json);
void json_end_object(struct json *json);
void json_begin_array(struct json *json);
void json_end_array(struct json *json);

/// A member's name; exactly one value follows.
void json_key(struct json *json, const char *name);

void json_null(struct json *json);
void json_bool(struct json *json, bool value);
void json_i64(struct json *json, int64_t value);
void json_u64(struct json *json, uint64_t value);
/// A number that the caller has formatted; it must be one by JSON's grammar.
void json_number(struct json *json, const char *text);
/// A string: quotes, backslashes and control characters are escaped; bytes that are not UTF-8
/// become U+FFFD.
void json_text(struct json *json, const char *text);

#endif
