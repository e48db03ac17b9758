#include "realtime.h"

#include <sched.h>
#include <stdio.h>
#include <sys/mman.h>

/// Above ordinary programs and most interrupt threads' users, below the kernel's interrupt threads
/// (50), which bring the frames that we wait for.
#define PRIORITY 30

void realtime_enter(struct realtime *realtime) {
    const struct sched_param wanted = {.sched_priority = PRIORITY};
    realtime->priority = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0;
    // Only what is there now: later pages of a program that allocates little are few, and a limit
    // on locked memory would turn them into failures.
    realtime->memory = mlockall(MCL_CURRENT) == 0;
    realtime->advice[0] = '\0';
    if (!realtime->priority || !realtime->memory) {
        snprintf(realtime->advice, sizeof realtime->advice,
                 "without %s%s%s: this process may not; start it as root, or as a service with "
                 "AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK",
                 realtime->priority ? "" : "real-time priority",
                 realtime->priority || realtime->memory ? "" : " and ",
                 realtime->memory ? "" : "locked memory");
    }
}

void realtime_leave(void) {
    const struct sched_param ordinary = {.sched_priority = 0};
    (void)sched_setscheduler(0, SCHED_OTHER, &ordinary);
    (void)munlockall();
}
