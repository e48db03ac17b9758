#include "event_loop.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

uint64_t event_loop_now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

// ---------------------------------------------------------------- watching

static bool add(struct event_loop *loop, int fd) {
    struct epoll_event event = {.events = EPOLLIN, .data.fd = fd};
    return epoll_ctl(loop->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

bool event_loop_watch(struct event_loop *loop, int fd, void (*ready)(void *context),
                      void *context) {
    if (loop->watch_count == EVENT_LOOP_WATCHES_MAX || !add(loop, fd)) {
        return false;
    }
    loop->watch[loop->watch_count++] = (struct event_loop_watch){fd, ready, context};
    return true;
}

void event_loop_forget(struct event_loop *loop, int fd) {
    for (unsigned i = 0; i < loop->watch_count; i++) {
        if (loop->watch[i].fd == fd) {
            (void)epoll_ctl(loop->epoll, EPOLL_CTL_DEL, fd, NULL);
            loop->watch[i] = loop->watch[--loop->watch_count];
            return;
        }
    }
}

static sigset_t our_signals(void) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGHUP);
    sigaddset(&set, SIGUSR1);
    return set;
}

void event_loop_block_signals(void) {
    const sigset_t set = our_signals();
    (void)sigprocmask(SIG_BLOCK, &set, NULL);
    (void)signal(SIGPIPE, SIG_IGN);
}

static bool open_signals(struct event_loop *loop) {
    const sigset_t set = our_signals();
    event_loop_block_signals();
    loop->signals = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    return loop->signals >= 0 && add(loop, loop->signals);
}

static bool open_timer(struct event_loop *loop) {
    loop->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    loop->start_us = event_loop_now_us();
    const uint64_t first_us = loop->start_us + loop->tick_us;
    const struct itimerspec times = {
        .it_interval = {loop->tick_us / 1000000U, (long)(loop->tick_us % 1000000U) * 1000},
        .it_value = {(time_t)(first_us / 1000000U), (long)(first_us % 1000000U) * 1000}};
    return loop->timer >= 0 && timerfd_settime(loop->timer, TFD_TIMER_ABSTIME, &times, NULL) == 0 &&
           add(loop, loop->timer);
}

bool event_loop_open(struct event_loop *loop, uint32_t tick_us) {
    memset(loop, 0, sizeof *loop);
    loop->timer = loop->signals = -1;
    loop->tick_us = tick_us;
    loop->jitter.step = EVENT_LOOP_JITTER_STEP_US;
    loop->epoll = epoll_create1(EPOLL_CLOEXEC);
    return loop->epoll >= 0 && open_signals(loop) && open_timer(loop);
}

void event_loop_close(struct event_loop *loop) {
    const int fds[] = {loop->timer, loop->signals, loop->epoll};
    for (unsigned i = 0; i < sizeof fds / sizeof *fds; i++) {
        if (fds[i] >= 0) {
            close(fds[i]);
        }
    }
    loop->timer = loop->signals = loop->epoll = -1;
}

// ---------------------------------------------------------------- waiting

static void read_signals(struct event_loop *loop) {
    struct signalfd_siginfo info;
    while (read(loop->signals, &info, sizeof info) == (ssize_t)sizeof info) {
        loop->raised |= info.ssi_signo == (uint32_t)SIGHUP    ? EVENT_LOOP_RELOAD
                        : info.ssi_signo == (uint32_t)SIGUSR1 ? EVENT_LOOP_REARM
                                                              : EVENT_LOOP_END;
    }
}

static void note_lateness(struct event_loop *loop) {
    const uint64_t due_us = loop->start_us + (loop->ticks + 1U) * loop->tick_us;
    const uint64_t now_us = event_loop_now_us();
    linux_jitter_add(&loop->jitter, now_us > due_us ? now_us - due_us : 0U);
}

/// How many ticks are due.
static uint64_t read_timer(struct event_loop *loop) {
    uint64_t due;
    if (read(loop->timer, &due, sizeof due) != (ssize_t)sizeof due) {
        return 0;
    }
    note_lateness(loop); // of the first of them
    loop->ticks += due;
    loop->missed_ticks += due - 1U;
    return due;
}

uint64_t event_loop_tick(struct event_loop *loop, uint32_t *raised) {
    uint64_t due = 0;
    while (due == 0U) {
        struct epoll_event events[EVENT_LOOP_WATCHES_MAX + 2];
        const int count = epoll_wait(loop->epoll, events, EVENT_LOOP_WATCHES_MAX + 2, -1);
        if (count < 0 && errno != EINTR) {
            return 0;
        }
        for (int i = 0; i < count; i++) {
            const int fd = events[i].data.fd;
            if (fd == loop->timer) {
                due = read_timer(loop);
            } else if (fd == loop->signals) {
                read_signals(loop);
            }
            // By number and not by place: what is called may forget others.
            for (unsigned w = 0; w < loop->watch_count; w++) {
                if (loop->watch[w].fd == fd) {
                    loop->watch[w].ready(loop->watch[w].context);
                    break;
                }
            }
        }
    }
    *raised = loop->raised;
    loop->raised = 0;
    return due;
}
