/// Virtual time behind hal/clock.h: stands still until it is moved.
#ifndef DEVICES_FAKE_CLOCK_H
#define DEVICES_FAKE_CLOCK_H

#include "hal/clock.h"

struct fake_clock {
    struct hal_clock hal;
    uint32_t now_us;
    /// Each reading moves the clock on by this: for code that waits in a loop. 0 at first.
    uint32_t step_us;
};

/// Must not move in memory afterwards.
void fake_clock_init(struct fake_clock *clock, uint32_t now_us);

void fake_clock_set(struct fake_clock *clock, uint32_t now_us);
/// Wraps at 2^32.
void fake_clock_advance(struct fake_clock *clock, uint32_t span_us);

#endif
