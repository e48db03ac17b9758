#include "linux/linux_gpio_thread.h"

#include <errno.h>
#include <sched.h>
#include <sys/prctl.h>
#include <time.h>

#define SECOND_NS UINT64_C(1000000000)
/// Awake so long before the time: a sleep is late by less than that on a system with real time.
#define WATCH_NS UINT64_C(60000)
/// The longest sleep, so that the end is noticed.
#define SLEEP_NS UINT64_C(20000000)
/// Above the control loop's 30 (boards/linux/realtime.c): an edge that is late by a millisecond is
/// a jerk of the servo, a tick is not.
#define PRIORITY 35

uint64_t linux_gpio_thread_now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * SECOND_NS + (uint64_t)now.tv_nsec;
}

void linux_gpio_thread_sleep_until(uint64_t then_ns) {
    const struct timespec then = {(time_t)(then_ns / SECOND_NS), (long)(then_ns % SECOND_NS)};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &then, NULL);
}

static void *run(void *ctx) {
    struct linux_gpio_thread *thread = ctx;
    const struct sched_param wanted = {.sched_priority = PRIORITY};
    (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
    (void)prctl(PR_SET_TIMERSLACK, 1UL); // without real-time priority sleeps are late by 50 us else
    while (!atomic_load(&thread->ending)) {
        uint64_t now_ns = linux_gpio_thread_now_ns();
        const uint64_t next_ns = thread->work(thread->ctx, now_ns);
        while (now_ns < next_ns && !atomic_load(&thread->ending)) {
            if (next_ns - now_ns > WATCH_NS) {
                const uint64_t sleep_ns = next_ns - now_ns - WATCH_NS;
                linux_gpio_thread_sleep_until(now_ns + (sleep_ns < SLEEP_NS ? sleep_ns : SLEEP_NS));
            }
            now_ns = linux_gpio_thread_now_ns();
        }
    }
    return NULL;
}

bool linux_gpio_thread_start(struct linux_gpio_thread *thread, linux_gpio_work *work, void *ctx) {
    thread->work = work;
    thread->ctx = ctx;
    atomic_store(&thread->ending, false);
    errno = pthread_create(&thread->thread, NULL, run, thread);
    thread->runs = errno == 0;
    return thread->runs;
}

void linux_gpio_thread_stop(struct linux_gpio_thread *thread) {
    if (thread->runs) {
        atomic_store(&thread->ending, true);
        (void)pthread_join(thread->thread, NULL);
        thread->runs = false;
    }
}
