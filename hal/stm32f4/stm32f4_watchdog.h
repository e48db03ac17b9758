/// The independent watchdog, and why the chip started.
///
/// It runs from an oscillator of its own, which the data sheet gives as 17 to 47 kHz, 32 typically.
/// The time-out holds for the slowest: a typical chip is reset after 0.53 of it, the fastest after
/// 0.36. Whoever feeds four times as often as hal/watchdog.h says is safe with all of them.
/// Shown: tests/mcu/cpu/faults.c.
#ifndef STM32F4_STM32F4_WATCHDOG_H
#define STM32F4_STM32F4_WATCHDOG_H

#include "hal/watchdog.h"

#include <stdbool.h>

struct stm32f4_watchdog {
    struct hal_watchdog hal;
    bool started;
    enum hal_reset_cause cause;
};

/// Reads the cause of the reset and clears it for the next time.
void stm32f4_watchdog_init(struct stm32f4_watchdog *watchdog);

#endif
