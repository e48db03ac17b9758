/// A watchdog on a clock. It can't reset the program that uses it: it tells that it would have.
#ifndef DEVICES_FAKE_WATCHDOG_H
#define DEVICES_FAKE_WATCHDOG_H

#include "devices/fake_failures.h"
#include "hal/clock.h"
#include "hal/watchdog.h"

#include <stdbool.h>

#define FAKE_WATCHDOG_TIMEOUT_US_MIN 100U
#define FAKE_WATCHDOG_TIMEOUT_US_MAX 32000000U

struct fake_watchdog {
    struct hal_watchdog hal;
    struct fake_failures failures;
    const struct hal_clock *clock;
    enum hal_reset_cause cause;
    bool started, fired;
    uint32_t timeout_us, fed_us;
};

/// A board that has just started, for that cause. Must not move in memory afterwards. clock: stays
/// the caller's.
void fake_watchdog_init(struct fake_watchdog *watchdog, const struct hal_clock *clock,
                        enum hal_reset_cause cause);

/// Whether the board has been reset: timeout_us have passed since the last feed. Once it has, feeds
/// change nothing. Look at least every 71 minutes of its clock.
bool fake_watchdog_has_fired(struct fake_watchdog *watchdog);

#endif
