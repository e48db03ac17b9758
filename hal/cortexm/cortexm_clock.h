/// The time from the core's own timer: a tick each period, microseconds in between.
///
/// The board's vector table calls cortexm_clock_on_tick for exception 15, which has the highest
/// priority, so that the time is right in every handler.
/// Shown: tests/mcu/hal/suites.c.
#ifndef CORTEXM_CORTEXM_CLOCK_H
#define CORTEXM_CORTEXM_CLOCK_H

#include "hal/clock.h"

struct cortexm_clock {
    struct hal_clock hal;
    volatile uint32_t ticks; ///< since the start; wraps
    uint32_t tick_us;
    uint32_t cycles_per_us;
};

/// Starts it. core_hz: a multiple of 1 MHz. tick_us: 1000 at 168 MHz; at most 2^24 cycles.
void cortexm_clock_start(struct cortexm_clock *clock, uint32_t core_hz, uint32_t tick_us);

/// As hal_clock_now_us, without the detour.
uint32_t cortexm_clock_now_us(const struct cortexm_clock *clock);

/// The handler.
void cortexm_clock_on_tick(struct cortexm_clock *clock);

/// Sleeps until there is a tick after the given one; returns the newest. More than one later: ticks
/// were missed.
uint32_t cortexm_clock_wait_tick(const struct cortexm_clock *clock, uint32_t tick);

#endif
