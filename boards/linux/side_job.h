/// A job in a thread of its own, with ordinary priority whatever that of the caller: for what may
/// take long (opening a USB device: up to seconds) and must not hold up the ticks.
///
///     side_job_start(&job, work, context);
///     each tick: if (side_job_is_over(&job)) ... what work() left in context is the caller's
///
/// What context holds belongs to the job until it is over. Shown:
/// tests/scenario/test_side_job.c.
#ifndef LINUX_SIDE_JOB_H
#define LINUX_SIDE_JOB_H

#include "fixed/must_check.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/// All zeros: no job.
struct side_job {
    pthread_t thread;
    bool running; ///< started, and not yet found to be over
    atomic_bool done;
    void (*work)(void *context);
    void *context;
};

/// False: there is no room for a thread now, or the last job is not over.
bool side_job_start(struct side_job *job, void (*work)(void *context), void *context) MUST_CHECK;

/// Whether no job is under way. Never waits for one.
bool side_job_is_over(struct side_job *job);

/// Waits until none is.
void side_job_wait(struct side_job *job);

/// A thread of ordinary priority, for whoever keeps it. False: no room.
bool side_job_thread(pthread_t *thread, void *(*run)(void *context), void *context) MUST_CHECK;

#endif
