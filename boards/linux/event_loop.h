/// The heart of `boresight run`: waits for the next tick and, until then, for whatever else can
/// happen: signals, and descriptors of others. One thread, epoll, a timerfd and a signalfd.
///
/// Ticks have absolute times, so a late one does not move those after it. How late each came is
/// kept, in steps of 10 us up to 20 ms; of ticks that are due together that of the first. Shown:
/// tests/scenario/test_event_loop.c.
#ifndef LINUX_EVENT_LOOP_H
#define LINUX_EVENT_LOOP_H

#include "linux/linux_jitter.h"

#include <stdbool.h>
#include <stdint.h>

enum { EVENT_LOOP_WATCHES_MAX = 16, EVENT_LOOP_JITTER_STEP_US = 10 };

/// Signals that came since the last tick.
enum event_loop_signal {
    EVENT_LOOP_END = 1,    ///< SIGINT, SIGTERM
    EVENT_LOOP_RELOAD = 2, ///< SIGHUP
    EVENT_LOOP_REARM = 4   ///< SIGUSR1
};

struct event_loop {
    int epoll, timer, signals;
    uint32_t tick_us;
    uint64_t start_us;          ///< CLOCK_MONOTONIC, of tick 0
    uint64_t ticks;             ///< that were due so far
    uint64_t missed_ticks;      ///< due while an earlier one was still being worked on
    uint32_t raised;            ///< enum event_loop_signal
    struct linux_jitter jitter; ///< us
    struct event_loop_watch {
        int fd;
        void (*ready)(void *context);
        void *context;
    } watch[EVENT_LOOP_WATCHES_MAX];
    unsigned watch_count;
};

/// Keeps the signals above for the loop that is opened later. Before anything starts a thread
/// (libusb does): a thread that does not block them would be killed by them, and all with it.
/// SIGPIPE is ignored from now on: whoever reads the results may leave, the rig goes on.
void event_loop_block_signals(void);

/// From now on the signals above no longer end the program but are told by event_loop_tick. The
/// first tick is due one tick from now. False: errno tells why; close it all the same.
bool event_loop_open(struct event_loop *loop, uint32_t tick_us);
void event_loop_close(struct event_loop *loop);

/// Calls ready(context) whenever fd can be read. False: there are too many, or fd is of a file that
/// can't be waited for.
bool event_loop_watch(struct event_loop *loop, int fd, void (*ready)(void *context), void *context);
void event_loop_forget(struct event_loop *loop, int fd);

/// Waits until a tick is due. Returns how many are: more than 1 if the last one took too long.
/// *raised: the signals since the last call. 0: interrupted by an error, errno tells.
uint64_t event_loop_tick(struct event_loop *loop, uint32_t *raised);

/// Microseconds of CLOCK_MONOTONIC.
uint64_t event_loop_now_us(void);

#endif
