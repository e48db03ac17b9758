/// PWM on files, of which a call fails: in front of a driver whose calls are system calls.
#ifndef CONTRACT_SUPPORT_FAILING_PWM_H
#define CONTRACT_SUPPORT_FAILING_PWM_H

#include "hal/pwm.h"

#include <stdbool.h>

struct failing_pwm {
    struct hal_pwm hal;
    const struct hal_pwm *inside;
    uint32_t nth; ///< calls until the one that fails; 0: none does
};

/// Hands calls on to inside.
void failing_pwm_init(struct failing_pwm *pwm, const struct hal_pwm *inside);

/// Of the calls that set something, the nth from now on (1: the next) finds that its first write
/// fails with EIO. false: another status can't be had.
bool failing_pwm_at(struct failing_pwm *pwm, uint32_t nth, enum hal_status status);

#endif
