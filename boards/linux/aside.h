/// Lines for somewhere that may be slow (a terminal that was stopped, a full pipe, a disk), written
/// by a thread of their own: whoever has something to say never waits.
///
/// Any number of threads may push. A line for which there is no room is dropped and counted.
/// Shown: tests/scenario/test_aside.c.
#ifndef LINUX_ASIDE_H
#define LINUX_ASIDE_H

#include "fixed/must_check.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

enum { ASIDE_LINES = 64, ASIDE_TEXT_BYTES = 1024, ASIDE_EVENT_BYTES = 16 };

struct aside_line {
    uint64_t at_us;
    bool severe;
    char event[ASIDE_EVENT_BYTES];
    char text[ASIDE_TEXT_BYTES];
};

/// Must not move in memory while it is open.
struct aside {
    void (*write)(void *context, const struct aside_line *line);
    void *context;
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool ending;
    uint32_t head, tail; ///< counted up; the line at tail is being written
    uint64_t dropped;
    struct aside_line line[ASIDE_LINES];
};

/// write is called in the other thread, of ordinary priority, a line at a time. False: no room for
/// a thread; nothing is open.
bool aside_open(struct aside *aside, void (*write)(void *context, const struct aside_line *line),
                void *context) MUST_CHECK;

/// Cost: a copy; never waits for a line to be written.
void aside_push(struct aside *aside, const struct aside_line *line);

/// Waits until all that was pushed is written.
void aside_flush(struct aside *aside);
uint64_t aside_dropped(struct aside *aside);

/// As aside_flush, and then no more.
void aside_close(struct aside *aside);

#endif
