#include "stm32f4/stm32f4_pwm.h"

#include "stm32f4/stm32f4_clocks.h"

#define RESOLUTION_NS   500U
#define COUNTER_HZ      2000000U
#define PERIOD_NS_FIRST 20000000U
#define STEPS_MAX       65536U ///< TIM3 and TIM4 count to 2^16 - 1

static uint32_t period_steps(const struct stm32f4_timer *timer) {
    return timer->arr + 1U;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    const struct stm32f4_pwm *pwm = ctx;
    if (channel >= pwm->channel_count) {
        return HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){.period_ns = period_steps(pwm->channels[channel].timer) *
                                                   RESOLUTION_NS,
                                      .period_ns_min = 2U * RESOLUTION_NS,
                                      .period_ns_max = STEPS_MAX * RESOLUTION_NS,
                                      .resolution_ns = RESOLUTION_NS};
    return HAL_OK;
}

static enum hal_status pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    const struct stm32f4_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || period_ns < 2U * RESOLUTION_NS ||
        period_ns > STEPS_MAX * RESOLUTION_NS) {
        return HAL_ERROR_ARGUMENT;
    }
    struct stm32f4_timer *timer = pwm->channels[channel].timer;
    const uint32_t steps = hal_pwm_round_ns(period_ns, RESOLUTION_NS) / RESOLUTION_NS;
    for (unsigned output = 0; output < 4U; output++) {
        if (timer->ccr[output] >= steps) {
            return HAL_ERROR_ARGUMENT;
        }
    }
    timer->arr = steps - 1U;
    return HAL_OK;
}

static enum hal_status pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    const struct stm32f4_pwm *pwm = ctx;
    if (channel >= pwm->channel_count || pulse_ns > STEPS_MAX * RESOLUTION_NS) {
        return HAL_ERROR_ARGUMENT;
    }
    const struct stm32f4_pwm_channel *to = &pwm->channels[channel];
    const uint32_t steps = hal_pwm_round_ns(pulse_ns, RESOLUTION_NS) / RESOLUTION_NS;
    if (steps >= period_steps(to->timer)) {
        return HAL_ERROR_ARGUMENT;
    }
    to->timer->ccr[to->output] = steps;
    return HAL_OK;
}

static const struct hal_pwm_ops stm32f4_pwm_ops = {pwm_limits, pwm_set_period, pwm_set_pulse};

/// 18.3.9: up-counting, edge-aligned. New periods and pulses wait for the end of the running one.
static void start_timer(struct stm32f4_timer *timer, uint32_t timer_hz) {
    stm32f4_clocks_enable(timer);
    timer->cr1 = STM32F4_TIMER_CR1_ARPE;
    timer->psc = timer_hz / COUNTER_HZ - 1U;
    timer->arr = PERIOD_NS_FIRST / RESOLUTION_NS - 1U;
    for (unsigned output = 0; output < 4U; output++) {
        timer->ccr[output] = 0;
    }
    const uint32_t mode = STM32F4_TIMER_CCMR_PWM1 | STM32F4_TIMER_CCMR_PRELOAD;
    timer->ccmr[0] = timer->ccmr[1] = mode | mode << 8;
    timer->egr = STM32F4_TIMER_EGR_UG; // takes them over now
    timer->cr1 = STM32F4_TIMER_CR1_ARPE | STM32F4_TIMER_CR1_CEN;
}

void stm32f4_pwm_init(struct stm32f4_pwm *pwm, const struct stm32f4_pwm_channel *channels,
                      uint32_t channel_count, uint32_t timer_hz) {
    (void)!hal_pwm_bind(&pwm->hal, &stm32f4_pwm_ops, pwm);
    pwm->channels = channels;
    pwm->channel_count = channel_count;
    for (uint32_t i = 0; i < channel_count; i++) {
        start_timer(channels[i].timer, timer_hz);
    }
    for (uint32_t i = 0; i < channel_count; i++) {
        channels[i].timer->ccer |= 1U << 4U * channels[i].output;
        stm32f4_gpio_set_alternate(channels[i].pin, channels[i].alternate, HAL_GPIO_PULL_DOWN);
    }
}
