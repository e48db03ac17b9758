/// The contract of hal/pwm.h as a test.
#ifndef CONTRACT_SUPPORT_PWM_SUITE_H
#define CONTRACT_SUPPORT_PWM_SUITE_H

#include "hal/pwm.h"

#include <stdbool.h>

struct pwm_fixture {
    const char *name;
    const struct hal_pwm *pwm;
    uint32_t channel_count;
    void *context;
    /// As after power-on, no failure pending.
    void (*reset)(void *context);
    /// What is on a channel's pin, once any period under way is over; pulse 0: steadily low.
    void (*measure)(void *context, uint32_t channel, uint32_t *pulse_ns, uint32_t *period_ns);
    /// How far a measurement may be off.
    uint32_t measure_error_ns;
    /// Of devices whose periods have coarser steps than their pulses; 0: as fine.
    uint32_t period_step_ns;
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
};

void pwm_suite(const struct pwm_fixture *fixture);

#endif
