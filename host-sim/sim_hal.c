#include "sim_private.h"

static uint32_t clock_now_us(void *ctx) {
    const struct sim *sim = ctx;
    return sim->config.start_us + (uint32_t)sim->time_us;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    (void)ctx;
    if (channel >= SIM_PWM_CHANNELS) {
        return HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){.period_ns = 20000000,
                                      .period_ns_min = 20000000,
                                      .period_ns_max = 20000000,
                                      .resolution_ns = 1};
    return HAL_OK;
}

static enum hal_status pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    (void)ctx;
    return channel < SIM_PWM_CHANNELS && period_ns == 20000000U ? HAL_OK : HAL_ERROR_ARGUMENT;
}

static enum hal_status pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct sim *sim = ctx;
    if (channel >= SIM_PWM_CHANNELS || pulse_ns >= 20000000U) {
        return HAL_ERROR_ARGUMENT;
    }
    sim->pulse_ns[channel] = pulse_ns;
    return HAL_OK;
}

bool sim_hal_bind(struct sim *sim) {
    static const struct hal_clock_ops clock_ops = {clock_now_us};
    static const struct hal_pwm_ops pwm_ops = {pwm_limits, pwm_set_period, pwm_set_pulse};
    return hal_clock_bind(&sim->clock, &clock_ops, sim) == HAL_OK &&
           hal_pwm_bind(&sim->pwm, &pwm_ops, sim) == HAL_OK;
}
