#include "devices/fake_pwm.h"

#include "devices/fake_bind.h"

static enum hal_status fake_pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    const struct fake_pwm *pwm = ctx;
    if (channel >= pwm->channel_count) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = fake_failures_presence(&pwm->failures);
    if (status == HAL_OK) {
        *limits = (struct hal_pwm_limits){fake_pwm_period_ns(pwm, channel), FAKE_PWM_PERIOD_NS_MIN,
                                          FAKE_PWM_PERIOD_NS_MAX, pwm->resolution_ns};
    }
    return status;
}

static enum hal_status fake_pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct fake_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || period_ns < FAKE_PWM_PERIOD_NS_MIN ||
        period_ns > FAKE_PWM_PERIOD_NS_MAX) {
        return HAL_ERROR_ARGUMENT;
    }
    const uint32_t rounded_ns = hal_pwm_round_ns(period_ns, pwm->resolution_ns);
    const uint32_t timer = channel / pwm->channels_a_timer;
    for (uint32_t i = 0; i < pwm->channel_count; i++) {
        if (i / pwm->channels_a_timer == timer && pwm->pulses_ns[i] >= rounded_ns) {
            return HAL_ERROR_ARGUMENT;
        }
    }
    const enum hal_status status = fake_failures_call(&pwm->failures);
    if (status == HAL_OK) {
        pwm->periods_ns[timer] = rounded_ns;
    }
    return status;
}

static enum hal_status fake_pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct fake_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || pulse_ns > FAKE_PWM_PERIOD_NS_MAX) {
        return HAL_ERROR_ARGUMENT;
    }
    const uint32_t rounded_ns = hal_pwm_round_ns(pulse_ns, pwm->resolution_ns);
    if (rounded_ns >= fake_pwm_period_ns(pwm, channel)) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = fake_failures_call(&pwm->failures);
    if (status == HAL_OK) {
        pwm->pulses_ns[channel] = rounded_ns;
    }
    return status;
}

static const struct hal_pwm_ops ops = {fake_pwm_limits, fake_pwm_set_period, fake_pwm_set_pulse};

void fake_pwm_init(struct fake_pwm *pwm, uint32_t channel_count, uint32_t channels_a_timer,
                   uint32_t resolution_ns) {
    *pwm = (struct fake_pwm){.channel_count = channel_count,
                             .channels_a_timer = channels_a_timer,
                             .resolution_ns = resolution_ns};
    if (channel_count - 1U >= FAKE_PWM_CHANNELS_MAX || channels_a_timer == 0U ||
        resolution_ns == 0U || FAKE_PWM_PERIOD_NS_MIN % resolution_ns != 0U) {
        abort();
    }
    for (uint32_t i = 0; i < channel_count; i++) {
        pwm->periods_ns[i] = FAKE_PWM_PERIOD_NS;
    }
    fake_bind_check(hal_pwm_bind(&pwm->hal, &ops, pwm));
}

uint32_t fake_pwm_pulse_ns(const struct fake_pwm *pwm, uint32_t channel) {
    return pwm->pulses_ns[channel];
}

uint32_t fake_pwm_period_ns(const struct fake_pwm *pwm, uint32_t channel) {
    return pwm->periods_ns[channel / pwm->channels_a_timer];
}
