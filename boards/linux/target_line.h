/// A line of a target stream: one JSON object, `{"t_us": 0, "id": 7, "object": "stage", "xyz":
/// [x,y,z]}` or with "dir", optional "weight" and "radius"; `{"id": 7, "gone": true}`.
/// Shown: tests/cli/drive.sh.
#ifndef LINUX_TARGET_LINE_H
#define LINUX_TARGET_LINE_H

#include "target/target_set.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Names of objects get numbers in the order in which they first appear.
struct target_objects {
    uint32_t count;
    char name[64][32];
};

struct target_line {
    struct target_update update;
    bool has_time;
    uint64_t time_us; ///< the sender's clock
};

/// Reads text[0..size). Unknown fields are ignored; a blank line or a comment (#) gives *is_blank.
/// xyz and its radius are in metres, world axes; dir needs no unit length, its radius is in
/// degrees. Returns: NULL, or what is wrong (valid until the next call).
const char *target_line_read(const char *text, size_t size, struct target_objects *objects,
                             struct target_line *out, bool *is_blank);

#endif
