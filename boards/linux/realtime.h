/// Ticks in time: real-time priority, and memory that is never paged out.
/// Shown: tests/cli/drives.sh.
#ifndef LINUX_REALTIME_H
#define LINUX_REALTIME_H

#include <stdbool.h>

struct realtime {
    bool priority, memory; ///< what was granted
    /// What was not and what to do about it, one line; empty if all was.
    char advice[200];
};

/// Asks for SCHED_FIFO and locked memory, for this process, as far as it is allowed.
void realtime_enter(struct realtime *realtime);
void realtime_leave(void);

#endif
