/// The event loop of `boresight run` with a real clock, real signals and a pipe.
#include "event_loop.h"

#include "check.h"

#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static struct event_loop loop;

static void open_loop(uint32_t tick_us) {
    CHECK(event_loop_open(&loop, tick_us));
}

/// No tick comes early, and none is lost: as many are told as have passed.
static void ticks_keep_the_time(void) {
    open_loop(5000);
    uint64_t told = 0;
    uint32_t raised;
    while (told < 40U) {
        const uint64_t due = event_loop_tick(&loop, &raised);
        told += due;
        CHECK(due >= 1U);
        CHECK_EQ(raised, 0);
        CHECK_EQ(loop.ticks, told);
        const uint64_t passed_us = event_loop_now_us() - loop.start_us;
        CHECK(passed_us >= told * 5000U);
    }
    CHECK_EQ(loop.jitter.count + loop.missed_ticks, told);
    CHECK(linux_jitter_quantile(&loop.jitter, 1) < 5000U); // the best of them, on any machine
    event_loop_close(&loop);
}

/// A tick that takes long: those that fell into it are told at once, and the next is in time.
static void late_ticks_are_counted(void) {
    open_loop(5000);
    uint32_t raised;
    CHECK(event_loop_tick(&loop, &raised) >= 1U);
    const uint64_t missed = loop.missed_ticks;
    usleep(26000);
    const uint64_t due = event_loop_tick(&loop, &raised);
    CHECK(due >= 5U);
    CHECK(loop.missed_ticks >= missed + 4U);
    CHECK(loop.jitter.max >= 20000U); // the first of them is 21 ms late
    event_loop_close(&loop);
}

static void signals_are_told(void) {
    open_loop(1000);
    uint32_t raised;
    CHECK_EQ(raise(SIGHUP), 0);
    CHECK_EQ(raise(SIGUSR1), 0);
    uint32_t seen = 0;
    for (int i = 0; i < 3; i++) {
        CHECK(event_loop_tick(&loop, &raised) >= 1U);
        seen |= raised;
    }
    CHECK_EQ(seen, EVENT_LOOP_RELOAD | EVENT_LOOP_REARM);
    CHECK_EQ(raise(SIGTERM), 0);
    seen = 0;
    for (int i = 0; i < 3; i++) {
        CHECK(event_loop_tick(&loop, &raised) >= 1U);
        seen |= raised;
    }
    CHECK_EQ(seen, EVENT_LOOP_END);
    event_loop_close(&loop);
}

static int heard, pipe_ends[2];

static void hear(void *context) {
    char byte;
    heard += read(*(int *)context, &byte, 1) == 1;
}

static void descriptors_are_watched(void) {
    uint32_t raised;
    open_loop(2000);
    CHECK_EQ(pipe(pipe_ends), 0);
    CHECK(event_loop_watch(&loop, pipe_ends[0], hear, &pipe_ends[0]));
    CHECK(!event_loop_watch(&loop, 9999, hear, NULL));
    CHECK_EQ(write(pipe_ends[1], "ab", 2), 2);
    for (int i = 0; i < 3; i++) {
        CHECK(event_loop_tick(&loop, &raised) >= 1U);
    }
    CHECK_EQ(heard, 2);
    event_loop_forget(&loop, pipe_ends[0]);
    CHECK_EQ(write(pipe_ends[1], "c", 1), 1);
    for (int i = 0; i < 3; i++) {
        CHECK(event_loop_tick(&loop, &raised) >= 1U);
    }
    CHECK_EQ(heard, 2);
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    event_loop_close(&loop);
}

/// By hand: 90 ticks in the bucket up to 10 us, 9 up to 30 us, 1 beyond all.
static void quantiles(void) {
    struct linux_jitter jitter = {.step = 10, .count = 100, .over = 1, .max = 31000};
    CHECK_EQ(linux_jitter_quantile(&(struct linux_jitter){.count = 0}, 500), 0);
    jitter.bucket[0] = 90;
    jitter.bucket[2] = 9;
    CHECK_EQ(linux_jitter_quantile(&jitter, 500), 10);
    CHECK_EQ(linux_jitter_quantile(&jitter, 900), 10);
    CHECK_EQ(linux_jitter_quantile(&jitter, 901), 30);
    CHECK_EQ(linux_jitter_quantile(&jitter, 990), 30);
    CHECK_EQ(linux_jitter_quantile(&jitter, 991), 31000);
    CHECK_EQ(linux_jitter_quantile(&jitter, 1000), 31000);
}

int main(void) {
    TEST(ticks_keep_the_time);
    TEST(late_ticks_are_counted);
    TEST(signals_are_told);
    TEST(descriptors_are_watched);
    TEST(quantiles);
    return check_finish();
}
