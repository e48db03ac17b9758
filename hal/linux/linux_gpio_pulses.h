/// hal/pwm.h on plain GPIO lines: a thread raises and lowers them. For hobby servos on a board
/// without PWM outputs; a channel's number is its line on the chip.
///
/// All channels have one period and begin together. How far pulses were off is measured, because no
/// system without real-time hardware gives them exactly: 1 us is 0.09 degree of a usual servo. A
/// line that can't be set any more ends all pulses of the chip, and every call says HAL_ERROR_GONE.
/// Shown: tests/contract/linux_gpio_edges.c (the contract suite in virtual time, lines that fail),
/// tests/vm/linux_gpio.c (on gpio-sim, with the jitter printed).
#ifndef HAL_LINUX_GPIO_PULSES_H
#define HAL_LINUX_GPIO_PULSES_H

#include "fixed/must_check.h"
#include "hal/pwm.h"
#include "linux/linux_error.h"
#include "linux/linux_gpio.h"
#include "linux/linux_gpio_thread.h"
#include "linux/linux_jitter.h"

#define LINUX_GPIO_PULSES_MAX 4U

struct linux_gpio_pulses {
    struct hal_pwm hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    char chip[LINUX_GPIO_NAME_BYTES];
    struct linux_gpio_thread thread;
    uint64_t (*now_ns)(void);
    bool open;
    atomic_bool failed; ///< by the thread: a line could not be set
    _Atomic uint32_t period_ns;
    uint64_t period_start_ns, period_end_ns;
    uint32_t count;
    struct linux_gpio_pulse {
        uint32_t line;
        void *held; ///< by the library
        _Atomic uint32_t wanted_ns;
        uint32_t given_ns; ///< of the period under way
        uint64_t rise_ns;
        bool high;
    } pulse[LINUX_GPIO_PULSES_MAX];
    pthread_mutex_t jitter_lock;
    struct linux_jitter jitter; ///< ns by which pulses were too long
};

/// Requests the lines, low, and starts the thread.
/// chip:     as for linux_gpio_open. lines: count of them, 1 to LINUX_GPIO_PULSES_MAX.
/// Returns:  as linux_gpio_open; HAL_ERROR_IO also if there is no thread to be had. If not HAL_OK,
///           nothing is open, pulses->error has the line, and pulses->hal answers HAL_ERROR_GONE.
/// Must not move in memory afterwards.
enum hal_status linux_gpio_pulses_open(struct linux_gpio_pulses *pulses, const char *chip,
                                       const uint32_t *lines, uint32_t count) MUST_CHECK;
/// Ends the pulses, each when it is due, and gives the lines back.
void linux_gpio_pulses_close(struct linux_gpio_pulses *pulses);

/// How far the pulses so far were off. Adds to *jitter, whose step is 1000 (ns).
void linux_gpio_pulses_jitter(struct linux_gpio_pulses *pulses, struct linux_jitter *jitter);

/// The thread's work, for tests that bring a clock of their own: opens without a thread.
enum hal_status linux_gpio_pulses_prepare(struct linux_gpio_pulses *pulses, const char *chip,
                                          const uint32_t *lines, uint32_t count,
                                          uint64_t (*now_ns)(void)) MUST_CHECK;
uint64_t linux_gpio_pulses_work(void *pulses, uint64_t now_ns);

#endif
