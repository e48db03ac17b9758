/// The time: microseconds in 32 bits, which wrap every 71 minutes and 35 seconds.
///
/// The only source of time there is; steady, never set. The zero point has no meaning, so only
/// differences count.
/// Shown: tests/contract/support/clock_suite.h, on every implementation.
#ifndef HAL_CLOCK_H
#define HAL_CLOCK_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct hal_clock_ops {
    uint32_t (*now_us)(void *ctx);
};

struct hal_clock {
    const struct hal_clock_ops *ops;
    void *ctx;
};

/// Fills *clock. HAL_ERROR_ARGUMENT (and *clock as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status
hal_clock_bind(struct hal_clock *clock, const struct hal_clock_ops *ops, void *ctx) {
    if (clock == NULL || ops == NULL || ops->now_us == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *clock = (struct hal_clock){ops, ctx};
    return HAL_OK;
}

/// Now. Never fails, never runs backwards (but wraps). Resolution: 1 us or finer.
/// Cost: a register read, or on Linux a call that does not enter the kernel.
static inline uint32_t hal_clock_now_us(const struct hal_clock *clock) {
    return clock->ops->now_us(clock->ctx);
}

/// Time from then to now. Right across the wrap for spans up to 2^32 - 1 us (71 minutes).
static inline uint32_t hal_clock_span_us(uint32_t then_us, uint32_t now_us) {
    return now_us - then_us;
}

/// Whether now is at or after the deadline. Right across the wrap if they are less than 2^31 us (35
/// minutes) apart: a deadline is looked at more often than that, and dropped once it has passed.
static inline bool hal_clock_has_reached(uint32_t now_us, uint32_t deadline_us) {
    return now_us - deadline_us < UINT32_C(0x80000000);
}

#endif
