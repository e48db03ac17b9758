/// Pulses for hobby servos and zoom lenses: a number of channels, each with a pulse width.
///
/// After reset no channel gives pulses, and its line is low.
/// Shown: tests/contract/support/pwm_suite.h, on every implementation.
#ifndef HAL_PWM_H
#define HAL_PWM_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stddef.h>
#include <stdint.h>

/// What a channel can do, and its period now.
struct hal_pwm_limits {
    uint32_t period_ns;
    uint32_t period_ns_min, period_ns_max;
    /// Pulse widths are rounded to the nearest multiple of this; it may change with the period. At
    /// least 1. Periods too, but some devices have fewer: what they gave is period_ns.
    uint32_t resolution_ns;
};

struct hal_pwm_ops {
    enum hal_status (*limits)(void *ctx, uint32_t channel, struct hal_pwm_limits *limits);
    enum hal_status (*set_period)(void *ctx, uint32_t channel, uint32_t period_ns);
    enum hal_status (*set_pulse)(void *ctx, uint32_t channel, uint32_t pulse_ns);
};

struct hal_pwm {
    const struct hal_pwm_ops *ops;
    void *ctx;
};

/// Fills *pwm. HAL_ERROR_ARGUMENT (and *pwm as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status hal_pwm_bind(struct hal_pwm *pwm,
                                                      const struct hal_pwm_ops *ops, void *ctx) {
    if (pwm == NULL || ops == NULL || ops->limits == NULL || ops->set_period == NULL ||
        ops->set_pulse == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *pwm = (struct hal_pwm){ops, ctx};
    return HAL_OK;
}

/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: no such channel; HAL_ERROR_GONE. *limits is set with
///           HAL_OK only.
/// Cost:     none to speak of.
MUST_CHECK static inline enum hal_status hal_pwm_limits(const struct hal_pwm *pwm, uint32_t channel,
                                                        struct hal_pwm_limits *limits) {
    if (limits == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return pwm->ops->limits(pwm->ctx, channel, limits);
}

/// Sets the period; pulse widths stay. Channels of one timer share it and change together: ask
/// hal_pwm_limits of each.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: no such channel, outside the limits, or not longer
///           than the pulse of this or a sharing channel; HAL_ERROR_IO, HAL_ERROR_GONE. Then the
///           old one holds.
/// Cost:     at start-up only: one pulse may come out short.
MUST_CHECK static inline enum hal_status hal_pwm_set_period(const struct hal_pwm *pwm,
                                                            uint32_t channel, uint32_t period_ns) {
    return pwm->ops->set_period(pwm->ctx, channel, period_ns);
}

/// Sets the pulse width: 0 for no pulses, else less than the period after rounding. A width above 0
/// never rounds to 0: it is at least one resolution.
/// Takes effect with the next period; the pulse under way is never cut or stretched.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: no such channel or too long; HAL_ERROR_IO,
///           HAL_ERROR_GONE: the old width holds.
/// Cost:     a register write and one 32-bit division; on Linux one or two system calls.
MUST_CHECK static inline enum hal_status hal_pwm_set_pulse(const struct hal_pwm *pwm,
                                                           uint32_t channel, uint32_t pulse_ns) {
    return pwm->ops->set_pulse(pwm->ctx, channel, pulse_ns);
}

/// ns as the device will give it: rounded to the nearest multiple of resolution_ns, half upward; at
/// least one resolution unless it is 0. ns at most 2^32 - 1 - resolution_ns. For implementations.
static inline uint32_t hal_pwm_round_ns(uint32_t ns, uint32_t resolution_ns) {
    const uint32_t steps = (ns + resolution_ns / 2U) / resolution_ns;
    return ns != 0U && steps == 0U ? resolution_ns : steps * resolution_ns;
}

#endif
