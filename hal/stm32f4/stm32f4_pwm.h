/// Servo pulses from the general-purpose timers TIM2 to TIM5: up to four channels each.
///
/// 50 Hz and a resolution of 0.5 us after init, whatever the bus clock. Channels of one timer share
/// their period.
/// Shown: tests/mcu/hal/suites.c.
#ifndef STM32F4_STM32F4_PWM_H
#define STM32F4_STM32F4_PWM_H

#include "hal/pwm.h"
#include "stm32f4/stm32f4_gpio.h"
#include "stm32f4/stm32f4_registers.h"

struct stm32f4_pwm_channel {
    struct stm32f4_timer *timer;
    uint8_t output; ///< 0 to 3: the timer's channel 1 to 4
    uint8_t alternate;
    struct stm32f4_pin pin;
};

struct stm32f4_pwm {
    struct hal_pwm hal;
    const struct stm32f4_pwm_channel *channels;
    uint32_t channel_count;
};

/// Starts the timers; no channel gives pulses. timer_hz: a multiple of 2 MHz.
void stm32f4_pwm_init(struct stm32f4_pwm *pwm, const struct stm32f4_pwm_channel *channels,
                      uint32_t channel_count, uint32_t timer_hz);

#endif
