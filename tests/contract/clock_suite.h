/// The contract of hal/clock.h as a test.
#ifndef CONTRACT_SUPPORT_CLOCK_SUITE_H
#define CONTRACT_SUPPORT_CLOCK_SUITE_H

#include "hal/clock.h"

struct clock_fixture {
    const char *name;
    const struct hal_clock *clock;
    void *context;
    /// Makes the clock show start_us now.
    void (*start_at)(void *context, uint32_t start_us);
    /// Lets at least span_us pass, by another measure than the clock.
    void (*pass)(void *context, uint32_t span_us);
    /// How much longer pass and two readings of the clock may take, in all; 0 with virtual time.
    uint32_t slack_us;
};

void clock_suite(const struct clock_fixture *fixture);

#endif
