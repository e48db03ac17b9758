#include "rp2040/rp2040_pwm.h"

#include "rp2040/rp2040_gpio.h"
#include "rp2040/rp2040_registers.h"

#define RESOLUTION_NS   500U
#define PERIOD_NS_FIRST 20000000U
#define STEPS_MAX       65536U

/// GPIO function table, 2.19.2: the pins count through the slices twice.
static struct rp2040_pwm_slice *slice_of(uint8_t pin) {
    return &RP2040_PWM_SLICES[pin / 2U % 8U];
}

/// The odd pin's width is in the upper half of the register.
static unsigned shift_of(uint8_t pin) {
    return pin % 2U * 16U;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    const struct rp2040_pwm *pwm = ctx;
    if (channel >= pwm->channel_count) {
        return HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){.period_ns =
                                          (slice_of(pwm->pins[channel])->top + 1U) * RESOLUTION_NS,
                                      .period_ns_min = 2U * RESOLUTION_NS,
                                      .period_ns_max = STEPS_MAX * RESOLUTION_NS,
                                      .resolution_ns = RESOLUTION_NS};
    return HAL_OK;
}

static enum hal_status pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    const struct rp2040_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || period_ns < 2U * RESOLUTION_NS ||
        period_ns > STEPS_MAX * RESOLUTION_NS) {
        return HAL_ERROR_ARGUMENT;
    }
    struct rp2040_pwm_slice *slice = slice_of(pwm->pins[channel]);
    const uint32_t steps = hal_pwm_round_ns(period_ns, RESOLUTION_NS) / RESOLUTION_NS;
    const uint32_t pulses = slice->compare;
    if ((pulses & 0xFFFFU) >= steps || pulses >> 16 >= steps) {
        return HAL_ERROR_ARGUMENT;
    }
    slice->top = steps - 1U;
    return HAL_OK;
}

/// 4.5.2.3: new widths wait for the end of the period.
static enum hal_status pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    const struct rp2040_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || pulse_ns > STEPS_MAX * RESOLUTION_NS) {
        return HAL_ERROR_ARGUMENT;
    }
    struct rp2040_pwm_slice *slice = slice_of(pwm->pins[channel]);
    const uint32_t steps = hal_pwm_round_ns(pulse_ns, RESOLUTION_NS) / RESOLUTION_NS;
    if (steps > slice->top) {
        return HAL_ERROR_ARGUMENT;
    }
    const unsigned shift = shift_of(pwm->pins[channel]);
    slice->compare = (slice->compare & ~(UINT32_C(0xFFFF) << shift)) | steps << shift;
    return HAL_OK;
}

static const struct hal_pwm_ops rp2040_pwm_ops = {pwm_limits, pwm_set_period, pwm_set_pulse};

void rp2040_pwm_init(struct rp2040_pwm *pwm, const uint8_t *pins, uint32_t channel_count,
                     uint32_t core_hz) {
    *pwm = (struct rp2040_pwm){{&rp2040_pwm_ops, pwm}, pins, channel_count};
    for (uint32_t i = 0; i < channel_count; i++) {
        struct rp2040_pwm_slice *slice = slice_of(pins[i]);
        slice->control = 0;
        slice->divisor = core_hz / 1000000U * 16U * RESOLUTION_NS / 1000U; // in 1/16
        slice->counter = 0;
        slice->compare = 0;
        slice->top = PERIOD_NS_FIRST / RESOLUTION_NS - 1U;
        slice->control = RP2040_PWM_CONTROL_ENABLE;
    }
    for (uint32_t i = 0; i < channel_count; i++) {
        rp2040_gpio_set_function(pins[i], RP2040_FUNCTION_PWM, HAL_GPIO_PULL_DOWN);
    }
}
