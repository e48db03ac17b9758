/// The clock of hal/linux against its contract and against the kernel's other clock.
#include "linux/linux_clock.h"
#include "contract/support/clock_suite.h"
#include "contract/support/contract.h"

#include <time.h>

static struct linux_clock clock_;

/// A machine busy with other tests may stop this program for long.
#define SLACK_US 2000000U

/// CLOCK_BOOTTIME goes at the same rate, but is another clock.
static uint64_t boot_us(void) {
    struct timespec now = {0, 0};
    CHECK_EQ(clock_gettime(CLOCK_BOOTTIME, &now), 0);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

static void pass(void *context, uint32_t span_us) {
    (void)context;
    const uint64_t from_us = boot_us();
    while (boot_us() - from_us < span_us) {
        nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
    }
}

static void start_at(void *context, uint32_t start_us) {
    (void)context;
    linux_clock_open(&clock_, start_us);
}

/// Enclosed by readings of the other clock, over half a second.
static void keeps_the_rate(void) {
    linux_clock_open(&clock_, 0xFFFC0000U); // and across the wrap
    const uint64_t outer_from = boot_us();
    const uint32_t from = hal_clock_now_us(&clock_.hal);
    const uint64_t inner_from = boot_us();
    pass(NULL, 500000);
    const uint64_t inner_to = boot_us();
    const uint32_t to = hal_clock_now_us(&clock_.hal);
    const uint64_t outer_to = boot_us();
    const uint32_t span_us = hal_clock_span_us(from, to);
    CHECK(span_us + 2U >= inner_to - inner_from);
    CHECK(span_us <= outer_to - outer_from + 2U);
    CHECK(to < from);
}

/// Finer than a millisecond: a kernel without high-resolution timers would not do.
static void resolution(void) {
    const uint32_t from = hal_clock_now_us(&clock_.hal);
    uint32_t to = from;
    for (int i = 0; i < 100000000 && to == from; i++) {
        to = hal_clock_now_us(&clock_.hal);
    }
    check_note("smallest step seen, us", hal_clock_span_us(from, to));
    CHECK(to != from);
}

int main(void) {
    linux_clock_open(&clock_, 0);
    clock_suite(&(struct clock_fixture){.name = "linux_clock",
                                        .clock = &clock_.hal,
                                        .start_at = start_at,
                                        .pass = pass,
                                        .slack_us = SLACK_US});
    TEST(keeps_the_rate);
    TEST(resolution);
    return check_finish();
}
