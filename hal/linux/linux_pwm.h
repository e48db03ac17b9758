/// hal/pwm.h on the PWM outputs of Linux (/sys/class/pwm): those of a Raspberry Pi, of other
/// boards' timers, of an I2C servo board whose driver is loaded.
///
/// Outputs are exported when the device is opened, and silent until a pulse is set. Of most chips
/// the kernel doesn't tell what they make of a pulse: it has steps of 1 ns here, and a period that
/// a chip can't do, or that another output of it forbids, is refused. Of the PCA9685 (the I2C servo
/// board with 16 outputs) it is known: 4096 steps a period, 4880 ns at 20 ms, rounded to the
/// nearest one (the kernel would round up); all outputs share the period, a multiple of 163840 ns.
/// The kernel does not tell either when that board's cable is off: a servo that stops is all there
/// is to see.
///
/// Shown: tests/contract/linux_pwm.c (the contract suite, failures at every write, on files that
/// stand for the kernel's), tests/vm/linux_pwm.c (the same on the kernel's own driver of the
/// PCA9685, against the registers of the chip).
/// Source: NXP, PCA9685, Rev. 4: 7.3.3 (LED outputs), 7.3.5 (prescaler).
#ifndef HAL_LINUX_PWM_H
#define HAL_LINUX_PWM_H

#include "fixed/must_check.h"
#include "hal/pwm.h"
#include "linux/linux_error.h"

#include <stdbool.h>

#define LINUX_PWM_CHANNELS_MAX 32U
#define LINUX_PWM_ROOT         "/sys/class/pwm"

struct linux_pwm {
    struct hal_pwm hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    bool gone;
    const struct linux_pwm_kind *kind; ///< null: nothing is known of the chip
    char folder[200];                  ///< of the chip
    char name[32];                     ///< for messages: pwmchip0
    struct linux_pwm_channel {
        bool open, enabled;
        int period_fd, duty_fd, enable_fd;
        uint32_t period_ns, pulse_ns; ///< the pulse as asked for
    } channel[LINUX_PWM_CHANNELS_MAX];
};

/// root:     LINUX_PWM_ROOT, or a folder like it. chip: pwmchip0 or the like.
/// channels: a bit for each output that is wanted, bit 0 for output 0.
/// Returns:  HAL_OK: pwm->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such chip; HAL_ERROR_ARGUMENT: it has no such output;
///           HAL_ERROR_DENIED: no permission, or the kernel uses the output itself; HAL_ERROR_IO.
///           If not HAL_OK, nothing is open, pwm->error has the line, and pwm->hal answers
///           HAL_ERROR_GONE. Must not move in memory afterwards.
/// Cost:     waits up to half a second for the files of a new output to get their permissions.
enum hal_status linux_pwm_open(struct linux_pwm *pwm, const char *root, const char *chip,
                               uint32_t channels) MUST_CHECK;

/// Whether the chip is still there: call it at every tick, since only a pulse that changes is
/// written. Returns: HAL_OK, HAL_ERROR_GONE, HAL_ERROR_IO. Cost: a system call an output.
enum hal_status linux_pwm_poll(struct linux_pwm *pwm);

/// Ends the pulses of its outputs.
void linux_pwm_close(struct linux_pwm *pwm);

/// A chip as `boresight probe` shows it.
struct linux_pwm_chip {
    char name[32];
    char driver[32]; ///< the kernel's, empty: unknown
    uint32_t channel_count;
};

/// All chips, up to capacity. Returns how many there are.
uint32_t linux_pwm_list(const char *root, struct linux_pwm_chip *chips, uint32_t capacity);

#endif
