#include "sim_private.h"

static uint32_t clock_now_us(void *ctx) {
    const struct sim *sim = ctx;
    return sim->config.start_us + (uint32_t)sim->time_us;
}

static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    struct sim *sim = ctx;
    return can_bus_send(&sim->bus, &sim->node, frame, sim->time_us * 1000U) ? HAL_OK : HAL_BUSY;
}

static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    struct sim *sim = ctx;
    uint64_t at_ns;
    if (!can_rx_queue_pop(&sim->received, frame, &at_ns)) {
        return HAL_EMPTY;
    }
    *received_us = sim->config.start_us + (uint32_t)(at_ns / 1000U);
    return HAL_OK;
}

static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    const struct sim *sim = ctx;
    *state = (struct hal_can_state){.health = sim->node.offline ? HAL_CAN_OFF : HAL_CAN_ACTIVE,
                                    .lost_count = (uint32_t)sim->received.overruns};
    return HAL_OK;
}

/// The controller's own filters are exercised by the contract suite on other devices; here every
/// frame is heard.
static enum hal_status can_set_filters(void *ctx, const struct hal_can_filter *filters,
                                       uint32_t count) {
    (void)ctx;
    (void)filters;
    (void)count;
    return HAL_ERROR_UNSUPPORTED;
}

static enum hal_status can_restart(void *ctx) {
    struct sim *sim = ctx;
    sim->node.offline = false;
    return HAL_OK;
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
    static const struct hal_can_ops can_ops = {can_send, can_receive, can_state, can_set_filters,
                                               can_restart};
    static const struct hal_pwm_ops pwm_ops = {pwm_limits, pwm_set_period, pwm_set_pulse};
    return hal_clock_bind(&sim->clock, &clock_ops, sim) == HAL_OK &&
           hal_can_bind(&sim->can, &can_ops, sim) == HAL_OK &&
           hal_pwm_bind(&sim->pwm, &pwm_ops, sim) == HAL_OK;
}
