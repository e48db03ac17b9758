/// A line of state on stdout, now and then, which never waits for its reader: `--state`.
/// Shown: tests/cli/camera_run.sh.
#ifndef LINUX_STATE_LINE_H
#define LINUX_STATE_LINE_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdio.h>

/// write(context, stream) writes the line, up to 1023 bytes. False: stdout does not take it now,
/// and it is dropped.
bool state_line_print(void (*write)(const void *context, FILE *stream),
                      const void *context) MUST_CHECK;

#endif
