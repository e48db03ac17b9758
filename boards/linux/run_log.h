/// The structured log of `boresight run`: an event a line, to a file or to the system's journal.
///
/// A line of a file is a JSON object: {"t_s": 1.234, "event": "mode", "text": "tracking"}, t_s
/// since the start. In the journal an entry has the text as MESSAGE and the event as
/// BORESIGHT_EVENT. The control never waits for it: a thread writes, and what can't be written is
/// counted and dropped. A file that was renamed or removed (logrotate, without any signal) is made
/// anew with the next line; a journal that was started again is found again.
/// Shown: tests/scenario/test_run_log.c, tests/vm/guest/run.sh.
#ifndef LINUX_RUN_LOG_H
#define LINUX_RUN_LOG_H

#include "aside.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/// Must not move in memory while it is open.
struct run_log {
    bool is_open;
    bool is_journal;
    bool takes_stderr; ///< the same journal
    const char *name;
    uint64_t start_us;
    // Of the thread that writes:
    int fd;
    bool told_lost; ///< that the file can't be made anew
    atomic_uint_fast64_t failed;
    struct aside lines;
};

/// Where the journal listens. Tests have one of their own.
extern const char *run_log_journal;

/// target: a file, which is appended to, or "journal"; NULL: no log. start_us: event_loop_now_us().
/// False: told on stderr why not.
bool run_log_open(struct run_log *log, const char *target, uint64_t start_us);
/// Writes what is left.
void run_log_close(struct run_log *log);

/// Lines that are lost so far. Waits until the others are written.
uint64_t run_log_dropped(struct run_log *log);

/// event: one word. Severe ones get a higher priority in the journal.
void run_log_event(struct run_log *log, bool severe, const char *event, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// To the person on stderr (message_command; message_at) and to the log; once, where both are the
/// same journal.
void run_log_tell(struct run_log *log, const char *command, bool severe, const char *event,
                  const char *text);
void run_log_tell_at(struct run_log *log, const char *file, const char *event, const char *text);

#endif
