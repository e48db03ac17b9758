/// Servo pulses from the PWM slices: 50 Hz and a resolution of 0.5 us after init.
///
/// Pins 2n and 2n + 1 are the two channels of one slice and share its period (4.5.2); pins 16 apart
/// share the channel itself, so use only one of them.
/// Shown: tests/mcu/rp2040/pico.sh.
#ifndef RP2040_RP2040_PWM_H
#define RP2040_RP2040_PWM_H

#include "hal/pwm.h"

struct rp2040_pwm {
    struct hal_pwm hal;
    const uint8_t *pins; ///< of each channel
    uint32_t channel_count;
};

/// Starts the slices of the pins; no channel gives pulses. core_hz: a multiple of 1 MHz, up to 512.
void rp2040_pwm_init(struct rp2040_pwm *pwm, const uint8_t *pins, uint32_t channel_count,
                     uint32_t core_hz);

#endif
