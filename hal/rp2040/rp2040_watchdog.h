/// The watchdog, and why the chip started.
///
/// It counts microseconds of the crystal (rp2040_clocks_start), so the time-out is exact; without a
/// crystal it is shorter. A reset by it restarts everything but the oscillators: the pins float
/// with their pull-downs, so servos get no more pulses.
/// Shown: tests/mcu/rp2040/pico.sh.
#ifndef RP2040_RP2040_WATCHDOG_H
#define RP2040_RP2040_WATCHDOG_H

#include "hal/watchdog.h"

#include <stdbool.h>

struct rp2040_watchdog {
    struct hal_watchdog hal;
    bool started;
    uint32_t load;
    enum hal_reset_cause cause;
};

/// Reads the cause of the reset, and leaves a mark by which the next start knows that a program of
/// ours ran before: a core that resets itself after a crash sets no flag anywhere.
void rp2040_watchdog_init(struct rp2040_watchdog *watchdog);

#endif
