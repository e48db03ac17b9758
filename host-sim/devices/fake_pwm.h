/// Pulse outputs in memory: timers with a few channels each, as microcontrollers have them.
#ifndef DEVICES_FAKE_PWM_H
#define DEVICES_FAKE_PWM_H

#include "devices/fake_failures.h"
#include "hal/pwm.h"

#define FAKE_PWM_CHANNELS_MAX 16U

struct fake_pwm {
    struct hal_pwm hal;
    struct fake_failures failures;
    uint32_t channel_count, channels_a_timer, resolution_ns;
    /// What is on the pins: periods by timer, pulses by channel (0: steadily low).
    uint32_t periods_ns[FAKE_PWM_CHANNELS_MAX], pulses_ns[FAKE_PWM_CHANNELS_MAX];
};

#define FAKE_PWM_PERIOD_NS     20000000U
#define FAKE_PWM_PERIOD_NS_MIN 1000000U
#define FAKE_PWM_PERIOD_NS_MAX 65536000U

/// Must not move in memory afterwards. channel_count: 1 to FAKE_PWM_CHANNELS_MAX, of which each
/// channels_a_timer (at least 1) share a period, 20 ms at first. resolution_ns: a divisor of 1 ms.
void fake_pwm_init(struct fake_pwm *pwm, uint32_t channel_count, uint32_t channels_a_timer,
                   uint32_t resolution_ns);

/// What is on a channel's pin, at once: the model has no periods under way. channel: less than
/// channel_count.
uint32_t fake_pwm_pulse_ns(const struct fake_pwm *pwm, uint32_t channel);
uint32_t fake_pwm_period_ns(const struct fake_pwm *pwm, uint32_t channel);

#endif
