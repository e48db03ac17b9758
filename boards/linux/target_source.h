/// A live target stream: lines from a file or a pipe, read as they come, without ever blocking.
///
/// A line's t_us is the sender's clock. From a regular file (a recording) each line is due that
/// long after the first; from a pipe a line is due when it arrives.
/// Shown: tests/cli/drive.sh.
#ifndef LINUX_TARGET_SOURCE_H
#define LINUX_TARGET_SOURCE_H

#include "target_line.h"

#include <stdbool.h>
#include <stdint.h>

struct target_source {
    int fd;
    const char *name;
    bool is_recording, at_end, opened;
    struct target_objects objects;
    unsigned long line_number;
    unsigned long bad_lines;
    uint64_t first_us; ///< t_us of the first line that has one
    bool has_first;
    bool has_pending;
    struct target_line pending; ///< read, not yet due or not yet taken
    size_t size;
    bool skipping; ///< inside a line that is too long
    char buffer[8192];
};

/// NULL or "-": stdin. False: told on stderr why not.
bool target_source_open(struct target_source *source, const char *path);

/// The next update that is due at now_us after the start, which stays pending until
/// target_source_taken. False: none. Bad lines are named on stderr, counted and skipped.
bool target_source_next(struct target_source *source, uint64_t now_us,
                        struct target_update *update);
void target_source_taken(struct target_source *source);

void target_source_close(struct target_source *source);

#endif
