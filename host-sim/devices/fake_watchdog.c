#include "devices/fake_watchdog.h"

#include "devices/fake_bind.h"

static enum hal_status fake_watchdog_start(void *ctx, uint32_t timeout_us) {
    struct fake_watchdog *watchdog = ctx;
    if (watchdog->started) {
        return HAL_ERROR_ARGUMENT;
    }
    if (timeout_us < FAKE_WATCHDOG_TIMEOUT_US_MIN || timeout_us > FAKE_WATCHDOG_TIMEOUT_US_MAX) {
        return HAL_ERROR_UNSUPPORTED;
    }
    const enum hal_status status = fake_failures_call(&watchdog->failures);
    if (status == HAL_OK) {
        watchdog->started = true;
        watchdog->timeout_us = timeout_us;
        watchdog->fed_us = hal_clock_now_us(watchdog->clock);
    }
    return status;
}

static enum hal_status fake_watchdog_feed(void *ctx) {
    struct fake_watchdog *watchdog = ctx;
    const enum hal_status status = fake_failures_call(&watchdog->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (!watchdog->started) {
        return HAL_ERROR_DOWN;
    }
    if (!fake_watchdog_has_fired(watchdog)) {
        watchdog->fed_us = hal_clock_now_us(watchdog->clock);
    }
    return HAL_OK;
}

static enum hal_status fake_watchdog_reset_cause(void *ctx, enum hal_reset_cause *cause) {
    struct fake_watchdog *watchdog = ctx;
    const enum hal_status status = fake_failures_call(&watchdog->failures);
    if (status == HAL_OK) {
        *cause = watchdog->cause;
    }
    return status;
}

static const struct hal_watchdog_ops ops = {fake_watchdog_start, fake_watchdog_feed,
                                            fake_watchdog_reset_cause};

void fake_watchdog_init(struct fake_watchdog *watchdog, const struct hal_clock *clock,
                        enum hal_reset_cause cause) {
    *watchdog = (struct fake_watchdog){.clock = clock, .cause = cause};
    fake_bind_check(hal_watchdog_bind(&watchdog->hal, &ops, watchdog));
}

bool fake_watchdog_has_fired(struct fake_watchdog *watchdog) {
    if (watchdog->started && !watchdog->fired) {
        const uint32_t now_us = hal_clock_now_us(watchdog->clock);
        watchdog->fired = hal_clock_span_us(watchdog->fed_us, now_us) >= watchdog->timeout_us;
    }
    return watchdog->fired;
}
