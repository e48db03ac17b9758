/// hal/clock.h on CLOCK_MONOTONIC: never set, does not run while the machine sleeps.
/// Shown: tests/contract/linux_clock.c.
#ifndef HAL_LINUX_CLOCK_H
#define HAL_LINUX_CLOCK_H

#include "hal/clock.h"

struct linux_clock {
    struct hal_clock hal;
    /// Added to the kernel's microseconds.
    uint32_t offset_us;
};

/// Starts at start_us: with 0xFFFF0000 a test sees the wrap after 65 ms. Needs no close; must not
/// move in memory afterwards.
void linux_clock_open(struct linux_clock *clock, uint32_t start_us);

#endif
