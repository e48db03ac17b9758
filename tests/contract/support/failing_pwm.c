#include "contract/support/failing_pwm.h"

#include "check.h"
#include "contract/support/syscalls.h"

#include <errno.h>

static enum hal_status failing_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    return hal_pwm_limits(((const struct failing_pwm *)ctx)->inside, channel, limits);
}

/// Before a call, and after it.
static void arm(struct failing_pwm *pwm) {
    const bool due = pwm->nth == 1U;
    pwm->nth -= pwm->nth > 0U;
    syscalls_at(due ? 1 : 0, SYSCALLS_FAIL, EIO);
}
static void disarm(void) {
    syscalls_at(0, SYSCALLS_FAIL, 0);
}

static enum hal_status failing_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct failing_pwm *pwm = ctx;
    arm(pwm);
    const enum hal_status status = hal_pwm_set_period(pwm->inside, channel, period_ns);
    disarm();
    return status;
}

static enum hal_status failing_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct failing_pwm *pwm = ctx;
    arm(pwm);
    const enum hal_status status = hal_pwm_set_pulse(pwm->inside, channel, pulse_ns);
    disarm();
    return status;
}

void failing_pwm_init(struct failing_pwm *pwm, const struct hal_pwm *inside) {
    static const struct hal_pwm_ops ops = {failing_limits, failing_set_period, failing_set_pulse};
    *pwm = (struct failing_pwm){.inside = inside};
    CHECK_EQ(hal_pwm_bind(&pwm->hal, &ops, pwm), HAL_OK);
}

bool failing_pwm_at(struct failing_pwm *pwm, uint32_t nth, enum hal_status status) {
    pwm->nth = nth;
    return status == HAL_ERROR_IO;
}
