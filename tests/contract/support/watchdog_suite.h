/// The contract of hal/watchdog.h as a test.
#ifndef CONTRACT_SUPPORT_WATCHDOG_SUITE_H
#define CONTRACT_SUPPORT_WATCHDOG_SUITE_H

#include "hal/watchdog.h"

#include <stdbool.h>

struct watchdog_fixture {
    const char *name;
    const struct hal_watchdog *watchdog;
    /// Time-outs that the device can do, and, if not 0, some it can't.
    uint32_t timeout_us_min, timeout_us_max, too_short_us, too_long_us;
    void *context;
    /// The board after power-on: not started, no failure pending.
    void (*reset)(void *context);
    void (*pass)(void *context, uint32_t span_us);
    /// Whether it has reset the board.
    bool (*has_fired)(void *context);
    /// The board comes up again after that.
    void (*come_up)(void *context);
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
};

/// Needs all hands but fail_at.
void watchdog_suite(const struct watchdog_fixture *fixture);

#endif
