/// A watchdog: resets the board, which lets go of all its outputs, unless it is fed in time.
/// Shown: tests/contract/support/watchdog_suite.h.
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stddef.h>
#include <stdint.h>

enum hal_reset_cause {
    /// The hardware doesn't tell (or the flags were read and cleared before, by a boot loader).
    HAL_RESET_UNKNOWN,
    HAL_RESET_POWER_ON,
    /// The supply sagged.
    HAL_RESET_BROWN_OUT,
    /// The reset pin or button.
    HAL_RESET_PIN,
    /// The program asked for it.
    HAL_RESET_SOFTWARE,
    HAL_RESET_WATCHDOG
};

struct hal_watchdog_ops {
    enum hal_status (*start)(void *ctx, uint32_t timeout_us);
    enum hal_status (*feed)(void *ctx);
    enum hal_status (*reset_cause)(void *ctx, enum hal_reset_cause *cause);
};

struct hal_watchdog {
    const struct hal_watchdog_ops *ops;
    void *ctx;
};

/// Fills *watchdog. HAL_ERROR_ARGUMENT (and *watchdog as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status
hal_watchdog_bind(struct hal_watchdog *watchdog, const struct hal_watchdog_ops *ops, void *ctx) {
    if (watchdog == NULL || ops == NULL || ops->start == NULL || ops->feed == NULL ||
        ops->reset_cause == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *watchdog = (struct hal_watchdog){ops, ctx};
    return HAL_OK;
}

/// Starts it. Nothing stops it again, and while it runs a second start is HAL_ERROR_ARGUMENT.
/// timeout_us: at least 1. The board is reset at most so long after the last feed, and not earlier
///             than half of it: feed four times as often.
/// Returns:  HAL_OK; HAL_ERROR_UNSUPPORTED: it can't be that quick or that slow;
///           HAL_ERROR_IO, HAL_ERROR_GONE.
/// Cost:     a few register writes; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_watchdog_start(const struct hal_watchdog *watchdog,
                                                            uint32_t timeout_us) {
    if (timeout_us == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    return watchdog->ops->start(watchdog->ctx, timeout_us);
}

/// Gives it another timeout_us. Called in one place only, when every task has checked in.
/// Returns:  HAL_OK; HAL_ERROR_DOWN: it was not started; HAL_ERROR_IO, HAL_ERROR_GONE: not fed: the
///           reset is coming, so bring the gimbal to rest.
/// Cost:     a register write; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_watchdog_feed(const struct hal_watchdog *watchdog) {
    return watchdog->ops->feed(watchdog->ctx);
}

/// Why the board started last. The same answer however often it is asked.
/// Returns:  HAL_OK; HAL_ERROR_IO, HAL_ERROR_GONE: *cause is not set.
/// Cost:     a copy.
MUST_CHECK static inline enum hal_status
hal_watchdog_reset_cause(const struct hal_watchdog *watchdog, enum hal_reset_cause *cause) {
    if (cause == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return watchdog->ops->reset_cause(watchdog->ctx, cause);
}

#endif
